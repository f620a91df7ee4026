"""Importing hthor leaves MuJoCo's and dm_control's own rendering as it is."""

from __future__ import annotations

import functools
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

BALL = '<mujoco><worldbody><light pos="0 0 3"/><geom size=".3" rgba="1 0 0 1"/></worldbody></mujoco>'
MUJOCO = f"""
import mujoco
model = mujoco.MjModel.from_xml_string('{BALL}')
data = mujoco.MjData(model)
mujoco.mj_forward(model, data)
renderer = mujoco.Renderer(model, 48, 64)
renderer.update_scene(data)
print(renderer.render().shape, int(renderer.render().sum()))
"""
DM_CONTROL = f"""
from dm_control import mujoco as dm
print(dm.Physics.from_xml_string('{BALL}').render(48, 64).sum())
"""
WORLD = """
import world_house
from hthor.world import World
world = World(world_house.house())
"""
NICE = 'print(world.human.rgb((8, 8), profile="nice").shape)'
SUPPORT = Path(__file__).parents[2] / "support"
OURS, THEIRS = "import hthor.world.world", "import mujoco, dm_control.mujoco"


def run(*parts: str, backend: str | None = "egl") -> str:
    """What a fresh process prints; its complaint when it fails."""
    given = {name: value for name, value in os.environ.items() if name not in ("MUJOCO_GL", "PYOPENGL_PLATFORM")}
    given["PYTHONPATH"] = os.pathsep.join([str(SUPPORT), given.get("PYTHONPATH", "")])
    environment = given | ({} if backend is None else {"MUJOCO_GL": backend})
    command = [sys.executable, "-c", "\n".join(parts)]
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run(command, env=environment, cwd=folder, capture_output=True, text=True, timeout=300)
    return done.stdout if done.returncode == 0 else f"failed: {done.stderr.strip().splitlines()[-1]}"


@functools.cache
def alone(*parts: str) -> str:
    """What they print without hthor; skips where that does not work."""
    found = run(*parts)
    if found.startswith("failed"):
        pytest.skip(f"EGL does not draw on this machine: {found[:120]}")
    return found


@pytest.mark.parametrize(
    "imports",
    [
        pytest.param((THEIRS, OURS), id="after"),
        # at each commit, the two tests below import ours first and draw as well
        pytest.param((OURS, THEIRS), id="before", marks=pytest.mark.nightly),
    ],
)
@pytest.mark.parametrize(
    "parts",
    [
        pytest.param((MUJOCO, DM_CONTROL), id="both"),
        pytest.param((MUJOCO,), id="mujoco", marks=pytest.mark.nightly),
        pytest.param((DM_CONTROL,), id="dm_control", marks=pytest.mark.nightly),
    ],
)
def test_rendering_works_whichever_is_imported_first(parts: tuple[str, ...], imports: tuple[str, str]) -> None:
    assert run(*imports, *parts) == alone(*parts)


@pytest.mark.nightly  # at each commit, the test above draws theirs beside our imports, and others draw ours
def test_rendering_works_beside_pictures_of_our_own() -> None:
    theirs = alone(MUJOCO, DM_CONTROL)
    assert run(WORLD, NICE, MUJOCO, DM_CONTROL, NICE) == f"(8, 8, 3)\n{theirs}(8, 8, 3)\n"


def test_the_back_end_is_chosen_at_first_use() -> None:
    late = "import os; os.environ['MUJOCO_GL'] = 'egl'"
    assert run(OURS, late, MUJOCO, DM_CONTROL, backend=None) == alone(MUJOCO, DM_CONTROL)


def test_nobody_is_asked_for_a_display_meanwhile() -> None:
    question = "import sys; print([name for name in sys.modules if name.split('.')[0] in ('OpenGL', 'glfw')])"
    assert run(OURS, question) == "[]\n"


def test_opengl_that_was_switched_off_stays_off() -> None:
    question = "import mujoco; print(hasattr(mujoco, 'GLContext'))"
    assert run(OURS, question, backend="disable") == run(question, backend="disable") == "False\n"
