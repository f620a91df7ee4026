"""What the host answers when a guest asks for something that its robot senses; knows nothing of processes."""

from __future__ import annotations

from typing import Any

import msgspec

from hthor.guest import wire
from hthor.guest.frames import Window
from hthor.types import Observation

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


def _sensed(observation: Observation, ask: wire.Ask) -> Any:
    if ask.what in _SENSES:
        return getattr(observation.senses, ask.what)()
    pictures = [message.image for message in observation.inbox if message.id == ask.which]
    if ask.what == "image" and pictures and callable(pictures[0]):
        return pictures[0]()
    raise Unknown(f"asked for '{ask.what[:80]}', which there is not")
