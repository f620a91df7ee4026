"""The seam where a person sits: what every human model can do.

A human model is one file in ``hthor/humans/models`` that defines ``class Model``. It is made once a session from a
`Person` and what is left of earlier trials, and goes through the trials of the session in order: ``begin``, ``act``
until the trial ends, ``rate``.

The file may also have a function ``ingredients(source: str) -> dict``: plain JSON values that tell what the model is
made from besides the file and the person, such as the hash of its weights; they become part of the people's hash. A
model named with a source (``replay:runs/demo``) is made with it: ``Model(person, source="/path/runs/demo")``. A class
that says ``alike = True`` knows no differences between people, and is given the population's mean.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol

from hthor.types import Action, Briefing, Observation


class HumanModel(Protocol):
    """One person through one session."""

    def begin(self, briefing: Briefing) -> None:
        """A trial begins. Everything but the person's own state is new to them."""

    def act(self, observation: Observation) -> Action:
        """What to do and say now; the motion is heeded only when ``observation.idle``."""
        ...

    def rate(self, met: bool, tick: int) -> int | None:
        """The trial ended at ``tick``, well when ``met``: trust in the robots from 1 to 7, None when there was none."""
        ...

    def state(self) -> Mapping[str, Any]:
        """What carries over to the next trial, as plain JSON values; a model made from it goes on as this one would."""
        ...
