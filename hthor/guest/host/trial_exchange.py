"""One trial of a guest: observations out, sensor requests answered, actions in, all within the time allowed."""

from collections.abc import Callable
from typing import Any, TypeVar

import msgspec

from hthor.guest.host.channel import GuestFault, MessageChannel
from hthor.guest.protocol import wire
from hthor.guest.protocol.shared_frames import FrameWriter
from hthor.types import Action, Observation
from hthor.types.sensors import READINGS

_T = TypeVar("_T")
_ASKS = 100
"""Sensor requests allowed within one ``act``; an agent never needs to ask for the same thing twice."""


class UnknownSensor(Exception):
    """A request for a sensor that does not exist."""


class TrialExchange:
    """A trial that has begun.

    Args:
        step_s: seconds for each action, without the time that the host takes to answer.
        bank_s: extra seconds that all actions together may use beyond ``step_s``.
        ahead: whether the guest accepts data that it will probably read, before it asks.
        window: shared memory for pictures, None for none.
    """

    def __init__(
        self, channel: MessageChannel, *, step_s: float, bank_s: float, ahead: bool, window: FrameWriter | None
    ) -> None:
        self._channel, self._window = channel, window
        self._step_s, self._bank = step_s, bank_s
        self._allowed = f"{step_s:g} s" + (f" and what was left of {bank_s:g} s more" if bank_s else "")
        self._read_ahead = ReadAhead() if ahead else None
        if window is not None:
            window.wipe()

    def act(self, observation: Observation) -> Action:
        """The agent's action.

        Raises:
            GuestFault: when it sends no valid action.
        """
        channel, read_ahead = self._channel, self._read_ahead
        slim = tuple(
            msgspec.structs.replace(message, image=None if message.image is None else True)
            for message in observation.inbox
        )
        bare = msgspec.structs.replace(observation, senses=None, inbox=slim)
        ahead = self._sensed(read_ahead.ahead, observation) if read_ahead else {}
        if self._window is not None:
            self._window.clear()
        granted = self._step_s + self._bank
        left = channel.send(wire.Look(observation=bare, ahead=ahead), granted, self._allowed)
        for _ in range(_ASKS):
            said, left = channel.receive(left, self._allowed)
            if isinstance(said, wire.Ask):
                left = channel.send(self._given(observation, said), left, self._allowed)
                if read_ahead:
                    read_ahead.read(said.what)
            elif isinstance(said, wire.Acted):
                if wrong := wire.find_action_fault(said.action):
                    raise channel.fault(*wrong)
                if read_ahead:
                    read_ahead.read(*said.read)
                self._bank -= max(0.0, granted - left - self._step_s)
                return said.action
            else:
                raise channel.wrong("act", said)
        raise channel.fault("garbage", f"asked for more than {_ASKS} things within one act")

    def end(self) -> None:
        """Tell the guest that the trial is over, if it still runs."""
        try:
            self._channel.send(wire.End(), self._step_s)
        except GuestFault:
            return

    def _given(self, observation: Observation, ask: wire.Ask) -> wire.Given:
        try:
            return self._sensed(make_reply, observation, ask, self._window)
        except UnknownSensor as error:
            raise self._channel.fault("garbage", str(error)) from None

    def _sensed(self, sense: Callable[..., _T], *values: object) -> _T:
        """The result of a sensing function. An error in it is not the agent's fault: end the guest and raise it."""
        try:
            return sense(*values)
        except UnknownSensor:
            raise
        except Exception:
            self._channel.close()
            raise


def make_reply(observation: Observation, ask: wire.Ask, window: FrameWriter | None) -> wire.Given:
    """The reply to a sensor request.

    Args:
        window: shared memory for pictures that the guest requests there; None for none.

    Raises:
        UnknownSensor: when there is no such sensor.
        Exception: any error of the sensor itself, which is not the guest's fault.
    """
    value = _sensed(observation, ask)
    placed = window.put(value) if window is not None and ask.shared else None
    return wire.Given(value=msgspec.Raw(wire.encode(value if placed is None else placed)))


class ReadAhead:
    """Predicts the sensor data that an agent reads next: those that it has read in both of its last two steps.

    They are sent with the next observation, since every request costs two switches between processes.
    """

    def __init__(self) -> None:
        self._before: set[str] = set()
        self._now: set[str] = set()

    def read(self, *what: str) -> None:
        """Note what the agent has read, except pictures, which take too long to be sent unless requested."""
        self._now.update(name for name in what if READINGS.get(name, Any) is not Any)

    def ahead(self, observation: Observation) -> dict[str, msgspec.Raw]:
        """Start a step: the data to send along. Raises any error of a sensor."""
        likely = sorted(self._before & self._now)
        self._before, self._now = self._now, set()
        return {what: msgspec.Raw(wire.encode(getattr(observation.senses, what)())) for what in likely}


def _sensed(observation: Observation, ask: wire.Ask) -> Any:
    if ask.what in READINGS:
        return getattr(observation.senses, ask.what)()
    pictures = [message.image for message in observation.inbox if message.id == ask.which]
    if ask.what == "image" and pictures and callable(pictures[0]):
        return pictures[0]()
    raise UnknownSensor(f"asked for '{ask.what[:80]}', which does not exist")
