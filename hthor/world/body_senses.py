"""A seat's sensor readings at one tick, computed when first asked for and then kept."""

from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from hthor.errors import StaleObservation
from hthor.types import Camera, Detection, Scan, Sighting, View


class SensorReadings(Protocol):
    """The sensors of all seats, read at the present tick; see `hthor.world.sensing_simulation.SensingSimulation`."""

    @property
    def moment(self) -> tuple[int, int]: ...
    @property
    def profile(self) -> str: ...
    def detections(self, seat: str) -> tuple[Detection, ...]: ...
    def sighting(self, seat: str, id: str) -> Sighting: ...
    def scan(self, seat: str) -> Scan: ...
    def camera(self, seat: str) -> Camera: ...
    def look(self, seat: str) -> View: ...
    def picture(self, seat: str, mode: str) -> NDArray[Any]: ...


class SeatSenses:
    """A seat's detector, range scanner and camera at the tick at which this was made."""

    __slots__ = ("_detections", "_drawn", "_moment", "_scan", "_seat", "_view", "_world")

    def __init__(self, world: SensorReadings, seat: str) -> None:
        self._world, self._seat, self._moment = world, seat, world.moment
        self._detections: tuple[Detection, ...] | None = None
        self._scan: Scan | None = None
        self._view: View | None = None
        self._drawn: dict[str, Any] = {}

    def detections(self) -> tuple[Detection, ...]:
        """Objects, furniture, doorways, people and robots in view, by id."""
        self._check()
        if self._detections is None:
            self._detections = self._world.detections(self._seat)
        return self._detections

    def sighting(self, id: str) -> Sighting:
        """How visible an object is; a share of 0 for what is not in view."""
        self._check()
        return self._world.sighting(self._seat, id)

    def scan(self) -> Scan:
        """Ranges to what would stop this body: walls and furniture, not people, robots or objects."""
        self._check()
        if self._scan is None:
            self._scan = self._world.scan(self._seat)
        return self._scan

    def rgb(self) -> NDArray[np.uint8]:
        """(H, W, 3) uint8."""
        image: NDArray[np.uint8] = self._picture("rgb")
        return image

    def depth(self) -> NDArray[np.float32]:
        """(H, W) float32 [m] along the optical axis."""
        image: NDArray[np.float32] = self._picture("depth")
        return image

    def segmentation(self) -> NDArray[np.int32]:
        """(H, W) int32, indices into ``World.names``, -1 for nothing."""
        image: NDArray[np.int32] = self._picture("segmentation")
        return image

    def camera(self) -> Camera:
        """Where the camera is and how it projects."""
        self._check()
        return self._world.camera(self._seat)

    def _picture(self, mode: str) -> Any:
        """A picture; in the profile "fast" all three are drawn at once, which costs little more than one."""
        self._check()
        if self._world.profile == "fast":
            if self._view is None:
                self._view = self._world.look(self._seat)
            return getattr(self._view, mode)
        if mode not in self._drawn:
            self._drawn[mode] = self._world.picture(self._seat, mode)
        return self._drawn[mode]

    def _check(self) -> None:
        if self._world.moment != self._moment:
            tick = self._moment[1]
            raise StaleObservation(
                f"this observation of seat '{self._seat}' was made at tick {tick} and the world has moved on; "
                "read pictures, scans and detections inside act, and keep what you need of them"
            )
