"""How much time a message saves, as the participant estimates it.

Without the message they would search on, option by option, the most promising first; with it they walk to the place
that it names and look there.
"""

import math

from hthor.humans.core.trial_context import HumanContext
from hthor.humans.motor.locomotion import Walker
from hthor.humans.search.option import Option
from hthor.humans.search.option_choice import OptionChoice
from hthor.types import Vec3

_BESIDE_M = 1.0
"""[m] The estimated way ends this near to the named place. Our choice."""


def expected_search_time(options: list[Option], left: float, kappa: float) -> float:
    """Seconds that a search is expected to take, one option after the other, at most ``left``.

    Args:
        options: as a search lists them; their value is belief / seconds^kappa.
        left: seconds to the end of the trial, which is what a search takes that finds nothing.
    """
    expected, elapsed, remaining = 0.0, 0.0, 1.0
    beliefs = [option.value * option.seconds**kappa for option in options]
    total = max(1.0, sum(beliefs))
    for option, belief in sorted(zip(options, beliefs, strict=True), key=lambda pair: (-pair[0].value, pair[0].name)):
        elapsed += option.seconds
        if elapsed >= left:
            break
        share = belief / total
        expected += share * elapsed
        remaining -= share
    return min(left, expected + max(0.0, remaining) * left)


def walk_to_message(human: HumanContext, walker: Walker, position: Vec3) -> tuple[float, float]:
    """Metres to the named place as far as the house is known, and seconds to go there and look."""
    point = (position[0], position[1])
    metres = walker.planner.distance(human.here, point, _BESIDE_M)
    if not math.isfinite(metres):
        metres = math.dist(human.here, point)
    return metres, metres * human.traits.k_map / human.traits.v_pace + human.traits.t_look


def time_saved(
    human: HumanContext, walker: Walker, search: OptionChoice, position: Vec3 | None
) -> tuple[float, float | None]:
    """Seconds that following is expected to save, never negative, and the metres to the place, None without one."""
    if position is None:
        return 0.0, None
    metres, seconds = walk_to_message(human, walker, position)
    searching = expected_search_time(search.recent(), human.seconds_left, human.traits.kappa)
    return max(0.0, searching - seconds), metres
