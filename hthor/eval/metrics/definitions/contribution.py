"""The metric of contribution: each seat's share of what was achieved in a trial."""

from collections.abc import Iterator, Sequence

from hthor.episode.recording.episode_log import EpisodeLog
from hthor.eval.metrics.metric import SHARE, Metric, Trial
from hthor.types import WALKERS, TrialSpec
from hthor.types.events import Closed, Dropped, Event, Lifted, Lowered, Opened, Picked, Placed, Progress, Success

_FINISH = (Placed, Dropped, Lifted, Lowered, Opened, Closed)
_TAKE = (Picked, Lifted)
_EPS = 1e-9

Credit = dict[str, float]
"""Shares by seat."""


def work(trial: Trial) -> dict[str, float]:
    """Each seat's share of what was achieved; no shares where nothing was achieved."""
    return shares(trial.spec, trial.log) or {}


def shares(spec: TrialSpec, log: EpisodeLog) -> Credit | None:
    """Each seat's share of the work, summing to 1; None when nothing was achieved.

    Every rise of the progress (for a goal without parts: meeting it) is credited in equal parts to these actions:

    - its cause: the last action before it that finishes something (an object placed, dropped, lifted or lowered, a
      thing opened or closed; failing that, picked up); while several carry something, their lift;
    - the pick before it of the same object;
    - the openings before it of the furniture that the object was taken out of or put into.

    An action that several seats did together counts in equal parts for them. A find is credited to the person who saw
    the target, and to the seat that opened its furniture; a walk to the seat that walks. A fall of the progress takes
    back the latest credit.
    """
    ledger: list[tuple[float, Credit]] = []
    for tick, rise, seer in _steps(spec, log):
        if rise > 0.0:
            ledger.append((rise, _credit(spec, log, tick, seer)))
        else:
            _take_back(ledger, -rise)
    total = dict.fromkeys(log.paths, 0.0)
    for rise, credit in ledger:
        for seat, part in credit.items():
            total[seat] += rise * part
    whole = sum(total.values())
    return {seat: value / whole for seat, value in total.items()} if whole > _EPS else None


def _steps(spec: TrialSpec, log: EpisodeLog) -> Iterator[tuple[int, float, str]]:
    """Ticks at which the progress changed, by how much, and the person who saw it; it starts to count after tick 0."""
    if log.progress is None:
        if log.met:
            ends = (event.seat for event in reversed(log.events) if isinstance(event, Success))
            yield log.ticks, 1.0, next(ends, spec.humans[0].seat)
        return
    value = 0.0
    for event in log.events:
        if isinstance(event, Progress):
            rise, value = event.value - value, event.value
            if event.tick > 0:
                yield event.tick, rise, event.seat


def _take_back(ledger: list[tuple[float, Credit]], fall: float) -> None:
    while ledger and fall > _EPS:
        rise, credit = ledger.pop()
        if rise > fall + _EPS:
            ledger.append((rise - fall, credit))
        fall -= rise


def _credit(spec: TrialSpec, log: EpisodeLog, tick: int, seer: str) -> Credit:
    """The seats' credit for the progress made at ``tick``; empty when nobody had acted before."""
    past = [event for event in log.events if event.tick <= tick]
    if all(job.relation == "find" for job in spec.task.goal.todo):
        parts = [(seer,), *_openers(past, [_start(spec, job.target) for job in spec.task.goal.todo])]
    elif all(job.relation == "go" for job in spec.task.goal.todo):
        parts = [(WALKERS[job.target],) for job in spec.task.goal.todo]
    else:
        parts = _chain(spec, past)
    credit: Credit = {}
    for seats in parts:
        for seat in seats:
            credit[seat] = credit.get(seat, 0.0) + 1.0 / (len(parts) * len(seats))
    return credit


def _chain(spec: TrialSpec, past: Sequence[Event]) -> list[tuple[str, ...]]:
    """The seats that did the last action, and each earlier action that it needed."""
    load = next((event for event in reversed(past) if isinstance(event, (Lifted, Lowered))), None)
    last = next((event for kinds in (_FINISH, _TAKE) for event in reversed(past) if isinstance(event, kinds)), None)
    if isinstance(load, Lifted):
        last = load
    if last is None:
        return []
    if isinstance(last, (Opened, Closed)):
        return [_doers(last)]
    before = list(past[: past.index(last)])
    parts = [_doers(last)]
    taken = (event for event in reversed(before) if isinstance(event, _TAKE))
    take = next((event for event in taken if event.object == last.object), None)
    origin = _start(spec, last.object)
    if take is not None and not isinstance(last, _TAKE):
        parts.append(_doers(take))
        placed = (event for event in reversed(before[: before.index(take)]) if isinstance(event, Placed))
        origin = next((event.on for event in placed if event.object == last.object), origin)
    return parts + _openers(before, [origin, last.on if isinstance(last, Placed) else ""])


def _openers(past: Sequence[Event], things: Sequence[str]) -> list[tuple[str, ...]]:
    """The seats that last opened each of the things."""
    opened = {event.thing: _doers(event) for event in past if isinstance(event, Opened)}
    return [opened[thing] for thing in dict.fromkeys(things) if thing in opened]


def _start(spec: TrialSpec, object_: str) -> str:
    """The furniture that the object rests on or in when the trial begins."""
    return next((placed.support for placed in spec.task.objects if placed.id == object_), "")


def _doers(event: Event) -> tuple[str, ...]:
    return event.bearers if isinstance(event, (Lifted, Lowered)) and event.bearers else (event.seat,)


METRICS = (Metric("work", "share of the work", work, unit=SHARE, rank=900, by_seat=True, needs_robot=True),)
