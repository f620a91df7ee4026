"""Everything that the estimators use of one trial's log, in one record."""

import math

from msgspec import Struct

from hthor import rules
from hthor.calibration.from_logs.features import locomotion, manipulation, messages
from hthor.calibration.from_logs.features.locomotion import Walk
from hthor.calibration.from_logs.features.manipulation import Attempt
from hthor.calibration.from_logs.features.messages import Offer, Reading
from hthor.calibration.from_logs.load_sessions import Sessions
from hthor.calibration.from_logs.models.choice_model import Choice, default_pace
from hthor.calibration.from_logs.models.detection_model import Exposure
from hthor.calibration.from_logs.models.trust_model import Experience
from hthor.eval.records.trial_record import TrialRecord


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
    return tuple(_reduced(one.record, one.person, one.session, one.index) for one in sessions.trials)


def _reduced(record: TrialRecord, person: int, session: int, index: int) -> TrialFeatures:
    walk = locomotion.walk_features(record)
    pace = walk.pace if walk is not None and not math.isnan(walk.pace) else default_pace()
    return TrialFeatures(
        person=person,
        session=session,
        index=index,
        walk=walk,
        attempts=manipulation.manipulation_attempts(record),
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
