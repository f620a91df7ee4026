"""Pictures of a world, drawn only when they are read, in any thread.

The profile ``fast`` draws the engine's own solids in a millisecond, with the processor only. The profile ``nice`` draws
detailed meshes with textures and shadows, through OpenGL; it is loaded at its first use.
"""

from __future__ import annotations

import contextlib
import functools
import threading
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from hthor import seeds
from hthor.errors import WorldClosed
from hthor.types import Camera, CameraSpec, HouseSpec, Pose, Vec2, View
from hthor.world import numbers
from hthor.world.model.composer_env import LazyComposerEnv
from hthor.world.model.geom_index import GeomIndex
from hthor.world.rendering import camera, forks
from hthor.world.rendering.camera import Images, PoseSnapshot
from hthor.world.rendering.renderer_slot import RendererSlot
from hthor.world.state.body_state import BodyState

if TYPE_CHECKING:
    from hthor.world.rendering.opengl_renderer import OpenGLRenderer
    from hthor.world.rendering.ray_renderer import RayRenderer
    from hthor.world.rendering.viewpoint import Viewpoint

PROFILES = ("fast", "nice")
MODES = ("rgb", "depth", "segmentation")
Size = tuple[int, int] | None
"""Width and height [pixels], None for the camera's own."""
_MARGIN_M = 0.3
"""[m] Margin shown around the rooms in the view from above."""


class LabelKey(NamedTuple):
    """What decides the numbers in the segmentations of an episode.

    ``spares`` are the world's objects that were not in the house when the episode began. Their numbers come last, so
    that everything else has the same numbers in a world without them.
    """

    seed: int
    spares: frozenset[str] = frozenset()


class SegmentationLabels:
    """The numbers of owners in a segmentation, shuffled for every episode so that numbers reveal nothing.

    Numbers in alphabetic order would reveal names, and constant numbers would identify a thing from one trial to the
    next. The argument ``names`` is in the order of the renderer's numbers; the attribute ``names`` is in the order of
    the numbers that pictures show.
    """

    def __init__(self, names: Sequence[str]) -> None:
        self._counted, self._key = tuple(names), LabelKey(-1)
        self.names: tuple[str, ...] = ()
        self._shown = np.zeros(0, np.int32)

    def draw(self, key: LabelKey) -> None:
        """Shuffle the numbers for an episode; equal keys give equal numbers."""
        if self.names and key == self._key:
            return
        root = seeds.derive(key.seed, "segmentation")
        self.names = tuple(sorted(self._counted, key=lambda name: (name in key.spares, seeds.draw(root, name))))
        self._key = key
        number = {name: index for index, name in enumerate(self.names)}
        self._shown = np.array([*(number[name] for name in self._counted), -1], np.int32)

    def of(self, numbers: Any) -> Any:
        """(H, W) int32, the numbers that pictures show, for the renderer's ``numbers``; -1 stays."""
        return self._shown[numbers]


class LazyImages:
    """Copies poses now and draws pictures of them on request.

    Args:
        opengl: makes the renderer of the profile ``nice`` when it is needed.
        profile: the profile of pictures for which a call names none.
        cameras: by seat, the cameras that replace their bodies' own.
    """

    def __init__(
        self,
        house: HouseSpec,
        env: LazyComposerEnv,
        geoms: GeomIndex,
        seats: Mapping[str, BodyState],
        opengl: Callable[[], OpenGLRenderer],
        profile: str = "fast",
        cameras: Mapping[str, CameraSpec] | None = None,
    ) -> None:
        _check(PROFILES, profile=profile)
        self.profile = profile
        self._house, self._env, self._geoms, self._seats = house, env, geoms, seats
        self._cameras = dict(cameras or {})
        self._opengl = RendererSlot(opengl)
        self._ray_renderer: RayRenderer | None = None
        self._labels = SegmentationLabels(geoms.names)
        self._lock = threading.RLock()  # renderers and labels keep buffers from picture to picture
        self._closed = False
        forks.watch(self)

    def names(self, labels: LabelKey) -> tuple[str, ...]:
        """The owners that the numbers of a segmentation stand for in the episode."""
        with self._lock:
            self._labels.draw(labels)
            return self._labels.names

    def view(self, seat: str, mode: str, size: Size, profile: str | None, labels: LabelKey) -> NDArray[Any]:
        """The camera's picture now: rgb (H, W, 3) uint8, depth (H, W) float32 [m] or segmentation (H, W) int32."""
        _check(MODES, mode=mode)
        return self._view(self.moment(), seat, mode, self._size(seat, size), profile, labels)

    def look(self, seat: str, size: Size, profile: str | None, labels: LabelKey) -> View:
        """Colour, depth and segmentation of this moment."""
        size = self._size(seat, size)
        images = self._look(self.moment(), seat, size, profile, labels)
        return View(
            rgb=images.rgb, depth=images.depth, segmentation=images.segmentation, camera=self.camera(seat, size)
        )

    def camera(self, seat: str, size: Size) -> Camera:
        """The seat's camera now, for pictures of ``size``."""
        body = self._seats[seat]
        return camera.camera_record(body.pose, body.spec, self._size(seat, size), self._by(seat))

    def frame(self, seat: str, size: Size, profile: str | None) -> Callable[[], NDArray[np.uint8]]:
        """A function that draws the colour picture of the seat's camera at this moment."""
        _check(PROFILES, profile=profile or self.profile)
        return functools.partial(self._view, self.moment(), seat, "rgb", self._size(seat, size), profile, LabelKey(0))

    def frozen(self, seat: str, labels: LabelKey) -> Callable[[str], NDArray[Any]]:
        """A function that draws the pictures of the seat's camera at this moment by their modes, each once.

        In the profile "fast" all three are drawn at once, which costs little more than one.
        """
        size, moment, drawn = self._size(seat, None), self.moment(), dict[str, NDArray[Any]]()

        def draw(mode: str) -> NDArray[Any]:
            with self._lock:
                if mode not in drawn and self.profile == "fast":
                    drawn.update(self._look(moment, seat, size, None, labels)._asdict())
                elif mode not in drawn:
                    drawn[mode] = self._view(moment, seat, mode, size, None, labels)
                return drawn[mode]

        return draw

    def survey(
        self, seat: str, poses: Iterable[Pose], labels: LabelKey, colours: bool
    ) -> Iterator[tuple[NDArray[np.uint8] | None, NDArray[np.float32], NDArray[np.int32]]]:
        """Colours if they are wanted, depth [m] and segmentation from each of these poses of the seat; nothing else
        moves. Always "fast".
        """
        size = camera.image_size(self._seats[seat].spec)
        for rgb, depth, found in self._fast().survey(self.moment(), seat, poses, size, colours):
            yield rgb, depth, self._labelled(found, labels)

    def top_view(self, pixels_per_metre: float, profile: str | None) -> NDArray[np.uint8]:
        """The house from above now, (H, W, 3) uint8."""
        if not numbers.is_finite(pixels_per_metre) or not 0.0 < pixels_per_metre <= 500.0:
            raise ValueError(
                f"pixels_per_metre must be more than 0 and at most 500, got {numbers.quoted(pixels_per_metre)}"
            )
        moment = self.moment()
        with self._drawing(profile) as renderer:
            picture: NDArray[np.uint8] = renderer.top_view(moment, self.bounds, pixels_per_metre)
        return picture

    def overview(self, viewpoint: Viewpoint, mode: str, size: tuple[int, int], profile: str | None) -> NDArray[Any]:
        """The house now from any viewpoint, without ceilings: rgb (H, W, 3) uint8 or depth (H, W) float32 [m]."""
        _check(("rgb", "depth"), mode=mode)
        camera.check_size(size)
        moment = self.moment()
        with self._drawing(profile) as renderer:
            picture: NDArray[Any] = renderer.overview(moment, viewpoint, mode, size)
        return picture

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """x0, y0, x1, y1 [m] around all rooms."""
        corners: list[Vec2] = [corner for room in self._house.rooms for corner in room.polygon]
        xs, ys = [corner[0] for corner in corners], [corner[1] for corner in corners]
        return (min(xs) - _MARGIN_M, min(ys) - _MARGIN_M, max(xs) + _MARGIN_M, max(ys) + _MARGIN_M)

    def _view(
        self, moment: PoseSnapshot, seat: str, mode: str, size: tuple[int, int], profile: str | None, labels: LabelKey
    ) -> NDArray[Any]:
        with self._drawing(profile) as renderer:
            picture: NDArray[Any] = renderer.view(moment, seat, mode, size, self._by(seat))
            return self._labelled(picture, labels) if mode == "segmentation" else picture

    def _look(
        self, moment: PoseSnapshot, seat: str, size: tuple[int, int], profile: str | None, labels: LabelKey
    ) -> Images:
        with self._drawing(profile) as renderer:
            images: Images = renderer.look(moment, seat, size, self._by(seat))
            return images._replace(segmentation=self._labelled(images.segmentation, labels))

    def _by(self, seat: str) -> CameraSpec:
        return self._cameras.get(self._seats[seat].name, camera.OWN)  # raises for an unknown seat

    def _size(self, seat: str, size: Size) -> tuple[int, int]:
        """``size``, or the camera's own if None."""
        if size is None:
            return camera.image_size(self._seats[seat].spec, self._by(seat))
        camera.check_size(size)
        return size

    def _labelled(self, numbers: NDArray[np.int32], labels: LabelKey) -> NDArray[np.int32]:
        self._labels.draw(labels)
        labelled: NDArray[np.int32] = self._labels.of(numbers)
        return labelled

    def moment(self) -> PoseSnapshot:
        """All poses of this moment."""
        if self._closed:
            raise WorldClosed.of(self._house.id)
        self._env.pin()
        poses = {name: (seat.pose, seat.spec) for name, seat in self._seats.items()}
        return PoseSnapshot(self._env.data.qpos.copy(), poses)

    @contextlib.contextmanager
    def _drawing(self, profile: str | None) -> Iterator[Any]:
        """The renderer of a profile, for this thread alone until the end of the block."""
        wanted = profile or self.profile
        _check(PROFILES, profile=wanted)
        with self._lock:
            if self._closed:
                raise WorldClosed.of(self._house.id)
            if wanted == "fast":
                yield self._fast()
            else:
                with self._opengl.drawing() as renderer:
                    yield renderer

    def close(self) -> None:
        """Let go of the engine and the renderers, after the picture that another thread may be drawing.

        From then on, every picture raises WorldClosed.
        """
        with self._lock:
            self._closed = True
            del self._env, self._geoms, self._ray_renderer, self._opengl

    def forked(self) -> None:
        """Start again what another thread was drawing, because in the forked process it never ends."""
        if self._lock.acquire(blocking=False):
            self._lock.release()
            return
        self._lock = threading.RLock()
        if not self._closed:
            self._ray_renderer, self._labels = None, SegmentationLabels(self._geoms.names)

    def _fast(self) -> RayRenderer:
        if self._ray_renderer is None:
            from hthor.world.rendering.ray_renderer import RayRenderer

            self._ray_renderer = RayRenderer(self._env.model, self._geoms, self._house)
        return self._ray_renderer


def _check(valid: tuple[str, ...], **given: str) -> None:
    for what, name in given.items():
        if name not in valid:
            raise ValueError(f"{what} must be one of {', '.join(valid)}, got '{name}'")
