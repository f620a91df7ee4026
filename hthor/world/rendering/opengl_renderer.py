"""Pictures in the ``nice`` profile, through OpenGL: colour, depth, segmentation, and the house from above.

It draws copied poses with a model of its own (see `hthor.world.rendering.scene`), so a picture never changes the world.
"""

import weakref
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hthor.looks.pack import Pack
from hthor.types import BodySpec, CameraSpec, HouseSpec, Pose, Vec2
from hthor.world.model.engine import mujoco
from hthor.world.model.geom_index import GeomIndex
from hthor.world.model.inventory import Contents
from hthor.world.perception import view_frustum
from hthor.world.rendering import camera as projection
from hthor.world.rendering import opengl_context
from hthor.world.rendering.camera import Images, PoseSnapshot
from hthor.world.rendering.opengl_process import PROCESS
from hthor.world.rendering.scene.asset_registry import AssetSource
from hthor.world.rendering.scene.compile_scene import compile_scene
from hthor.world.rendering.scene.lights import RoomLights
from hthor.world.rendering.scene.pose_sync import PoseSync, seat_frames
from hthor.world.rendering.scene.scene_mesh import ABOVE, ALWAYS, INSIDE
from hthor.world.rendering.viewpoint import Viewpoint

CODE_PART = "pictures"

_SUPERSAMPLING = 2
"""Colour is drawn in this many times the resolution and averaged: the engine's smoothing leaves dotted shadow edges."""
_FAR_AWAY = (0.0, 0.0, -200.0)
_MODES = ("rgb", "depth", "segmentation")
_NEAR_M, _FAR_M = 0.02, 120.0
_ABOVE_M = 20.0


class OpenGLRenderer:
    """Draws snapshots of one world; it is made and used in a turn of `hthor.world.rendering.opengl_process`.

    Args:
        house: the floor plan. contents: its things, movable and static. seats: the body in each seat, in order.
        model: the compiled physics. scene: the owners of its geoms. pack: furniture to draw instead of our own.

    Raises:
        RenderingUnavailable: when no OpenGL back end works.
    """

    def __init__(
        self,
        house: HouseSpec,
        contents: Contents,
        seats: Mapping[str, BodySpec],
        model: Any,
        scene: GeomIndex,
        pack: Pack | None = None,
    ) -> None:
        self._puppets, self._lamps = PoseSync(model, scene), RoomLights(house)
        dressed = compile_scene(house, contents, self._puppets, AssetSource(pack), seats, self._lamps)
        self._model, self._followers, self._seats = dressed.model, dressed.followers, dressed.seats
        number = {name: index for index, name in enumerate(scene.names)}
        self._numbers = np.array([number.get(owner, -1) for owner in dressed.owner], np.int32)
        self._data = mujoco.MjData(self._model)
        self._surface = PROCESS.open(self._model)
        weakref.finalize(self, PROCESS.discard, self._surface).atexit = False
        self._context = self._surface.context
        self._scene = mujoco.MjvScene(self._model, maxgeom=self._model.ngeom + 64)
        self._option = mujoco.MjvOption()

    def look(self, moment: PoseSnapshot, seat: str, size: tuple[int, int], by: CameraSpec = projection.OWN) -> Images:
        """All three pictures of the camera of ``seat``."""
        return Images(*(self.view(moment, seat, mode, size, by) for mode in _MODES))

    def view(
        self, moment: PoseSnapshot, seat: str, mode: str, size: tuple[int, int], by: CameraSpec = projection.OWN
    ) -> Any:
        """A picture of ``seat``: rgb (H, W, 3) uint8, depth (H, W) float32 [m] or segmentation (H, W) int32."""
        if mode not in _MODES:
            raise ValueError(f"mode must be one of {', '.join(_MODES)}, got '{mode}'")
        pose, spec = moment.seats[seat]
        self._pose(moment, without=seat)
        self._compose(INSIDE)
        for eye in self._scene.camera:
            place_at_eye(eye, pose, spec, projection.image_tangents(spec, size, by))
        self._lamps.light(self._scene, pose)
        return self._shoot(mode, size)

    def top_view(self, moment: PoseSnapshot, bounds: tuple[float, float, float, float], pixels_per_metre: float) -> Any:
        """The area x0, y0, x1, y1 [m] from straight above without ceilings, (H, W, 3) uint8."""
        x0, y0, x1, y1 = bounds
        self._pose(moment)
        self._compose(ABOVE)
        for eye in self._scene.camera:
            place_above(eye, bounds)
        self._lamps.daylight(self._scene, ((x0 + x1) / 2, (y0 + y1) / 2), _ABOVE_M)
        return self._shoot("rgb", (round((x1 - x0) * pixels_per_metre), round((y1 - y0) * pixels_per_metre)))

    def overview(self, moment: PoseSnapshot, viewpoint: Viewpoint, mode: str, size: tuple[int, int]) -> Any:
        """The house without ceilings from any viewpoint: rgb or depth."""
        self._pose(moment)
        self._compose(ABOVE)
        for eye in self._scene.camera:
            place_at_viewpoint(eye, viewpoint, size)
        self._lamps.daylight(self._scene, viewpoint.target[:2], _ABOVE_M)
        return self._shoot(mode, size)

    def _pose(self, moment: PoseSnapshot, without: str = "") -> None:
        """Put everything where it was at ``moment``, and the body ``without`` far away."""
        position, turn = self._puppets.at(moment.qpos)
        count = len(self._followers)
        self._data.mocap_pos[:count], self._data.mocap_quat[:count] = position[self._followers], turn[self._followers]
        for seat, (pose, spec) in moment.seats.items():
            body, head = self._seats[seat]
            for puppet, (place, turned) in zip((body, head), seat_frames(pose, spec), strict=True):
                self._data.mocap_pos[puppet], self._data.mocap_quat[puppet] = place, turned
            if seat == without:
                self._data.mocap_pos[[body, head]] = _FAR_AWAY
        mujoco.mj_kinematics(self._model, self._data)

    def _compose(self, extra: int) -> None:
        self._option.geomgroup[:] = [group in (ALWAYS, extra) for group in range(6)]
        everything = int(mujoco.mjtCatBit.mjCAT_ALL)
        blank = mujoco.MjvCamera()
        mujoco.mjv_updateScene(self._model, self._data, self._option, None, blank, everything, self._scene)

    def _shoot(self, mode: str, size: tuple[int, int]) -> Any:
        with opengl_context.current(self._surface.gl):
            return self._rendered(mode, size)

    def _rendered(self, mode: str, size: tuple[int, int]) -> Any:
        fine = _SUPERSAMPLING if mode == "rgb" else 1
        width, height = size[0] * fine, size[1] * fine
        if (self._context.offWidth, self._context.offHeight) != (width, height):
            mujoco.mjr_resizeOffscreen(width, height, self._context)
        for flag in (mujoco.mjtRndFlag.mjRND_SEGMENT, mujoco.mjtRndFlag.mjRND_IDCOLOR):
            self._scene.flags[int(flag)] = mode == "segmentation"
        self._scene.flags[int(mujoco.mjtRndFlag.mjRND_SHADOW)] = mode == "rgb"
        area = mujoco.MjrRect(0, 0, width, height)
        mujoco.mjr_render(area, self._scene, self._context)
        if mode == "depth":
            return self._depth(area)
        pixels = np.empty((height, width, 3), np.uint8)
        mujoco.mjr_readPixels(pixels, None, area, self._context)
        return self._owners(pixels[::-1]) if mode == "segmentation" else _downsampled(pixels[::-1], fine)

    def _depth(self, area: Any) -> NDArray[np.float32]:
        buffer = np.empty((area.height, area.width), np.float32)
        mujoco.mjr_readPixels(None, buffer, area, self._context)
        near, far = _NEAR_M, _FAR_M
        depth = near / (1.0 - buffer[::-1].astype(np.float64) * (1.0 - near / far))
        return np.asarray(np.minimum(depth, projection.FAR_M), np.float32)

    def _owners(self, pixels: NDArray[np.uint8]) -> NDArray[np.int32]:
        """The number of each pixel's owner, -1 where nothing was drawn."""
        owner = np.full(1 << 16, -1, np.int32)
        for geom in self._scene.geoms[: self._scene.ngeom]:
            if geom.objtype == int(mujoco.mjtObj.mjOBJ_GEOM) and geom.segid >= 0:
                owner[geom.segid + 1] = self._numbers[geom.objid]
        wide = pixels.astype(np.int32)
        numbers: NDArray[np.int32] = owner[(wide[..., 0] + (wide[..., 1] << 8) + (wide[..., 2] << 16)) & 0xFFFF]
        return numbers


def _downsampled(pixels: NDArray[np.uint8], times: int) -> NDArray[np.uint8]:
    """Each block of ``times`` x ``times`` pixels replaced by one pixel of their mean colour."""
    height, width, channels = pixels.shape
    blocks = pixels.reshape(height // times, times, width // times, times, channels).sum(axis=(1, 3), dtype=np.uint16)
    return np.asarray((blocks + times * times // 2) // (times * times), np.uint8)


def place_at_eye(camera: Any, pose: Pose, spec: BodySpec, lens: Vec2) -> None:
    """Put the camera where the body's eye is; ``lens`` are the tangents of half its fields of view."""
    view = view_frustum.view_vector(pose, spec)
    _place(camera, view[:3], view[3:12].reshape(3, 3), lens)


def place_at_viewpoint(camera: Any, viewpoint: Viewpoint, size: tuple[int, int]) -> None:
    """Put the camera at a viewpoint, for pictures of ``size`` (width, height)."""
    _place(camera, viewpoint.eye, viewpoint.axes, viewpoint.tangents(size))


def _place(camera: Any, eye: Any, axes: Any, lens: Vec2) -> None:
    camera.pos, camera.forward, camera.up = eye, axes[0], axes[2]
    camera.orthographic, camera.frustum_center = 0, 0.0
    camera.frustum_near, camera.frustum_far = _NEAR_M, _FAR_M
    top = _NEAR_M * lens[1]
    camera.frustum_bottom, camera.frustum_top = -top, top
    camera.frustum_width = _NEAR_M * lens[0]


def place_above(camera: Any, bounds: tuple[float, float, float, float]) -> None:
    """Let the camera look straight down on the area x0, y0, x1, y1 [m], north up."""
    x0, y0, x1, y1 = bounds
    camera.pos, camera.forward, camera.up = ((x0 + x1) / 2, (y0 + y1) / 2, _ABOVE_M), (0, 0, -1), (0, 1, 0)
    camera.orthographic = 1
    camera.frustum_center, camera.frustum_width = 0.0, (x1 - x0) / 2
    camera.frustum_bottom, camera.frustum_top = -(y1 - y0) / 2, (y1 - y0) / 2
    camera.frustum_near, camera.frustum_far = _NEAR_M, _FAR_M
