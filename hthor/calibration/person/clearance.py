"""How much room one person leaves between themselves and walls and furniture while walking."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from hthor.calibration.from_logs.trial_features import Trial
from hthor.calibration.person.measure import Measure, unknown
from hthor.eval.records.trial_record import TrialRecord
from hthor.houses.space.free_space import FreeSpace
from hthor.types import HUMAN, HouseSpec
from hthor.world.model.bodies import avatar

_LEAST = 20
_STEP_M = 0.05
"""[m] Somebody who moves less than this between two poses of a log stands. Our choice."""


def clearance(trials: Sequence[Trial], house_of: Callable[[TrialRecord], HouseSpec]) -> Measure:
    """[m] From the person's outline to the nearest wall or piece of furniture while walking, the median."""
    gaps: list[float] = []
    for one in trials:
        gaps += _gaps(one.record, house_of(one.record))
    if len(gaps) < _LEAST:
        return unknown("clearance", "m", "there was hardly any walking")
    low, middle, high = np.quantile(gaps, (0.05, 0.5, 0.95))
    how = "between the body and what is nearest; the interval has nine of ten moments of walking"
    return Measure(
        name="clearance",
        unit="m",
        value=float(middle),
        low=float(low),
        high=float(high),
        n=len(gaps),
        how=how,
    )


def _gaps(record: TrialRecord, house: HouseSpec) -> list[float]:
    from scipy.ndimage import distance_transform_edt

    space = FreeSpace.of(house, avatar.HUMAN.radius)
    metres = distance_transform_edt(space.free) * space.cell
    path = np.array(record.paths[HUMAN], dtype=float)[:, :2] / 1000.0
    moved = np.hypot(*np.diff(path, axis=0).T) > _STEP_M
    found = []
    for x, y in path[1:][moved]:
        row, column = space.cell_of(float(x), float(y))
        if 0 <= row < metres.shape[0] and 0 <= column < metres.shape[1]:
            found.append(float(metres[row, column]))
    return found
