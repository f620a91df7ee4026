"""The bars that a calibration has to clear before its population is worth using; computes no statistics.

A small calibration has wider ones: with ten studies, a share of .90 is found as anything from .7 to 1, its emulator has
seen a thirtieth of the trials, and there is nothing for ABC to go by.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from msgspec import Struct


class Bounds(Struct, frozen=True, kw_only=True):
    """Where a figure of merit has to lie.

    Attributes:
        coverage: share of true values inside 90 % intervals, over simulated studies.
        z_sd: sd of the emulator's standardised errors on whole studies.
        shift: greatest shift of a fitted parameter's median by ABC, in posterior standard deviations.
        effective: least effective number of weighed points. studies: least number of simulated studies.
        covered: share of the published figures that have to lie inside 90 % intervals of simulated studies.
    """

    coverage: tuple[float, float]
    z_sd: tuple[float, float]
    shift: float
    effective: float
    studies: int
    covered: float


FULL = Bounds(coverage=(0.86, 0.94), z_sd=(0.9, 1.1), shift=0.5, effective=400.0, studies=200, covered=1.0)
QUICK = Bounds(coverage=(0.75, 1.0), z_sd=(0.5, 2.0), shift=math.inf, effective=30.0, studies=10, covered=0.75)

_CLOSE = "medians, SR and TWSR within 4 points, adoption within 7"


class Figures(Struct, frozen=True, kw_only=True):
    """What is judged; see `Bounds`. ``worst`` is the parameter that ABC shifts most."""

    coverage: float
    studies: int
    z_sd: float
    shift: float
    worst: str
    effective: float
    covered: tuple[int, int]
    close: tuple[int, int]


class Gate(Struct, frozen=True, kw_only=True):
    """What was asked, what was found, and whether that will do."""

    name: str
    asks: str
    found: str
    passed: bool


def judge(found: Figures, *, quick: bool) -> tuple[Gate, ...]:
    """Every gate's verdict."""
    bounds = QUICK if quick else FULL
    return (
        _between("coverage", "90 % intervals hold {} to {} of the truths", found.coverage, bounds.coverage),
        _least("simulated studies", "at least {:.0f}", found.studies, bounds.studies),
        _between("emulator", "sd of standardised errors from {} to {}", found.z_sd, bounds.z_sd),
        _least("effective points", "at least {:.0f}", found.effective, bounds.effective),
        _share("figures covered", "in 90 % intervals of studies", found.covered, bounds.covered),
        *(() if quick else (_shift(found, bounds), _share("medians close", _CLOSE, found.close, 1.0))),
    )


def count(rows: Mapping[str, bool]) -> tuple[int, int]:
    """How many are true, and of how many."""
    return int(np.sum(list(rows.values()))), len(rows)


def _shift(found: Figures, bounds: Bounds) -> Gate:
    asks = f"medians of fitted parameters within {bounds.shift} posterior sd"
    if math.isnan(found.shift):
        return _gate("ABC cross-check", asks, "too few studies", False)
    return _gate("ABC cross-check", asks, f"{found.shift:.2f} ({found.worst})", found.shift < bounds.shift)


def _between(name: str, asks: str, value: float, bounds: tuple[float, float]) -> Gate:
    return _gate(name, asks.format(*bounds), f"{value:.3f}", bounds[0] <= value <= bounds[1])


def _least(name: str, asks: str, value: float, bound: float) -> Gate:
    return _gate(name, asks.format(bound), f"{value:.0f}", value >= bound)


def _share(name: str, asks: str, some: tuple[int, int], share: float) -> Gate:
    part, whole = some
    least = int(np.ceil(share * whole))
    return _gate(name, f"{least} of {whole} {asks}", f"{part} of {whole}", part >= least)


def _gate(name: str, asks: str, found: str, passed: bool) -> Gate:
    return Gate(name=name, asks=asks, found=found, passed=passed)
