"""Voided trials: they stay in the log with their reason, do not count, and are repeated under the same task."""

from __future__ import annotations

import json
from pathlib import Path
from unittest import mock

import eval_fakes as fakes
import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st
from typer.testing import CliRunner

from hthor import code_identity
from hthor.cli import app
from hthor.errors import RunError, UnknownName
from hthor.eval.comparison import compare
from hthor.eval.config import run_config, shards
from hthor.eval.merge import merge_shards
from hthor.eval.records import attempts, find, trial_log, trial_record
from hthor.eval.records.attempts import Attempt, Attempts
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.records.trial_record import TrialRecord
from hthor.eval.results import aggregate, pairing
from hthor.eval.runner import progress, run
from hthor.humans.models import _logged_trials
from hthor.leaderboard import enter
from hthor.leaderboard.entries.files import BoardError
from hthor.report.analysis import load_runs
from hthor.types import TrialSpec
from hthor.types.events import Voided

COUNT = 20
CABLE = "the headset's cable came loose"


def voided(trial: TrialSpec, reason: str = CABLE) -> TrialRecord:
    """The record of an attempt that ended after a moment."""
    log = fakes.episode(trial)
    end = Voided(tick=30, seat="human", reason=reason)
    events = (*(event for event in log.events if event.tick < 30), end)
    ratings = dict.fromkeys(log.ratings)
    return trial_record.make_record(
        trial, msgspec.structs.replace(log, events=events, ticks=30, met=False, ratings=ratings)
    )


def played(trial: TrialSpec) -> TrialRecord:
    return trial_record.make_record(trial, fakes.episode(trial, trial.index))


def begun(folder: Path, *, name: str = "helper", absent: bool = False) -> tuple[RunFolder, list[TrialSpec]]:
    """A run's folder without trials, and its trials."""
    plan, dealt = fakes.run_of(COUNT, name=name, absent=absent)
    where = RunFolder(folder)
    where.path.mkdir(parents=True)
    where.write_config(plan)
    return where, [trial for one in dealt for trial in one.trials]


def resumed(folder: RunFolder) -> aggregate.RunResult:
    plan, dealt = fakes.run_of(COUNT)
    return run.run_evaluation(plan, dealt, fakes.player, folder=folder, engine=fakes.Here(), watcher=progress.Silent())


@pytest.fixture
def disturbed(tmp_path: Path) -> RunFolder:
    """A run in which the third trial was voided twice before it was done, and nothing else was done yet."""
    folder, trials = begun(tmp_path / "disturbed")
    with folder.open_log() as log:
        for reason in (CABLE, "a fire drill"):
            assert log.add(voided(log.due(trials[2]), reason))
        assert log.add(played(log.due(trials[2])))
    return folder


def test_a_voided_trial_is_due_again_under_the_same_task(tmp_path: Path) -> None:
    folder, trials = begun(tmp_path / "run")
    first = trials[2]
    with folder.open_log() as log:
        assert log.due(first) == first
        assert log.add(voided(first))
        again = log.due(first)
        assert again == msgspec.structs.replace(first, attempt=1)
        assert trial_record.key(again) != trial_record.key(first), "so the log does not take it for the same line"
        assert log.add(voided(again))
        third = log.due(first)
        assert third.attempt == 2
        assert (log.counted, len(log)) == (0, 2)
        assert log.add(played(third))
        assert not log.add(played(third)), "the same attempt is written once"
        assert log.due(first) == third, "it counts now"
        assert (log.counted, len(log)) == (1, 3)
    with folder.open_log() as log:
        assert log.due(first) == third, "a new process knows it from the file"
    reasons = [one.log.voided for _, one in trial_log.read(folder.log_file)]
    assert reasons == [CABLE, CABLE, ""], "every attempt stays, with its reason"


def test_a_run_goes_on_after_a_voided_trial(disturbed: RunFolder, tmp_path: Path) -> None:
    found = resumed(disturbed)
    whole, _ = begun(tmp_path / "undisturbed")
    same = resumed(whole)
    assert (found.counts.trials, found.counts.voided) == (COUNT, 2)
    assert same.counts.voided is msgspec.UNSET
    assert found.metrics == same.metrics
    assert len(disturbed.attempts()) == COUNT + 2
    records = disturbed.records()
    assert [one.spec.attempt or 0 for one in records] == [2 if number == 2 else 0 for number in range(COUNT)]
    assert [one.reason for one in disturbed.voided] == [CABLE, "a fire drill"]
    before = disturbed.log_file.read_bytes()
    assert resumed(disturbed) == found, "nothing is left to do"
    assert disturbed.log_file.read_bytes() == before


def test_an_attempt_that_is_missing_is_played(tmp_path: Path) -> None:
    folder, trials = begun(tmp_path / "run")
    resumed(folder)
    lines = [line for line, _ in trial_log.read(folder.log_file)]
    gone = trial_record.key(trials[4])
    kept = [line for line, one in trial_log.read(folder.log_file) if one.key != gone]
    folder.log_file.write_bytes(b"".join(kept) + trial_record.encode(voided(trials[4])))
    found = resumed(folder)
    assert (found.counts.trials, found.counts.voided) == (COUNT, 1)
    assert len(list(trial_log.read(folder.log_file))) == len(lines) + 1
    assert folder.records()[4].spec.attempt == 1


def test_who_reads_a_run_reads_what_counts(disturbed: RunFolder, tmp_path: Path) -> None:
    resumed(disturbed)
    plain, _ = begun(tmp_path / "alone", absent=True)
    plan, dealt = fakes.run_of(COUNT, absent=True)
    run.run_evaluation(plan, dealt, fakes.player, folder=plain, engine=fakes.Here(), watcher=progress.Silent())
    _, result, _ = aggregate.rescore(disturbed.path)
    assert (result.counts.trials, result.counts.voided) == (COUNT, 2)
    compared = compare.compare_runs([plain.path, disturbed.path])
    assert (compared.pairs[0].n, compared.pairs[0].dropped) == (COUNT, (0, 0)), "an attempt has its partner"
    assert [one.voided for one in compared.runs] == [msgspec.UNSET, 2]
    (read,) = load_runs.load_runs([disturbed.path])
    assert (len(read.records), len(read.voided)) == (COUNT, 2)
    logged = _logged_trials.read_logged_trials(str(disturbed.path))
    assert [len(own) for own in logged.values()] == [10, 10]
    assert all(trial.spec.attempt == 2 for trial in logged[0] if trial.spec.index == 2)
    one, other = disturbed.records()[2].spec, plain.records()[2].spec
    assert pairing.pairing_key(one) == pairing.pairing_key(other)


def test_shards_with_attempts_are_merged(disturbed: RunFolder, tmp_path: Path) -> None:
    resumed(disturbed)
    whole, parts = disturbed.config, []
    for words in ("1/2", "2/2"):
        shard = run_config.shard_config(whole, shards.parse_shard(words), COUNT)
        folder = RunFolder(tmp_path / f"part-{words[0]}")
        folder.path.mkdir()
        folder.write_config(shard)
        own = shard.shard.share(range(2))
        kept = (line for line, one in trial_log.read(disturbed.log_file) if one.spec.session in own)
        folder.log_file.write_bytes(b"".join(kept))
        parts.append(folder.path)
    dry = merge_shards.merge_shards(parts, tmp_path / "merged", dry=True)
    assert (dry.trials, dry.new) == (COUNT, COUNT)
    done = merge_shards.merge_shards(parts, tmp_path / "merged")
    assert (done.trials, done.new, done.gaps) == (COUNT, COUNT, ())
    assert done.result is not None
    assert done.result.counts.voided == 2
    assert len(RunFolder(tmp_path / "merged").attempts()) == COUNT + 2


def test_an_attempt_can_be_named(disturbed: RunFolder) -> None:
    resumed(disturbed)
    task = disturbed.records()[2].spec.task.id
    assert find.find_trial(disturbed, "2").spec.attempt == 2, "the one that counts"
    assert find.find_trial(disturbed, task).spec.attempt == 2
    for name in ("2@0", f"{task}@0"):
        assert find.find_trial(disturbed, name).log.voided == CABLE
    first = disturbed.voided[0]
    assert find.find_trial(disturbed, first.key[:8]).log.voided == CABLE
    with pytest.raises(UnknownName, match=r"unknown attempt '7'.*Valid: 0, 1, 2"):
        find.find_trial(disturbed, "2@7")


def test_while_every_attempt_is_void_it_can_still_be_named(tmp_path: Path) -> None:
    folder, trials = begun(tmp_path / "run")
    with folder.open_log() as log:
        log.add(voided(trials[0]))
    assert folder.records() == []
    assert find.find_trial(folder, f"{trials[0].task.id}@0").log.voided == CABLE
    with pytest.raises(RunError, match="no trials"):
        load_runs.load_runs([folder.path])


def test_a_run_with_voided_trials_is_not_ranked(disturbed: RunFolder) -> None:
    resumed(disturbed)
    same = mock.patch.object(code_identity, "code_sha256", return_value=disturbed.config.code_sha256)
    with same, pytest.raises(BoardError, match="has 2 voided trials, and cannot stand on the leaderboard"):
        enter.make_entry(disturbed.path)


def hthor(*words: str) -> str:
    said = CliRunner().invoke(app, words, env={"COLUMNS": "200"}, catch_exceptions=False)
    assert said.exit_code == 0, said.output
    return said.output


def test_it_is_said_how_many_were_voided(disturbed: RunFolder) -> None:
    resumed(disturbed)
    assert "2 attempts were voided and do not count" in hthor("score", str(disturbed.path))
    assert f"attempt 0, {disturbed.voided[0].key}: {CABLE}" in hthor("runs", "view", str(disturbed.path))
    document = json.loads(hthor("runs", "view", str(disturbed.path), "--json"))
    assert [one["reason"] for one in document["voided"]] == [CABLE, "a fire drill"]
    assert document["done"] == COUNT


@given(st.lists(st.tuples(st.integers(0, 2), st.booleans()), max_size=12))
def test_the_last_attempt_that_was_not_voided_counts(rows: list[tuple[int, bool]]) -> None:
    known, by_trial = Attempts(), {}
    for index, void in rows:
        number = len(by_trial.setdefault(index, []))
        by_trial[index].append(void)
        known.add(Attempt((0, index), number, void))
    for index, voids in by_trial.items():
        valid = [number for number, void in enumerate(voids) if not void]
        assert known.number((0, index)) == (valid[-1] if valid else len(voids))
        for number, void in enumerate(voids):
            assert known.counts(Attempt((0, index), number, void)) == (valid[-1:] == [number])
    assert known.counted == sum(not all(voids) for voids in by_trial.values())
    assert known.voided == sum(void for _, void in rows)
    assert known.number((0, 99)) == 0


def test_a_line_says_which_attempt_it_is() -> None:
    trial = msgspec.structs.replace(fakes.run_of(10)[1][0].trials[3], attempt=4)
    for record, void in ((played(trial), False), (voided(trial), True)):
        one = attempts.read_attempt(trial_record.encode(record))
        assert one == attempts.attempt_of(record) == Attempt((0, 3), 4, void)
