"""One trial of a guest from its first look to its last action: who asks, who answers, and what time is left."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

import msgspec

from hthor.guest.protocol import sensor_replies, wire
from hthor.guest.protocol.channel import Talk
from hthor.guest.protocol.faults import GuestFault
from hthor.guest.protocol.shared_frames import Window
from hthor.types import Action, Observation

_T = TypeVar("_T")
_ASKS = 100
"""How often an agent may ask for something within one ``act``; what it has read once it need not ask for again."""


class Turns:
    """A trial that has begun.

    Args:
        step_s: seconds for each action; what the host takes to answer does not count.
        bank_s: seconds by which actions may take longer than that, all together.
        ahead: whether the guest takes what it is likely to read before it asks.
        window: where pictures are shared, None for nowhere.
    """

    def __init__(self, talk: Talk, *, step_s: float, bank_s: float, ahead: bool, window: Window | None) -> None:
        self._talk, self._window = talk, window
        self._step_s, self._bank = step_s, bank_s
        self._allowed = f"{step_s:g} s" + (f" and what was left of {bank_s:g} s more" if bank_s else "")
        self._habits = sensor_replies.Habits() if ahead else None
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
                if wrong := wire.objection(said.action):
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
            return self._sensed(sensor_replies.answer, observation, ask, self._window)
        except sensor_replies.Unknown as error:
            raise self._talk.fault("garbage", str(error)) from None

    def _sensed(self, sense: Callable[..., _T], *values: object) -> _T:
        """What sensing gives. A failure to sense is ours, so the guest is let go and the error passed on."""
        try:
            return sense(*values)
        except sensor_replies.Unknown:
            raise
        except Exception:
            self._talk.close()
            raise
