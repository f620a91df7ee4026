"""The statistics by which published and simulated studies are compared: counts and ratios."""

from __future__ import annotations

from typing import Any

import numpy as np
from msgspec import Struct

from hthor.calibration.evidence import FIGURES
from hthor.calibration.simulation import trial_table as tables
from hthor.calibration.simulation.trial_table import Table
from hthor.calibration.targets import CONDITIONS, Targets

Array = np.ndarray[Any, Any]


class StudyResults(Struct, frozen=True, kw_only=True, eq=False):
    """Results of S studies, float64 arrays (S, 3) by study and condition.

    ``successes`` of ``trials`` met the goal, ``adopted`` of ``asked`` accepted a message; 0 trials if a study does not
    report them. ``ratio`` is TWSR / SR, the mean of T*/max(T*, T) over the successes; NaN without one.
    """

    successes: Array
    trials: Array
    adopted: Array
    asked: Array
    ratio: Array

    def __len__(self) -> int:
        return len(self.trials)

    def one(self, study: int) -> StudyResults:
        """A single study, still with S = 1."""
        return StudyResults(**{name: getattr(self, name)[study : study + 1] for name in self.__struct_fields__})

    def without(self, condition: str) -> StudyResults:
        """The same studies, without anything about one condition."""
        return self._keeping([name != condition for name in CONDITIONS])

    def only(self, condition: str) -> StudyResults:
        """The same studies, with only one condition."""
        return self._keeping([name == condition for name in CONDITIONS])

    def _keeping(self, kept: list[bool]) -> StudyResults:
        counts = {name: getattr(self, name) * np.array(kept) for name in ("successes", "trials", "adopted", "asked")}
        return StudyResults(**counts, ratio=np.where(kept, self.ratio, np.nan))

    def figures(self) -> dict[str, Array]:
        """The eight figures (S,) by name, as fractions; NaN for figures that a study does not report."""
        with np.errstate(invalid="ignore", divide="ignore"):
            sr, adoption = self.successes / self.trials, self.adopted / self.asked
        held = {"sr": sr, "twsr": sr * self.ratio, "adoption": adoption}
        return {name: held[name.split()[0]][:, CONDITIONS.index(name.split()[1])] for name in FIGURES}


def published_results(targets: Targets) -> StudyResults:
    """The published study; numbers that are not in the targets are left out."""
    counts = np.zeros((4, 1, len(CONDITIONS)))
    ratio = np.full((1, len(CONDITIONS)), np.nan)
    for place, name in enumerate(CONDITIONS):
        if name in targets.sr:
            counts[:2, 0, place] = targets.sr[name].k, targets.sr[name].n
        if name in targets.adoption:
            counts[2:, 0, place] = targets.adoption[name].k, targets.adoption[name].n
        ratio[0, place] = targets.ratio.get(name, np.nan)
    return StudyResults(successes=counts[0], trials=counts[1], adopted=counts[2], asked=counts[3], ratio=ratio)


def study_results(table: Table, least: Array) -> tuple[Array, StudyResults]:
    """Simulated studies as if they had been published: points (S, P) of the unit cube, and results in that order.

    Trials outside any study are ignored; ``least`` is T* [s] by task.
    """
    held = table.take(table.study >= 0)
    numbers, rows, study = np.unique(held.study, return_index=True, return_inverse=True)
    shape = (len(numbers), len(CONDITIONS))

    def total(values: Array) -> Array:
        sums = np.zeros(shape)
        np.add.at(sums, (study, held.condition), values)
        return sums

    met = held.met & held.valid
    successes, worth = total(met), total(np.where(met, tables.twsr(held, least), 0.0))
    with np.errstate(invalid="ignore", divide="ignore"):
        ratio = worth / successes
    found = StudyResults(
        successes=successes,
        trials=total(held.valid),
        adopted=total(held.adopted & held.counted),
        asked=total(held.counted),
        ratio=ratio,
    )
    return held.unit(rows), found
