"""Killed at random, torn and full: every record is kept once, as if nothing had been, and nobody is left."""

from __future__ import annotations

import sys
from pathlib import Path

import guest_fakes
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[3]))
from benchmarks import chaos

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="looks for processes in /proc")


@pytest.mark.parametrize(
    ("real", "trials", "kills"),
    [
        pytest.param(True, 20, 3, id="held-short"),
        pytest.param(True, 40, 6, id="held", marks=pytest.mark.nightly),
        pytest.param(False, 300, 6, id="made-up", marks=pytest.mark.nightly),
    ],
)
def test_a_disturbed_run_is_as_an_undisturbed_one(real: bool, trials: int, kills: int, tmp_path: Path):
    agent = guest_fakes.write(tmp_path / "agent")

    def command(folder: Path) -> list[str]:
        return chaos.held(folder, trials, agent, "auto") if real else chaos.fake(folder, trials)

    reference, folder = tmp_path / "undisturbed", tmp_path / "disturbed"
    chaos.Chaos(command(reference), reference).finish()
    storm = chaos.Chaos(command(folder), folder)
    storm.kill(kills, trials, 1_000)  # less than any trial's line
    storm.finish()
    assert chaos.differences(folder, reference) == []
    assert storm.report.orphans == []
    assert storm.report.killed["runner"] == kills // 3
    assert storm.report.killed["worker"] + storm.report.killed["guest"] >= kills // 3
    full = [words for words in storm.report.ended if "trials.jsonl: File too large" in words]
    assert len(full) == storm.report.full == kills // 3
    assert all(words.startswith("2: ") for words in full)
