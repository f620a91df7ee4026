"""Reports of agents' failures for their authors; no score depends on them.

The trial's record has the fault itself. A fault report adds the agent's last output, observations and actions. A run
keeps the first reports of each kind of fault as `faults/KEY.json`, so that many faults cannot fill the disk.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec
from msgspec import Struct

from hthor import documents, jsonio, rules
from hthor.errors import RunError
from hthor.trials.participants import RecordedAgent
from hthor.types import Action, Observation, TrialSpec

if TYPE_CHECKING:
    from hthor.episode import Fault

SCHEMA = "hthor.faults/2"
FOLDER = "faults"
MOST_OF_A_KIND, MOST = 20, 200
"""How many reports a run keeps: of one kind of fault, and in all. Our choice."""
_OUTPUT_CHARACTERS = 8000
_SCRATCH = re.compile(r"[^\s'\"]*/hthor-guest(?:-\w+)?(?=[/\s'\":,)]|$)")
_ADDRESS = re.compile(r"\b0x[0-9a-f]{6,16}\b")


class Look(Struct, frozen=True, kw_only=True):
    """One step of the agent: the observation without its sensors, and its action; null if it failed there."""

    tick: int
    observation: dict[str, Any]
    action: Action | None


class Failure(Struct, frozen=True, kw_only=True):
    """One agent's failure, ``time_s`` [s] into the trial: its traceback or what it did, its last output and steps."""

    seat: str
    agent: str
    kind: str
    tick: int
    time_s: float
    detail: str
    output: str = ""
    looks: tuple[Look, ...] = ()


class FaultReport(Struct, frozen=True, kw_only=True):
    """A trial in which agents failed. ``again`` is the command that runs it once more."""

    schema: str = SCHEMA
    key: str
    task: str
    session: int
    index: int
    failures: tuple[Failure, ...]
    again: str = ""


def describe_faults(key: str, trial: TrialSpec, faults: Sequence[Fault], agents: Mapping[str, Any]) -> FaultReport:
    """The report of a trial's faults and its ``agents`` by seat; for an agent that was not recorded, only its fault."""
    names = {robot.seat: robot.agent.name for robot in trial.robots}
    failures = []
    for fault in faults:
        agent = agents.get(fault.seat)
        output, looks = (agent.output, tuple(agent.looks)) if isinstance(agent, RecordedAgent) else ("", ())
        failures.append(
            Failure(
                seat=fault.seat,
                agent=names[fault.seat],
                kind=fault.kind,
                tick=fault.tick,
                time_s=round(fault.tick * rules.TICK_S, 1),
                detail=fault.detail,
                output=output[-_OUTPUT_CHARACTERS:],
                looks=tuple(_look(*pair) for pair in looks),
            )
        )
    return FaultReport(key=key, task=trial.task.id, session=trial.session, index=trial.index, failures=tuple(failures))


def _look(observation: Observation, action: Action | None) -> Look:
    fields = {
        name: msgspec.to_builtins(getattr(observation, name))
        for name in ("pose", "idle", "room", "holding", "outcome", "receipt")
    }
    return Look(tick=observation.tick, observation=fields, action=action)


def redact(text: str, files: Iterable[str]) -> str:
    """A fault's text without what differs between machines: paths become relative to these files, addresses are cut.

    The text is part of the trial's record, which must be the same bytes wherever the agent's file is.

    Args:
        files: paths of files, or of classes in files (``agent.py:Class``).
    """
    scripts = [file for file in files if file.endswith(".py") or ".py:" in file]
    folders = {str(Path(file.rpartition(":")[0] if ".py:" in file else file).resolve().parent) for file in scripts}
    for folder in sorted(folders, key=len, reverse=True):
        if folder != "/":
            text = text.replace(f"{folder}/", "")
    return _ADDRESS.sub("0x...", _SCRATCH.sub("$TMPDIR", text))


class FaultArchive:
    """Writes fault reports into a run's folder, up to `MOST_OF_A_KIND` and `MOST`.

    Args:
        folder: the run's folder.
        command: the command that runs a trial once more, without the trial's key; may be empty.
    """

    def __init__(self, folder: Path, command: str = "") -> None:
        self._folder, self._command = folder / FOLDER, command
        self._kinds: dict[str, int] | None = None

    def keep(self, report: FaultReport) -> None:
        """Write a report, unless there are enough of its kind."""
        if self._kinds is None:
            self._kinds = self._counts()
        kind = report.failures[0].kind if report.failures else ""
        if self._kinds.get(kind, 0) >= MOST_OF_A_KIND or sum(self._kinds.values()) >= MOST:
            return
        self._kinds[kind] = self._kinds.get(kind, 0) + 1
        report = msgspec.structs.replace(report, again=f"{self._command} {report.key}" if self._command else "")
        jsonio.write(self._folder / f"{report.key}.json", jsonio.pretty(report))

    def _counts(self) -> dict[str, int]:
        """How many reports earlier commands kept, by kind; half-written files are removed."""
        for torn in self._folder.glob(".*.json.*"):
            torn.unlink(missing_ok=True)
        kinds: dict[str, int] = {}
        for path in sorted(self._folder.glob("*.json")):
            kind = load_fault_report(path).failures[0].kind
            kinds[kind] = kinds.get(kind, 0) + 1
        return kinds


def load_fault_report(path: Path) -> FaultReport:
    """The report in a file; raises RunError when it cannot be read."""
    return documents.read(path, FaultReport, RunError, hint="it only describes faults: delete it, and go on")


def rerun_command(folder: Path, key: str) -> str:
    """The command that runs a trial of a run once more, from its fault report; empty where it has none."""
    path = folder / FOLDER / f"{key}.json"
    return load_fault_report(path).again if path.is_file() else ""
