"""What the host answers when a guest asks for something that its robot senses."""

from __future__ import annotations

from typing import Any

import msgspec

from hthor.guest.protocol import wire
from hthor.guest.protocol.shared_frames import Window
from hthor.types import Observation

_CHEAP = ("detections", "scan")
_SENSES = ("detections", "scan", "rgb", "depth", "segmentation", "camera")


class Unknown(Exception):
    """Something was asked for that there is not."""


def answer(observation: Observation, ask: wire.Ask, window: Window | None) -> wire.Given:
    """What was asked for.

    Args:
        window: where pictures go that are asked for in shared memory; None where there is none.

    Raises:
        Unknown: when there is no such thing.
        Exception: whatever sensing raises, which is not the guest's doing.
    """
    value = _sensed(observation, ask)
    placed = window.put(value) if window is not None and ask.shared else None
    return wire.Given(value=msgspec.Raw(wire.encode(value if placed is None else placed)))


class Habits:
    """What an agent has read in both of its last two steps, which is likely what it reads next.

    To be sent along with the next observation: every question costs two changes of process.
    """

    def __init__(self) -> None:
        self._before: set[str] = set()
        self._now: set[str] = set()

    def read(self, *what: str) -> None:
        """It has read this."""
        self._now.update(one for one in what if one in _CHEAP)

    def ahead(self, observation: Observation) -> dict[str, msgspec.Raw]:
        """Begin a step with this; raises whatever sensing raises."""
        likely = sorted(self._before & self._now)
        self._before, self._now = self._now, set()
        return {what: msgspec.Raw(wire.encode(getattr(observation.senses, what)())) for what in likely}


def _sensed(observation: Observation, ask: wire.Ask) -> Any:
    if ask.what in _SENSES:
        return getattr(observation.senses, ask.what)()
    pictures = [message.image for message in observation.inbox if message.id == ask.which]
    if ask.what == "image" and pictures and callable(pictures[0]):
        return pictures[0]()
    raise Unknown(f"asked for '{ask.what[:80]}', which there is not")
