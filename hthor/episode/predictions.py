"""Predictions of people's beliefs, as robots make them."""

import math

from hthor.types import Predict
from hthor.types.events import Predicted, Refused

PLACES_MAX = 64
"""Most places, and most activities, in one prediction."""
NAME_MAX = 200
"""Most characters in the name of an object, a place or an activity."""
_DIGITS, _SPARE = 4, 1e-6


def predicted(tick: int, seat: str, signal: Predict, people: tuple[str, ...]) -> Predicted | Refused:
    """The event of a prediction; one that is about nobody, or is no distribution, is refused."""
    if signal.person not in people:
        reason = f"'{signal.person}' is no person of this trial; its people are {', '.join(people)}"
        return Refused(tick=tick, seat=seat, reason=reason)
    reason = _objection("places", signal.places) or _objection("next", signal.next)
    if not _is_name(signal.object):
        reason = f"a prediction's 'object' must be an id of at most {NAME_MAX} printable characters"
    if signal.places and not signal.object:
        reason = reason or "a prediction of places needs an object"
    if reason:
        return Refused(tick=tick, seat=seat, reason=reason)
    places, following = _rounded(signal.places), _rounded(signal.next)
    return Predicted(tick=tick, seat=seat, person=signal.person, object=signal.object, places=places, next=following)


def _objection(name: str, shares: dict[str, float]) -> str:
    """Why the shares are no probabilities, empty when they are."""
    if len(shares) > PLACES_MAX:
        return f"a prediction's '{name}' has {len(shares)} entries, at most {PLACES_MAX} are taken"
    if not all(map(_is_name, shares)):
        return f"a prediction's '{name}' must have names of at most {NAME_MAX} printable characters"
    if any(not 0.0 <= share <= 1.0 for share in shares.values()):
        return f"a prediction's '{name}' has a probability that is not from 0 to 1"
    if (total := math.fsum(shares.values())) > 1.0 + _SPARE:
        return f"the probabilities of a prediction's '{name}' add up to {total:.3f}, which is more than 1"
    return ""


def _is_name(text: str) -> bool:
    return len(text) <= NAME_MAX and text.isprintable()


def _rounded(shares: dict[str, float]) -> dict[str, float]:
    """The shares by name, to four decimals."""
    return {name: round(shares[name], _DIGITS) for name in sorted(shares)}
