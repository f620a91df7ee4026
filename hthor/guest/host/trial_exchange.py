"""One trial of a guest from its first look to its last action: who asks, who answers, and what time is left."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import msgspec

from hthor.guest.host.channel import GuestFault, MessageChannel
from hthor.guest.protocol import wire
from hthor.guest.protocol.shared_frames import FrameWriter
from hthor.types import Action, Observation

_T = TypeVar("_T")
_ASKS = 100
"""How often an agent may ask for something within one ``act``; what it has read once it need not ask for again."""


_CHEAP = ("detections", "scan")
_SENSES = ("detections", "scan", "rgb", "depth", "segmentation", "camera")


class UnknownSensor(Exception):
    """Something was asked for that there is not."""


class TrialExchange:
    """A trial that has begun.

    Args:
        step_s: seconds for each action; what the host takes to answer does not count.
        bank_s: seconds by which actions may take longer than that, all together.
        ahead: whether the guest takes what it is likely to read before it asks.
        window: where pictures are shared, None for nowhere.
    """

    def __init__(
        self, talk: MessageChannel, *, step_s: float, bank_s: float, ahead: bool, window: FrameWriter | None
    ) -> None:
        self._talk, self._window = talk, window
        self._step_s, self._bank = step_s, bank_s
        self._allowed = f"{step_s:g} s" + (f" and what was left of {bank_s:g} s more" if bank_s else "")
        self._habits = ReadAhead() if ahead else None
        if window is not None:
            window.wipe()

    def act(self, observation: Observation) -> Action:
        """The agent's action.

        Raises:
            GuestFault: when there is none.
        """
        talk, habits = self._talk, self._habits
        slim = tuple(msgspec.structs.replace(message, image=None) for message in observation.inbox)
        bare = msgspec.structs.replace(observation, senses=None, inbox=slim)
        ahead = self._sensed(habits.ahead, observation) if habits else {}
        if self._window is not None:
            self._window.clear()
        granted = self._step_s + self._bank
        left = talk.send(wire.Look(observation=bare, ahead=ahead), granted, self._allowed)
        for _ in range(_ASKS):
            said, left = talk.receive(left, self._allowed)
            if isinstance(said, wire.Ask):
                left = talk.send(self._given(observation, said), left, self._allowed)
                if habits:
                    habits.read(said.what)
            elif isinstance(said, wire.Acted):
                if wrong := wire.find_action_fault(said.action):
                    raise talk.fault(*wrong)
                if habits:
                    habits.read(*said.read)
                self._bank -= max(0.0, granted - left - self._step_s)
                return said.action
            else:
                raise talk.wrong("act", said)
        raise talk.fault("garbage", f"asked for more than {_ASKS} things within one act")

    def end(self) -> None:
        """Say that the trial is over, if there is still somebody to hear it."""
        try:
            self._talk.send(wire.End(), self._step_s)
        except GuestFault:
            return

    def _given(self, observation: Observation, ask: wire.Ask) -> wire.Given:
        try:
            return self._sensed(make_reply, observation, ask, self._window)
        except UnknownSensor as error:
            raise self._talk.fault("garbage", str(error)) from None

    def _sensed(self, sense: Callable[..., _T], *values: object) -> _T:
        """What sensing gives. A failure to sense is ours, so the guest is let go and the error passed on."""
        try:
            return sense(*values)
        except UnknownSensor:
            raise
        except Exception:
            self._talk.close()
            raise


def make_reply(observation: Observation, ask: wire.Ask, window: FrameWriter | None) -> wire.Given:
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


class ReadAhead:
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
    raise UnknownSensor(f"asked for '{ask.what[:80]}', which there is not")
