"""Playing an entry's trials again, on this machine; judges nothing.

A person remembers earlier trials, so those before a wanted one in the same session are played with it.
"""

from __future__ import annotations

import functools
from collections.abc import Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

import msgspec

from hthor import code_identity
from hthor.eval.config import robot_team, run_config, sessions, task_selection
from hthor.eval.config.robot_team import RobotTeam
from hthor.eval.config.sessions import Session
from hthor.eval.config.task_selection import TaskSelection
from hthor.eval.records import run_isolation, trial_record
from hthor.eval.records.trial_record import TrialRecord
from hthor.eval.runner import engines, trial_runner
from hthor.eval.runner.engines import RunnerFactory
from hthor.eval.runner.messages import SessionAbandoned, TrialDone
from hthor.guest import AgentInputs, GuestConfig
from hthor.humans.population import resolve
from hthor.humans.population.resolve import ParticipantSource
from hthor.leaderboard.enter import OURS
from hthor.leaderboard.entries.entry import REALTIME, Entry
from hthor.leaderboard.entries.files import BoardError
from hthor.tasks.suites import library

_SHOWN = 3


def play(
    entry: Entry,
    places: Sequence[int],
    *,
    agent: str = "",
    suite: str = "",
    jobs: int | None = None,
    require_isolation: str = "",
    given: AgentInputs | None = None,
) -> dict[int, tuple[TrialRecord, bytes]]:
    """The records of the trials at these places, and of those that had to be played with them, with their lines.

    Args:
        agent: the agent's file, for one that is not hthor's own. suite: where the suite lies, when it is not either.
        require_isolation: the least level that will do for a submitted agent.
        given: arguments and files that it is given.

    Raises:
        BoardError: when this is not what the entry says was played, naming the field; when a trial that is wanted could
            not be played, as nothing follows from a part of a draw.
    """
    chosen = task_selection.select_tasks(suite or entry.run.suite.name, "")
    crew, who = crew_of(entry, agent, given), resolve.resolve_humans(entry.run.humans.source)
    _same(entry, chosen, crew, who)
    whole = sessions.make_sessions(chosen.suite, agent=crew, human=who, **dealt(entry))
    wanted, seats = _cut(whole, places)
    played = perform(entry, wanted, player(suite, crew, who, require_isolation, given), jobs)
    return {seats[one.spec.participant, one.spec.index]: (one, line) for one, line in played}


def perform(
    entry: Entry, wanted: Sequence[Session], make: RunnerFactory, jobs: int | None
) -> list[tuple[TrialRecord, bytes]]:
    """The records of these sessions, every trial of them, with their lines.

    Raises:
        BoardError: when a trial could not be played, with the cause.
    """
    found: list[tuple[TrialRecord, bytes]] = []
    lost: list[str] = []
    with closing(engines.find_engine(engines.LOCAL, jobs=jobs).perform(wanted, make)) as stream:
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


def crew_of(entry: Entry, agent: str, given: AgentInputs | None = None) -> RobotTeam:
    """The robots of an entry, with the submitted agent from its file."""
    minds: list[str] = []
    for robot in entry.run.robots:
        ours = robot.agent.source.startswith(OURS)
        if not ours and not agent:
            raise BoardError(f"{entry.id}: the agent is a file, {robot.agent.source}. Name it with --agent.")
        minds.append(robot.agent.name if ours else agent)
    bodies = [robot.robot or "scout" for robot in entry.run.robots]  # a mind that wants no robot has no body either
    first = entry.run.robots[0]
    return robot_team.form_team(
        bodies,
        minds,
        first.detector or "own",
        first.camera or "own",
        GuestConfig(inputs=given or AgentInputs()),
    )


def _same(entry: Entry, chosen: TaskSelection, crew: RobotTeam, who: ParticipantSource) -> None:
    """See that the same configuration comes out; versions of libraries belong to the platform."""
    here = run_config.build_config(chosen.suite, crew, human=who, **dealt(entry))
    there, here = (msgspec.structs.replace(plan, versions={}) for plan in (entry.run, here))
    if there != here:
        told = "; ".join(run_config.differences(there, here))
        raise BoardError(f"{entry.id}: this is not what was played: {told} ('there' is the entry).")


def dealt(entry: Entry) -> dict[str, Any]:
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


def player(
    suite: str, crew: RobotTeam, who: ParticipantSource, required: str, given: AgentInputs | None = None
) -> RunnerFactory:
    """What plays a session, as in the run that the entry is of.

    Args:
        suite: where the suite lies, empty for one of hthor's own. required: the least level that holds the agents.
        given: arguments and files that they are given.
    """
    code_identity.keep_compiled()
    own = bool(suite) and Path(suite).exists() and bool(library.house_files(suite))
    folder = Path(suite) if Path(suite).is_dir() else Path(suite).parent
    houses = str((folder / "houses").resolve()) if own else ""
    held = run_isolation.resolve_isolation("auto", required, sorted(set(crew.minds.values())))
    guests = GuestConfig(
        isolation=held.level if held else "auto",
        hidden=(str(folder.resolve()),) if suite else (),
        inputs=given or AgentInputs(),
    )
    sources = trial_runner.Sources(
        minds=crew.minds,
        manifests=crew.manifests,
        bodies=crew.bodies,
        houses=houses,
        people=who.word,
        guests=guests,
    )
    return functools.partial(trial_runner.make_runner, sources)
