"""From logs to numbers: a small run worked out by hand, and the laws that every run keeps."""

from __future__ import annotations

import json
import shutil

import eval_fakes as fakes
import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st
from typer.testing import CliRunner

from hthor import code_identity, jsonio
from hthor.cli import app
from hthor.episode import EpisodeLog
from hthor.errors import RunError
from hthor.eval.metrics import trial_metrics
from hthor.eval.metrics.trial_metrics import TrialMetrics
from hthor.eval.records import scored_trial, trial_record
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.results import aggregate, estimates, result_file
from hthor.eval.runner import progress, run
from hthor.report.terminal import result_tables
from hthor.types.events import Accepted, Declined, Event, Sent

pytestmark = pytest.mark.usefixtures("no_workers")


def _log(ticks: int, met: bool, events: tuple[Event, ...] = (), trust: int | None = 4) -> EpisodeLog:
    return EpisodeLog(events=events, paths={"human": []}, ticks=ticks, met=met, ratings={"human": trust}, faults=())


def _sent(message: int, seat: str = "robot") -> Event:
    return Sent(tick=1, seat=seat, message=message, text="here")


def _answer(message: int, kind: type[Accepted | Declined] = Accepted) -> Event:
    return kind(tick=9, seat="human", message=message, sender="robot")


TRIALS = fakes.run_of(10)[1][0].trials
ALONE = fakes.run_of(10, absent=True)[1][0].trials
GOLDEN = (
    # ticks, met, events, trust: what the trial is worth, with T* = 8 s + task number % 7
    (160, True, (_sent(0), _answer(0)), 6),
    (900, False, (_sent(0), _sent(1), _answer(1, Declined)), 2),
    (40, True, (), 4),
)


def test_a_small_log_worked_out_by_hand():
    trials = [trial for trial in TRIALS if trial.task.t_star == 8.0][:1] * 3
    made = [
        scored_trial.score(trial_record.make_record(msgspec.structs.replace(trial, session=number), _log(*case)))
        for number, (trial, case) in enumerate(zip(trials, GOLDEN, strict=True))
    ]
    main = ("sr", "twsr", "adoption", "time_s", "trust")
    assert [tuple(getattr(one.metrics, name) for name in main) for one in made] == [
        (1, 0.5, 1, 16.0, 6),
        (0, 0.0, 0, 90.0, 2),
        (1, 1.0, 0, 4.0, 4),
    ]
    found = estimates.estimate_metrics(made)
    assert [getattr(found, name).mean for name in main] == [0.666667, 0.5, 0.333333, 36.666667, 4.0]
    assert found.sr.ci95[0] < 0.2
    assert found.sr.ci95[1] > 0.9
    assert all(getattr(found, name).n == 3 for name in main)
    counts = ("sent", "accepted", "declined", "covered", "unanswered", "false_claims")
    assert [getattr(found, name).mean for name in counts] == [1.0, 0.333333, 0.333333, 0.0, 0.333333, 0.0]


@given(st.integers(1, 900), st.booleans(), st.sampled_from(TRIALS))
def test_laws_of_one_trial(ticks: int, met: bool, trial):
    found = trial_metrics.measure(trial, _log(ticks, met))
    assert 0.0 <= found.twsr <= found.sr <= 1
    assert 0.0 < found.time_s <= trial.task.time_limit
    assert found.twsr == 0.0 or met
    assert met or found.time_s == trial.task.time_limit


def test_only_a_robots_confirmed_message_is_adopted():
    trial = TRIALS[0]
    cases = (
        ((), 0),
        ((_sent(0),), 0),
        ((_sent(0), _answer(0, Declined)), 0),
        ((_sent(0), _answer(0)), 1),
        ((_sent(0), _sent(1, "robot2"), _answer(1)), 1),
        ((_sent(0, "human"), _answer(0)), 0),
    )
    for events, adopted in cases:
        assert trial_metrics.measure(trial, _log(10, True, events))["adoption"] == adopted
    assert trial_metrics.measure(ALONE[0], _log(10, True))["adoption"] is None


def test_without_a_robot_there_is_neither_adoption_nor_trust():
    plan, dealt = fakes.run_of(10, absent=True)
    made = fakes.records(dealt[0])
    found = aggregate.make_result(plan, [trial_record.encode(one) for one in made], made)
    assert (found.metrics.adoption.mean, found.metrics.adoption.ci95, found.metrics.adoption.n) == (None, None, 0)
    assert found.metrics.trust.n == 0
    assert found.metrics.sr.n == 10
    assert [robot.robot for robot in found.robots] == [""]
    assert (found.metrics.sent.n, found.metrics.in_way.n, found.metrics.work) == (0, 0, {})


def _played(folder, name: str = "helper"):
    plan, dealt = fakes.run_of(20, name=name)
    return run.run_evaluation(plan, dealt, fakes.player, folder=RunFolder(folder), jobs=1, watcher=progress.Silent())


def test_scoring_again_gives_the_stored_result(tmp_path):
    result = _played(tmp_path)
    _, again, stored = aggregate.rescore(tmp_path)
    assert again == stored == result


def test_a_result_of_an_older_format_is_made_anew(tmp_path):
    _played(tmp_path)
    folder = tmp_path
    path = folder / "result.json"
    path.write_bytes(b'{"schema": "hthor.result/3", "name": "helper"}')
    _, result, stored = aggregate.rescore(folder)
    assert stored is None
    assert result.counts.trials > 0
    path.write_bytes(b'{"schema": "hthor.result/6"}')
    with pytest.raises(RunError, match="delete the file"):
        aggregate.rescore(folder)


def test_scoring_trusts_events_not_stored_metrics(tmp_path):
    honest = _played(tmp_path)
    path = tmp_path / "trials.jsonl"
    perfect = TrialMetrics(sr=1, twsr=1.0, adoption=1, time_s=1.0, trust=7)
    records = RunFolder(tmp_path).records()
    lines = [msgspec.json.decode(line) for line in path.read_bytes().splitlines()]
    path.write_bytes(b"".join(_with_metrics(line, perfect) for line in lines))
    assert RunFolder(tmp_path).config.code_sha256 == honest.hashes.code
    assert [one.metrics for one in RunFolder(tmp_path).records()] == [one.metrics for one in records]
    assert aggregate.rescore(tmp_path)[1].metrics == honest.metrics
    assert b'"metrics"' not in trial_record.encode(records[0])


def test_a_run_goes_on_after_trials_that_other_metrics_scored(tmp_path):
    whole = _played(tmp_path / "whole")
    part = tmp_path / "part"
    shutil.copytree(tmp_path / "whole", part, ignore=shutil.ignore_patterns("result.json", "control"))
    lines = [msgspec.json.decode(line) for line in (part / "trials.jsonl").read_bytes().splitlines()]
    older = TrialMetrics(sr=0, twsr=0.0, adoption=None, time_s=1.0, trust=1)
    (part / "trials.jsonl").write_bytes(b"".join(_with_metrics(line, older) for line in lines[:7]))
    done = _played(part)
    assert (done.metrics, done.counts) == (whole.metrics, whole.counts)
    assert done.hashes.scoring == code_identity.scoring_sha256()


def test_a_result_of_another_scoring_version_is_made_anew_and_said_to_be(tmp_path):
    now = _played(tmp_path)
    sr = msgspec.structs.replace(now.metrics.sr, mean=1.0)
    older = msgspec.structs.replace(
        now,
        metrics=msgspec.structs.replace(now.metrics, sr=sr),
        hashes=msgspec.structs.replace(now.hashes, scoring="78" * 32),
    )
    result_file.store_result(tmp_path, older)
    said = CliRunner().invoke(app, ["score", str(tmp_path)], env={"COLUMNS": "400"}, catch_exceptions=False).output
    assert f"trials of code {now.hashes.code[:10]}, judged by scoring version {now.hashes.scoring[:10]}" in said
    assert f"was made by scoring version {'78' * 5} of hthor" in said
    assert result_file.load_result(tmp_path) == now


def test_a_metric_that_old_logs_cannot_have_is_a_gap_that_is_said(tmp_path):
    result = _played(tmp_path)
    assert not [note for note in result_tables.result_notes([result]) if "measured" in note]
    fewer = msgspec.structs.replace(result.metrics.trust, n=12)
    part = msgspec.structs.replace(result, metrics=msgspec.structs.replace(result.metrics, trust=fewer))
    (note,) = (note for note in result_tables.result_notes([part]) if "measured" in note)
    assert "trust (1 to 7) is measured in 12 of 20 trials; the others do not have what it needs." in note


def _with_metrics(line: dict[str, object], metrics: TrialMetrics) -> bytes:
    """The line as log 1.1 had it: with values of metrics."""
    del line["check"]
    return trial_record.sealed(msgspec.json.encode({**line, "schema": "hthor.trial/1.1", "metrics": metrics}))


def test_a_line_of_another_run_is_refused(tmp_path):
    _played(tmp_path)
    other = fakes.run_of(20, seed=1)[1][0].trials[0]
    with (tmp_path / "trials.jsonl").open("ab") as file:
        file.write(trial_record.encode(trial_record.make_record(other, fakes.episode(other))))
    with pytest.raises(RunError, match=r"spec\.seed is not the one in run\.json"):
        aggregate.rescore(tmp_path)


def test_faults_are_counted_and_their_trials_too(tmp_path):
    result = _played(tmp_path, "clumsy")
    assert result.counts.faults == 2
    assert result.counts.trials == result.metrics.sr.n == 20


def test_the_stored_result_says_how_it_came_about(tmp_path):
    _played(tmp_path)
    document = msgspec.json.decode((tmp_path / "result.json").read_bytes())
    assert document["schema"] == "hthor.result/6"
    assert set(document["versions"]) >= {"hthor", "python", "mujoco", "dm_control", "numpy"}
    assert document["effort"]["trials"] == 20
    assert (tmp_path / "result.json").read_bytes() == jsonio.pretty(document)
    assert b"wall" not in (tmp_path / "trials.jsonl").read_bytes()


def test_a_run_of_a_version_that_noted_no_kinds_is_still_read() -> None:
    config, _ = fakes.run_of(4)
    older = {name: value for name, value in json.loads(msgspec.json.encode(config)).items() if name != "kinds"}
    known = msgspec.json.decode(json.dumps(older), type=type(config))
    assert not known.kinds
    assert msgspec.json.decode(msgspec.json.encode(known)) == older
