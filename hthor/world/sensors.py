"""The sensors of every seat: detections and range scans, and pictures through `Pictures`."""

import itertools
from collections.abc import Iterable, Iterator
from typing import NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from hthor.errors import UnknownName
from hthor.types import Camera, Detection, Pose, Scan, Senses, Sighting, Vec3, View
from hthor.world import numbers
from hthor.world.perception import view_frustum
from hthor.world.pictures import Pictures
from hthor.world.seat_senses import MEASURED, FrozenSenses, SeatSenses
from hthor.world.simulation import Simulation

_OUT_OF_SIGHT = Pose(x=-1e3, y=-1e3)


class SurveyReading(NamedTuple):
    """What a seat senses from one pose: detections, depth (H, W) float32 [m], segmentation (H, W) int32, and colours
    (H, W, 3) uint8 if they were wanted.
    """

    detections: tuple[Detection, ...]
    depth: NDArray[np.float32]
    segmentation: NDArray[np.int32]
    rgb: NDArray[np.uint8] | None = None


class Sensors:
    """What the seats of one simulation sense; see `World` for each call.

    A sensor that `hthor.types.sensors` declares is measured by the method here that has its name and takes the seat.
    """

    def __init__(self, simulation: Simulation, pictures: Pictures) -> None:
        self._simulation, self._pictures = simulation, pictures

    def senses(self, seat: str) -> Senses:
        """See `World.senses`."""
        return cast(Senses, SeatSenses(self, seat))

    def frozen_senses(self, seat: str) -> Senses:
        """See `World.frozen_senses`."""
        readings = {name: getattr(self, name)(seat) for name in MEASURED}
        objects = [one.id for one in readings["detections"] if one.family == "object"]
        sightings = {id: self.sighting(seat, id) for id in objects}
        return cast(Senses, FrozenSenses(readings, sightings, self._pictures.frozen(seat)))

    def detections(self, seat: str) -> tuple[Detection, ...]:
        """See `World.detections`."""
        parts = self._simulation.parts
        found, noise = parts.visibility.detections(parts.seats[seat]), parts.detectors.get(seat)
        if noise is None:
            return found
        return noise.report(found, parts.objects, self._simulation.seed, self._simulation.tick)

    def sighting(self, seat: str, id: str) -> Sighting:
        """See `World.sighting`."""
        return self._simulation.parts.visibility.sighting(self._simulation.parts.seats[seat], id)

    def hidden(self, id: str, eye: Vec3) -> bool:
        """See `World.hidden`."""
        eye, item, geoms = (
            numbers.point3("eye", eye),
            self._simulation.parts.objects.known(id),
            self._simulation.parts.geoms,
        )
        if item is None:
            raise UnknownName("object", id, [one.id for one in self._simulation.parts.objects])
        return all(geoms.hidden(eye, point, id) for point in view_frustum.look_points(item.position, item.size))

    def scan(self, seat: str) -> Scan:
        """See `World.scan`."""
        body = self._simulation.parts.seats[seat]
        return self._simulation.parts.scanners[seat].scan(body.pose, body.space)

    def survey(self, seat: str, poses: Iterable[Pose], *, colours: bool = False) -> Iterator[SurveyReading]:
        """See `World.survey`."""
        parts, body, kept = self._simulation.parts, self._simulation.parts.seats[seat], self._simulation.poses()
        try:
            for other in parts.seats.values():
                other.pose = _OUT_OF_SIGHT
            parts.mocap.rewrite()
            first, second = itertools.tee(poses)
            pictures = self._pictures.survey(seat, second, colours)
            for body.pose, (rgb, depth, segmentation) in zip(first, pictures, strict=True):
                yield SurveyReading(parts.visibility.detections(body), depth, segmentation, rgb)
        finally:
            for name, pose in kept.items():
                parts.seats[name].pose = pose
            parts.mocap.rewrite()

    @property
    def moment(self) -> tuple[int, int, int]:
        """See `Simulation`."""
        return self._simulation.moment

    @property
    def profile(self) -> str:
        """How pictures are drawn unless a call names another profile."""
        return self._pictures.profile

    def look(self, seat: str) -> View:
        """All three pictures of this moment."""
        return self._pictures.look(seat)

    def camera(self, seat: str) -> Camera:
        """The pose and projection of the seat's camera now."""
        return self._pictures.camera(seat)

    def picture(self, seat: str, mode: str) -> NDArray[np.generic]:
        """The picture of the seat's camera now: "rgb", "depth" or "segmentation"."""
        return self._pictures.picture(seat, mode)
