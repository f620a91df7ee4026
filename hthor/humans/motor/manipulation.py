"""How a participant handles things: slowly, sometimes missing, trying again.

Every attempt is recorded in the journal, as `hthor.types.events.Attempt`.
"""

import math
from collections.abc import Generator

import msgspec

from hthor.humans.core.trial_context import HumanContext
from hthor.types import Motion, Place, Vec3, Wait
from hthor.types.events import Attempt

_MAX_ATTEMPTS = 8
"""[count] Misses in a row after which people do something else. Our choice."""
_MISSED = "missed"


class Hands:
    """Two hands with a controller each. Attempts are numbered, so that each has random numbers of its own."""

    def __init__(self, human: HumanContext) -> None:
        self.human = human
        self._attempts: dict[str, int] = {}

    def do(self, motion: Motion, name: str) -> Generator[Motion, None, str]:
        """Try a motion until the hands do not miss; returns the world's reason for refusing, empty when it worked.

        ``name`` is a name of the act for its random numbers, such as "pick apple".
        """
        for _ in range(_MAX_ATTEMPTS):
            number = self._attempts.get(name, 0)
            self._attempts[name] = number + 1
            attempt = Attempt(
                tick=self.human.now.tick, seat=self.human.seat, what=type(motion).__name__.lower(), at=_where(motion)
            )
            place = self.human.record(attempt)
            traits = self.human.traits
            seconds = traits.t_manip * math.exp(traits.manip_sd * self.human.normal("handle", name, number))
            handling = self.human.body.handling
            yield from self.human.rest(seconds - handling)
            if self.human.draw("miss", name, number) < traits.p_fail:
                yield Wait(seconds=handling)
                self._complete(place, attempt, _MISSED)
                continue
            yield motion
            outcome = self.human.now.outcome
            why = "" if outcome is None or outcome.ok else outcome.reason or "refused"
            self._complete(place, attempt, why)
            return why
        return _MISSED

    def _complete(self, place: int, attempt: Attempt, why: str) -> None:
        """Add to the journal how the attempt at this place ended: ``why`` it failed, empty when it succeeded."""
        human = self.human
        seconds = round((human.now.tick - attempt.tick) * human.tick_s, 3)
        human.journal[place] = msgspec.structs.replace(attempt, seconds=seconds, ok=not why, why=why)


def _where(motion: Motion) -> Vec3 | None:
    """Where an object is put [m], to the millimetre; None when the motion does not say."""
    if not isinstance(motion, Place) or motion.position is None:
        return None
    x, y, z = motion.position
    return round(x, 3), round(y, 3), round(z, 3)
