"""One trial of a run played once more with its agents, as they are now; prints and writes nothing.

What the person does depends on their trials before, so these are played too. An agent's file may have been mended
meanwhile: then it is the mended one that plays, and the trial may go otherwise.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

import msgspec
from msgspec import Struct

from hthor import activity, code_identity, plugins
from hthor.errors import HthorError
from hthor.eval.config import robot_team, run_config
from hthor.eval.config.robot_team import AgentInfo
from hthor.eval.config.sessions import Session
from hthor.eval.records import trial_record
from hthor.eval.records.trial_record import TrialRecord
from hthor.eval.replay import session_history
from hthor.eval.runner import fault_report, trial_runner
from hthor.eval.runner.fault_report import FaultReport
from hthor.eval.runner.trial_runner import Sources
from hthor.guest import AgentInputs, GuestConfig
from hthor.types import RobotSeat, TrialSpec


class RunFiles(Struct, frozen=True, kw_only=True):
    """Where that lies which a trial needs and a run's folder does not hold, as the user typed it."""

    agents: tuple[str, ...] = ()
    robots: tuple[str, ...] = ()
    kind: str = ""
    humans: str = ""


class Rerun(Struct, frozen=True, kw_only=True):
    """A trial played once more. ``changed`` says that an agent's file is another than in the run, ``same`` that the
    record came out equal, byte for byte; ``left`` is there when an agent failed.
    """

    record: TrialRecord
    before: int
    changed: bool
    same: bool
    left: FaultReport | None


def rerun_trial(
    folder: Path, wanted: TrialRecord, files: RunFiles, isolation: str = "auto", given: AgentInputs | None = None
) -> Rerun:
    """Play a trial of a run once more.

    Raises:
        RunError: when trials before it are missing, or another version of hthor played them.
        HthorError: when a file is needed and not given.
    """
    guests = GuestConfig(isolation=isolation, hidden=(str(folder.resolve()),), inputs=given or AgentInputs())
    code_identity.keep_compiled()
    specs = session_history.session_before(folder, wanted)
    minds = _minds(wanted.spec, files.agents, guests)
    robots = tuple(_seated(seat, minds) for seat in wanted.spec.robots)
    trials = tuple(msgspec.structs.replace(spec, robots=robots) for spec in specs)
    session = Session(participant=wanted.spec.participant, trials=trials)
    perform = trial_runner.make_runner(_sources(folder, wanted.spec, files, minds, guests))
    done = _last(perform(session), len(trials))
    left = [fault_report.take(trial_record.key(trial)) for trial in trials][-1]
    changed = robots != wanted.spec.robots
    same = trial_record.encode(done) == trial_record.encode(wanted)
    return Rerun(record=done, before=len(trials) - 1, changed=changed, same=same, left=left)


def _last(played: Iterator[TrialRecord], count: int) -> TrialRecord:
    """The last of so many trials, each said before it is played."""
    activity.say(f"playing trial 1 of {count}")
    done = [next(played)]
    for number in range(2, count + 1):
        activity.say(f"playing trial {number} of {count}")
        done.append(next(played))
    return done[-1]


def _minds(spec: TrialSpec, paths: Sequence[str], guests: GuestConfig) -> dict[str, AgentInfo]:
    """For each seat whose agent is not built in, the file that is meant: the very same one, or one of its name."""
    given = [robot_team.load_agent_info(path, guests) for path in paths]
    found: dict[str, AgentInfo] = {}
    for seat in spec.robots:
        if seat.agent.name in plugins.names("agent"):
            continue
        same = [one for one in given if one.ref.sha256 == seat.agent.sha256 and one.ref.source == seat.agent.source]
        named = [one for one in given if one.ref.name == seat.agent.name]
        if not (fits := same or named or (given if len(given) == 1 else [])):
            came = f"the agent '{seat.agent.name}' of this run came from the file {seat.agent.source}"
            raise HthorError(f"{came}. Give that file with --agent.")
        found[seat.seat] = fits[0]
    return found


def _seated(seat: RobotSeat, minds: dict[str, AgentInfo]) -> RobotSeat:
    return msgspec.structs.replace(seat, agent=minds[seat.seat].ref) if seat.seat in minds else seat


def _sources(
    folder: Path, spec: TrialSpec, files: RunFiles, minds: dict[str, AgentInfo], guests: GuestConfig
) -> Sources:
    """Where everything lies, looked for before anything is played."""
    if spec.kind_sha256 and not files.kind:
        raise HthorError(f"the kind '{spec.task.kind}' of this trial came from a file of its own. Give it with --kind.")
    bodies: dict[str, str] = {}
    for seat in spec.robots:
        if plugins.is_built_in("robot", seat.robot):
            continue
        fits = [path for path in files.robots if plugins.sha256(path) == seat.robot_sha256]
        if not fits:
            raise HthorError(
                f"the body '{seat.robot}' of this run came from a file of its own. Give it, unchanged, with --robot."
            )
        bodies[seat.seat] = str(Path(fits[0]).resolve())
    own, shown = folder / "houses", run_config.load_config(folder).assets.name
    return Sources(
        minds={seat: one.path for seat, one in minds.items()},
        manifests={seat: one.manifest for seat, one in minds.items() if one.manifest is not None},
        bodies=bodies,
        kind=str(Path(files.kind).resolve()) if files.kind else "",
        assets="" if shown == run_config.PROCEDURAL else shown,
        houses=str(own.resolve()) if own.is_dir() else "",
        people=files.humans,
        guests=guests,
    )
