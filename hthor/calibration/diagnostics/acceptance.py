"""The criteria that a calibration has to meet before its population may be used.

A small calibration has wider bounds: with ten studies, a coverage of .90 is estimated as anything from .7 to 1, its
emulator has seen a thirtieth of the trials, and there are too few studies for the ABC check.
"""

import math
from collections.abc import Sequence

from msgspec import Struct

from hthor.calibration.evidence import AbcShift


class AcceptanceBounds(Struct, frozen=True, kw_only=True):
    """The bounds of each figure of merit. Our choice.

    ``coverage`` is the share of true values inside 90 % intervals, ``z_sd`` the sd of the emulator's standardised
    errors on whole studies, ``shift`` the greatest shift of a fitted median by ABC, in our sds; ``effective`` (points)
    and ``studies`` (simulated) are least numbers; ``covered`` is the share of published figures in 90 % intervals.
    """

    coverage: tuple[float, float]
    z_sd: tuple[float, float]
    shift: float
    effective: float
    studies: int
    covered: float


FULL = AcceptanceBounds(coverage=(0.86, 0.94), z_sd=(0.9, 1.1), shift=0.5, effective=400.0, studies=200, covered=1.0)
QUICK = AcceptanceBounds(
    coverage=(0.75, 1.0), z_sd=(0.5, 2.0), shift=math.inf, effective=30.0, studies=10, covered=0.75
)

CLOSE = "SR and TWSR within 4 points, adoption within 7"
"""`hthor.calibration.evidence.TOLERANCE` in words."""


class QualityFigures(Struct, frozen=True, kw_only=True):
    """The figures that are judged; see `AcceptanceBounds`. ``covered`` and ``close`` are (number, out of)."""

    coverage: float
    studies: int
    z_sd: float
    shifts: tuple[AbcShift, ...]
    effective: float
    covered: tuple[int, int]
    close: tuple[int, int]


class Gate(Struct, frozen=True, kw_only=True):
    """A criterion: its requirement (``asks``), the finding, and whether the finding passes."""

    name: str
    asks: str
    found: str
    passed: bool


def judge_calibration(found: QualityFigures, *, quick: bool) -> tuple[Gate, ...]:
    """Every gate's verdict."""
    bounds = QUICK if quick else FULL
    full = () if quick else (_shift(found, bounds), _share("medians close", f"medians, {CLOSE}", found.close, 1.0))
    return (
        _between("coverage", "90 % intervals contain {} to {} of the truths", found.coverage, bounds.coverage),
        _least("simulated studies", "at least {:.0f}", found.studies, bounds.studies),
        _between("emulator", "sd of standardised errors from {} to {}", found.z_sd, bounds.z_sd),
        _least("effective points", "at least {:.0f}", found.effective, bounds.effective),
        _share("figures covered", "in 90 % intervals of studies", found.covered, bounds.covered),
        *full,
    )


def count(values: Sequence[bool]) -> tuple[int, int]:
    """The number of true values, and the number of all."""
    return sum(values), len(values)


def _shift(found: QualityFigures, bounds: AcceptanceBounds) -> Gate:
    asks = f"medians of fitted parameters within {bounds.shift} posterior sd"
    if not found.shifts:
        return _gate("ABC cross-check", asks, "too few studies", False)
    worst = max(found.shifts, key=lambda one: abs(one.shift))
    return _gate("ABC cross-check", asks, f"{abs(worst.shift):.2f} ({worst.name})", abs(worst.shift) < bounds.shift)


def _between(name: str, asks: str, value: float, bounds: tuple[float, float]) -> Gate:
    return _gate(name, asks.format(*bounds), f"{value:.3f}", bounds[0] <= value <= bounds[1])


def _least(name: str, asks: str, value: float, bound: float) -> Gate:
    return _gate(name, asks.format(bound), f"{value:.0f}", value >= bound)


def _share(name: str, asks: str, part_of_whole: tuple[int, int], share: float) -> Gate:
    part, whole = part_of_whole
    least = math.ceil(share * whole)
    return _gate(name, f"{least} of {whole} {asks}", f"{part} of {whole}", part >= least)


def _gate(name: str, asks: str, found: str, passed: bool) -> Gate:
    return Gate(name=name, asks=asks, found=found, passed=passed)
