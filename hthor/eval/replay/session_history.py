"""What it takes to play a logged trial again: the session before it and where everything lies; plays nothing."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from hthor import code_identity, plugins
from hthor.errors import HthorError, RunError
from hthor.eval.config import robot_team, run_config
from hthor.eval.config.robot_team import AgentInfo
from hthor.eval.records import reader
from hthor.eval.records.trial_record import TrialRecord
from hthor.eval.runner import trial_runner
from hthor.guest import AgentInputs, GuestConfig
from hthor.guest.agent import manifest
from hthor.types import RobotSeat, TrialSpec


def session_before(folder: Path, wanted: TrialRecord) -> tuple[TrialSpec, ...]:
    """The trials of the person's session up to this one.

    Raises:
        RunError: when trials before it are missing, or another version of hthor played them.
    """
    plan = run_config.load_config(folder)
    here, logged = code_identity.code_sha256(plan.humans.model, plan.kinds), wanted.spec.code_sha256
    if here != logged:
        raise RunError(
            f"{folder} was played by another version of hthor (its code's hash was {logged[:10]} and is {here[:10]}), "
            "in which people may think otherwise. Play the run again with 'hthor eval', or look with that version."
        )
    spec = wanted.spec
    _, records = reader.records(folder, plan)
    mine = [one.spec for one in records if one.spec.participant == spec.participant and one.spec.index <= spec.index]
    if [one.index for one in mine] != list(range(spec.index + 1)):
        raise RunError(
            f"{folder} lacks some of the trials that participant {spec.participant} did before this one, which shaped "
            "their trust. Finish the run with the 'hthor eval' command that began it."
        )
    return tuple(mine)


def replay_sources(
    folder: Path, spec: TrialSpec, agents: Sequence[str] = (), humans: str = "", given: AgentInputs | None = None
) -> trial_runner.Sources:
    """Where that lies which a trial needs.

    Args:
        folder: the run's. agents: files of its agents that are not built in. humans: where its people come from.
        given: arguments and files that the agents are given.

    Raises:
        HthorError: when an agent's file is needed and not given.
    """
    theirs = [seat for seat in spec.robots if seat.agent.name not in plugins.names("agent")]
    guests = GuestConfig(hidden=(str(folder.resolve()),), inputs=given or AgentInputs())
    found = [robot_team.load_agent_info(path, guests) for path in agents] if theirs else []
    minds = {seat.seat: _same(folder, seat, found) for seat in theirs}
    own = folder / "houses"
    return trial_runner.Sources(
        minds={seat: one.path for seat, one in minds.items()},
        manifests={seat: one.manifest for seat, one in minds.items() if one.manifest is not None},
        people=humans,
        houses=str(own.resolve()) if own.is_dir() else "",
        guests=guests,
    )


def _same(folder: Path, seat: RobotSeat, given: Sequence[AgentInfo]) -> AgentInfo:
    """The agent among those that were given which the run was played with."""
    for character in given:
        if character.ref.sha256 == seat.agent.sha256:
            return character
    known = next((one for one in run_config.load_config(folder).agents if one.sha256 == seat.agent.sha256), None)
    near = next((one.manifest for one in given if one.manifest and known and one.manifest.source == known.source), None)
    what = ""
    if near is not None and known is not None:
        found = manifest.differences(known.files, near.files)
        found += ["--agent-args are others"] if near.args != known.args else []
        what = f" It is not as it was: {'; '.join(found)}."
    raise HthorError(
        f"the agent '{seat.agent.name}' of this run came from the file {seat.agent.source}. Give that file, unchanged, "
        f"with --agent.{what}"
    )
