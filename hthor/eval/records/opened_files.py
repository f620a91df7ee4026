"""Files that agents opened only while they played: joined over a run's trials, and compared with the disk.

What an agent consists of stands in `run.json` before the first trial. What it opens later, each trial's record tells.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import msgspec

from hthor.errors import AgentError, RunError
from hthor.eval.config.run_config import RunConfig
from hthor.eval.records.trial_record import TrialRecord
from hthor.guest import Guest, GuestConfig
from hthor.guest.agent import agent_files
from hthor.guest.agent.manifest import File, Manifest


def complete_manifests(plan: RunConfig, records: Iterable[TrialRecord]) -> tuple[Manifest, ...]:
    """What each agent of a run consists of, with all that its trials add; the same in whatever order they come.

    Raises:
        RunError: when trials were played with different content of one file.
    """
    more: dict[str, dict[str, tuple[File, str]]] = {}
    for record in records:
        for seat, files in (record.files or {}).items():
            agent = next((robot.agent.sha256 for robot in record.spec.robots if robot.seat == seat), "")
            held = more.setdefault(agent, {})
            for file in files:
                there, trial = held.setdefault(file.path, (file, record.key))
                if there != file:
                    raise RunError(
                        f"{file.path} was not the same in all trials of this run: trials {trial} and {record.key} were "
                        "played with different content of it. Play the run again in a new folder, with --out."
                    )
    return tuple(
        msgspec.structs.replace(
            one, files=tuple(sorted({*one.files, *(file for file, _ in more.get(one.sha256, {}).values())}))
        )
        for one in plan.agents
    )


def check_opened_files(
    minds: Mapping[str, str], guests: GuestConfig, plan: RunConfig, records: Sequence[TrialRecord]
) -> None:
    """See that what a run's trials were played with so far is still there, before more of them are played.

    Args:
        minds: agents that are not built in, by seat. guests: what they are given.

    Raises:
        AgentError: names the file that is not as it was. RunError: as `manifests`.
    """
    complete_manifests(plan, records)
    for seat, mind in minds.items():
        used = {file for record in records for file in (record.files or {}).get(seat, ())}
        if used:
            try:
                grounds = Guest(mind, config=guests).paths
                agent_files.check_hashes(sorted(used), grounds, since="since trials of this run were played with it")
            except AgentError as error:
                raise AgentError(f"{error} --out FOLDER gives it one.") from None
