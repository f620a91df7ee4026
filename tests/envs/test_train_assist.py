"""The example that learns: its intervals are right, and it trains and tests."""

from __future__ import annotations

import runpy
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("sb3_contrib", reason="needs the extra sb3")
pytest.importorskip("gymnasium", reason="needs the extra learn")


@pytest.fixture(scope="module")
def example(root: Path) -> dict[str, Any]:
    return runpy.run_path(str(root / "examples" / "train_assist.py"))


def test_it_prints_intervals(example: dict[str, Any]) -> None:
    rows = np.array([[1.0, 0.5, 20.0], [0.0, -1.0, 90.0], [1.0, 0.9, 10.0], [1.0, 0.8, 16.0]])
    assert example["success"](rows) == "success 75 % (30 to 95) of 4"
    assert example["mean"](rows[:, 2]) == "34.00 (-2.81 to 70.81)"


@pytest.mark.nightly
def test_it_trains_and_tests(
    example: dict[str, Any], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "argv", ["train_assist.py", "--decisions", "4096", "--episodes", "3"])
    example["main"]()
    assert [line.split(":")[0] for line in capsys.readouterr().out.splitlines()[-3:]] == [
        "learned",
        "random",
        "learned - random",
    ]
