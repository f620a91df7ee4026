"""Finds an OpenGL back end that works, with or without a display.

Without a graphics card, Mesa starts a drawing thread for every core. With one process per core, set
``LP_NUM_THREADS=0`` so that these threads do not compete.
"""

import contextlib
import importlib
import os
import sys
import warnings
from collections.abc import Container, Iterator
from typing import Any

from hthor.errors import RenderingUnavailable

CODE_PART = "pictures"

_VARIABLE = "MUJOCO_GL"
_PLATFORM = "PYOPENGL_PLATFORM"
_BACKENDS = ("egl", "osmesa", "glfw")
_CURE = (
    "On Debian or Ubuntu run 'apt-get install libegl1 libgl1-mesa-dri' (or 'libosmesa6'), or set MUJOCO_GL to the "
    "back end that you have: egl, osmesa or glfw. Only pictures in the profile nice need it; fast draws without."
)


def context(width: int, height: int) -> Any:
    """An off-screen context, made current: EGL, else OSMesa, else a hidden window; or the one that MUJOCO_GL names.

    Raises:
        RenderingUnavailable: when no back end works; the message says which were tried and what to install.
    """
    wanted = os.environ.get(_VARIABLE, "").strip().lower()
    order = (wanted,) if wanted in _BACKENDS else _BACKENDS
    failures = []
    loaded = frozenset(sys.modules)
    for name in order:
        try:
            return _open(name, width, height)
        except Exception as error:  # every back end raises other errors
            failures.append(f"{name}: {str(error).splitlines()[0] if str(error) else type(error).__name__}")
            _forget(loaded)
    raise RenderingUnavailable(f"no OpenGL back end could draw ({'; '.join(failures)}). {_CURE}")


@contextlib.contextmanager
def current(context: Any) -> Iterator[None]:
    """Make ``context`` the current one of this thread, and none afterwards: it can be current in one thread only."""
    context.make_current()
    try:
        yield
    finally:
        _release(context)


def _release(context: Any) -> None:
    backend = sys.modules[type(context).__module__]
    name = backend.__name__.rpartition(".")[2]
    if name == "egl":
        nothing = backend.EGL.EGL_NO_SURFACE, backend.EGL.EGL_NO_SURFACE, backend.EGL.EGL_NO_CONTEXT
        backend.EGL.eglMakeCurrent(backend.EGL_DISPLAY, *nothing)
    elif name == "osmesa":
        backend.osmesa.OSMesaMakeCurrent(None, None, backend.GL.GL_FLOAT, 0, 0)
    else:
        backend.glfw.make_context_current(None)


@contextlib.contextmanager
def named(context: Any) -> Iterator[None]:
    """Make the engine load its OpenGL functions from the library that ``context`` comes from."""
    before = os.environ.get(_VARIABLE)
    os.environ[_VARIABLE] = type(context).__module__.rpartition(".")[2]
    try:
        yield
    finally:
        if before is None:
            del os.environ[_VARIABLE]
        else:
            os.environ[_VARIABLE] = before


def _open(name: str, width: int, height: int) -> Any:
    if name == "glfw" and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        raise RuntimeError("there is no display")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        context = importlib.import_module(f"mujoco.{name}").GLContext(width, height)
        context.make_current()
    return context


def _forget(loaded: Container[str]) -> None:
    """Undo a failed import, because PyOpenGL chooses its platform once, at its first import.

    Modules that were ``loaded`` before belong to the user's program and stay.
    """
    if os.environ.get(_PLATFORM) in _BACKENDS and _PLATFORM not in _given:
        del os.environ[_PLATFORM]
    ours = ("OpenGL", *(f"mujoco.{name}" for name in _BACKENDS))
    for module in [name for name in sys.modules if name not in loaded]:
        if any(module == package or module.startswith(f"{package}.") for package in ours):
            del sys.modules[module]


_given = frozenset({_PLATFORM} & set(os.environ))
"""PyOpenGL's environment variable if the user has set it; it is then left unchanged."""
