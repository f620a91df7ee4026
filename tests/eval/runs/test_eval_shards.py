"""A run in shards: each has its share, merging gives the undivided run's bytes, and what is missing has a name."""

from __future__ import annotations

import json
import shlex
from collections.abc import Sequence
from pathlib import Path

import eval_fakes as fakes
import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st
from typer.testing import CliRunner, Result

from hthor.cli import app
from hthor.errors import HthorError, RunError
from hthor.eval.config import run_config
from hthor.eval.config.shards import Shard, parse_shard
from hthor.eval.merge import merge_shards
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.runner import progress, run
from hthor.trials import sessions

pytestmark = pytest.mark.usefixtures("no_workers")

COUNT = 57
_FILES = [".lock", "effort.json", "platform.json", "run.json", "trials.jsonl"]


def _play(folder: Path, words: str = "", *, make=fakes.player, **how) -> Path:
    """A run, or a shard of it, of tasks that do not divide evenly; its folder."""
    plan, dealt = fakes.run_of(COUNT, **how)
    if words:
        plan = run_config.shard_config(plan, parse_shard(words), COUNT)
        folder, dealt = plan.shard.folder(folder), plan.shard.share(dealt)
    run.run_evaluation(plan, dealt, make, folder=RunFolder(folder), engine=fakes.Here(), watcher=progress.Silent())
    return folder


@pytest.fixture(scope="module")
def undivided(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return _play(tmp_path_factory.mktemp("undivided") / "run")


@pytest.fixture(scope="module")
def shards(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """Not to be changed."""
    folder = tmp_path_factory.mktemp("shards") / "run"
    return [_play(folder, f"{number}/4") for number in range(1, 5)]


def _result(folder: Path) -> dict[str, object]:
    document = json.loads((folder / "result.json").read_bytes())
    assert document.pop("effort")
    return document


@given(st.integers(1, 90), st.integers(1, 40), st.integers(1, 40))
def test_shards_are_a_partition_and_know_their_size(tasks: int, people: int, of: int):
    plan, _ = fakes.run_of(10)
    plan = msgspec.structs.replace(plan, participants=people)
    if of > people:
        with pytest.raises(HthorError, match=f"{people} shards at most"):
            run_config.shard_config(plan, Shard(number=1, of=of), tasks)
        return
    parts = [run_config.shard_config(plan, Shard(number=number, of=of), tasks).shard for number in range(1, of + 1)]
    held = [participant for part in parts for participant in part.share(range(people))]
    assert sorted(held) == list(range(people))
    hands = [
        sessions.assign_tasks([fakes.task(number) for number in range(tasks)], 0, person) for person in range(people)
    ]
    assert [part.trials for part in parts] == [sum(map(len, part.share(hands))) for part in parts]


@pytest.mark.parametrize("words", ["0/4", "5/4", "4", "a/b", "-1/4", "1/0", "1/4/2"])
def test_a_shard_that_there_is_not_is_refused(words: str):
    with pytest.raises(HthorError, match=r"expected i/N with i from 1 to N"):
        parse_shard(words)


def test_merged_shards_are_the_undivided_run(undivided: Path, shards: Sequence[Path], tmp_path: Path):
    done = merge_shards.merge_shards(shards[::-1], tmp_path / "whole")
    assert (done.trials, done.new, done.gaps) == (COUNT, COUNT, ())
    assert _result(tmp_path / "whole") == _result(undivided)
    assert (tmp_path / "whole" / "run.json").read_bytes() == (undivided / "run.json").read_bytes()
    there = RunFolder(undivided).lines()[0]
    assert (tmp_path / "whole" / "trials.jsonl").read_bytes() == b"".join(there)
    again = merge_shards.merge_shards([*shards, shards[1]], tmp_path / "whole")
    assert (again.trials, again.new, again.result) == (COUNT, 0, done.result)
    assert _play(tmp_path / "whole", make=fakes.forgetful_player)  # plays nothing, as all is there


def test_a_shard_is_no_result(shards: Sequence[Path]):
    assert sorted(path.name for path in shards[0].iterdir()) == _FILES
    assert shards[2].name == "run-shard-3-of-4"


def test_what_is_missing_is_named_with_its_command(undivided: Path, shards: Sequence[Path], tmp_path: Path):
    torn = tmp_path / shards[2].name
    torn.mkdir()
    (torn / "run.json").write_bytes((shards[2] / "run.json").read_bytes())
    lines = (shards[2] / "trials.jsonl").read_bytes().splitlines(keepends=True)
    (torn / "trials.jsonl").write_bytes(b"".join(lines[:-3]) + lines[-3][:40])
    done = merge_shards.merge_shards([shards[0], torn, shards[3]], tmp_path / "whole")
    assert done.result is None
    assert not (tmp_path / "whole" / "result.json").exists()
    second, third = done.gaps
    assert (second.number, second.trials, third.number, third.trials) == (2, None, 3, 3)
    assert shlex.split(second.command)[-4:] == ["--out", str(shards[0].parent / "run"), "--shard", "2/4"]
    assert shlex.split(third.command)[-4:] == ["--out", str(tmp_path / "run"), "--shard", "3/4"]
    _play(tmp_path / "run", "3/4")
    _play(tmp_path / "run", "2/4")
    filled = merge_shards.merge_shards([torn, tmp_path / "run-shard-2-of-4"], tmp_path / "whole")
    assert filled.new == COUNT - done.trials
    assert _result(tmp_path / "whole") == _result(undivided)


def test_the_command_says_what_is_missing_and_ends_with_one(shards: Sequence[Path], tmp_path: Path):
    def said(*words: object) -> Result:
        return CliRunner().invoke(app, ["merge", *map(str, words), "--out", str(tmp_path / "whole")])

    dry = said(*shards[:3], "--dry-run")
    assert dry.exit_code == 1
    assert f"47 of {COUNT} trials would be in" in dry.stderr
    assert not (tmp_path / "whole").exists()
    part = said(*shards[:3])
    assert part.exit_code == 1
    assert f"47 of {COUNT} trials are in" in part.stderr
    assert "shard 4/4 is missing: hthor eval --agent helper.py" in part.stderr
    assert "Replace helper.py by the path of the agent's file." in part.stderr
    assert part.stdout == ""
    whole = said(*shards, "--json")
    assert whole.exit_code == 0
    assert json.loads(whole.stdout)["gaps"] == []


def test_a_part_that_was_merged_is_finished_as_a_run(undivided: Path, shards: Sequence[Path], tmp_path: Path):
    merge_shards.merge_shards(shards[:3], tmp_path)
    _play(tmp_path)
    assert _result(tmp_path) == _result(undivided)


def test_shards_of_several_divisions_are_merged(undivided: Path, shards: Sequence[Path], tmp_path: Path):
    half = _play(tmp_path / "run", "2/2")
    part = merge_shards.merge_shards([shards[0], shards[1], half], tmp_path / "whole")
    (gap,) = part.gaps
    assert (gap.number, gap.of, gap.trials) == (1, 1, COUNT - part.trials)
    assert "--shard" not in gap.command
    assert shlex.split(gap.command)[-2:] == ["--out", str(tmp_path / "whole")]
    assert merge_shards.merge_shards([half, shards[2]], tmp_path / "whole").gaps == ()
    assert _result(tmp_path / "whole") == _result(undivided)


def test_shards_of_other_runs_are_told_apart(undivided: Path, shards: Sequence[Path], tmp_path: Path):
    other = _play(tmp_path / "other", "2/4", seed=1)
    with pytest.raises(RunError, match=r"other-shard-2-of-4 is a shard of another run than .*: seed is 0 there and 1"):
        merge_shards.merge_shards([shards[0], other], tmp_path / "whole")
    with pytest.raises(RunError, match="not divided"):
        merge_shards.merge_shards([undivided], tmp_path / "whole")
    assert not (tmp_path / "whole").exists()


def test_records_of_other_shards_and_other_outcomes_are_refused(shards: Sequence[Path], tmp_path: Path):
    mixed = tmp_path / "mixed"
    mixed.mkdir()
    (mixed / "run.json").write_bytes((shards[0] / "run.json").read_bytes())
    (mixed / "trials.jsonl").write_bytes((shards[1] / "trials.jsonl").read_bytes())
    with pytest.raises(RunError, match=r"spec\.session is 1, which is not in shard 1/4"):
        merge_shards.merge_shards([mixed], tmp_path / "whole")
    otherwise = _play(tmp_path / "otherwise", "2/4", make=fakes.forgetful_player)
    with pytest.raises(RunError, match=r"is not the same in .* and in .*otherwise"):
        merge_shards.merge_shards([*shards, otherwise], tmp_path / "whole")
