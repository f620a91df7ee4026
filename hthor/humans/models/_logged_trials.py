"""Trials of a person as a run's log holds them, to be done again.

Only what a person did is read: where they went, where they looked, what they handled, what they answered.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path

import msgspec
from msgspec import Struct

from hthor import documents, rules
from hthor.errors import HthorError
from hthor.humans.memory.subgoals import todo
from hthor.types import HUMAN, Briefing, Close, Drop, Event, Motion, Open, Pick, Place, Pose, TrialSpec

_START_M = 0.002
_DEEDS: dict[str, Callable[[dict[str, str]], Motion]] = {
    "picked": lambda data: Pick(object=data["object"]),
    "held": lambda data: Pick(object=data["object"]),
    "placed": lambda data: Place(on=data["on"]),
    "dropped": lambda _: Drop(),
    "lowered": lambda _: Drop(),
    "released": lambda _: Drop(),
    "opened": lambda data: Open(thing=data["thing"]),
    "closed": lambda data: Close(thing=data["thing"]),
}
_HINT = "Give a run folder or its trials.jsonl, as in --humans replay:runs/oracle-paper-seed0."


class Past(Struct, frozen=True, kw_only=True):
    """One trial of a log, as far as it is the person's; what else stands in its line is passed over."""

    spec: TrialSpec
    ticks: int
    trust: int | None
    events: tuple[Event, ...]
    paths: dict[str, list[tuple[int, int, int]]]
    journal: tuple[Event, ...] = ()

    def is_of(self, briefing: Briefing) -> bool:
        """Whether the task is the one that the person is told of now, as far as words go."""
        task = self.spec.task
        told = (briefing.instruction, briefing.target, briefing.relation, briefing.time_limit)
        return told == (task.instruction, task.goal.target, task.goal.relation, task.time_limit) and (
            todo(briefing) == task.goal.todo
        )

    def begins_at(self, pose: Pose) -> bool:
        """Whether the person stood here when it began."""
        start = self.spec.task.human_start
        return math.dist((start.x, start.y), (pose.x, pose.y)) < _START_M

    def deeds(self) -> Iterator[tuple[int, Motion]]:
        """What the hands did, and at which tick it took effect."""
        for event in self.events:
            if event.seat == HUMAN and event.kind in _DEEDS:
                yield event.tick, _where(_DEEDS[event.kind](event.data), event.tick, self.journal)

    def answers(self) -> Iterator[tuple[int, bool]]:
        """When the person confirmed (True) or declined a message."""
        for event in self.events:
            if event.seat == HUMAN and event.kind in ("confirmed", "declined"):
                yield event.tick, event.kind == "confirmed"

    def poses(self) -> list[Pose]:
        """Where the person was and looked, every `rules.LOG_EVERY_TICKS` ticks."""
        pitch = self._pitch()
        return [
            Pose(x=x / 1000.0, y=y / 1000.0, yaw=yaw / 1000.0, pitch=pitch(k * rules.LOG_EVERY_TICKS))
            for k, (x, y, yaw) in enumerate(self.paths[HUMAN])
        ]

    def moving(self) -> Callable[[int], bool | None]:
        """Whether the stick was pushed at a tick; None where the log does not say."""
        runs = next((event.data["runs"] for event in self.journal if event.kind == "stick"), None)
        if runs is None:
            return lambda _: None
        value = _steps(runs)
        return lambda tick: value(tick) > 0

    def _pitch(self) -> Callable[[int], float]:
        runs = next((event.data["pitch"] for event in self.journal if event.kind == "head"), [0, 0])
        value = _steps(runs)
        return lambda tick: value(tick) / 1000.0


def read(source: str) -> dict[int, list[Past]]:
    """The trials of each participant in a run folder or a log.

    Raises:
        HthorError: when there is no such log, or it cannot be read.
    """
    path = Path(source)
    return _read(str(path / "trials.jsonl" if path.is_dir() else path))


def sha256(source: str) -> str:
    """Hash of the log's bytes."""
    path = Path(source)
    return hashlib.sha256(_bytes(path / "trials.jsonl" if path.is_dir() else path)).hexdigest()


@cache
def _read(path: str) -> dict[int, list[Past]]:
    decoder = msgspec.json.Decoder(Past)
    found: dict[int, list[Past]] = {}
    for number, line in enumerate(_bytes(Path(path)).splitlines(keepends=True), 1):
        if not line.endswith(b"\n"):
            break  # a run that was stopped
        try:
            with documents.reading_errors():
                past = decoder.decode(line)
        except documents.Unreadable as error:
            raise HthorError(f"{path}, line {number}: {error}. {_HINT}") from None
        found.setdefault(past.spec.participant, []).append(past)
    if not found:
        raise HthorError(f"{path} holds no whole trial. {_HINT}")
    return {person: sorted(trials, key=lambda past: past.spec.index) for person, trials in found.items()}


def _bytes(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        raise HthorError(f"there is no log to replay at {path}: {error.strerror}. {_HINT}") from None


def _where(motion: Motion, tick: int, journal: tuple[Event, ...]) -> Motion:
    """The same motion, with where exactly something was put when the journal has it."""
    if not isinstance(motion, Place):
        return motion
    tried = [e for e in journal if e.kind == "attempt" and e.data.get("what") == "place" and e.tick <= tick]
    at = tried[-1].data.get("at") if tried else None
    return motion if at is None else Place(on=motion.on, position=tuple(at))


def _steps(runs: list[int]) -> Callable[[int], int]:
    """A step function from flat pairs of a tick and the value from then on."""
    ticks, values = runs[::2], runs[1::2]
    place = 0

    def value(tick: int) -> int:
        nonlocal place
        if ticks and ticks[min(place, len(ticks) - 1)] > tick:
            place = 0
        while place + 1 < len(ticks) and ticks[place + 1] <= tick:
            place += 1
        return values[place] if values and ticks[place] <= tick else 0

    return value
