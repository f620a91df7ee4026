"""What a person tried to manipulate in a trial, from the journal."""

from msgspec import Struct

from hthor import rules
from hthor.eval.records.trial_record import TrialRecord


class Attempt(Struct, frozen=True, kw_only=True):
    """One manipulation attempt: its duration [s], whether it ``missed``, and whether it was ``cut`` short."""

    seconds: float
    missed: bool
    cut: bool


def manipulation_attempts(record: TrialRecord) -> tuple[Attempt, ...]:
    """The attempts of a trial in order; one without an outcome was cut short by walking on or by the end."""
    walked = [
        tick
        for event in record.journal
        if event.kind == "stick"
        for tick, deflection in zip(event.data["runs"][::2], event.data["runs"][1::2], strict=True)
        if deflection > 0
    ]
    found = []
    for event in record.journal:
        if event.kind == "attempt":
            cut = "ok" not in event.data
            until = min((tick for tick in walked if tick > event.tick), default=record.ticks)
            seconds = (until - event.tick) * rules.TICK_S if cut else float(event.data["seconds"])
            found.append(Attempt(seconds=seconds, missed=event.data.get("why") == "missed", cut=cut))
    return tuple(found)
