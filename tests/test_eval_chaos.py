"""Killed at random, torn and full: every record is kept once, as if nothing had been, and nobody is left."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from benchmarks import chaos

TRIALS = 300


@pytest.mark.skipif(sys.platform != "linux", reason="looks for processes in /proc")
def test_a_disturbed_run_is_as_an_undisturbed_one(tmp_path: Path):
    reference, folder = tmp_path / "undisturbed", tmp_path / "disturbed"
    subprocess.run(chaos.fake(reference, TRIALS), check=True, timeout=300)
    storm = chaos.Chaos(chaos.fake(folder, TRIALS), folder)
    storm.kill(6, TRIALS, 30_000)
    storm.finish()
    assert chaos.differences(folder, reference) == []
    assert storm.report.orphans == []
    assert storm.report.killed["runner"] == 2
    assert storm.report.killed["worker"] + storm.report.killed["guest"] >= 2
    full = [words for words in storm.report.ended if "trials.jsonl: File too large" in words]
    assert len(full) == storm.report.full == 2
    assert all(words.startswith("2: ") for words in full)
