"""Files that agents opened only during trials: joined over a run's trials, and compared with the disk.

`run.json` lists an agent's files before the first trial; each trial's record lists files that it opened later.
"""

from collections.abc import Iterable, Mapping, Sequence

import msgspec

from hthor.errors import AgentError, RunError
from hthor.eval.config.run_config import RunConfig
from hthor.eval.records.trial_record import TrialRecord
from hthor.guest import Guest, GuestConfig
from hthor.guest.agent import agent_files
from hthor.guest.agent.manifest import File, Manifest


def complete_manifests(config: RunConfig, records: Iterable[TrialRecord]) -> tuple[Manifest, ...]:
    """The files of each submitted agent, with those that trials added; independent of the order of records.

    Raises:
        RunError: when trials used different content of one file.
    """
    by_agent: dict[str, dict[str, tuple[File, str]]] = {}
    for record in records:
        for seat, files in (record.files or {}).items():
            agent = next((robot.agent.sha256 for robot in record.spec.robots if robot.seat == seat), "")
            known = by_agent.setdefault(agent, {})
            for file in files:
                first, trial = known.setdefault(file.path, (file, record.key))
                if first != file:
                    raise RunError(
                        f"{file.path} was not the same in all trials of this run: trials {trial} and {record.key} were "
                        "played with different content of it. Play the run again in a new folder, with --out."
                    )
    return tuple(
        msgspec.structs.replace(
            agent, files=tuple(sorted({*agent.files, *(file for file, _ in by_agent.get(agent.sha256, {}).values())}))
        )
        for agent in config.agents
    )


def check_opened_files(
    agent_paths: Mapping[str, str], guests: GuestConfig, config: RunConfig, records: Sequence[TrialRecord]
) -> None:
    """Check that the files that the agents (by seat) opened in earlier trials of a run are unchanged.

    Raises:
        AgentError: names the file that changed.
        RunError: as `complete_manifests`.
    """
    complete_manifests(config, records)
    for seat, agent in agent_paths.items():
        files = {file for record in records for file in (record.files or {}).get(seat, ())}
        if files:
            try:
                grounds = Guest(agent, config=guests).paths
                agent_files.check_hashes(sorted(files), grounds, since="since trials of this run were played with it")
            except AgentError as error:
                raise AgentError(f"{error} --out FOLDER gives it one.") from None
