"""Pictures of a simulation, from the seats' cameras and from anywhere, and everything that can be seen as meshes."""

import functools
from collections.abc import Callable, Iterable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hthor.errors import HthorError
from hthor.looks import pack as packs
from hthor.looks.pack import Pack
from hthor.types import Camera, CameraSpec, Pose, View, is_person
from hthor.types import cameras as hthor_cameras
from hthor.world.rendering.lazy_images import LabelKey, LazyImages, Size
from hthor.world.rendering.scene.asset_registry import AssetSource
from hthor.world.rendering.scene.pose_sync import PoseSync
from hthor.world.rendering.scene.scene_parts import SceneParts
from hthor.world.rendering.viewpoint import Viewpoint
from hthor.world.simulation import Simulation


class Pictures:
    """Draws the pictures of one simulation; see `World` for each call.

    Args:
        profile, assets, cameras: see `World`.

    Attributes:
        cameras: the camera of each robot that replaces its body's own.
    """

    def __init__(
        self,
        simulation: Simulation,
        profile: str = "fast",
        assets: Pack | str = "",
        cameras: Iterable[CameraSpec | str] = (),
    ) -> None:
        self._simulation, parts = simulation, simulation.parts
        self._pack = (packs.load(assets) if assets else None) if isinstance(assets, str) else assets
        given = [hthor_cameras.parse(one) if isinstance(one, str) else one for one in cameras]
        if len(given) > len(simulation.robots):
            raise HthorError(
                f"there are {len(given)} cameras and {len(simulation.robots)} robots; give one camera for each robot"
            )
        self.cameras = dict(zip(simulation.robots, given, strict=False))
        house, bodies = simulation.house, simulation.bodies
        seen = house, simulation.contents, bodies, parts.env.model, parts.geoms, self._pack
        studio = functools.partial(
            _studio, *seen
        )  # without these pictures in it: a circle would wait for the collector
        self._images = LazyImages(house, parts.env, parts.geoms, parts.seats, studio, profile, self.cameras)
        self._kinds = {wall.id: "wall" for wall in house.walls}
        self._kinds |= {one.id: one.kind for one in (*house.openings, *house.things, *parts.objects)}
        self._kinds |= {seat: "person" if is_person(seat) else body.name for seat, body in bodies.items()}

    @property
    def _labels(self) -> LabelKey:
        return LabelKey(self._simulation.seed, self._simulation.spares)

    @property
    def names(self) -> tuple[str, ...]:
        """See `World.names`."""
        return self._images.names(self._labels)

    @property
    def label_kinds(self) -> tuple[str, ...]:
        """See `World.label_kinds`."""
        return tuple(self._kinds.get(name, name.partition(" of ")[0]) for name in self.names)

    @property
    def profile(self) -> str:
        """See `World.profile`."""
        return self._images.profile

    def picture(self, seat: str, mode: str = "rgb", size: Size = None, profile: str | None = None) -> NDArray[Any]:
        """See `World.picture`."""
        return self._images.view(seat, mode, size, profile, self._labels)

    def look(self, seat: str, size: Size = None, profile: str | None = None) -> View:
        """See `World.look`."""
        return self._images.look(seat, size, profile, self._labels)

    def camera(self, seat: str, size: Size = None) -> Camera:
        """See `World.camera`."""
        return self._images.camera(seat, size)

    def frame(self, seat: str, size: Size = None, profile: str | None = None) -> Callable[[], NDArray[np.uint8]]:
        """See `World.frame`."""
        return self._images.frame(seat, size, profile)

    def frozen(self, seat: str) -> Callable[[str], NDArray[Any]]:
        """A function that draws the pictures of the seat's camera at this moment by their modes, each once."""
        return self._images.frozen(seat, self._labels)

    def survey(
        self, seat: str, poses: Iterable[Pose], colours: bool
    ) -> Iterator[tuple[NDArray[np.uint8] | None, NDArray[np.float32], NDArray[np.int32]]]:
        """Colours if they are wanted, depth [m] and segmentation from each of these poses of the seat."""
        return self._images.survey(seat, poses, self._labels, colours)

    def top_view(self, pixels_per_metre: float = 50.0, profile: str | None = None) -> NDArray[np.uint8]:
        """See `World.top_view`."""
        return self._images.top_view(pixels_per_metre, profile)

    @property
    def top_view_bounds(self) -> tuple[float, float, float, float]:
        """See `World.top_view_bounds`."""
        return self._images.bounds

    def overview(
        self, viewpoint: Viewpoint, mode: str = "rgb", size: tuple[int, int] = (640, 480), profile: str | None = None
    ) -> NDArray[Any]:
        """See `World.overview`."""
        return self._images.overview(viewpoint, mode, size, profile)

    @functools.cached_property
    def scene(self) -> SceneParts:
        """See `World.scene`."""
        simulation, parts = self._simulation, self._simulation.parts
        puppets = PoseSync(parts.env.model, parts.geoms)
        return SceneParts(simulation.house, simulation.contents, puppets, simulation.bodies, AssetSource(self._pack))

    def scene_poses(self) -> NDArray[np.float64]:
        """See `World.scene_poses`."""
        return self.scene.poses(self._images.moment())

    def close(self) -> None:
        """Let go of the renderers; from then on, every picture raises WorldClosed."""
        self._images.close()


def _studio(*seen: Any) -> Any:
    """The renderer of the profile "nice"; its module loads OpenGL, so it is imported only now."""
    from hthor.world.rendering.opengl_renderer import OpenGLRenderer

    return OpenGLRenderer(*seen)
