"""The cells of a person's table, for the terminal and for their page."""

from __future__ import annotations

import math

from hthor.calibration.person.measure import Measure
from hthor.calibration.person.population_comparison import Row, Spread
from hthor.calibration.person.words import OTHERS, PARAMETERS

_HUNDRED = 100.0
_ABOUT = 3.0
"""[%] Someone with nearly all, or nearly none, of a population below them is said to be at its end."""


def value_words(measure: Measure) -> str:
    """The person's value with its unit and its interval; a dash if it is not known."""
    if measure.value is None:
        return "–"
    value = _number(measure, measure.value)
    if measure.bound:
        return f"{measure.bound} {value}"
    if measure.low == measure.high:
        return value
    return f"{value} ({_number(measure, measure.low, bare=True)} … {_number(measure, measure.high, bare=True)})"


def people_words(row: Row) -> str:
    """The population's mean with its standard deviation, a dash if it has no such number."""
    if row.people is None:
        return "–"
    return _spread_words(row.measure, row.people)


def place_words(row: Row) -> str:
    """Where the person is among a hundred people of the population, in words."""
    if row.below is None:
        return "–"
    if row.measure.bound:
        return f"{row.measure.bound} {_rank(row.below)}"
    return _rank(row.below)


def z_words(row: Row) -> str:
    """How many standard deviations of the population the person is above its mean; a dash where that is not known."""
    return "–" if row.z is None else f"{row.z:+.1f}".replace("-", "−")


def _rank(below: float) -> str:
    if below >= _HUNDRED - _ABOUT:
        return "more than nearly everybody"
    if below <= _ABOUT:
        return "less than nearly everybody"
    return f"more than {below:.0f} of 100 people"


def _spread_words(measure: Measure, people: Spread) -> str:
    return f"{_number(measure, people.mean)} ± {_number(measure, people.sd, bare=True)}"


def _number(measure: Measure, value: float, *, bare: bool = False) -> str:
    """A number with its unit, or without."""
    wording = PARAMETERS.get(measure.name) or OTHERS[measure.name]
    if wording.percent:
        return f"{_HUNDRED * value:.0f}" + ("" if bare else " %")
    if not math.isfinite(value):
        return "any"
    text = f"{value:.2f}" if abs(value) < 10.0 else f"{value:.0f}"
    if value == round(value) and not measure.unit:
        text = f"{value:.0f}"
    return text.replace("-", "−") if bare or not measure.unit else f"{text} {measure.unit}".replace("-", "−")
