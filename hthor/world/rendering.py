"""Pictures through OpenGL, drawn only when asked for: colour, depth, segmentation, and the house from above.

It draws copied moments on a copy of the model, so a picture never touches the world; knows nothing of seats' doings.
"""

from __future__ import annotations

import atexit
import copy
import math
import weakref
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hthor.types import BodySpec, Pose
from hthor.world import geoms, opengl, sight
from hthor.world.engine import mujoco
from hthor.world.moment import Moment
from hthor.world.scene import Scene

_NEAR_M, _FAR_M = 0.02, 80.0
_ABOVE_M = 20.0
_FAR_AWAY = (0.0, 0.0, -100.0)
_MODES = ("rgb", "depth", "segmentation")


class Studio:
    """Draws moments of one world.

    Raises:
        RenderingUnavailable: when no OpenGL back end works.
    """

    def __init__(self, model: Any, scene: Scene) -> None:
        self._model = copy.copy(model)
        self._model.opt.enableflags &= ~int(mujoco.mjtEnableBit.mjENBL_SLEEP)
        self._data = mujoco.MjData(self._model)
        self._numbers = scene.numbers
        self._gl = opengl.context(64, 64)
        with opengl.named(self._gl):
            self._context = mujoco.MjrContext(self._model, int(mujoco.mjtFontScale.mjFONTSCALE_100))
        mujoco.mjr_setBuffer(int(mujoco.mjtFramebuffer.mjFB_OFFSCREEN), self._context)
        self._scene = mujoco.MjvScene(self._model, maxgeom=self._model.ngeom + 64)
        self._option = mujoco.MjvOption()

        self.close = weakref.finalize(self, _free, self._gl, self._context)
        """Gives the graphics memory back."""
        self.close.atexit = False
        atexit.register(self.close)  # registered after the back end's own farewell, so it runs before it

    def view(self, moment: Moment, seat: str, mode: str, size: tuple[int, int]) -> Any:
        """What ``seat`` sees: rgb (H, W, 3) uint8, depth (H, W) float32 [m] or segmentation (H, W) int32."""
        if mode not in _MODES:
            raise ValueError(f"mode must be one of {', '.join(_MODES)}, got '{mode}'")
        pose, spec = moment.seats[seat]
        self._pose(moment, without=seat)
        self._compose(_lamp(pose, spec), ceilings=True)
        for camera in self._scene.camera:
            _aim(camera, pose, spec)
        return self._shoot(mode, size)

    def top_view(self, moment: Moment, bounds: tuple[float, float, float, float], pixels_per_metre: float) -> Any:
        """The area x0, y0, x1, y1 [m] from straight above without ceilings, (H, W, 3) uint8."""
        x0, y0, x1, y1 = bounds
        self._pose(moment)
        self._compose(_lamp(Pose(x=x0, y=y0, yaw=math.pi / 2, pitch=-math.pi / 2)), ceilings=False)
        for camera in self._scene.camera:
            camera.pos, camera.forward, camera.up = ((x0 + x1) / 2, (y0 + y1) / 2, _ABOVE_M), (0, 0, -1), (0, 1, 0)
            camera.orthographic = 1
            camera.frustum_center, camera.frustum_width = 0.0, (x1 - x0) / 2
            camera.frustum_bottom, camera.frustum_top = -(y1 - y0) / 2, (y1 - y0) / 2
            camera.frustum_near, camera.frustum_far = _NEAR_M, _FAR_M
        return self._shoot("rgb", (round((x1 - x0) * pixels_per_metre), round((y1 - y0) * pixels_per_metre)))

    def _pose(self, moment: Moment, without: str = "") -> None:
        """Everything where it was; the viewer's own body is out of the picture."""
        self._data.qpos[:] = moment.qpos
        for index, (name, (pose, _)) in enumerate(moment.seats.items()):
            self._data.mocap_pos[index] = _FAR_AWAY if name == without else (pose.x, pose.y, 0.0)
            self._data.mocap_quat[index] = geoms.quaternion(pose.yaw)
        mujoco.mj_kinematics(self._model, self._data)
        mujoco.mj_camlight(self._model, self._data)

    def _compose(self, lamp: Any, ceilings: bool) -> None:
        shown = {geoms.FURNITURE, geoms.WALLS, geoms.OBJECTS, geoms.BODIES} | ({geoms.CEILINGS} if ceilings else set())
        self._option.geomgroup[:] = [group in shown for group in range(6)]
        everything = int(mujoco.mjtCatBit.mjCAT_ALL)
        mujoco.mjv_updateScene(self._model, self._data, self._option, None, lamp, everything, self._scene)

    def _shoot(self, mode: str, size: tuple[int, int]) -> Any:
        width, height = size
        self._gl.make_current()
        if (self._context.offWidth, self._context.offHeight) != size:
            mujoco.mjr_resizeOffscreen(width, height, self._context)
        for flag in (mujoco.mjtRndFlag.mjRND_SEGMENT, mujoco.mjtRndFlag.mjRND_IDCOLOR):
            self._scene.flags[int(flag)] = mode == "segmentation"
        area = mujoco.MjrRect(0, 0, width, height)
        mujoco.mjr_render(area, self._scene, self._context)
        if mode == "depth":
            return self._depth(area)
        pixels = np.empty((height, width, 3), np.uint8)
        mujoco.mjr_readPixels(pixels, None, area, self._context)
        pixels = np.ascontiguousarray(pixels[::-1])
        return self._owners(pixels) if mode == "segmentation" else pixels

    def _depth(self, area: Any) -> NDArray[np.float32]:
        buffer = np.empty((area.height, area.width), np.float32)
        mujoco.mjr_readPixels(None, buffer, area, self._context)
        depth = _NEAR_M / (1.0 - buffer[::-1].astype(np.float64) * (1.0 - _NEAR_M / _FAR_M))
        return np.asarray(depth, np.float32)

    def _owners(self, pixels: NDArray[np.uint8]) -> NDArray[np.int32]:
        """The number of each pixel's owner, -1 where nothing was drawn."""
        owner = np.full(1 << 16, -1, np.int32)
        for geom in self._scene.geoms[: self._scene.ngeom]:
            if geom.objtype == int(mujoco.mjtObj.mjOBJ_GEOM) and geom.segid >= 0:
                owner[geom.segid + 1] = self._numbers[geom.objid]
        wide = pixels.astype(np.int32)
        numbers: NDArray[np.int32] = owner[(wide[..., 0] + (wide[..., 1] << 8) + (wide[..., 2] << 16)) & 0xFFFF]
        return numbers


def _free(gl: Any, context: Any) -> None:
    gl.make_current()
    context.free()
    gl.free()


def _lamp(pose: Pose, spec: BodySpec | None = None) -> Any:
    """The engine's own camera at a pose: it carries the headlight."""
    lamp = mujoco.MjvCamera()
    lamp.lookat[:] = (pose.x, pose.y, _ABOVE_M if spec is None else spec.eye)
    lamp.distance, lamp.azimuth, lamp.elevation = 0.01, math.degrees(pose.yaw), math.degrees(pose.pitch)
    return lamp


def _aim(camera: Any, pose: Pose, spec: BodySpec) -> None:
    view = sight.camera(pose, spec)
    camera.pos, camera.forward, camera.up = view[:3], view[3:6], view[9:12]
    camera.orthographic, camera.frustum_center = 0, 0.0
    camera.frustum_near, camera.frustum_far = _NEAR_M, _FAR_M
    top = _NEAR_M * math.tan(spec.fov[1] / 2)
    camera.frustum_bottom, camera.frustum_top = -top, top
    camera.frustum_width = _NEAR_M * math.tan(spec.fov[0] / 2)
