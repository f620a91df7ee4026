"""Small drawings in a table's cells: a mean and its interval on a scale that a column shares."""

from __future__ import annotations

import math
from collections.abc import Iterable

from msgspec import Struct

from hthor.eval.stats import Estimate

_WIDE, _HIGH, _EDGE = 150.0, 16.0, 6.0


class Scale(Struct, frozen=True, kw_only=True):
    """From where to where a column's marks go, in percent."""

    low: int
    high: int

    def at(self, share: float) -> float:
        """Where a share lies [px]."""
        part = (100.0 * share - self.low) / (self.high - self.low)
        return round(_EDGE + (_WIDE - 2 * _EDGE) * min(max(part, 0.0), 1.0), 1)


def scale(some: Iterable[Estimate]) -> Scale:
    """The tens around all intervals."""
    ends = [end for one in some for end in (one.ci95 or ())] or [0.0, 1.0]
    low, high = 10 * math.floor(10 * min(ends)), 10 * math.ceil(10 * max(ends))
    return Scale(low=max(0, low), high=min(100, max(high, low + 10)))


def axis(on: Scale) -> str:
    """The head of a column of marks: its ends in numbers."""
    low, high = on.at(on.low / 100.0), on.at(on.high / 100.0)
    text = '<text y="11" font-size="10" fill="var(--soft)"'
    return (
        f'{_open("scale")}{text} x="{low - 4:g}">{on.low}</text>'
        f'{text} x="{high + 4:g}" text-anchor="end">{on.high}</text></svg>'
    )


def mark(one: Estimate, on: Scale, colour: str) -> str:
    """A dot for the mean, a line for the interval, thin lines at each tenth."""
    if one.mean is None:
        return ""
    low, high = one.ci95 or (one.mean, one.mean)
    step = 10 if on.high - on.low <= 60 else 20
    grid = "".join(
        f'<line x1="{on.at(tenth / 100):g}" x2="{on.at(tenth / 100):g}" y1="0" y2="{_HIGH:g}" stroke="var(--line)"/>'
        for tenth in range(on.low, on.high + 1, step)
    )
    middle = _HIGH / 2
    bar = f'<line x1="{on.at(low):g}" x2="{on.at(high):g}" y1="{middle:g}" y2="{middle:g}" stroke-width="2.5"/>'
    dot = f'<circle cx="{on.at(one.mean):g}" cy="{middle:g}" r="3.6"/>'
    drawn = f'<g stroke="var(--{colour})" fill="var(--{colour})" stroke-linecap="round">{bar}{dot}</g>'
    words = f"{100 * one.mean:.1f} %, 95 % interval {100 * low:.1f} to {100 * high:.1f}"
    return f"{_open(words)}{grid}{drawn}</svg>"


def _open(words: str) -> str:
    size = f'width="{_WIDE:g}" height="{_HIGH:g}" viewBox="0 0 {_WIDE:g} {_HIGH:g}"'
    return f'<svg role="img" {size}><title>{words}</title>'
