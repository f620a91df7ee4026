"""Set-points of bodies that drive, rounded to what the log keeps, so that a log repeats exactly what was done."""

import math

from hthor.humans.core.recorded_inputs import INPUT_UNIT
from hthor.types import Drive


def rounded(drive: Drive) -> Drive:
    """The set-point in whole multiples of `INPUT_UNIT` [m/s, rad]; a number that is not finite becomes 0."""
    return Drive(
        forward=_rounded(drive.forward), left=_rounded(drive.left), yaw=_rounded(drive.yaw), pitch=_rounded(drive.pitch)
    )


def _rounded(value: float) -> float:
    return round(value / INPUT_UNIT) * INPUT_UNIT if math.isfinite(value) and abs(value) < _MOST else 0.0


_MOST = 1e6
"""[m/s, rad] No set-point is as large as this; a larger number counts as none."""
