"""Lets an agent read its robot's senses, by requests to the host."""

from collections.abc import Callable, Mapping
from typing import Any, NoReturn, Protocol

import msgspec
import numpy as np
from numpy.typing import NDArray

from hthor.errors import StaleObservation
from hthor.guest.protocol import shared_frames, wire
from hthor.types.sensors import READINGS


class HostGone(BaseException):
    """The host has closed the connection. Not an `Exception`, so that no agent catches it by accident."""


class HostConnection(Protocol):
    """The guest's end of a connection; ``view`` is the shared memory for pictures, if any."""

    view: shared_frames.FrameReader | None

    def receive(self) -> wire.ToGuest: ...
    def send(self, message: wire.ToHost) -> None: ...
    def fail(self) -> NoReturn: ...


class RemoteSenses:
    """Requests readings from the host when the agent reads them, each once; implements `hthor.types.Senses`.

    Args:
        ahead: data that came with the observation.
    """

    def __init__(self, pipe: HostConnection, ahead: Mapping[str, msgspec.Raw] | None = None) -> None:
        self._pipe, self._known, self._fresh = pipe, dict[tuple[str, int], Any](), True
        self._ahead = dict(ahead or {})

    @property
    def read(self) -> tuple[str, ...]:
        """The names of everything read so far."""
        return tuple(what for what, _ in self._known)

    def expire(self) -> None:
        """End the tick: nothing can be read after it."""
        self._fresh = False

    def __getattr__(self, name: str) -> Callable[[], Any]:
        """The method that reads the sensor of this name."""
        if name not in READINGS:
            raise AttributeError(f"there is no sensor '{name}'; there are {', '.join(READINGS)}")
        return lambda: self._get(name)

    def image(self, number: int) -> NDArray[np.uint8]:
        """The picture that came with message ``number``."""
        image: NDArray[np.uint8] = self._get("image", number)
        return image

    def _get(self, what: str, which: int = -1) -> Any:
        if not self._fresh:
            raise StaleObservation("this observation is of an earlier tick: read what you need during act")
        key = (what, which)
        if key not in self._known:
            sent, kind = self._ahead.get(what), READINGS.get(what, Any)
            reading = self._ask(what, which, kind is Any) if sent is None else sent
            self._known[key] = self._array(reading) if kind is Any else _decode(reading, kind)
        return self._known[key]

    def _ask(self, what: str, which: int, picture: bool) -> msgspec.Raw:
        self._pipe.send(wire.Ask(what=what, which=which, shared=picture and self._pipe.view is not None))
        answer = self._pipe.receive()
        if not isinstance(answer, wire.Given):
            self._pipe.fail()
        return answer.value

    def _array(self, data: bytes) -> Any:
        value = msgspec.msgpack.decode(data)
        view = self._pipe.view
        return view.take(value) if view is not None and "at" in value else wire.decode_array(value)


def _decode(data: bytes, kind: Any) -> Any:
    """A reading of type ``kind``, with its fields that are arrays."""
    reading = msgspec.msgpack.decode(data, type=kind)
    if isinstance(reading, msgspec.Struct):
        fields = {name: getattr(reading, name) for name in reading.__struct_fields__}
        arrays = {
            name: wire.decode_array(value)
            for name, value in fields.items()
            if isinstance(value, dict) and "__nd__" in value
        }
        return msgspec.structs.replace(reading, **arrays)
    return reading
