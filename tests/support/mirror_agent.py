"""An agent that sends back everything it gets, for tests that compare agents in and out of hthor's process.

It is a file of its own, as guests import it, and needs nothing of the tests.
"""

from __future__ import annotations

import hashlib
import json
from typing import Any

import msgspec
import numpy as np

from hthor.types import Action, BodySpec, Briefing, Drive, Observation, Send
from hthor.types.sensors import READINGS

DRIVE = Drive(forward=0.4, left=-0.1, yaw=2.5, pitch=0.2)


class Agent:
    """Drives, and says what it got, as JSON: as an answer when it was asked, else as a question."""

    privileges = ("object_poses", "house_map", "ideal_detector", "pixel_labels")

    def begin(self, briefing: Briefing) -> None:
        self.briefing = {name: short(plain(getattr(briefing, name))) for name in briefing.__struct_fields__}

    def act(self, observation: Observation) -> Action:
        seen = {"briefing": self.briefing, "observation": plain(observation), "senses": readings(observation)}
        say = Send(text=json.dumps(seen), question=True)
        for message in observation.inbox:
            if message.question:
                say = Send(text=json.dumps(seen), answers=message.id, to=message.sender)
        return Action(motion=DRIVE, say=say)


def short(value: Any) -> Any:
    """The value, or its hash if it would not fit into a message, as a house's floor plan."""
    text = json.dumps(value)
    return value if len(text) < 8000 else hashlib.sha256(text.encode()).hexdigest()


def readings(observation: Observation) -> dict[str, Any]:
    """Everything that the sensors read."""
    return {name: plain(getattr(observation.senses, name)()) for name in READINGS}


def plain(value: Any) -> Any:
    """A value as JSON that differs whenever any field, type or byte of the value differs."""
    if isinstance(value, msgspec.Struct):
        fields = [name for name in value.__struct_fields__ if name != "senses"]
        kind = "BodySpec" if isinstance(value, BodySpec) else type(value).__name__  # a RobotSpec has the same fields
        return {"record": kind, **{name: plain(getattr(value, name)) for name in fields}}
    if isinstance(value, np.ndarray):
        data = np.ascontiguousarray(value)
        return [value.dtype.str, *value.shape, hashlib.sha256(data.tobytes()).hexdigest()[:16]]
    if isinstance(value, dict):
        return {str(key): plain(part) for key, part in value.items()}
    if isinstance(value, (set, frozenset)):
        return [type(value).__name__, *sorted(value)]
    if isinstance(value, (tuple, list)):
        return [type(value).__name__, *(plain(part) for part in value)]
    if callable(value):
        return ["called", plain(value())]
    return [type(value).__name__, repr(value)]
