"""A few of the damaged files and made-up command lines that `python -m benchmarks.damage` tries by the thousand."""

from __future__ import annotations

import random
import shutil
from pathlib import Path

import pytest

from benchmarks.damage import files, lines, playground
from benchmarks.damage.asking import Said, ask

FILES, LINES = 12, 6
SLOW = ("check", "make", "verify", "run", "doctor", "generate", "validate", "case", "calibrate", "census", "replay")


@pytest.fixture(scope="module")
def ground(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return playground.make(tmp_path_factory.mktemp("ground"))


def test_a_damaged_file_ends_in_a_clear_error_and_costs_nothing_else(ground: Path, tmp_path: Path) -> None:
    found = [files.damage(ground, tmp_path / str(number), random.Random(f"test {number}")) for number in range(FILES)]
    assert [one for one in found if one.problems] == []
    assert {0, 2} <= {one.code for one in found}


def test_a_made_up_command_line_ends_in_a_documented_way(ground: Path, tmp_path: Path) -> None:
    folder = shutil.copytree(ground, tmp_path / "copy")
    quick = (words for words in lines.lines(random.Random("test"), 1000) if not set(SLOW) & set(words[:2]))
    for _, words in zip(range(LINES), quick, strict=False):
        before = files.contents(folder)
        said = ask(folder, words)
        assert [*said.problems(), *files.lost(before, files.contents(folder), said)] == [], words


def test_the_judge_sees_what_is_wrong() -> None:
    """A test of the test: each sort of bad end is named."""
    bad = {
        "traceback": Said(("score", "x"), 1, "", "", "Traceback (most recent call last)\nKeyError: 'x'"),
        "not documented": Said(("score", "x"), 77, "", "error"),
        "checks nothing": Said(("score", "x"), 1, "", "error"),
        "no number": Said(("score", "x"), 0, '{"mean": nan}', ""),
        "--json": Said(("score", "x", "--json"), 2, "", "error"),
        "without a word": Said(("score", "x"), 2, "", ""),
    }
    for words, said in bad.items():
        assert any(words in problem for problem in said.problems()), words
    assert Said(("score", "x"), 0, "banana, information", "").problems() == []
    assert files.lost({"runs/a/trials.jsonl": b"1"}, {}, bad["no number"]) == ["runs/a/trials.jsonl is not as it was"]
