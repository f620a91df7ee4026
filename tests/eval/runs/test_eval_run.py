"""Whole runs with a fake umpire: any number of workers, killed workers, killed runs, and the same bytes always."""

from __future__ import annotations

import errno
import functools
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import eval_fakes as fakes
import pytest

from hthor import rules, tasks
from hthor.errors import KILLED, RunError
from hthor.eval.config.options import EvalOptions
from hthor.eval.planning.resolve import resolve
from hthor.eval.records import session_restarts, trial_log, trial_record
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.results import aggregate, result_file
from hthor.eval.results.result_file import RunResult
from hthor.eval.runner import collector, engines, experiment, progress, run, session_runner
from hthor.eval.runner.engines import local


class Notes(progress.Silent):
    """Remembers what it was told."""

    def __init__(self) -> None:
        self.kept, self.new, self.notes = 0, 0, []

    def begin(self, total: int, kept: int) -> None:
        self.kept = kept

    def played(self, met: bool, faulty: bool) -> None:
        self.new += 1

    def note(self, text: str) -> None:
        self.notes.append(text)


def _run(folder: Path, make=fakes.player, *, jobs: int = 0, count: int = 30, watch=None, **how) -> RunResult:
    """A run with so many workers, or without any in this process."""
    plan, dealt = fakes.run_of(count, **how)
    engine = engines.find_engine("local", jobs=jobs) if jobs else fakes.Here()
    return run.run_evaluation(
        plan, dealt, make, folder=RunFolder(folder), engine=engine, watcher=watch or progress.Silent()
    )


def _lines(folder: Path) -> list[bytes]:
    return sorted((folder / "trials.jsonl").read_bytes().splitlines(keepends=True))


@pytest.fixture(scope="module")
def reference(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run of 60 trials that nobody disturbed."""
    folder = tmp_path_factory.mktemp("reference")
    _run(folder, count=60)
    return folder


@pytest.mark.parametrize("jobs", [pytest.param(1, marks=pytest.mark.nightly), 2])
def test_workers_write_the_same_lines_as_this_process(tmp_path: Path, reference: Path, jobs: int):
    one = result_file.load_result(reference)
    two = _run(tmp_path, jobs=jobs, count=60)
    assert _lines(tmp_path) == _lines(reference)
    assert one is not None
    assert (one.metrics, one.counts, one.hashes) == (two.metrics, two.counts, two.hashes)


def test_a_whole_run_is_not_played_again(tmp_path: Path):
    first = _run(tmp_path)
    before = {path.name: path.stat().st_mtime_ns for path in tmp_path.iterdir()}
    watch = Notes()
    assert _run(tmp_path, make=functools.partial(fakes.failing_player, "own"), watch=watch) == first
    assert (watch.kept, watch.new) == (30, 0)
    after = {path.name: path.stat().st_mtime_ns for path in tmp_path.iterdir()}
    assert {**before, ".lock": 0} == {**after, ".lock": 0}


def test_a_part_is_finished_by_whole_sessions_without_writing_twice(tmp_path: Path):
    _run(tmp_path)
    path = tmp_path / "trials.jsonl"
    whole = path.read_bytes().splitlines(keepends=True)
    path.write_bytes(b"".join(whole[::3]) + whole[1][:50])
    watch = Notes()
    _run(tmp_path, watch=watch)
    assert _lines(tmp_path) == sorted(whole)
    assert (watch.kept, watch.new) == (10, 20)
    assert "cut 50 bytes" in watch.notes[0]


@pytest.mark.parametrize("deaths", [pytest.param(1, marks=pytest.mark.nightly), 2])
def test_a_killed_worker_costs_nothing(tmp_path: Path, reference: Path, deaths: int):
    make = functools.partial(fakes.dying_player, str(tmp_path), deaths)
    _run(tmp_path / "run", make, count=60, jobs=2)
    assert len(list(tmp_path.glob("died-*"))) == 3
    assert _lines(tmp_path / "run") == _lines(reference)


def test_sessions_that_cannot_be_played_do_not_stop_the_others(tmp_path: Path, reference: Path):
    watch, make = Notes(), functools.partial(fakes.sick_player, str(tmp_path), "crash", "bug")
    with pytest.raises(collector.InternalFailure) as caught:
        _run(tmp_path / "run", make, count=60, jobs=2, watch=watch)
    told = str(caught.value)
    assert "session 1: it ended 3 workers, the last by signal SIGSEGV" in told
    assert "session 5: ZeroDivisionError: our own" in told
    assert "14 of 60 trials are missing, all others are kept." in told
    assert caught.value.exit_code == 1
    assert "eval_fakes.py" in (tmp_path / "run" / "error.txt").read_text()
    assert sum("session 1 begins again: its worker was ended by signal SIGSEGV" in note for note in watch.notes) == 2
    assert sum("is given up" in note for note in watch.notes) == 2
    assert len(_lines(tmp_path / "run")) == 46
    assert _run(tmp_path / "run", count=60).counts.trials == 60
    assert _lines(tmp_path / "run") == _lines(reference)


class Impatient(engines.PausableClock):
    """For which a minute passes at each look, while a session hangs that has not begun again yet."""

    def __init__(self, hung: Path, watch: Notes) -> None:
        super().__init__()
        self._hung, self._watch = hung, watch

    def now(self) -> float:
        if self._hung.exists() and not self._watch.notes:
            self._now += 60.0
        return super().now()


@pytest.mark.parametrize("waits", [False, pytest.param(True, marks=pytest.mark.nightly)])
def test_a_worker_that_hangs_is_ended_and_its_session_played_again(
    tmp_path: Path, reference: Path, monkeypatch: pytest.MonkeyPatch, waits: bool
):
    plan, dealt = fakes.run_of(60)
    make, watch = functools.partial(fakes.sick_player, str(tmp_path), "hang"), Notes()
    if not waits:
        monkeypatch.setattr(local, "PausableClock", functools.partial(Impatient, tmp_path / "hung", watch))
    # no other worker plays when time leaps
    engine = engines.find_engine("local", jobs=2 if waits else 1, limit_s=6.0 if waits else 60.0)
    result = run.run_evaluation(plan, dealt, make, folder=RunFolder(tmp_path / "run"), engine=engine, watcher=watch)
    limit = 6 if waits else 60
    assert f"session 3 begins again: its worker was ended by the limit of {limit} s for a trial" in watch.notes[0]
    assert result.effort.replays == 1
    assert _lines(tmp_path / "run") == _lines(reference)


def test_a_session_that_always_ends_its_worker_has_its_own_exit_code(tmp_path: Path):
    make = functools.partial(fakes.dying_player, str(tmp_path), 9)
    with pytest.raises(
        collector.Unfinished, match=r"session 0: .*SIGKILL.*The same command tries them again"
    ) as caught:
        _run(tmp_path / "run", make, count=10, jobs=1)
    assert caught.value.exit_code == 1


def test_a_run_of_which_nothing_can_be_played_ends_soon(tmp_path: Path):
    watch = Notes()
    with pytest.raises(collector.InternalFailure, match="30 of 30 trials are missing"):
        _run(tmp_path, fakes.hopeless_player, jobs=2, watch=watch)
    assert sum("is given up" in note for note in watch.notes) == 3


def test_a_run_that_lacks_trials_does_not_keep_others_from_being_played(tmp_path: Path, monkeypatch):
    real = tasks.load_suite
    monkeypatch.setattr(tasks, "load_suite", lambda name: fakes.suite(20) if name == "fake" else real(name))
    monkeypatch.setattr(session_runner, "make_runner", fakes.lonely_player)
    fakes.play_here(monkeypatch)
    options = EvalOptions(agent=("none", "frontier"), suite="fake", jobs=1, out=tmp_path, control=False)
    with pytest.raises(collector.InternalFailure, match=r"session 1: ZeroDivisionError.* 10 of 20 trials are missing"):
        list(experiment.run_experiment(resolve(options), lambda _: progress.Silent()))
    assert result_file.load_result(tmp_path / "frontier").counts.trials == 20
    assert result_file.load_result(tmp_path / "none") is None
    monkeypatch.setattr(session_runner, "make_runner", fakes.player)
    done = [one.config.name for one in experiment.run_experiment(resolve(options), lambda _: progress.Silent())]
    assert done == ["none", "frontier"]
    assert result_file.load_result(tmp_path / "frontier").uplift is not None


def test_a_worker_has_as_long_as_its_agents_deadlines_allow():
    tasks = [fakes.task()]
    assert engines.trial_limit_s(tasks, 0) == engines.LIMIT_S
    assert engines.trial_limit_s(tasks, 2) > 2 * (60 + 60 + 60 + 5 * tasks[0].time_limit / rules.TICK_S)


def test_a_users_error_in_a_worker_keeps_its_exit_code(tmp_path: Path):
    with pytest.raises(engines.SessionFailed, match="the agent is no good") as caught:
        _run(tmp_path, functools.partial(fakes.failing_player, "user"))
    assert caught.value.exit_code == 4


@pytest.mark.parametrize(("times", "faults"), [(0, 0), (1, 2), (2, 3)])
def test_a_run_has_one_do_over_for_killed_agents(tmp_path: Path, times: int, faults: int):
    """Of three sessions in which an agent is killed one is played again; whatever comes of that stands."""
    plan, dealt = fakes.run_of(30)
    make = functools.partial(fakes.killing_player, times, {})
    result = run.run_evaluation(
        plan, dealt, make, folder=RunFolder(tmp_path), engine=fakes.Here(), watcher=progress.Silent()
    )
    again = int(times > 0)
    assert (result.counts.trials, result.counts.faults, result.counts.replays) == (30, faults, again)
    assert result.effort is not None
    assert result.effort.replays == again
    assert aggregate.rescore(tmp_path)[1].counts.replays == again


def test_no_later_command_has_another_do_over(tmp_path: Path):
    plan, dealt = fakes.run_of(30)
    make = functools.partial(fakes.killing_player, 1, {})
    RunFolder(tmp_path).write_config(plan)
    assert session_restarts.SessionRestarts(tmp_path).take(7)
    result = run.run_evaluation(
        plan, dealt, make, folder=RunFolder(tmp_path), engine=fakes.Here(), watcher=progress.Silent()
    )
    assert (result.counts.faults_by_kind, result.counts.replays) == ({KILLED: 3}, 1)


def test_what_was_played_beside_a_killed_agent_does_not_count(tmp_path: Path):
    """Trials after the one that is played again went otherwise: their person had another trial before."""
    plan, dealt = fakes.run_of(10)
    calm = run.run_evaluation(
        plan, dealt, fakes.player, folder=RunFolder(tmp_path / "calm"), engine=fakes.Here(), watcher=progress.Silent()
    )
    make = functools.partial(fakes.killing_player, 1, {})
    other = run.run_evaluation(
        plan, dealt, make, folder=RunFolder(tmp_path / "killed"), engine=fakes.Here(), watcher=progress.Silent()
    )
    assert other.hashes.trials == calm.hashes.trials
    assert session_restarts.load(tmp_path / "killed").sessions == (dealt[0].number,)


@pytest.mark.parametrize("times", [1, 2])
def test_an_agent_that_is_killed_while_it_starts_is_started_once_more(tmp_path: Path, times: int):
    plan, dealt = fakes.run_of(30)
    make, watch = functools.partial(fakes.late_player, times, {}), Notes()

    def whole() -> RunResult:
        return run.run_evaluation(plan, dealt, make, folder=RunFolder(tmp_path), engine=fakes.Here(), watcher=watch)

    if times == 2:
        with pytest.raises(collector.Unfinished, match=r"session 1: helper\.py: its process was killed.*10 of 30"):
            whole()
        assert len(_lines(tmp_path)) == 20
    else:
        assert whole().counts.replays == 1
    assert sum("begins again: an agent's process was killed" in note for note in watch.notes) == 1


def test_a_full_disk_leaves_whole_lines(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    plan, dealt = fakes.run_of(30)
    real, room = os.write, 20_000

    def write(handle: int, data: bytes) -> int:
        nonlocal room
        if not room:
            raise OSError(errno.ENOSPC, "No space left on device")
        count = real(handle, data[:room])
        room -= count
        return count

    monkeypatch.setattr(trial_log.os, "write", write)
    with pytest.raises(RunError, match=r"trials\.jsonl: No space left on device\. The \d+ trials .* are kept"):
        run.run_evaluation(
            plan, dealt, fakes.player, folder=RunFolder(tmp_path), engine=fakes.Here(), watcher=progress.Silent()
        )
    monkeypatch.undo()
    held = _lines(tmp_path)
    assert 0 < len(held) < 30
    assert all(line.endswith(b"\n") for line in held)
    watch = Notes()
    run.run_evaluation(plan, dealt, fakes.player, folder=RunFolder(tmp_path), engine=fakes.Here(), watcher=watch)
    assert (watch.kept, watch.new, watch.notes) == (len(held), 30 - len(held), [])


def test_another_run_is_refused_and_told_apart(tmp_path: Path):
    _run(tmp_path, count=10)
    with pytest.raises(RunError, match=r"holds another run: seed is 0 there and 1 here\. Choose another folder"):
        _run(tmp_path, count=10, seed=1)
    with pytest.raises(RunError, match=r"robots\.0\.agent\.name is helper there and other here"):
        _run(tmp_path, count=10, name="other")


def test_a_folder_of_other_things_is_refused_untouched(tmp_path: Path):
    (tmp_path / "thesis.txt").write_text("precious")
    with pytest.raises(RunError, match=r"not empty and holds no run \(thesis\.txt\)"):
        _run(tmp_path, count=10)
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.txt"]


def test_what_does_not_repeat_itself_is_told(tmp_path: Path):
    _run(tmp_path, count=10)
    path = tmp_path / "trials.jsonl"
    path.write_bytes(b"".join(path.read_bytes().splitlines(keepends=True)[:-1]))
    watch = Notes()
    _run(tmp_path, fakes.forgetful_player, count=10, watch=watch)
    assert "9 re-run trials differ from the log" in watch.notes[0]


def _start(folder: Path, *seconds: float) -> subprocess.Popen[str]:
    """A run by two workers whose trials take so long, or the first of each session and all others."""
    script = str(Path(fakes.__file__).resolve())
    words = [sys.executable, script, str(folder), *map(str, seconds)]
    return subprocess.Popen(words, stderr=subprocess.PIPE, text=True, start_new_session=True)


def _played(folder: Path) -> int:
    return len(_whole_lines(folder))


def _wait_for(folder: Path, trials: int) -> None:
    deadline = time.monotonic() + 900.0
    while _played(folder) < trials:
        assert time.monotonic() < deadline, "the run does not get on"
        time.sleep(0.005)


def _wait_for_both(folder: Path) -> None:
    """Until both workers have played the first trial of their sessions."""
    deadline = time.monotonic() + 900.0
    while len({trial_record.decode(line).spec.session for line in _whole_lines(folder)}) < 2:
        assert time.monotonic() < deadline, "the run does not get on"
        time.sleep(0.005)


def _whole_lines(folder: Path) -> list[bytes]:
    path = folder / "trials.jsonl"
    lines = path.read_bytes().splitlines(keepends=True) if path.exists() else []
    return [line for line in lines if line.endswith(b"\n")]


def _children(pid: int) -> list[int]:
    return [int(text) for text in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]


def _alive(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except (FileNotFoundError, ProcessLookupError):
        return False


def test_a_run_that_is_killed_again_and_again_ends_up_the_same(tmp_path: Path, reference: Path):
    chance = random.Random(4)
    workers: list[int] = []
    for _ in range(2):
        with _start(tmp_path) as process:
            _wait_for(tmp_path, _played(tmp_path) + chance.randint(2, 8))
            workers += _children(process.pid)
            process.kill()
    deadline = time.monotonic() + 900.0
    while any(map(_alive, workers)) and time.monotonic() < deadline:
        time.sleep(0.01)
    assert not any(map(_alive, workers)), "workers outlived their run"
    assert 4 <= _played(tmp_path) < 60
    _run(tmp_path, count=60)
    assert _lines(tmp_path) == _lines(reference)
    assert result_file.load_result(tmp_path).metrics == result_file.load_result(reference).metrics


@pytest.mark.parametrize("number", [pytest.param(signal.SIGINT, marks=pytest.mark.nightly), signal.SIGTERM])
def test_the_first_signal_lets_trials_come_to_their_end(tmp_path: Path, number: int):
    with _start(tmp_path, 0.5, 0.0) as process:
        _wait_for_both(tmp_path)
        before = _played(tmp_path)
        os.killpg(process.pid, number)  # as a terminal and Slurm do: to the workers as well
        _, words = process.communicate(timeout=900)
    assert process.returncode == 130
    assert "resume with the same command" in words
    assert "Traceback" not in words
    assert before < _played(tmp_path) <= before + 2


def test_the_second_signal_ends_at_once(tmp_path: Path):
    with _start(tmp_path, 1.5, 0.0) as process:
        _wait_for_both(tmp_path)
        before, began = _played(tmp_path), time.monotonic()
        os.killpg(process.pid, signal.SIGINT)
        time.sleep(0.2)
        os.killpg(process.pid, signal.SIGINT)
        _, words = process.communicate(timeout=900)
    assert process.returncode == 130
    assert "interrupted at once; resume with the same command" in words
    assert "Traceback" not in words
    assert _played(tmp_path) == before or time.monotonic() - began > 1.0  # a machine too busy to tell
