"""What is left of an agent that failed, for its author; decides nothing, and no score depends on it.

The record has the fault. Why it came to that is told by what the agent printed last, what it was given and what it
did. A run keeps this as `faults/KEY.json`, for the first trials of each kind of fault: a thousand faults fill no disk.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import msgspec
from msgspec import Struct

from hthor import documents, jsonio, rules
from hthor.episode import Fault
from hthor.errors import HthorError, RunError
from hthor.eval.runner.agent_recorder import RecordedAgent
from hthor.types import Action, Observation, TrialSpec

SCHEMA = "hthor.faults/1"
FOLDER = "faults"
MOST_OF_A_KIND, MOST = 20, 200
"""Trials whose remains a run keeps: of one kind of fault, and of all."""
_OUTPUT_CHARACTERS = 8000


class Look(Struct, frozen=True, kw_only=True):
    """One time that the agent was asked: what it could read at once, and what it did; null when that was its end."""

    tick: int
    observation: dict[str, Any]
    action: Action | None


class Failure(Struct, frozen=True, kw_only=True):
    """One robot's failure ``time_s`` into the trial: its traceback or what it did, its last output and last looks."""

    seat: str
    agent: str
    kind: str
    tick: int
    time_s: float
    detail: str
    output: str = ""
    looks: tuple[Look, ...] = ()


class FaultReport(Struct, frozen=True, kw_only=True):
    """A trial in which agents failed. ``again`` is the command that plays it once more."""

    schema: str = SCHEMA
    key: str
    task: str
    participant: int
    index: int
    failures: tuple[Failure, ...]
    again: str = ""


def describe_faults(key: str, trial: TrialSpec, faults: Sequence[Fault], minds: Mapping[str, Any]) -> FaultReport:
    """What is left of the agents that failed in a trial; of those that were not watched only the fault."""
    names = {robot.seat: robot.agent.name for robot in trial.robots}
    failures = []
    for fault in faults:
        mind = minds.get(fault.seat)
        output, looks = (mind.output, tuple(mind.looks)) if isinstance(mind, RecordedAgent) else ("", ())
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
    return FaultReport(
        key=key, task=trial.task.id, participant=trial.participant, index=trial.index, failures=tuple(failures)
    )


def _look(observation: Observation, action: Action | None) -> Look:
    told = {
        name: msgspec.to_builtins(getattr(observation, name))
        for name in ("pose", "idle", "room", "holding", "outcome", "receipt")
    }
    return Look(tick=observation.tick, observation=told, action=action)


_box: dict[str, FaultReport] = {}


def leave(left: FaultReport) -> None:
    """Lay it down in this process until whoever sends the trial's record takes it along."""
    _box[left.key] = left


def take(key: str) -> FaultReport | None:
    """What was laid down of a trial, which is then gone from here."""
    return _box.pop(key, None)


class FaultArchive:
    """Writes remains into a run's folder, as many as there is room for.

    Args:
        folder: the run's. again: the command that plays a trial once more, but for the trial's key; may be empty.
    """

    def __init__(self, folder: Path, again: str = "") -> None:
        self._folder, self._again = folder / FOLDER, again
        self._kinds: dict[str, int] | None = None

    def keep(self, left: FaultReport) -> None:
        """Write a trial's remains, unless there are enough of its kind."""
        if self._kinds is None:
            self._kinds = self._counted()
        kind = left.failures[0].kind if left.failures else ""
        if self._kinds.get(kind, 0) >= MOST_OF_A_KIND or sum(self._kinds.values()) >= MOST:
            return
        self._kinds[kind] = self._kinds.get(kind, 0) + 1
        told = msgspec.structs.replace(left, again=f"{self._again} {left.key}" if self._again else "")
        jsonio.write(self._folder / f"{left.key}.json", jsonio.pretty(told))

    def _counted(self) -> dict[str, int]:
        """How many an earlier command kept, by kind; it may also have left half a file."""
        for torn in self._folder.glob(".*.json.*"):
            torn.unlink(missing_ok=True)
        kinds: dict[str, int] = {}
        for path in sorted(self._folder.glob("*.json")):
            kind = load_fault_report(path).failures[0].kind
            kinds[kind] = kinds.get(kind, 0) + 1
        return kinds


def load_fault_report(path: Path) -> FaultReport:
    """What a file says.

    Raises:
        RunError: when it cannot be read.
    """
    return documents.read(path, FaultReport, RunError, hint="it only describes faults: delete it, and go on")


def rerun_command(folder: Path, key: str) -> str:
    """What plays a trial of a run once more, as its remains have it; empty where it has none."""
    path = folder / FOLDER / f"{key}.json"
    return load_fault_report(path).again if path.is_file() else ""


def parse_max_faults(words: str) -> Callable[[int], float]:
    """How many of so many trials may have a fault: "3", or "5%" of them.

    Raises:
        HthorError: when it is neither.
    """
    number, percent = words.strip().removesuffix("%"), words.strip().endswith("%")
    try:
        value = float(number) if percent else int(number)
    except ValueError:
        value = -1.0
    if not 0.0 <= value < math.inf or (percent and value > 100.0):
        raise HthorError(f"--max-faults '{words}' is no number of trials, such as 3, and no share of them, such as 5%.")
    return lambda trials: value / 100.0 * trials if percent else value
