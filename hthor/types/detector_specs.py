"""The names and rates by which users choose a robot's detector."""

import math

from hthor.errors import HthorError, UnknownName
from hthor.types import DetectorSpec

OWN = "own"
"""The detector that the robot's body declares."""
IDEAL = DetectorSpec(name="ideal")
NOISY = DetectorSpec(name="noisy", miss=0.2, false_alarm=0.05, position_sigma=0.03)
_NAMED = {spec.name: spec for spec in (IDEAL, NOISY)}
_RATES = ("miss", "false_alarm", "position_sigma")
_VALID = "own, ideal, noisy, or rates such as miss=0.2,false_alarm=0.05,position_sigma=0.03"


def parse(text: str) -> DetectorSpec:
    """The detector named "ideal" or "noisy", or described by rates: "miss=0.2,false_alarm=0.05,position_sigma=0.03".

    Rates that are left out are 0. The record's name is the text in canonical spelling: rates in order, zeros left out.

    Raises:
        HthorError: when the text is neither a name nor a list of rates, or a rate is out of range.
    """
    if text in _NAMED:
        return _NAMED[text]
    rates: dict[str, float] = {}
    for word in text.split(","):
        name, equals, number = (part.strip() for part in word.partition("="))
        if not equals and "," not in text:
            hint = "Or rates, such as miss=0.2,false_alarm=0.05,position_sigma=0.03."
            raise UnknownName("detector", text, (OWN, *_NAMED), hint)
        if not equals or name not in _RATES or name in rates:
            raise HthorError(f"unknown detector '{text}': '{word.strip()}' is not a rate. Valid: {_VALID}.")
        rates[name] = _rate(name, number)
    known = DetectorSpec(name="", **rates)
    listed = ",".join(f"{name}={getattr(known, name):.12g}" for name in _RATES if getattr(known, name))
    return DetectorSpec(name=listed or IDEAL.name, **rates)


def canonical_name(text: str) -> str:
    """The canonical spelling of a detector; "own" stays as it is.

    Raises:
        HthorError: when `parse` raises it.
    """
    return OWN if text == OWN else parse(text).name


def _rate(name: str, number: str) -> float:
    try:
        value = float(number)
    except ValueError:
        value = math.nan
    if not 0.0 <= value <= 1.0:
        unit = "m" if name == "position_sigma" else "a chance"
        raise HthorError(f"detector: {name} must be from 0 to 1 ({unit}), got '{number}'. Valid: {_VALID}.")
    return value
