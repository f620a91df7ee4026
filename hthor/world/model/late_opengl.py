"""Lets MuJoCo and dm_control choose their OpenGL back end when a program first draws with it, not on import.

Both normally choose on import, by MUJOCO_GL, and warn if there is no display. `engine` imports them with OpenGL
switched off. This module lets them choose later, by the environment at that time, for programs that use them together
with hthor. Our own pictures do not need this, see `hthor.world.rendering.opengl_context`.
"""

import importlib
from collections.abc import Callable, Sequence
from types import ModuleType
from typing import Any

CODE_PART = "pictures"

_MUJOCO = "mujoco.rendering.classic.gl_context"
_DM_CONTROL = "dm_control._render"


def choose_later(loaded: Sequence[str]) -> None:
    """Let the packages that were imported with OpenGL switched off choose a back end when they are used.

    Args:
        loaded: names of the modules that were imported before hthor; they keep the back end that they chose.
    """
    if _MUJOCO not in loaded:
        chooser = importlib.import_module(_MUJOCO)
        _reload_for(chooser, "GLContext")
        for name in ("mujoco", "mujoco.gl_context"):  # they import it from that module
            _answer(importlib.import_module(name), ("GLContext",), lambda wanted: getattr(chooser, wanted))
    if _DM_CONTROL not in loaded:
        _reload_for(importlib.import_module(_DM_CONTROL), "Renderer", "BACKEND", "USING_GPU")


def _reload_for(module: ModuleType, *names: str) -> None:
    """Remove ``names`` from a module; the first access to one of them runs the module again."""
    for name in names:
        vars(module).pop(name, None)

    def answer(wanted: str) -> Any:
        importlib.reload(module)
        return vars(module)[wanted] if wanted in vars(module) else _missing(module, wanted)

    _answer(module, names, answer)


def _answer(module: ModuleType, names: Sequence[str], answer: Callable[[str], Any]) -> None:
    """Let ``answer`` supply those of ``names`` that are missing in the module."""

    def attribute(wanted: str) -> Any:
        return answer(wanted) if wanted in names else _missing(module, wanted)

    vars(module)["__getattr__"] = attribute


def _missing(module: ModuleType, name: str) -> Any:
    raise AttributeError(f"module '{module.__name__}' has no attribute '{name}'")
