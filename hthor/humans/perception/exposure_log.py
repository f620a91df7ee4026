"""The glimpses at each object until it was noticed, for the journal.

A regression needs them to estimate the parameters of noticing: glimpses without success, and the successful glimpse.
Similar glimpses are added up.
"""

import math

from msgspec import Struct

from hthor.humans.core.trial_context import HumanContext
from hthor.types.events import Exposure, ExposureRow

_PER_OCTAVE = 4
"""[1/octave] Cells per octave of visual angle; the glimpses in a cell are added up. Our choice."""
_ECC_RAD = 0.1
"""[rad] Width of a cell of eccentricity. Our choice."""
_SHARE = 0.2
"""[share] Width of a cell of the visible share. Our choice."""
_DIGITS = 4
"""[digits] Decimals of the means in the journal. Our choice."""


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
        """The cell in which the glimpse is added up."""
        angle = math.floor(_PER_OCTAVE * math.log2(max(self.angle, 1e-9)))
        return angle, int(self.ecc / _ECC_RAD), int(self.share / _SHARE), self.beside, self.attended


class ExposureLog:
    """The glimpses of one trial at objects not noticed yet.

    Each object gets one `Exposure` in the journal, when it is noticed or at the end of the trial. ``gathered`` has one
    row per cell, with total seconds and means of `Glimpse`, and then the last glimpse alone, at which the object was
    noticed if it was.
    """

    def __init__(self, human: HumanContext) -> None:
        self.human = human
        self._cells: dict[str, dict[tuple[int, int, int, int, bool], list[float]]] = {}
        self._last: dict[str, Glimpse] = {}

    def add(self, name: str, glimpse: Glimpse) -> None:
        """Add a glimpse at an object."""
        last = self._last.get(name)
        if last is not None:
            sums = self._cells.setdefault(name, {}).setdefault(last.cell, [0.0, 0.0, 0.0, 0.0])
            weight = last.seconds
            for column, value in enumerate((1.0, last.angle, last.ecc, last.share)):
                sums[column] += weight * value
        self._last[name] = glimpse

    def close(self, name: str, noticed: bool) -> None:
        """Write the glimpses at one object to the journal, if there were any."""
        last = self._last.pop(name, None)
        if last is None:
            return
        cells = self._cells.pop(name, {})
        rows = [_row(cell, sums) for cell, sums in sorted(cells.items())]
        rows.append(_rounded(last.seconds, last.angle, last.ecc, last.share, last.beside, last.attended))
        human = self.human
        human.record(
            Exposure(
                tick=human.now.tick,
                seat=human.seat,
                object=name,
                noticed=noticed,
                seconds=round(sum(row[0] for row in rows), _DIGITS),
                gathered=tuple(rows),
            )
        )

    def end(self) -> None:
        """At the end of the trial, write the objects that were in view and never noticed."""
        for name in sorted(self._last):
            self.close(name, noticed=False)


def _row(cell: tuple[int, int, int, int, bool], sums: list[float]) -> ExposureRow:
    seconds, *rest = sums
    angle, ecc, share = (value / seconds for value in rest)
    return _rounded(seconds, angle, ecc, share, cell[3], cell[4])


def _rounded(seconds: float, angle: float, ecc: float, share: float, beside: int, attended: bool) -> ExposureRow:
    a, b, c, d = (round(value, _DIGITS) for value in (seconds, angle, ecc, share))
    return a, b, c, d, beside, int(attended)
