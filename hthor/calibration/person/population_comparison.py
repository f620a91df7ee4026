"""Where one person stands in a population, parameter by parameter."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import msgspec
import numpy as np
from msgspec import Struct

from hthor.calibration.from_logs.estimate_all import READING
from hthor.calibration.person.measure import Measure
from hthor.calibration.person.words import Wording
from hthor.humans.population.parameters import Parameters
from hthor.humans.population.population import Population

PEOPLE = 1000
"""[people] So many people of the population are compared with. Our choice."""


class Spread(Struct, frozen=True, kw_only=True):
    """A parameter among the people of a population: mean, standard deviation, and where 90 % of them are."""

    mean: float
    sd: float
    low: float
    high: float


class Row(Struct, frozen=True, kw_only=True):
    """One number of a person beside the population's.

    Attributes:
        title: what it is, in plain words. measure: the person's.
        people: the population's; None where it has no such number.
        below: [%] of the population with less than the person's value; None where either is not known, or where the
            people of the population do not differ.
        z: how many standard deviations of the population the person is above its mean; None as ``below``.
    """

    title: str
    measure: Measure
    people: Spread | None = None
    below: float | None = None
    z: float | None = None


def people_of(population: Population, seed: int = 0) -> Mapping[str, Any]:
    """The parameters of `PEOPLE` participants, each (PEOPLE,), by name, and the sum of both reading times."""
    drawn = [population.draw_traits(seed, number) for number in range(PEOPLE)]
    names = msgspec.structs.fields(Parameters)
    found = {field.name: np.array([getattr(one, field.name) for one in drawn]) for field in names}
    return {**found, READING: found["t_notice"] + found["t_read"]}


def compare(measures: Sequence[Measure], words: Mapping[str, Wording], people: Mapping[str, Any]) -> tuple[Row, ...]:
    """A row for each measure, in their order."""
    return tuple(_row(one, words[one.name].title, people.get(one.name)) for one in measures)


def _row(measure: Measure, title: str, values: Any | None) -> Row:
    if values is None:
        return Row(title=title, measure=measure)
    low, high = (float(edge) for edge in np.quantile(values, (0.05, 0.95)))
    spread = Spread(mean=float(values.mean()), sd=float(values.std()), low=low, high=high)
    if measure.value is None or spread.sd < 1e-9:
        return Row(title=title, measure=measure, people=spread)
    below = float((values < measure.value).mean() + 0.5 * (values == measure.value).mean())
    z = (measure.value - spread.mean) / spread.sd
    return Row(title=title, measure=measure, people=spread, below=round(100.0 * below, 1), z=round(z, 2))
