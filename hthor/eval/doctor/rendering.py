"""Checks that robots' frames and people's pictures can be drawn; run as a script, it draws both."""

import os
import sys
from collections.abc import Iterator

from msgspec import Struct

from hthor.eval.doctor.check_result import CheckResult

_SIZE = (64, 64)
_HOUSE = "alder"
_CURE = "sudo apt-get install libegl1 libgl1-mesa-dri || sudo apt-get install libosmesa6"


class RenderingProbe(Struct, frozen=True, kw_only=True):
    """How many colours each profile's picture has, 0 for none; the OpenGL back end, or why there is none."""

    fast: int = 0
    nice: int = 0
    backend: str = ""
    reason: str = ""


def check_rendering(drawn: RenderingProbe | str) -> list[CheckResult]:
    """Check the frames that the process rendered."""
    if isinstance(drawn, str):
        says = f"the process that draws a frame failed: {drawn}"
        return [CheckResult(name="pictures", status="fail", says=says, fix=f"{_CURE}; or MUJOCO_GL=osmesa")]
    camera = CheckResult(name="robot's camera", says=f"draws a frame of {drawn.fast} colours, without OpenGL")
    if drawn.fast <= 1:
        fix = "pip install --force-reinstall hthor"
        camera = CheckResult(name="robot's camera", status="fail", says="its frame is blank", fix=fix)
    opengl = CheckResult(name="OpenGL", says=f"{drawn.backend} draws a frame of {drawn.nice} colours")
    if drawn.nice <= 1:
        why = drawn.reason or f"the frame that {drawn.backend} draws is blank"
        says = f"{why} (only pictures in the profile nice need it)"
        opengl = CheckResult(name="OpenGL", status="warn", says=says, fix=_CURE)
    return [camera, opengl]


def render_frames() -> Iterator[RenderingProbe]:
    """Draw a frame in each profile, and report after each frame, as a driver may crash the process."""
    from hthor.errors import RenderingUnavailable
    from hthor.world import World
    from hthor.world.rendering import opengl_context

    world = World(_HOUSE, robots=["scout"])
    fast = _colours(world.robot.rgb(_SIZE))
    yield RenderingProbe(fast=fast, reason="the process that draws a frame with OpenGL crashed")
    try:
        context = opengl_context.context(*_SIZE)
        backend = type(context).__module__.rpartition(".")[2]
        context.free()
        nice = _colours(world.robot.rgb(_SIZE, profile="nice"))
    except RenderingUnavailable as error:
        yield RenderingProbe(fast=fast, reason=str(error).partition(". ")[0])
    else:
        yield RenderingProbe(fast=fast, nice=nice, backend=backend)


def _colours(picture: object) -> int:
    import numpy as np

    return len(np.unique(np.asarray(picture).reshape(-1, 3), axis=0))


if __name__ == "__main__":
    from hthor import jsonio

    for drawn in render_frames():
        sys.stdout.write(jsonio.canonical(drawn).decode() + "\n")
        sys.stdout.flush()
    os._exit(0)  # some drivers crash when they are unloaded, after all work is done
