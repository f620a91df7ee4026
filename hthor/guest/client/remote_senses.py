"""What an agent reads of its robot's senses, asked for over the wire."""

from collections.abc import Mapping
from typing import Any, NoReturn, Protocol

import msgspec

from hthor.errors import StaleObservation
from hthor.guest.protocol import shared_frames, wire
from hthor.types import Camera, Detection, Scan

_PICTURES = ("rgb", "depth", "segmentation", "image")


class HostGone(BaseException):
    """The host has closed the connection. Not an `Exception`, so that no agent catches it by accident."""


class HostConnection(Protocol):
    """The guest's end of a connection; ``view`` is the shared memory for pictures, if any."""

    view: shared_frames.FrameReader | None

    def receive(self) -> wire.ToGuest: ...
    def send(self, message: wire.ToHost) -> None: ...
    def fail(self) -> NoReturn: ...


class RemoteSenses:
    """Asks the host for what the agent reads, each thing once; implements `hthor.types.Senses`.

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

    def detections(self) -> tuple[Detection, ...]:
        return self._get("detections", lambda data: msgspec.msgpack.decode(data, type=tuple[Detection, ...]))  # type: ignore[no-any-return]

    def scan(self) -> Scan:
        return self._get("scan", _scan)  # type: ignore[no-any-return]

    def rgb(self) -> Any:
        return self._get("rgb", self._array)

    def depth(self) -> Any:
        return self._get("depth", self._array)

    def segmentation(self) -> Any:
        return self._get("segmentation", self._array)

    def camera(self) -> Camera:
        return self._get("camera", _camera)  # type: ignore[no-any-return]

    def image(self, number: int) -> Any:
        """The picture that came with message ``number``."""
        return self._get("image", self._array, number)

    def _get(self, what: str, decode: Any, which: int = -1) -> Any:
        if not self._fresh:
            raise StaleObservation("this observation is of an earlier tick: read what you need during act")
        key = (what, which)
        if key not in self._known:
            sent = self._ahead.get(what)
            self._known[key] = decode(self._ask(what, which) if sent is None else sent)
        return self._known[key]

    def _ask(self, what: str, which: int) -> msgspec.Raw:
        self._pipe.send(wire.Ask(what=what, which=which, shared=what in _PICTURES and self._pipe.view is not None))
        answer = self._pipe.receive()
        if not isinstance(answer, wire.Given):
            self._pipe.fail()
        return answer.value

    def _array(self, data: bytes) -> Any:
        value = msgspec.msgpack.decode(data)
        view = self._pipe.view
        return view.take(value) if view is not None and "at" in value else wire.decode_array(value)


def _scan(data: bytes) -> Scan:
    scan: Any = msgspec.msgpack.decode(data, type=Scan)
    decoded: Scan = msgspec.structs.replace(
        scan,
        bearings=wire.decode_array(scan.bearings),
        ranges=wire.decode_array(scan.ranges),
        tops=scan.tops if scan.tops is None else wire.decode_array(scan.tops),
    )
    return decoded


def _camera(data: bytes) -> Camera:
    camera: Any = msgspec.msgpack.decode(data, type=Camera)
    decoded: Camera = msgspec.structs.replace(
        camera, matrix=wire.decode_array(camera.matrix), pose=wire.decode_array(camera.pose)
    )
    return decoded
