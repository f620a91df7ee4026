"""How a participant handles things: slowly, sometimes missing, trying again.

Every attempt is recorded in the journal, see `hthor.humans.core.behaviour_log`.
"""

import math
from collections.abc import Generator

from hthor.humans.core.trial_context import HumanContext
from hthor.types import Event, Motion, Place, Wait

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
            entry = self.human.record("attempt", what=type(motion).__name__.lower(), **_where(motion))
            traits = self.human.traits
            seconds = traits.t_manip * math.exp(traits.manip_sd * self.human.normal("handle", name, number))
            handling = self.human.body.handling
            yield from self.human.rest(seconds - handling)
            if self.human.draw("miss", name, number) < traits.p_fail:
                yield Wait(seconds=handling)
                self._complete(entry, _MISSED)
                continue
            yield motion
            outcome = self.human.now.outcome
            why = "" if outcome is None or outcome.ok else outcome.reason or "refused"
            self._complete(entry, why)
            return why
        return _MISSED

    def _complete(self, entry: Event, why: str) -> None:
        """Add to the journal how an attempt ended: ``why`` it failed, empty when it succeeded."""
        human = self.human
        entry.data.update(seconds=round((human.now.tick - entry.tick) * human.tick_s, 3), ok=not why)
        if why:
            entry.data["why"] = why


def _where(motion: Motion) -> dict[str, list[float]]:
    """Where an object is put [m], to the millimetre; empty when the motion does not say."""
    if not isinstance(motion, Place) or motion.position is None:
        return {}
    return {"at": [round(part, 3) for part in motion.position]}
