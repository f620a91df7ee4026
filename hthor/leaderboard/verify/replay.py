"""Replays an entry's trials on this machine.

A person remembers earlier trials, so those before a wanted one in the same session are run too.
"""

from collections.abc import Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

import msgspec
from msgspec import Struct

from hthor import code_identity
from hthor.eval.config import robot_team, run_config, task_selection
from hthor.eval.config.robot_team import RobotTeam
from hthor.eval.config.run_config import RunConfig
from hthor.eval.config.sessions import Session
from hthor.eval.config.task_selection import TaskSelection
from hthor.eval.records import run_isolation, trial_record
from hthor.eval.records.trial_record import TrialRecord
from hthor.eval.runner import engines
from hthor.eval.runner.messages import RunnerFactory, SessionAbandoned, TrialDone
from hthor.eval.runner.run_job import RunJob, make_sources
from hthor.eval.runner.trial_runner import Sources
from hthor.guest import AgentInputs, GuestConfig
from hthor.humans.population import resolve
from hthor.humans.population.resolve import ParticipantSource
from hthor.leaderboard.enter import OURS
from hthor.leaderboard.entries.entry import REALTIME, Entry
from hthor.leaderboard.entries.files import BoardError
from hthor.tasks.suites import library

_SHOWN = 3


class Request(Struct, frozen=True, kw_only=True):
    """The options of `hthor leaderboard verify`.

    ``word`` is public random text from after the submission. ``agent`` is the agent's file, for one that is not hthor's
    own, and ``suite`` where the suite lies, when it is not either. ``given`` are arguments and files that the agent is
    given, ``require_isolation`` the least level that holds it. ``sample`` None draws `verify.SAMPLE` trials, or all
    where the agent does not repeat itself; ``fresh`` is how many fresh tasks are played.
    """

    word: str
    agent: str = ""
    given: AgentInputs | None = None
    suite: str = ""
    sample: int | None = None
    fresh: int = 200
    official: bool = False
    jobs: int | None = None
    require_isolation: str = ""
    by: str = ""
    date: str = ""


def replay_trials(entry: Entry, places: Sequence[int], request: Request) -> dict[int, tuple[TrialRecord, bytes]]:
    """The records of the trials at these places, and of those that had to be run before them, with their lines.

    Raises:
        BoardError: when this is not what the entry says was played, naming the field; when a trial that is wanted could
            not be played, as nothing follows from a part of a draw.
    """
    chosen = task_selection.select_tasks(request.suite or entry.run.suite.name, "")
    team, humans = robot_team_of(entry, request), resolve.resolve_humans(entry.run.humans.source)
    job = RunJob(
        config=_same_config(entry, chosen, team, humans),
        team=team,
        population=humans,
        tasks=chosen,
        sources=make_sources_of(request.suite, team, humans, request),
    )
    wanted, seats = _cut(job.sessions, places)
    played = run_sessions(entry, wanted, job.make_runner, request.jobs)
    return {seats[one.spec.participant, one.spec.index]: (one, line) for one, line in played}


def run_sessions(
    entry: Entry, wanted: Sequence[Session], make: RunnerFactory, jobs: int | None
) -> list[tuple[TrialRecord, bytes]]:
    """The records of these sessions, every trial of them, with their lines.

    Raises:
        BoardError: when a trial could not be played, with the cause.
    """
    found: list[tuple[TrialRecord, bytes]] = []
    lost: list[str] = []
    with closing(engines.find_engine(engines.LOCAL, jobs=jobs).run_sessions(wanted, make)) as stream:
        for news in stream:
            if isinstance(news, TrialDone):
                found.append((trial_record.decode(news.line), news.line))
            elif isinstance(news, SessionAbandoned):
                lost.append(f"participant {news.participant}: {news.cause.rstrip('.')}")
    asked = {(one.participant, index) for one in wanted for index in range(len(one.trials))}
    missing = asked - {(one.spec.participant, one.spec.index) for one, _ in found}
    if missing:
        causes = f" ({'; '.join(lost[:_SHOWN])})" if lost else ""
        raise BoardError(
            f"{entry.id}: {len(missing)} of the {len(asked)} trials that were drawn could not be played{causes}. A "
            "verification needs all of them: verify it again, with fewer --jobs if memory ran out. An agent that ends "
            "its own process cannot be verified."
        )
    return found


def robot_team_of(entry: Entry, request: Request) -> RobotTeam:
    """The robots of an entry, with the submitted agent from its file."""
    minds: list[str] = []
    for robot in entry.run.robots:
        ours = robot.agent.source.startswith(OURS)
        if not ours and not request.agent:
            raise BoardError(f"{entry.id}: the agent is a file, {robot.agent.source}. Name it with --agent.")
        minds.append(robot.agent.name if ours else request.agent)
    bodies = [robot.robot or "scout" for robot in entry.run.robots]  # a mind that wants no robot has no body either
    first = entry.run.robots[0]
    guests = GuestConfig(inputs=request.given or AgentInputs())
    return robot_team.form_team(bodies, minds, first.detector or "own", first.camera or "own", guests)


def _same_config(entry: Entry, chosen: TaskSelection, team: RobotTeam, humans: ParticipantSource) -> RunConfig:
    """The run's configuration here, if it is that of the entry; versions of libraries belong to the platform."""
    config = run_config.build_config(chosen.suite, team, human=humans, **session_options(entry))
    there, here = (msgspec.structs.replace(one, versions={}) for one in (entry.run, config))
    if there != here:
        differences = "; ".join(run_config.differences(there, here))
        raise BoardError(
            f"{entry.id}: this agent differs from the one that was run: {differences} ('there' is the entry)."
        )
    return config


def session_options(entry: Entry) -> dict[str, Any]:
    """How its people were dealt their tasks, and whether thinking took time."""
    clock = {"realtime": True} if entry.mode == REALTIME else {}
    return {"seed": entry.run.seed, "participants": entry.run.participants, **clock}


def _cut(whole: Sequence[Session], places: Sequence[int]) -> tuple[list[Session], dict[tuple[int, int], int]]:
    """The sessions that are needed, each as far as it is, and the place of each (person, trial)."""
    seats: dict[tuple[int, int], int] = {}
    for one in whole:
        for index in range(len(one.trials)):
            seats[one.participant, index] = len(seats)
    asked = set(places)
    wanted = []
    for one in whole:
        last = max((index for index in range(len(one.trials)) if seats[one.participant, index] in asked), default=-1)
        if last >= 0:
            wanted.append(Session(participant=one.participant, trials=one.trials[: last + 1]))
    return wanted, seats


def make_sources_of(suite: str, team: RobotTeam, humans: ParticipantSource, request: Request) -> Sources:
    """Where everything is that the entry's run needs; ``suite`` is empty for one of hthor's own."""
    code_identity.keep_compiled()
    own = bool(suite) and Path(suite).exists() and bool(library.house_files(suite))
    folder = Path(suite) if Path(suite).is_dir() else Path(suite).parent
    isolation = run_isolation.resolve_isolation(
        "auto", request.require_isolation, sorted(set(team.agent_paths.values()))
    )
    guests = GuestConfig(
        isolation=isolation.level if isolation else "auto",
        hidden=(str(folder.resolve()),) if suite else (),
        inputs=request.given or AgentInputs(),
    )
    return make_sources(team, houses=folder / "houses" if own else None, humans=humans.word, guests=guests)
