"""Reads a trial's log for drawing: paths, messages and their outcomes, targets and colours."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

import numpy as np
from msgspec import Struct

from hthor import rules
from hthor.episode import EpisodeLog, Fault
from hthor.errors import RunError
from hthor.types import HUMAN, HouseSpec, HumanSeat, Job, Placement, RobotSeat, TrialSpec, Vec2, is_person
from hthor.types.events import Accepted, MessageEvent, Sent

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Okabe and Ito's palette, which colour-blind readers can tell apart.
PEOPLE = ("#0072B2", "#001f54", "#7fb8e6", "#5b6f95")
ROBOTS = ("#D55E00", "#CC79A7", "#E69F00", "#56B4E9", "#8a6d00")
TARGET, MESSAGE, FAILED = "#009E73", "#7a3b8f", "#b00020"
IDLE_MESSAGE = "#ae98b8"
INK = "#2b2f36"

ACTS = {
    "picked": ("^", "picks"),
    "placed": ("v", "places"),
    "dropped": ("v", "drops"),
    "held": (">", "takes hold"),
    "lifted": ("^", "lift"),
    "lowered": ("v", "put down"),
    "opened": ("D", "opens"),
    "closed": ("s", "closes"),
}
"""Marker and verb of each action that is drawn."""
_OUTCOMES = ("accepted", "declined", "answered", "covered", "shown")
_THERE_M = 0.3
_PARTS, _ROUND, _PADDED = 2, 3, 1.6
"""Parts of a group of numbers that are written out; letters from which on a badge is no disc; its margins [letters]."""
GONE = "#9aa0a6"
"""The colour of a robot whose agent failed."""
_MARKED = 8
"""Destinations are marked if they are at most this many; more would mark half the house."""


def targets(spec: TrialSpec, house: HouseSpec) -> list[tuple[Job, Placement]]:
    """Every job that is not done at the start, and the start placement of its object."""
    starts, kinds = (
        {placed.id: placed for placed in spec.task.objects},
        {thing.id: thing.kind for thing in house.things},
    )

    def is_there(job: Job, start: Placement) -> bool:
        if job.place is not None:
            return math.dist(job.place[:2], start.position[:2]) < _THERE_M
        return bool({start.support, kinds.get(start.support, "")} & set(job.destinations))

    pairs = [(job, starts[job.target]) for job in spec.task.goal.todo if job.target in starts]
    return [(job, start) for job, start in pairs if not is_there(job, start)]


def phase_words(spec: TrialSpec) -> str:
    """The phases before the task itself in words."""
    return " and ".join(phase.name for phase in spec.task.phases)


def destinations(spec: TrialSpec, house: HouseSpec) -> list[str]:
    """Ids of the things and rooms that objects are to be taken to; none if almost any place is right."""
    wanted = {name for job in spec.task.goal.todo if job.place is None for name in job.destinations}
    found = [thing.id for thing in house.things if {thing.id, thing.kind} & wanted]
    found += [room.id for room in house.rooms if room.id in wanted]
    return found if len(found) <= _MARKED else []


def robot_words(robot: RobotSeat) -> str:
    """A robot's seat, body and agent in words."""
    return f"{robot.seat}: {robot.robot} ({robot.agent.name})"


def seat_colour(seat: str) -> str:
    """The colour of a seat's path."""
    sort, shades = (HUMAN, PEOPLE) if is_person(seat) else ("robot", ROBOTS)
    return shades[(int(seat.removeprefix(sort) or 1) - 1) % len(shades)]


def seat_name(seat: str, seats: Iterable[str]) -> str:
    """A seat in pictures: "person" for the only one among ``seats``, else the seat's own name."""
    return "person" if is_person(seat) and not any(is_person(other) for other in seats if other != seat) else seat


def person_words(human: HumanSeat, spec: TrialSpec) -> str:
    """A person in a legend; if there are several, with their seat and the population that they belong to."""
    return "person" if len(spec.humans) == 1 else f"{human.seat}: {human.model}"


def points(log: EpisodeLog, seat: str) -> np.ndarray:
    """(N, 2) positions of the seat at all logged ticks [m]."""
    return np.array(_path(log, seat), dtype=float)[:, :2] / 1000.0


def position_at(log: EpisodeLog, seat: str, tick: int) -> Vec2:
    """The seat's position at ``tick`` [m], taken from the nearest logged pose."""
    path = _path(log, seat)
    x, y, _ = path[min(tick // rules.LOG_EVERY_TICKS, len(path) - 1)]
    return (x / 1000.0, y / 1000.0)


def _path(log: EpisodeLog, seat: str) -> list[tuple[int, int, int]]:
    """The logged path of the seat.

    Raises:
        RunError: if the log has no path of this seat, for example because somebody edited it.
    """
    if not (path := log.paths.get(seat)):
        raise RunError(f"the trial's record has no path of '{seat}', so the trial cannot be drawn.")
    return path


def messages(log: EpisodeLog) -> list[Sent]:
    """The messages that were sent, in order."""
    return [event for event in log.events if isinstance(event, Sent)]


def outcome_of(log: EpisodeLog, message: int) -> str:
    """How a message ended for anybody: accepted, declined, answered, covered, shown or sent, the first that fits."""
    kinds = {event.kind for event in log.events if isinstance(event, MessageEvent) and event.message == message}
    return next((kind for kind in _OUTCOMES if kind in kinds), "sent")


def message_colour(log: EpisodeLog, message: Sent) -> str:
    """The colour of a message: strong if a person accepted it, else pale."""
    return message_colours(log)[message.message]


def message_colours(log: EpisodeLog) -> dict[int, str]:
    """The colours of all messages that were sent, by their numbers in the log."""
    accepted = {event.message for event in log.events if isinstance(event, Accepted)}
    sent = (message.message for message in messages(log))
    return {number: MESSAGE if number in accepted else IDLE_MESSAGE for number in sent}


def end_word(log: EpisodeLog) -> str:
    """How the trial ended, in a word or three."""
    return "voided" if log.voided else "done" if log.met else "time is up"


def first_fault(log: EpisodeLog, seat: str) -> Fault | None:
    """The first fault of a seat's agent; the trial went on without the agent."""
    return next((fault for fault in log.faults if fault.seat == seat), None)


_Mark = tuple[int, Sent, Vec2]
_Joined = tuple[list[_Mark], str]
"""A message with its number and place (``_Mark``); those that share a badge, and their numbers in words."""


class MessageGroup(Struct, frozen=True, kw_only=True):
    """Messages that share a badge because they would hide one another."""

    words: str
    place: Vec2
    shade: str


def group_messages(
    log: EpisodeLog, marks: Sequence[tuple[int, Sent, Vec2]], letter: float, high: float
) -> list[MessageGroup]:
    """Group messages, with numbers and places: those whose badges would touch are joined, at the place of the first.

    A group with an accepted message has the colour of accepted messages.

    Args:
        letter, high: width of a letter on a badge and height of a badge, in the units of the places.
    """

    def touch(one: _Joined, other: _Joined) -> bool:
        (x, y), (u, v) = one[0][0][2], other[0][0][2]
        wide = sum(_PADDED + len(words) for _, words in (one, other)) * letter / 2.0
        return abs(x - u) < wide and abs(y - v) < high

    shades = message_colours(log)
    held: list[_Joined] = []  # no two groups touch, so there are only a few, however many messages there are
    for mark in marks:
        one: _Joined = ([mark], _numbers([mark]))
        while (near := next((other for other in held if touch(one, other)), None)) is not None:
            held = [other for other in held if other is not near]
            both = sorted([*near[0], *one[0]], key=lambda mark: mark[0])
            one = (both, _numbers(both))
        held.append(one)
    return [
        MessageGroup(
            words=words,
            place=some[0][2],
            shade=MESSAGE if any(shades[message.message] == MESSAGE for _, message, _ in some) else IDLE_MESSAGE,
        )
        for some, words in sorted(held, key=lambda one: one[0][0][0])
    ]


def _numbers(marks: Sequence[tuple[int, Sent, Vec2]]) -> str:
    return number_ranges([number for number, _, _ in marks])


def number_ranges(numbers: Sequence[int]) -> str:
    """Rising numbers in words, such as "1–3, 7"; if these are more than two parts, only both ends: "1 … 9"."""
    parts: list[list[int]] = []
    for number in numbers:
        if parts and number == parts[-1][1] + 1:
            parts[-1][1] = number
        else:
            parts.append([number, number])
    words = [
        f"{low}–{high}" if high > low + 1 else ", ".join(map(str, dict.fromkeys((low, high)))) for low, high in parts
    ]
    return ", ".join(words) if len(words) <= _PARTS else f"{numbers[0]} … {numbers[-1]}"


def draw_mark(ax: Axes, place: Sequence[float], shape: str, size: float, shade: str, edge: float, z: float) -> None:
    """Draw a mark of ``size`` [pt^2] with a white outline of ``edge`` [pt]."""
    ax.scatter(place[0], place[1], s=size, marker=shape, color=shade, edgecolor="white", linewidths=edge, zorder=z)


def draw_badge(ax: Axes, place: Vec2, text: str, shade: str) -> None:
    """Draw messages' numbers in a disc. The disc does not make the axes smaller, even at their edge."""
    style = "circle,pad=0.22" if len(text) < _ROUND else "round,pad=0.2,rounding_size=0.6"
    box = {"boxstyle": style, "facecolor": shade, "edgecolor": "white", "lw": 0.8}
    made = ax.text(
        *place, text, fontsize=7, color="white", weight="bold", ha="center", va="center", bbox=box, zorder=14
    )
    made.set_in_layout(False)
