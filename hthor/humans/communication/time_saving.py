"""How much time a message saves in the person's own eyes.

Without the message they would search on; with it they walk to the place that it names and look there. Both are reckoned
as people do it, roughly: the options they think of anyway, in the order of what they promise for their time.
"""

from __future__ import annotations

import math

from hthor.humans.core.trial_context import Subject
from hthor.humans.motor.locomotion import Walker
from hthor.humans.search.option_choice import Option, Search
from hthor.types import Vec3

_BESIDE_M = 1.0


def searching(options: list[Option], left: float, kappa: float) -> float:
    """Seconds that a search is expected to take.

    One option after the other, the most promising first. What lies at none of them is not found in the time that is
    left, and no search takes longer than that.

    Args:
        options: as a search lists them; what they promise is belief / seconds^kappa.
        left: seconds to the end of the trial.
    """
    expected, gone, hope = 0.0, 0.0, 1.0
    beliefs = [option.value * option.seconds**kappa for option in options]
    total = max(1.0, sum(beliefs))
    for option, belief in sorted(zip(options, beliefs, strict=True), key=lambda pair: (-pair[0].value, pair[0].name)):
        gone += option.seconds
        if gone >= left:
            break
        share = belief / total
        expected += share * gone
        hope -= share
    return min(left, expected + max(0.0, hope) * left)


def way(me: Subject, walker: Walker, position: Vec3) -> tuple[float, float]:
    """Metres to the named place as far as the person knows the house, and seconds to go there and look."""
    point = (position[0], position[1])
    metres = walker.planner.distance(me.here, point, _BESIDE_M)
    if not math.isfinite(metres):
        metres = math.dist(me.here, point)
    return metres, metres * me.traits.k_map / me.traits.v_pace + me.traits.t_look


def gain(me: Subject, walker: Walker, search: Search, position: Vec3 | None) -> tuple[float, float | None]:
    """Seconds that following is expected to save, never negative, and the metres to the place, None without one."""
    if position is None:
        return 0.0, None
    left = max(0.0, me.task.time_limit - me.now.tick * me.tick_s)
    metres, there = way(me, walker, position)
    return max(0.0, searching(search.recent(), left, me.traits.kappa) - there), metres
