"""Sessions, logs and a player that need no engine, for the tests of `hthor.eval`; workers import it by its name."""

from __future__ import annotations

import ctypes
import functools
import hashlib
import os
import resource
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Generator, Iterator
from pathlib import Path
from typing import TYPE_CHECKING
from unittest import mock

import msgspec

from hthor import code_identity, seeds
from hthor.episode import EpisodeLog, Fault
from hthor.errors import KILLED, AgentKilled
from hthor.eval.config import run_config
from hthor.eval.config.run_config import RunConfig
from hthor.eval.records import scored_trial, trial_record
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.records.scored_trial import ScoredTrial
from hthor.eval.runner import engines, worker
from hthor.eval.runner.engines import SessionFailed
from hthor.eval.runner.messages import Failed, News, TrialOutcome
from hthor.humans.population import resolve
from hthor.humans.population.population import Population, Validity
from hthor.humans.population.resolve import ParticipantSource
from hthor.tasks import Suite
from hthor.tasks.suite import make_suite
from hthor.trials import Sources, human_team, robot_team, sessions
from hthor.trials.human_team import HumanTeam
from hthor.trials.sessions import Session
from hthor.types import AgentRef, Goal, Placement, Pose, TaskSpec, TrialSpec
from hthor.types.events import Accepted, Sent, Success, Timeout

if TYPE_CHECKING:  # workers import this module, and start sooner without it
    import pytest

HOUSES = ("attic", "barn", "cottage")


def task(number: int = 0) -> TaskSpec:
    return TaskSpec(
        id=f"t{number:03d}",
        kind=("object_goal_navigation", "mobile_manipulation")[number % 2],
        house=HOUSES[number % 3],
        house_sha256="ab" * 32,
        human_start=Pose(x=1.0, y=2.5),
        robot_starts=(Pose(x=0.1, y=-0.3, yaw=1.5),),
        objects=(Placement(id="apple", kind="apple", position=(1.0, 2.0, 0.9), support="table"),),
        goal=Goal(target="apple", relation="find"),
        instruction="Find the apple.",
        time_limit=90.0,
        t_star=8.0 + number % 7,
    )


def suite(count: int = 60) -> Suite:
    return make_suite("fake", 1, tuple(task(number) for number in range(count)))


def persons(name: str = "proxy", *, calibrated: bool = True) -> ParticipantSource:
    """People of one draw, fitted to the fake suite of thirty tasks or to nothing."""
    validity = Validity(suite="fake", suite_sha256=suite(30).sha256) if calibrated else Validity()
    drawn = Population.make(
        "few", [[0.5]], names=["v_pace"], purpose="a test", seed=0, command="a test", validity=validity
    )
    return ParticipantSource(
        name=name,
        word=name,
        purpose="a test",
        model="proxy",
        source="",
        population=drawn,
        kind=None,
        sha256=hashlib.sha256(name.encode()).hexdigest(),
    )


def people(name: str = "proxy") -> HumanTeam:
    """One such person in every trial."""
    return human_team.form_team([persons(name)])


def character(name: str = "helper", guests: object = None, *, absent: bool = False) -> robot_team.AgentInfo:
    return robot_team.AgentInfo(ref=AgentRef(name=name, source=f"{name}.py", sha256="cd" * 32), absent=absent)


def crew(*names: str, absent: bool = False, detector: str = "own") -> robot_team.RobotTeam:
    """Scouts with minds of these names."""
    return robot_team.form_team(["scout"] * len(names), [character(name, absent=absent) for name in names], detector)


def run_of(
    count: int = 30, *, name: str = "helper", absent: bool = False, seed: int = 0
) -> tuple[RunConfig, tuple[Session, ...]]:
    tasks, who = suite(count), crew(*name.split("+"), absent=absent)
    with (
        mock.patch.object(resolve, "resolve_humans", return_value=persons()),
        mock.patch.object(code_identity, "code_sha256", return_value="34" * 32),
    ):
        plan = run_config.build_config(tasks, who, humans="proxy", seed=seed, participants=None)
        return plan, sessions.make_sessions(tasks, agent=who, seed=seed)


def episode(trial: TrialSpec, memory: int = 0) -> EpisodeLog:
    """A log that depends on the trial and on how many trials came before it in the session."""
    names = (trial.task.id, trial.session, trial.index, memory)
    met = seeds.draw(trial.seed, "met", *names) < 0.7
    ticks = 100 + int(600 * seeds.draw(trial.seed, "ticks", *names)) if met else 900
    events = []
    paths = {"human": [(i, 2 * i, 0) for i in range(ticks // 2)]}
    faults: tuple[Fault, ...] = ()
    for robot in trial.robots:
        paths[robot.seat] = [(0, 0, i) for i in range(ticks // 2)]
    if trial.robots:
        claim = (seeds.draw(trial.seed, "claim", *names), 1.0 / 3.0, 0.5)
        events.append(Sent(tick=40, seat="robot", message=0, text="here", position=claim))
        if seeds.draw(trial.seed, "accepts", *names) < 0.6:
            events.append(Accepted(tick=60, seat="human", message=0, sender="robot"))
        if trial.robots[0].agent.name == "clumsy" and trial.index == 3:
            faults = (Fault(seat="robot", kind="raised", tick=70, detail="Traceback\n  ...\nValueError: no"),)
    events.append((Success if met else Timeout)(tick=ticks, seat="human"))
    return EpisodeLog(
        events=tuple(events),
        paths=paths,
        ticks=ticks,
        met=met,
        ratings={"human": 5 if trial.robots else None},
        faults=faults,
        idle=dict.fromkeys(paths, ticks // 10),
    )


def player(sources: Sources | None = None) -> Callable[[Session], Iterator[TrialOutcome]]:
    """Plays a session in no time; the fake person counts the trials so far, so sessions cannot be cut in pieces."""

    def perform(session_: Session) -> Iterator[TrialOutcome]:
        for memory, trial in enumerate(session_.trials):
            yield outcome(trial, episode(trial, memory))

    return perform


def outcome(trial: TrialSpec, log: EpisodeLog) -> TrialOutcome:
    return TrialOutcome(record=trial_record.make_record(trial, log))


def records(session_: Session) -> list[ScoredTrial]:
    """The records of a session that `player` plays, with their metrics."""
    return [scored_trial.score(played.record) for played in player()(session_)]


def leaning_player(sources: Sources | None = None) -> Callable[[Session], Iterator[TrialOutcome]]:
    """Robots help the people they meet, and hinder those called random."""

    def perform(session_: Session) -> Iterator[TrialOutcome]:
        for trial in session_.trials:
            chance = 0.5 if not trial.robots else 0.2 if trial.humans[0].model.startswith("random") else 0.9
            met = seeds.draw(trial.seed, "met", trial.task.id) < chance
            log = episode(trial)
            ticks = 300 if met else 900
            paths = {seat: path[:1] * (ticks // 2) for seat, path in log.paths.items()}
            last = (Success if met else Timeout)(tick=ticks, seat="human")
            events = (*(event for event in log.events[:-1] if event.tick < ticks), last)
            yield outcome(trial, msgspec.structs.replace(log, met=met, ticks=ticks, paths=paths, events=events))

    return perform


def forgetful_player() -> Callable[[Session], Iterator[TrialOutcome]]:
    """Plays every trial otherwise than `player`."""

    def perform(session_: Session) -> Iterator[TrialOutcome]:
        for trial in session_.trials:
            yield outcome(trial, episode(trial, memory=99))

    return perform


def slow_player(seconds: float = 0.05, first_s: float | None = None) -> Callable[[Session], Iterator[TrialOutcome]]:
    """Takes so long over each trial, and as long as is said over the first one of a session."""

    def perform(session_: Session) -> Iterator[TrialOutcome]:
        for number, played in enumerate(player()(session_)):
            time.sleep(seconds if number or first_s is None else first_s)
            yield played

    return perform


def dying_player(folder: str, deaths: int = 1) -> Callable[[Session], Iterator[TrialOutcome]]:
    """Kills its own process in the middle of sessions, ``deaths`` times for every session of an even participant."""

    def perform(session_: Session) -> Iterator[TrialOutcome]:
        for number, played in enumerate(player()(session_)):
            mark = Path(folder, f"died-{session_.number}")
            died = len(mark.read_text()) if mark.exists() else 0
            if session_.number % 2 == 0 and number == 2 + 3 * died and died < deaths:
                mark.write_text("x" * (died + 1))
                os.kill(os.getpid(), signal.SIGKILL)
            yield played

    return perform


def lonely_player(sources: Sources | None = None) -> Callable[[Session], Iterator[TrialOutcome]]:
    """Participant 1 cannot be played without a robot."""

    def perform(session_: Session) -> Iterator[TrialOutcome]:
        if session_.number == 1 and not session_.trials[0].robots:
            raise ZeroDivisionError("our own")
        yield from player()(session_)

    return perform


def hopeless_player() -> Callable[[Session], Iterator[TrialOutcome]]:
    raise ModuleNotFoundError("no module named 'mujoco'")


def failing_player(error: str) -> Callable[[Session], Iterator[TrialOutcome]]:
    def perform(session_: Session) -> Iterator[TrialOutcome]:
        yield from list(player()(session_))[:2]
        from hthor.errors import AgentError

        raise AgentError("the agent is no good") if error == "user" else ZeroDivisionError("our own")

    return perform


def sick_player(folder: str, *ills: str) -> Callable[[Session], Iterator[TrialOutcome]]:
    """The fourth trial of participant 1 ends the worker, of participant 3 hangs once, of participant 5 has a bug."""

    def perform(session_: Session) -> Iterator[TrialOutcome]:
        for number, played in enumerate(player()(session_)):
            ill = {1: "crash", 3: "hang", 5: "bug"}.get(session_.number) if number == 3 else None
            if ill == "crash" and ill in ills:
                ctypes.string_at(0)
            if ill == "bug" and ill in ills:
                raise ZeroDivisionError("our own")
            if ill == "hang" and ill in ills and not Path(folder, "hung").exists():
                Path(folder, "hung").touch()
                time.sleep(1e6)
            yield played

    return perform


GUEST = """
import ctypes, os, sys
ctypes.CDLL(None).prctl(1, 9)
if os.getppid() != int(sys.argv[1]):
    os._exit(0)
for line in sys.stdin.buffer:
    os.write(1, line)
"""


def guarded_player(seconds: float = 0.004) -> Callable[[Session], Iterator[TrialOutcome]]:
    """Each session has a guest, a process that has to answer in each trial; if not, the trial has a fault."""

    def perform(session_: Session) -> Iterator[TrialOutcome]:
        words = [sys.executable, "-S", "-E", "-c", GUEST, str(os.getpid())]
        with subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, bufsize=0) as guest:
            assert guest.stdin is not None
            assert guest.stdout is not None
            try:
                for memory, trial in enumerate(session_.trials):
                    time.sleep(seconds)
                    log = episode(trial, memory)
                    try:
                        guest.stdin.write(b"act\n")
                        answer = guest.stdout.readline()
                    except BrokenPipeError:
                        answer = b""
                    if not answer:
                        fault = Fault(seat="robot", kind=KILLED, tick=1, detail="killed by SIGKILL")
                        log = msgspec.structs.replace(log, faults=(fault,))
                    yield outcome(trial, log)
            finally:
                guest.kill()

    return perform


def killing_player(times: int, plays: dict[int, int]) -> Callable[[Session], Iterator[TrialOutcome]]:
    """The agent of the third trial is killed in the first ``times`` plays of a session, which ``plays`` counts."""

    def perform(session_: Session) -> Iterator[TrialOutcome]:
        plays[session_.number] = plays.get(session_.number, 0) + 1
        for memory, trial in enumerate(session_.trials):
            log = episode(trial, memory)
            if memory == 2 and plays[session_.number] <= times:
                fault = Fault(seat="robot", kind=KILLED, tick=1, detail="killed by SIGKILL")
                log = msgspec.structs.replace(log, faults=(fault,))
            yield outcome(trial, log)

    return perform


def late_player(times: int, plays: dict[int, int]) -> Callable[[Session], Iterator[TrialOutcome]]:
    """The agent of participant 1 is killed before it can say what it is, so many times; ``plays`` counts them."""

    def perform(session_: Session) -> Iterator[TrialOutcome]:
        if session_.number == 1 and plays.get(1, 0) < times:
            plays[1] = plays.get(1, 0) + 1
            raise AgentKilled("helper.py: its process was killed by SIGKILL while it started.")
        yield from player()(session_)

    return perform


class Here:
    """An engine that plays in this process, which saves starting others."""

    def __init__(self, *, jobs: int | None = None, address: str = "", gpus: float = 0.0, limit_s: float = 0.0) -> None:
        pass

    def drain(self) -> None:
        pass

    def run_sessions(self, sessions, make) -> Generator[News | None, None, None]:
        player = worker.SessionPlayer(make)
        for one in sessions:
            for news in player.run(one):
                if isinstance(news, Failed):
                    raise SessionFailed(news)
                yield news


def play_here(patch: pytest.MonkeyPatch) -> None:
    """Sessions of evaluations are run in this process from now on."""
    patch.setattr(engines, "find_engine", lambda *_, **__: Here())


def run_in(folder: Path, seconds: float = 0.02, first_s: float | None = None) -> None:
    """A whole run as a command does it."""
    _evaluate(folder, 60, functools.partial(slow_player, seconds, first_s), engines.find_engine("local", jobs=2))


def guarded(folder: str, count: str) -> None:
    """A whole run with guests."""
    _evaluate(Path(folder), int(count), guarded_player, engines.find_engine("local", jobs=2))


def hosted(folder: str, count: str, agent: str, level: str) -> None:
    """A whole run with real guests."""
    import guest_fakes

    make = functools.partial(guest_fakes.player, agent, level)
    _evaluate(Path(folder), int(count), make, engines.find_engine("local", jobs=2))


def clustered(folder: str, count: str, address: str, agent: str = "") -> None:
    """A whole run on a Ray cluster, with real guests of this file or none."""
    import guest_fakes

    make = functools.partial(guest_fakes.player, agent, "auto") if agent else functools.partial(slow_player, 0.01)
    _evaluate(Path(folder), int(count), make, engines.find_engine("ray", address=address))
    sys.stdout.write(f"{resource.getrusage(resource.RUSAGE_SELF).ru_maxrss}\n")


def _evaluate(folder: Path, count: int, make, engine: engines.Engine) -> None:
    from hthor.eval.runner import progress, run

    plan, dealt = run_of(count)
    run.run_evaluation(plan, dealt, make, folder=RunFolder(folder), engine=engine, watcher=progress.Silent())


if __name__ == "__main__":
    from hthor.errors import HthorError

    try:
        import eval_fakes  # workers must find its functions under this name, not under __main__

        if sys.argv[1] in ("guarded", "hosted", "clustered"):
            getattr(eval_fakes, sys.argv[1])(*sys.argv[2:])
        else:
            eval_fakes.run_in(Path(sys.argv[1]), *map(float, sys.argv[2:]))
    except HthorError as error:
        sys.stderr.write(f"{error}\n")
        sys.exit(error.exit_code)
