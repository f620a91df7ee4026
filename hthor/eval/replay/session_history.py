"""Runs a logged trial again: the session up to it, with its agents as they were or as they are now."""

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import msgspec
from msgspec import Struct

from hthor import activity, code_identity, plugins
from hthor.errors import HthorError, RunError
from hthor.eval.config import run_config
from hthor.eval.records import trial_record
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.records.trial_record import TrialRecord
from hthor.eval.replay import recorded_session
from hthor.eval.runner.fault_report import FaultReport
from hthor.eval.runner.messages import TrialOutcome
from hthor.eval.runner.session_runner import run_trial
from hthor.guest import AgentInputs, GuestConfig, GuestPool
from hthor.guest.agent import manifest
from hthor.trials import Sources, TrialRunner, make_sources, robot_team
from hthor.trials.robot_team import AgentInfo, RobotInfo, RobotTeam
from hthor.trials.sessions import Session
from hthor.types import RobotSeat, TrialSpec

Choose = Callable[[RunFolder, RobotSeat, Sequence[AgentInfo]], AgentInfo]
"""Chooses the agent of a seat among those that the user gave."""


class RunFiles(Struct, frozen=True, kw_only=True):
    """Files of the user's that a trial needs and that a run's folder lacks, as the user typed them.

    Attributes:
        agents: the submitted agents.
        robots: files of the user's own robots.
        kind: the file of the user's own task kind.
        humans: the word that finds the human population, when the name in the log does not.
    """

    agents: tuple[str, ...] = ()
    robots: tuple[str, ...] = ()
    kind: str = ""
    humans: str = ""


class Rerun(Struct, frozen=True, kw_only=True):
    """A trial that was run once more.

    Attributes:
        before: how many trials of the session were run before it.
        changed: whether an agent's file differs from the run's.
        same: whether the record equals the logged one, byte for byte.
        left: the fault report, if an agent failed.
    """

    record: TrialRecord
    before: int
    changed: bool
    same: bool
    left: FaultReport | None


def session_before(folder: RunFolder, trial: TrialRecord) -> tuple[TrialSpec, ...]:
    """The trials of the session up to this one.

    Raises:
        RunError: when trials before it are missing, or another version of hthor ran them.
    """
    config, spec = folder.config, trial.spec
    here, logged = code_identity.code_sha256(config.humans.models, config.kinds or ()), spec.code_sha256
    if here != logged:
        raise RunError(
            f"{folder} was played by another version of hthor (its code's hash was {logged[:10]} and is {here[:10]}), "
            "in which people may decide differently. Play the run again with 'hthor eval', or use that version."
        )
    specs = [record.spec for record in folder.played()]
    before = [one for one in specs if one.session == spec.session and one.index < spec.index]
    if [one.index for one in before] != list(range(spec.index)):
        raise RunError(
            f"{folder} lacks some of the trials before this one in session {spec.session}, which shaped people's "
            "trust. Finish the run with the 'hthor eval' command that began it."
        )
    return (*before, spec)


def replay_team(
    folder: RunFolder, spec: TrialSpec, files: RunFiles, guests: GuestConfig, choose: Choose | None = None
) -> RobotTeam:
    """The robots of a logged trial, with the user's files for those that did not ship with hthor.

    ``choose`` finds the agent of a seat among the given agents; by default it must be unchanged.

    Raises:
        HthorError: when a file is needed and not given.
    """
    asked = () if recorded_session.is_live(spec) else spec.robots  # decisions beside living people are in the log
    submitted = [seat for seat in asked if seat.agent.name not in plugins.names("agent")]
    given = [robot_team.load_agent_info(path, guests) for path in files.agents] if submitted else []
    choose = choose or same_agent
    agents = [choose(folder, seat, given) if seat in submitted else AgentInfo(ref=seat.agent) for seat in spec.robots]
    robots = [_robot(seat, files.robots) for seat in spec.robots]
    return RobotTeam(robots=tuple(zip(robots, agents, strict=True)))


def replay_sources(
    folder: RunFolder, spec: TrialSpec, files: RunFiles, guests: GuestConfig, team: RobotTeam | None = None
) -> Sources:
    """The sources of all that a logged trial needs; by default its robots are unchanged, as `replay_team` finds them.

    Raises:
        HthorError: when a file is needed and not given.
    """
    if spec.kind_sha256 and not files.kind:
        raise HthorError(f"the kind '{spec.task.kind}' of this trial came from a file of its own. Give it with --kind.")
    assets = folder.config.assets.name
    return make_sources(
        team or replay_team(folder, spec, files, guests),
        kind_path=str(Path(files.kind).resolve()) if files.kind else "",
        assets="" if assets == run_config.PROCEDURAL else assets,
        houses=folder.houses,
        humans=files.humans,
        guests=guests,
    )


def same_agent(folder: RunFolder, seat: RobotSeat, given: Sequence[AgentInfo]) -> AgentInfo:
    """The agent of the run, unchanged.

    Raises:
        HthorError: when it is not among the given agents; says which of its files changed.
    """
    for agent in given:
        if agent.ref.sha256 == seat.agent.sha256:
            return agent
    known = next((one for one in folder.config.agents if one.sha256 == seat.agent.sha256), None)
    near = next((one.manifest for one in given if one.manifest and known and one.manifest.source == known.source), None)
    what = ""
    if near is not None and known is not None:
        changes = manifest.differences(known.files, near.files)
        changes += ["--agent-args are others"] if near.args != known.args else []
        what = f" It is not as it was: {'; '.join(changes)}."
    raise HthorError(
        f"the agent '{seat.agent.name}' of this run came from the file {seat.agent.source}. Give that file, unchanged, "
        f"with --agent.{what}"
    )


def _robot(seat: RobotSeat, paths: Sequence[str]) -> RobotInfo:
    if plugins.is_built_in("robot", seat.robot):
        return RobotInfo(name=seat.robot, sha256=seat.robot_sha256)
    path = next((path for path in paths if plugins.sha256(path) == seat.robot_sha256), "")
    if not path:
        raise HthorError(
            f"the body '{seat.robot}' of this run came from a file of its own. Give it, unchanged, with --robot."
        )
    return RobotInfo(name=seat.robot, sha256=seat.robot_sha256, path=str(Path(path).resolve()))


def rerun_trial(
    folder: RunFolder, trial: TrialRecord, files: RunFiles, isolation: str = "auto", inputs: AgentInputs | None = None
) -> Rerun:
    """Run a trial of a run once more, with its agents as they are now; prints and writes nothing.

    What the human does depends on their earlier trials, so these are run too. If an agent's file was changed since the
    run, the changed agent takes part, and the trial may differ.

    Raises:
        RunError: when trials before it are missing, or another version of hthor ran them.
        HthorError: when a file is needed and not given.
    """
    hidden = (str(folder.path.resolve()),)
    guests = GuestConfig(isolation=isolation, hidden=hidden, inputs=inputs or AgentInputs())
    code_identity.keep_compiled()
    specs = session_before(folder, trial)
    team = replay_team(folder, trial.spec, files, guests, _agent_as_it_is)
    pairs = zip(trial.spec.robots, team.robots, strict=True)
    robots = tuple(msgspec.structs.replace(seat, agent=agent.ref) for seat, (_, agent) in pairs)
    trials = tuple(msgspec.structs.replace(spec, robots=robots) for spec in specs)
    session = Session(number=trial.spec.session, trials=trials)
    sources = replay_sources(folder, trial.spec, files, guests, team)
    outcome = _last(_outcomes(sources, session, folder), len(trials))
    return Rerun(
        record=outcome.record,
        before=len(trials) - 1,
        changed=robots != trial.spec.robots,
        same=_encoded(folder.corrected(outcome.record)) == _encoded(trial),
        left=outcome.fault_report,
    )


def _outcomes(sources: Sources, session: Session, folder: RunFolder) -> Iterator[TrialOutcome]:
    runner = TrialRunner(sources, GuestPool())
    with recorded_session.enter(runner, session, folder) as participants:
        for trial in session.trials:
            yield run_trial(runner, participants, trial)


def _encoded(record: TrialRecord) -> bytes:
    return trial_record.encode(recorded_session.without_pauses(record))


def _last(outcomes: Iterator[TrialOutcome], count: int) -> TrialOutcome:
    """The outcome of the last of ``count`` trials; each is announced before it is run."""
    for number in range(1, count + 1):
        activity.say(f"playing trial {number} of {count}")
        last = next(outcomes)
    return last


def _agent_as_it_is(_: RunFolder, seat: RobotSeat, given: Sequence[AgentInfo]) -> AgentInfo:
    """The unchanged agent of the run, else a given agent of its name, else the only agent given."""
    same = [one for one in given if one.ref.sha256 == seat.agent.sha256 and one.ref.source == seat.agent.source]
    named = [one for one in given if one.ref.name == seat.agent.name]
    if not (fits := same or named or (given if len(given) == 1 else [])):
        raise HthorError(
            f"the agent '{seat.agent.name}' of this run came from the file {seat.agent.source}. "
            "Give that file with --agent."
        )
    return fits[0]
