"""How a person handles things: slowly, sometimes missing, trying again.

Every attempt is written into the journal, see `hthor.humans.core.behaviour_log`.
"""

from __future__ import annotations

import math
from collections.abc import Generator

from hthor.humans.core.trial_context import Subject
from hthor.types import Event, Motion, Place, Wait

_MISSES = 8
_MISSED = "missed"


class Hands:
    """Two hands with a controller each. Attempts are numbered, so that chance treats each on its own."""

    def __init__(self, me: Subject) -> None:
        self.me = me
        self._attempts: dict[str, int] = {}

    def do(self, motion: Motion, name: str) -> Generator[Motion, None, str]:
        """Try until the hands do not miss; returns the world's reason for refusing, empty when it worked.

        Args:
            motion: a Pick, Place, Open or Close.
            name: what it is, such as "pick apple", for chance.
        """
        for _ in range(_MISSES):
            number = self._attempts.get(name, 0)
            self._attempts[name] = number + 1
            entry = self.me.note("attempt", what=type(motion).__name__.lower(), **_where(motion))
            traits = self.me.traits
            seconds = traits.t_manip * math.exp(traits.manip_sd * self.me.normal("handle", name, number))
            handling = self.me.body.handling
            yield from self.me.rest(seconds - handling)
            if self.me.draw("miss", name, number) < traits.p_fail:
                yield Wait(seconds=handling)
                self._end(entry, _MISSED)
                continue
            yield motion
            outcome = self.me.now.outcome
            why = "" if outcome is None or outcome.ok else outcome.reason or "refused"
            self._end(entry, why)
            return why
        return _MISSED

    def _end(self, entry: Event, why: str) -> None:
        """Write down how an attempt ended: ``why`` it failed, empty when it did not."""
        me = self.me
        entry.data.update(seconds=round((me.now.tick - entry.tick) * me.tick_s, 3), ok=not why)
        if why:
            entry.data["why"] = why


def _where(motion: Motion) -> dict[str, list[float]]:
    """Where something is put [m], to the millimetre, when that is named."""
    if not isinstance(motion, Place) or motion.position is None:
        return {}
    return {"at": [round(part, 3) for part in motion.position]}
