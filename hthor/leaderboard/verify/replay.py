"""Replays an entry's trials on this machine.

Because a person remembers earlier trials, the trials before a wanted one in its session are played too.
"""

from collections.abc import Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

import msgspec
from msgspec import Struct

from hthor import code_identity
from hthor.eval.config import run_config, task_selection
from hthor.eval.config.run_config import RunConfig
from hthor.eval.config.task_selection import TaskSelection
from hthor.eval.records import run_isolation, scored_trial, trial_record
from hthor.eval.records.scored_trial import ScoredTrial
from hthor.eval.runner import engines
from hthor.eval.runner.messages import RunnerFactory, SessionAbandoned, TrialDone
from hthor.eval.runner.run_job import RunJob
from hthor.guest import AgentInputs, GuestConfig
from hthor.leaderboard.enter import OURS
from hthor.leaderboard.entries.entry import Entry
from hthor.leaderboard.entries.files import BoardError
from hthor.tasks.suites import library
from hthor.trials import Sources, human_team, make_sources, robot_team
from hthor.trials.human_team import HumanTeam
from hthor.trials.robot_team import RobotTeam
from hthor.trials.sessions import Session

_SHOWN = 3


class Request(Struct, frozen=True, kw_only=True):
    """The options of `hthor leaderboard verify`.

    ``word`` is a public random text from after the submission. ``agent`` is the agent's file if the agent is not
    hthor's own; ``suite`` is where the suite is if it is not hthor's own. ``given`` are arguments and files for the
    agent; ``require_isolation`` is the least isolation level for it. If ``sample`` is None, `verify.SAMPLE` trials are
    drawn, or all if the agent is not deterministic. ``fresh`` is how many fresh tasks are played.
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


def replay_trials(entry: Entry, places: Sequence[int], request: Request) -> dict[int, tuple[ScoredTrial, bytes]]:
    """Replay the trials at these places and those before them in their sessions; return their records and log lines.

    Raises:
        BoardError: if the run is not the one that the entry claims (names the field), or if a wanted trial could not be
        played, because a part of a sample proves nothing.
    """
    chosen = task_selection.select_tasks(request.suite or entry.run.suite.name, "")
    team, humans = robot_team_of(entry, request), human_team.find_team(entry.run.humans.source)
    job = RunJob(
        config=_same_config(entry, chosen, team, humans),
        team=team,
        people=humans,
        tasks=chosen,
        sources=make_sources_of(request.suite, team, humans, request),
    )
    wanted, seats = _cut(job.sessions, places)
    played = run_sessions(entry, wanted, job.make_runner, request.jobs)
    return {seats[one.spec.session, one.spec.index]: (one, line) for one, line in played}


def run_sessions(
    entry: Entry, wanted: Sequence[Session], make: RunnerFactory, jobs: int | None
) -> list[tuple[ScoredTrial, bytes]]:
    """Play all trials of these sessions; return their records and log lines.

    Raises:
        BoardError: if a trial could not be played; gives the cause.
    """
    found: list[tuple[ScoredTrial, bytes]] = []
    lost: list[str] = []
    with closing(engines.find_engine(engines.LOCAL, jobs=jobs).run_sessions(wanted, make)) as stream:
        for news in stream:
            if isinstance(news, TrialDone):
                found.append((scored_trial.score(trial_record.decode(news.line)), news.line))
            elif isinstance(news, SessionAbandoned):
                lost.append(f"session {news.session}: {news.cause.rstrip('.')}")
    asked = {(one.number, index) for one in wanted for index in range(len(one.trials))}
    missing = asked - {(one.spec.session, one.spec.index) for one, _ in found}
    if missing:
        causes = f" ({'; '.join(lost[:_SHOWN])})" if lost else ""
        raise BoardError(
            f"{entry.id}: {len(missing)} of the {len(asked)} trials that were drawn could not be played{causes}. A "
            "verification needs all of them: verify it again, with fewer --jobs if memory ran out. An agent that ends "
            "its own process cannot be verified."
        )
    return found


def robot_team_of(entry: Entry, request: Request) -> RobotTeam:
    """The robots of an entry; a submitted agent is loaded from its file."""
    minds: list[str] = []
    for robot in entry.run.robots:
        ours = robot.agent.source.startswith(OURS)
        if not ours and not request.agent:
            raise BoardError(f"{entry.id}: the agent is a file, {robot.agent.source}. Name it with --agent.")
        minds.append(robot.agent.name if ours else request.agent)
    bodies = [robot.robot or "scout" for robot in entry.run.robots]  # an agent that wants no robot has no body either
    first = entry.run.robots[0]
    guests = GuestConfig(inputs=request.given or AgentInputs())
    return robot_team.form_team(bodies, minds, first.detector or "own", first.camera or "own", guests)


def _same_config(entry: Entry, chosen: TaskSelection, team: RobotTeam, humans: HumanTeam) -> RunConfig:
    """The run config on this machine, if it equals the entry's; library versions count as part of the platform."""
    config = run_config.build_config(chosen.suite, team, humans=humans, **session_options(entry))
    there, here = (msgspec.structs.replace(one, versions={}) for one in (entry.run, config))
    if there != here:
        differences = "; ".join(run_config.differences(there, here))
        raise BoardError(
            f"{entry.id}: this agent differs from the one that was run: {differences} ('there' is the entry)."
        )
    return config


def session_options(entry: Entry) -> dict[str, Any]:
    """The options that decide which person does which task, and whether computing takes simulated time."""
    return {"seed": entry.run.seed, "participants": entry.run.participants, "clock": entry.mode}


def _cut(whole: Sequence[Session], places: Sequence[int]) -> tuple[list[Session], dict[tuple[int, int], int]]:
    """The needed sessions, each cut after its last needed trial, and the place in the run of each (person, trial)."""
    seats: dict[tuple[int, int], int] = {}
    for one in whole:
        for index in range(len(one.trials)):
            seats[one.number, index] = len(seats)
    asked = set(places)
    wanted = []
    for one in whole:
        last = max((index for index in range(len(one.trials)) if seats[one.number, index] in asked), default=-1)
        if last >= 0:
            wanted.append(Session(number=one.number, trials=one.trials[: last + 1]))
    return wanted, seats


def make_sources_of(suite: str, team: RobotTeam, humans: HumanTeam, request: Request) -> Sources:
    """The sources of everything that the entry's run needs; ``suite`` is empty for one of hthor's own suites."""
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
