"""What the glimpses at each object were like until it was noticed, for the journal.

For a recorder that tells what is in view, this is what a regression needs to estimate the parameters of noticing:
glimpses that found nothing, and the one that found. Glimpses that are much alike are added up.
"""

from __future__ import annotations

import math

from msgspec import Struct

from hthor.humans.core.trial_context import Subject

_PER_OCTAVE, _ECC_RAD, _SHARE = 4, 0.1, 0.2
"""Glimpses are alike when they fall into the same cell of visual angle, eccentricity and share."""
_DIGITS = 4

Row = tuple[float, float, float, float, int, int]


class Glimpse(Struct, frozen=True):
    """``seconds`` of looking at an object at a visual ``angle`` [rad], ``ecc`` [rad] off the head's direction.

    ``share`` of it was in view, ``beside`` counts the small things close to it, and ``attended`` says whether the
    person was searching just there.
    """

    seconds: float
    angle: float
    ecc: float
    share: float
    beside: int
    attended: bool

    @property
    def cell(self) -> tuple[int, int, int, int, bool]:
        """What this has in common with all that are much like it."""
        angle = math.floor(_PER_OCTAVE * math.log2(max(self.angle, 1e-9)))
        return angle, int(self.ecc / _ECC_RAD), int(self.share / _SHARE), self.beside, self.attended


class Exposures:
    """The glimpses of one trial at what is not noticed yet, each object on its own.

    In the journal they are an event "exposure" with the ``object``, whether it was ``noticed``, the ``seconds`` in
    view, and ``gathered``: rows [seconds, angle, ecc, share, beside, attended] as `Glimpse` has them, ``attended`` 0
    or 1, and the means of those that are added up. The last row is the last glimpse alone: the one at which it was
    noticed. It is written when that happens, or at the end of the trial of what never was.
    """

    def __init__(self, me: Subject) -> None:
        self.me = me
        self._cells: dict[str, dict[tuple[int, int, int, int, bool], list[float]]] = {}
        self._last: dict[str, Glimpse] = {}

    def add(self, name: str, glimpse: Glimpse) -> None:
        """An object was looked at."""
        last = self._last.get(name)
        if last is not None:
            sums = self._cells.setdefault(name, {}).setdefault(last.cell, [0.0, 0.0, 0.0, 0.0])
            weight = last.seconds
            for column, value in enumerate((1.0, last.angle, last.ecc, last.share)):
                sums[column] += weight * value
        self._last[name] = glimpse

    def close(self, name: str, noticed: bool) -> None:
        """Write down the glimpses at one object, if there were any."""
        last = self._last.pop(name, None)
        if last is None:
            return
        cells = self._cells.pop(name, {})
        rows = [_row(cell, sums) for cell, sums in sorted(cells.items())]
        rows.append(_rounded(last.seconds, last.angle, last.ecc, last.share, last.beside, last.attended))
        seconds = round(sum(row[0] for row in rows), _DIGITS)
        self.me.note("exposure", object=name, noticed=noticed, seconds=seconds, gathered=[list(row) for row in rows])

    def end(self) -> None:
        """The trial is over: write down what was in view and never noticed."""
        for name in sorted(self._last):
            self.close(name, noticed=False)


def _row(cell: tuple[int, int, int, int, bool], sums: list[float]) -> Row:
    seconds, *rest = sums
    angle, ecc, share = (value / seconds for value in rest)
    return _rounded(seconds, angle, ecc, share, cell[3], cell[4])


def _rounded(seconds: float, angle: float, ecc: float, share: float, beside: int, attended: bool) -> Row:
    a, b, c, d = (round(value, _DIGITS) for value in (seconds, angle, ecc, share))
    return a, b, c, d, beside, int(attended)
