"""How large a study must be, from what the user knows: two rates, or two runs; works nothing out itself."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from msgspec import Struct

from hthor.errors import HthorError
from hthor.eval import compare, power
from hthor.eval.power import Need

SCHEMA = "hthor.power/1"
USUAL = 0.5
"""Correlation that is taken when nobody knows it; docs/statistics.md has measured ones."""


class Plan(Struct, frozen=True, kw_only=True):
    """What it takes to see a difference of two success rates: the same people at the same tasks, and others."""

    schema: str = SCHEMA
    first: float
    second: float
    measured: bool
    paired: Need
    unpaired: Need
    sentence: str


def plan(
    folders: Sequence[Path], rates: str, correlation: float | None, difference: float | None, wanted: float
) -> Plan:
    """The plan for two runs, or for two rates as the user typed them.

    Raises:
        HthorError: when it is neither, or what is wanted is impossible.
    """
    if bool(folders) == bool(rates) or len(folders) not in (0, 2):
        raise HthorError("name two runs, hthor power RUN RUN, or two rates, hthor power --rates 0.73,0.76; not both.")
    if folders:
        first, second, measured = _measured(folders)
        correlation = measured if correlation is None else correlation
    else:
        first, second = _rates(rates)
    if difference is not None:
        second = first + difference
    power.possible(first, second)
    if correlation is None:
        correlation = min(USUAL, power.correlation_range(first, second)[1])
    elif folders:  # as measured, but for rates that may be others
        low, high = power.correlation_range(first, second)
        correlation = min(max(low, correlation), high)
    paired = power.need(first, second, correlation=correlation, power=wanted)
    unpaired = power.need(first, second, power=wanted)
    return Plan(
        first=round(first, 6),
        second=round(second, 6),
        measured=bool(folders),
        paired=paired,
        unpaired=unpaired,
        sentence=(
            f"{100.0 * first:.1f} % against {100.0 * second:.1f} % shows in {100.0 * wanted:.0f} of 100 studies with "
            f"{paired.trials} tasks where both robots meet the same people at the same tasks (correlation "
            f"{correlation:.2f}), and with {unpaired.trials} tasks each where they do not."
        ),
    )


def _measured(folders: Sequence[Path]) -> tuple[float, float, float]:
    """Both rates and the correlation of two runs."""
    found = compare.runs(folders).pairs[0].differences["sr"]
    return found.first, found.second, found.correlation or 0.0


def _rates(words: str) -> tuple[float, float]:
    try:
        first, second = (float(word) for word in words.split(","))
    except ValueError:
        raise HthorError(f"--rates '{words}' is not two rates; expected something like 0.73,0.76.") from None
    return first, second
