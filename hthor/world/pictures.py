"""Pictures of a world, put off until someone looks at them; knows nothing of how either profile draws.

The profile ``fast`` traces the engine's own solids, in a millisecond and with nothing but the processor. ``nice`` draws
what they stand for, with textures and shadows, through OpenGL; it is loaded when it is first asked for.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from hthor.types import Camera, HouseSpec, Vec2, View
from hthor.world import camera, numbers
from hthor.world.env import FastEnv
from hthor.world.moment import Moment
from hthor.world.scene import Scene
from hthor.world.seats import Seat

if TYPE_CHECKING:
    from hthor.world.rendering import Studio
    from hthor.world.tracer import Tracer

IMAGE_SIZE = (128, 128)
"""Width and height of a seat's own pictures, in pixels."""
PROFILES = ("fast", "nice")
MODES = ("rgb", "depth", "segmentation")
_MARGIN_M = 0.3


class Pictures:
    """Copies moments now and draws them when asked.

    Args:
        studio: makes what draws the profile ``nice``; called at most once, when first needed.
        profile: the profile of every picture for which a call names none.
    """

    def __init__(
        self,
        house: HouseSpec,
        env: FastEnv,
        scene: Scene,
        seats: Mapping[str, Seat],
        studio: Callable[[], Studio],
        profile: str = "fast",
    ) -> None:
        _check(PROFILES, profile=profile)
        self._profile = profile
        self._house, self._env, self._scene, self._seats = house, env, scene, seats
        self._make = studio
        self._studio: Studio | None = None
        self._tracer: Tracer | None = None

    def view(self, seat: str, mode: str, size: tuple[int, int], profile: str | None) -> Any:
        """The seat's own view now: rgb (H, W, 3) uint8, depth (H, W) float32 [m] or segmentation (H, W) int32."""
        _check(MODES, mode=mode)
        camera.check(size)
        return self._draw(profile).view(self._moment(), seat, mode, size)

    def look(self, seat: str, size: tuple[int, int]) -> View:
        """Colour, depth and segmentation of one glance, in the profile ``fast``."""
        camera.check(size)
        glance = self._fast().look(self._moment(), seat, size)
        return View(
            rgb=glance.rgb, depth=glance.depth, segmentation=glance.segmentation, camera=self.camera(seat, size)
        )

    def camera(self, seat: str, size: tuple[int, int]) -> Camera:
        """The seat's camera now, as it takes pictures of this size."""
        camera.check(size)
        body = self._seats[seat]
        return camera.of(body.pose, body.spec, size)

    def frame(self, seat: str, size: tuple[int, int], profile: str | None) -> Callable[[], Any]:
        """The seat's own view of this moment in colour, drawn when called."""
        _check(PROFILES, profile=profile or self._profile)
        camera.check(size)
        moment = self._moment()
        return lambda: self._draw(profile).view(moment, seat, "rgb", size)

    def top_view(self, pixels_per_metre: float, profile: str | None) -> Any:
        """The house from above now, (H, W, 3) uint8."""
        if not numbers.finite(pixels_per_metre) or not 0.0 < pixels_per_metre <= 500.0:
            raise ValueError(f"pixels_per_metre must be more than 0 and at most 500, got {pixels_per_metre!r:.40}")
        return self._draw(profile).top_view(self._moment(), self.bounds, pixels_per_metre)

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """x0, y0, x1, y1 [m] around all rooms."""
        corners: list[Vec2] = [corner for room in self._house.rooms for corner in room.polygon]
        xs, ys = [corner[0] for corner in corners], [corner[1] for corner in corners]
        return (min(xs) - _MARGIN_M, min(ys) - _MARGIN_M, max(xs) + _MARGIN_M, max(ys) + _MARGIN_M)

    def _moment(self) -> Moment:
        self._env.pin()
        poses = {name: (seat.pose, seat.spec) for name, seat in self._seats.items()}
        return Moment(self._env.data.qpos.copy(), poses)

    def _draw(self, profile: str | None) -> Any:
        wanted = profile or self._profile
        _check(PROFILES, profile=wanted)
        return self._fast() if wanted == "fast" else self._nice()

    def _fast(self) -> Tracer:
        if self._tracer is None:
            from hthor.world.tracer import Tracer

            self._tracer = Tracer(self._env.model, self._scene, self._house)
        return self._tracer

    def _nice(self) -> Studio:
        if self._studio is None:
            self._studio = self._make()
        return self._studio


def _check(valid: tuple[str, ...], **given: str) -> None:
    for what, name in given.items():
        if name not in valid:
            raise ValueError(f"{what} must be one of {', '.join(valid)}, got '{name}'")
