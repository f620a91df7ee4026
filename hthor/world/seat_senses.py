"""The sensors of a seat as agents and human models read them: at one tick only, or frozen at one moment."""

from collections.abc import Callable, Mapping
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from hthor.errors import StaleObservation
from hthor.types import Camera, Detection, Scan, Sighting, View

_NOT_SEEN = Sighting()


class SensedWorld(Protocol):
    """The members of a `hthor.world.sensing_simulation.SensingSimulation` that senses use."""

    @property
    def moment(self) -> tuple[int, int, int]: ...
    @property
    def profile(self) -> str: ...
    def detections(self, seat: str) -> tuple[Detection, ...]: ...
    def sighting(self, seat: str, id: str) -> Sighting: ...
    def scan(self, seat: str) -> Scan: ...
    def look(self, seat: str) -> View: ...
    def picture(self, seat: str, mode: str) -> NDArray[Any]: ...
    def camera(self, seat: str) -> Camera: ...


class SeatSenses:
    """A seat's detector, range scanner and camera at the tick at which this object was made.

    Nothing is computed before it is read.
    """

    __slots__ = ("_detections", "_drawn", "_moment", "_scan", "_seat", "_view", "_world")

    def __init__(self, world: SensedWorld, seat: str) -> None:
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
        """How visible an object is; a share of 0 if it is not in view."""
        self._check()
        return self._world.sighting(self._seat, id)

    def scan(self) -> Scan:
        """Ranges to walls, furniture and shut doors, which stop this body; not to people, robots or objects."""
        self._check()
        if self._scan is None:
            self._scan = self._world.scan(self._seat)
        return self._scan

    def rgb(self) -> NDArray[np.uint8]:
        """The camera's picture, (H, W, 3) uint8."""
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
        """The pose and the projection of the camera."""
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


class FrozenSenses:
    """A seat's detector, range scanner and camera at one moment, which may be read at any time and in any thread.

    Args:
        detections, scan, camera: the readings of the moment. sightings: of the objects in view, by id.
        draw: draws a picture of the moment: "rgb", "depth" or "segmentation".
    """

    __slots__ = ("_camera", "_detections", "_draw", "_scan", "_sightings")

    def __init__(
        self,
        detections: tuple[Detection, ...],
        scan: Scan,
        camera: Camera,
        sightings: Mapping[str, Sighting],
        draw: Callable[[str], NDArray[Any]],
    ) -> None:
        self._detections, self._scan, self._camera = detections, scan, camera
        self._sightings, self._draw = sightings, draw

    def detections(self) -> tuple[Detection, ...]:
        """Objects, furniture, doorways, people and robots in view, by id."""
        return self._detections

    def sighting(self, id: str) -> Sighting:
        """How visible an object is; a share of 0 if it was not in view."""
        return self._sightings.get(id, _NOT_SEEN)

    def scan(self) -> Scan:
        """Ranges to walls, furniture and shut doors, which stop this body; not to people, robots or objects."""
        return self._scan

    def rgb(self) -> NDArray[np.uint8]:
        """The camera's picture, (H, W, 3) uint8."""
        return self._draw("rgb")

    def depth(self) -> NDArray[np.float32]:
        """(H, W) float32 [m] along the optical axis."""
        return self._draw("depth")

    def segmentation(self) -> NDArray[np.int32]:
        """(H, W) int32, indices into ``World.names`` of that episode, -1 for nothing."""
        return self._draw("segmentation")

    def camera(self) -> Camera:
        """The pose and the projection of the camera."""
        return self._camera
