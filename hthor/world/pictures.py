"""Pictures of a world, put off until someone looks at them; knows nothing of OpenGL until then."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from hthor.types import HouseSpec, Vec2
from hthor.world.env import FastEnv
from hthor.world.moment import Moment
from hthor.world.scene import Scene
from hthor.world.seats import Seat

if TYPE_CHECKING:
    from hthor.world.rendering import Studio

IMAGE_SIZE = (128, 128)
"""Width and height of a seat's own pictures, in pixels."""
_MARGIN_M = 0.3


class Pictures:
    """Copies moments now and draws them when asked."""

    def __init__(self, house: HouseSpec, env: FastEnv, scene: Scene, seats: Mapping[str, Seat]) -> None:
        self._house, self._env, self._scene, self._seats = house, env, scene, seats
        self._studio: Studio | None = None

    def view(self, seat: str, mode: str, size: tuple[int, int]) -> Any:
        """The seat's own view now, see `Studio.view`."""
        return self._draw().view(self._moment(), seat, mode, size)

    def frame(self, seat: str, size: tuple[int, int]) -> Callable[[], Any]:
        """The seat's own view of this moment in colour, drawn when called."""
        moment = self._moment()
        return lambda: self._draw().view(moment, seat, "rgb", size)

    def top_view(self, pixels_per_metre: float) -> Any:
        """The house from above now, see `Studio.top_view`."""
        return self._draw().top_view(self._moment(), self.bounds, pixels_per_metre)

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

    def _draw(self) -> Studio:
        if self._studio is None:
            from hthor.world.rendering import Studio

            self._studio = Studio(self._env.model, self._scene)
        return self._studio
