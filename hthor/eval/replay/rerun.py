"""`hthor agent run`: one trial of a run once more, with its agents as they are now; prints and writes nothing.

What the human does depends on their earlier trials, so these are run too. If an agent's file was changed meanwhile,
the changed agent takes part, and the trial may go differently.
"""

from collections.abc import Iterator, Sequence

import msgspec
from msgspec import Struct

from hthor import activity, code_identity
from hthor.errors import HthorError
from hthor.eval.config.robot_team import AgentInfo
from hthor.eval.config.sessions import Session
from hthor.eval.records import trial_record
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.records.trial_record import TrialRecord
from hthor.eval.replay import session_history
from hthor.eval.replay.session_history import RunFiles
from hthor.eval.runner.fault_report import FaultReport
from hthor.eval.runner.messages import TrialOutcome
from hthor.eval.runner.trial_runner import make_runner
from hthor.guest import AgentInputs, GuestConfig
from hthor.types import RobotSeat


class Rerun(Struct, frozen=True, kw_only=True):
    """A trial that was run once more.

    Attributes:
        before: how many trials of the session were run before it.
        changed: an agent's file is not the one of the run.
        same: the record came out equal, byte for byte.
        left: how an agent failed, if one did.
    """

    record: TrialRecord
    before: int
    changed: bool
    same: bool
    left: FaultReport | None


def rerun_trial(
    folder: RunFolder, trial: TrialRecord, files: RunFiles, isolation: str = "auto", inputs: AgentInputs | None = None
) -> Rerun:
    """Run a trial of a run once more.

    Args:
        isolation: the level at which submitted agents are isolated, or "auto".
        inputs: the arguments and readable files that agents are given.

    Raises:
        RunError: when trials before it are missing, or another version of hthor ran them.
        HthorError: when a file is needed and not given.
    """
    hidden = (str(folder.path.resolve()),)
    guests = GuestConfig(isolation=isolation, hidden=hidden, inputs=inputs or AgentInputs())
    code_identity.keep_compiled()
    specs = session_history.session_before(folder, trial)
    team = session_history.replay_team(folder, trial.spec, files, guests, _agent_as_it_is)
    pairs = zip(trial.spec.robots, team.robots, strict=True)
    robots = tuple(msgspec.structs.replace(seat, agent=agent.ref) for seat, (_, agent) in pairs)
    trials = tuple(msgspec.structs.replace(spec, robots=robots) for spec in specs)
    session = Session(participant=trial.spec.participant, trials=trials)
    sources = session_history.replay_sources(folder, trial.spec, files, guests, team)
    outcome = _last(make_runner(sources)(session), len(trials))
    return Rerun(
        record=outcome.record,
        before=len(trials) - 1,
        changed=robots != trial.spec.robots,
        same=trial_record.encode(outcome.record) == trial_record.encode(trial),
        left=outcome.fault_report,
    )


def _last(outcomes: Iterator[TrialOutcome], count: int) -> TrialOutcome:
    """The last of so many trials; each is announced before it is run."""
    for number in range(1, count + 1):
        activity.say(f"playing trial {number} of {count}")
        last = next(outcomes)
    return last


def _agent_as_it_is(_: RunFolder, seat: RobotSeat, given: Sequence[AgentInfo]) -> AgentInfo:
    """The unchanged agent of the run, else one of its name, else the only one that was given."""
    same = [one for one in given if one.ref.sha256 == seat.agent.sha256 and one.ref.source == seat.agent.source]
    named = [one for one in given if one.ref.name == seat.agent.name]
    if not (fits := same or named or (given if len(given) == 1 else [])):
        raise HthorError(
            f"the agent '{seat.agent.name}' of this run came from the file {seat.agent.source}. "
            "Give that file with --agent."
        )
    return fits[0]
