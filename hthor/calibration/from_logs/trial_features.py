"""Everything that the estimators use of one trial's log, in one record."""

import math

from msgspec import Struct

from hthor import rules
from hthor.calibration.from_logs.features import locomotion, messages
from hthor.calibration.from_logs.features.locomotion import Walk
from hthor.calibration.from_logs.features.messages import Offer, Reading
from hthor.calibration.from_logs.load_sessions import Sessions, Trial
from hthor.calibration.from_logs.models.search_models import Choice, Exposure
from hthor.calibration.from_logs.models.trust_model import Experience
from hthor.eval.records.trial_record import TrialRecord
from hthor.humans.population.parameters import Parameters


class Attempt(Struct, frozen=True, kw_only=True):
    """One manipulation attempt: its duration [s], whether it ``missed``, and whether it was ``cut`` short."""

    seconds: float
    missed: bool
    cut: bool


class TrialFeatures(Struct, frozen=True, kw_only=True):
    """A trial as numbers; ``walk`` is None where the log has no joystick data."""

    person: int
    session: int
    index: int
    walk: Walk | None
    attempts: tuple[Attempt, ...]
    readings: tuple[Reading, ...]
    noticings: tuple[tuple[float, bool], ...]
    offers: tuple[Offer, ...]
    choices: tuple[Choice, ...]
    exposures: tuple[Exposure, ...]
    experience: Experience


def extract_features(sessions: Sessions) -> tuple[TrialFeatures, ...]:
    """The features of every trial of some sessions, in their order."""
    return tuple(_reduced(one) for one in sessions.trials)


def _reduced(trial: Trial) -> TrialFeatures:
    record = trial.record
    walk = locomotion.walk_features(record)
    pace = walk.pace if walk is not None and not math.isnan(walk.pace) else Parameters().v_pace
    return TrialFeatures(
        person=trial.person,
        session=trial.session,
        index=record.spec.index,
        walk=walk,
        attempts=manipulation_attempts(record),
        readings=messages.message_readings(record),
        noticings=messages.message_noticings(record),
        offers=messages.message_offers(record),
        choices=tuple(
            Choice(options=event.data["options"], chosen=event.data["chosen"], pace=pace)
            for event in record.journal
            if event.kind == "choice" and event.data["aim"] == "target" and len(event.data["options"]) > 1
        ),
        exposures=tuple(
            Exposure(rows=event.data["gathered"], noticed=event.data["noticed"])
            for event in record.journal
            if event.kind == "exposure"
        ),
        experience=_experience(record),
    )


def _experience(record: TrialRecord) -> Experience:
    confirmed = [event.tick for event in record.journal if event.kind == "offer" and _helps(event.data)]
    misled = [event.tick for event in record.journal if event.kind == "misled"]
    helped = confirmed[0] * rules.TICK_S if confirmed and not misled else math.nan
    return Experience(
        offered=any(event.kind == "shown" for event in record.events),
        helped=helped,
        misled=len(misled),
        met=record.met,
        rating=record.trust or 0,
    )


def _helps(offer: dict[str, object]) -> bool:
    return bool(offer["relevant"]) and offer["answer"] == "confirm"


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
