"""MuJoCo and dm_control choose their OpenGL back end when a program first draws with it, not when they are imported.

Both choose at import, by MUJOCO_GL, and complain where there is no display. `engine` imports them with OpenGL switched
off; what is here lets them choose after all, by the environment as it is then, for programs that use them
together with hthor. Our own pictures do without, see `opengl`.
"""

import importlib
from collections.abc import Callable, Sequence
from types import ModuleType
from typing import Any

CODE_PART = "pictures"

_MUJOCO = "mujoco.rendering.classic.gl_context"
_DM_CONTROL = "dm_control._render"


def choose_later(loaded: Sequence[str]) -> None:
    """Undo that the packages were imported with OpenGL switched off.

    Args:
        loaded: names of the modules that were there before; what they chose stays.
    """
    if _MUJOCO not in loaded:
        chooser = importlib.import_module(_MUJOCO)
        _reload_for(chooser, "GLContext")
        for name in ("mujoco", "mujoco.gl_context"):  # which have it from there
            _answer(importlib.import_module(name), ("GLContext",), lambda wanted: getattr(chooser, wanted))
    if _DM_CONTROL not in loaded:
        _reload_for(importlib.import_module(_DM_CONTROL), "Renderer", "BACKEND", "USING_GPU")


def _reload_for(module: ModuleType, *names: str) -> None:
    """Take ``names`` out of a module; it is run again when one of them is asked for."""
    for name in names:
        vars(module).pop(name, None)

    def answer(wanted: str) -> Any:
        importlib.reload(module)
        return vars(module)[wanted] if wanted in vars(module) else _missing(module, wanted)

    _answer(module, names, answer)


def _answer(module: ModuleType, names: Sequence[str], answer: Callable[[str], Any]) -> None:
    """Let ``answer`` say what a module's ``names`` are that are not in it."""

    def attribute(wanted: str) -> Any:
        return answer(wanted) if wanted in names else _missing(module, wanted)

    vars(module)["__getattr__"] = attribute


def _missing(module: ModuleType, name: str) -> Any:
    raise AttributeError(f"module '{module.__name__}' has no attribute '{name}'")
