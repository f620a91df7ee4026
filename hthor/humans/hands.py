"""How a person handles things: slowly, sometimes missing, trying again; knows nothing of what is to be done."""

from __future__ import annotations

import math
from collections.abc import Generator

from hthor.humans.subject import Subject
from hthor.types import Motion, Wait

_MISSES = 8


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
            traits = self.me.traits
            seconds = traits.t_manip * math.exp(traits.manip_sd * self.me.normal("handle", name, number))
            handling = self.me.body.handling
            yield from self.me.rest(seconds - handling)
            if self.me.draw("miss", name, number) < traits.p_fail:
                yield Wait(seconds=handling)
                continue
            yield motion
            outcome = self.me.now.outcome
            return "" if outcome is None or outcome.ok else outcome.reason or "refused"
        return "missed"
