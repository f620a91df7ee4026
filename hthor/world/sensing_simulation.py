"""A simulation with sensors: detections, range scans and pictures for every seat."""

import functools
import itertools
from collections.abc import Callable, Iterable, Iterator
from typing import Any, NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from hthor.errors import HthorError, UnknownName
from hthor.looks import pack as packs
from hthor.looks.pack import Pack
from hthor.types import (
    Camera,
    CameraSpec,
    Detection,
    DetectorSpec,
    HouseSpec,
    Pose,
    RobotSpec,
    Scan,
    Senses,
    Sighting,
    Vec3,
    View,
    is_person,
)
from hthor.types import cameras as hthor_cameras
from hthor.world import numbers
from hthor.world.editable_simulation import EditableSimulation
from hthor.world.model import inventory
from hthor.world.perception import view_frustum
from hthor.world.rendering.lazy_images import LabelKey, LazyImages, Size
from hthor.world.rendering.scene.asset_registry import AssetSource
from hthor.world.rendering.scene.pose_sync import PoseSync
from hthor.world.rendering.scene.scene_parts import SceneParts
from hthor.world.rendering.viewpoint import Viewpoint
from hthor.world.seat_senses import MEASURED, FrozenSenses, SeatSenses

_OUT_OF_SIGHT = Pose(x=-1e3, y=-1e3)


class SurveyReading(NamedTuple):
    """What a seat senses from one pose: detections, depth (H, W) float32 [m], segmentation (H, W) int32, and colours
    (H, W, 3) uint8 if they were wanted.
    """

    detections: tuple[Detection, ...]
    depth: NDArray[np.float32]
    segmentation: NDArray[np.int32]
    rgb: NDArray[np.uint8] | None = None


class SensingSimulation(EditableSimulation):
    """A simulation with the sensors of every seat.

    Args:
        house, robots, objects, detectors, people: see `hthor.world.simulation.Simulation`.
        profile: how pictures are drawn unless a call names another profile: "fast" needs only the processor, "nice" is
            for people and needs OpenGL.
        assets: a furniture pack, or its name; the profile "nice" shows its furniture where it has any, else our own.
        cameras: the robots' cameras, in the order of the robots: records, or texts that `hthor.types.cameras.parse`
            reads; by default each body's own.
    """

    def __init__(
        self,
        house: HouseSpec | str,
        robots: Iterable[RobotSpec | str] = (),
        objects: Iterable[tuple[str, str]] = inventory.DEFAULT_OBJECTS,
        detectors: Iterable[DetectorSpec | str] = (),
        profile: str = "fast",
        assets: Pack | str = "",
        cameras: Iterable[CameraSpec | str] = (),
        people: int = 1,
    ) -> None:
        self._pack = (packs.load(assets) if assets else None) if isinstance(assets, str) else assets
        super().__init__(house, robots, objects, detectors, people)
        given = [hthor_cameras.parse(one) if isinstance(one, str) else one for one in cameras]
        if len(given) > len(self.robots):
            raise HthorError(
                f"there are {len(given)} cameras and {len(self.robots)} robots; give one camera for each robot"
            )
        self.cameras = dict(zip(self.robots, given, strict=False))
        seen = self.house, self._contents, self.bodies, self._env.model, self._geoms, self._pack
        studio = functools.partial(_studio, *seen)  # without this world in it: a circle would wait for the collector
        self._pictures = LazyImages(self.house, self._env, self._geoms, self._seats, studio, profile, self.cameras)
        self._kinds = {wall.id: "wall" for wall in self.house.walls}
        self._kinds |= {one.id: one.kind for one in (*self.house.openings, *self.house.things, *self._objects)}
        self._kinds |= {seat: "person" if is_person(seat) else body.name for seat, body in self.bodies.items()}

    # -------------------------------------------------------------------------------------------------------- senses
    # A sensor that `hthor.types.sensors` declares is measured by the method here that has its name and takes the seat.

    def senses(self, seat: str) -> Senses:
        """The seat's sensors at this tick."""
        return cast(Senses, SeatSenses(self, seat))

    def frozen_senses(self, seat: str) -> Senses:
        """The seat's sensors as they are now, to be read at any later time and in any thread.

        What they measure is measured now; pictures are drawn from poses of now when they are read, one after another if
        several threads read them.
        """
        readings = {name: getattr(self, name)(seat) for name in MEASURED}
        objects = [one.id for one in readings["detections"] if one.family == "object"]
        sightings = {id: self.sighting(seat, id) for id in objects}
        pictures = self._pictures.frozen(seat, self._label_key)
        return cast(Senses, FrozenSenses(readings, sightings, pictures))

    def detections(self, seat: str) -> tuple[Detection, ...]:
        """Detections of the seat's detector now, by id, with the detector's errors."""
        found, noise = self._visibility.detections(self._seats[seat]), self._detectors.get(seat)
        return found if noise is None else noise.report(found, self._objects, self._seed, self.tick)

    def sighting(self, seat: str, id: str) -> Sighting:
        """How visible an object is to the seat now; a share of 0 if it is not in view or not an object."""
        return self._visibility.sighting(self._seats[seat], id)

    def hidden(self, id: str, eye: Vec3) -> bool:
        """Whether furniture, walls or other objects hide an object from an eye at (x, y, z) [m].

        Raises:
            UnknownName: when there is no object with this id.
        """
        eye, item = numbers.point3("eye", eye), self._objects.known(id)
        if item is None:
            raise UnknownName("object", id, [one.id for one in self._objects])
        return all(self._geoms.hidden(eye, point, id) for point in view_frustum.look_points(item.position, item.size))

    def scan(self, seat: str) -> Scan:
        """The seat's range scan now."""
        body = self._seats[seat]
        return self._scanners[seat].scan(body.pose, body.space)

    def survey(self, seat: str, poses: Iterable[Pose], *, colours: bool = False) -> Iterator[SurveyReading]:
        """What the seat would sense from each of these poses if no other body were in the house.

        For data sets: no time passes, nothing is pushed, and the poses need not be free. The detector is ideal and the
        camera the body's own. Afterwards all bodies are where they were.

        Args:
            colours: whether the readings have colour pictures, too; drawing them takes longer.
        """
        body, kept = self._seats[seat], self.poses()
        try:
            for other in self._seats.values():
                other.pose = _OUT_OF_SIGHT
            self._mocap.rewrite()
            first, second = itertools.tee(poses)
            pictures = self._pictures.survey(seat, second, self._label_key, colours)
            for body.pose, (rgb, depth, segmentation) in zip(first, pictures, strict=True):
                yield SurveyReading(self._visibility.detections(body), depth, segmentation, rgb)
        finally:
            for name, pose in kept.items():
                self._seats[name].pose = pose
            self._mocap.rewrite()

    # ------------------------------------------------------------------------------------------------------ pictures

    @property
    def _label_key(self) -> LabelKey:
        return LabelKey(self._seed, self._spares)

    @property
    def names(self) -> tuple[str, ...]:
        """Ids that the numbers of a segmentation stand for: of things, seats, rooms, walls and openings.

        Every episode shuffles the numbers by its seed. Objects that were not in the house when it began come last.
        """
        return self._pictures.names(self._label_key)

    @property
    def label_kinds(self) -> tuple[str, ...]:
        """The kind of what each number of a segmentation stands for, in the order of `names`.

        For things and objects the kind that detections report; else "floor", "ceiling", "wall", "door", "window",
        "person", a robot's name, "ground", "outdoors" or "roof".
        """
        return tuple(self._kinds.get(name, name.partition(" of ")[0]) for name in self.names)

    @property
    def profile(self) -> str:
        """How pictures are drawn unless a call names another profile."""
        return self._pictures.profile

    def picture(self, seat: str, mode: str = "rgb", size: Size = None, profile: str | None = None) -> NDArray[Any]:
        """The picture of the seat's camera now, without the seat's own body.

        Args:
            mode: rgb (H, W, 3) uint8, depth (H, W) float32 [m] along the optical axis, or segmentation (H, W) int32,
                indices into `names`, -1 for nothing. Depth and segmentation look through glass.
            size: (width, height) [pixels]; None for the camera's own. Pixels are square: a picture whose
                shape differs from that of the body's field of view shows the middle of it.
            profile: "fast", "nice", or None for the world's own.

        Raises:
            ValueError: when mode, size or profile is invalid.
            RenderingUnavailable: when the profile is nice and no OpenGL back end works.
        """
        return self._pictures.view(seat, mode, size, profile, self._label_key)

    def look(self, seat: str, size: Size = None, profile: str | None = None) -> View:
        """All three pictures of this moment, and the camera that took them; see `picture`."""
        return self._pictures.look(seat, size, profile, self._label_key)

    def camera(self, seat: str, size: Size = None) -> Camera:
        """The pose of the seat's camera now, and its projection for pictures of ``size`` (width, height) [pixels]."""
        return self._pictures.camera(seat, size)

    def frame(self, seat: str, size: Size = None, profile: str | None = None) -> Callable[[], NDArray[np.uint8]]:
        """A function that draws the seat's view of this moment, (H, W, 3) uint8; it may be called later."""
        return self._pictures.frame(seat, size, profile)

    def top_view(self, pixels_per_metre: float = 50.0, profile: str | None = None) -> NDArray[np.uint8]:
        """The house from above without its ceilings, (H, W, 3) uint8, covering `top_view_bounds`; north (+y) is up."""
        return self._pictures.top_view(pixels_per_metre, profile)

    def overview(
        self, viewpoint: Viewpoint, mode: str = "rgb", size: tuple[int, int] = (640, 480), profile: str | None = None
    ) -> NDArray[Any]:
        """The house now from any viewpoint, without its ceilings; for figures, no seat ever sees it.

        Args:
            mode: rgb (H, W, 3) uint8, or depth (H, W) float32 [m] along the optical axis.
            size: (width, height) [pixels]. profile: "fast", which cuts walls at 1 m, "nice", which shows them whole, or
                None for the world's own.
        """
        return self._pictures.overview(viewpoint, mode, size, profile)

    @functools.cached_property
    def scene(self) -> SceneParts:
        """Everything that can be seen, as plain meshes, for a program that draws the house itself."""
        puppets = PoseSync(self._env.model, self._geoms)
        return SceneParts(self.house, self._contents, puppets, self.bodies, AssetSource(self._pack))

    def scene_poses(self) -> NDArray[np.float64]:
        """Where everything in `scene` that moves is now, see `SceneParts.poses`."""
        return self.scene.poses(self._pictures.moment())

    @property
    def top_view_bounds(self) -> tuple[float, float, float, float]:
        """x0, y0, x1, y1 [m] of the top view: the rooms and a small margin."""
        return self._pictures.bounds


def _studio(*seen: Any) -> Any:
    """The renderer of the profile "nice"; its module loads OpenGL, so it is imported only now."""
    from hthor.world.rendering.opengl_renderer import OpenGLRenderer

    return OpenGLRenderer(*seen)
