"""OpenGL in a process: one picture is drawn at a time, and nothing is used or freed that a parent process made.

A driver's threads are not in a forked process, so whatever waits for them there waits for ever. And a picture must not
be disturbed by the garbage collector, which may run while it is drawn and find another world's renderer.
"""

import atexit
import contextlib
import ctypes
import sys
import threading
from collections import deque
from collections.abc import Iterator
from typing import Any

from hthor.errors import RenderingUnavailable
from hthor.world.model.engine import mujoco
from hthor.world.rendering import forks, opengl_context

CODE_PART = "pictures"

_FORKED = (
    "this process was forked from one that had drawn with OpenGL, which does not survive a fork. Start processes with "
    'multiprocessing.get_context("spawn"), or draw the first picture of the profile nice after the fork; fast draws in '
    "forked processes too."
)


class Surface:
    """An OpenGL context with what the engine keeps in it for one model: its meshes, textures and shadows.

    It is made, used and freed in an `OpenGLProcess.turn`.

    Raises:
        RenderingUnavailable: when no OpenGL back end works.
    """

    def __init__(self, model: Any) -> None:
        self.gl = opengl_context.context(64, 64)
        with opengl_context.current(self.gl), opengl_context.named(self.gl):
            self.context = mujoco.MjrContext(model, int(mujoco.mjtFontScale.mjFONTSCALE_100))
            mujoco.mjr_setBuffer(int(mujoco.mjtFramebuffer.mjFB_OFFSCREEN), self.context)

    def free(self) -> None:
        """Release the graphics memory."""
        with opengl_context.current(self.gl):
            self.context.free()
        self.gl.free()

    def abandon(self) -> None:
        """Keep everything for ever, so that nothing frees it."""
        for one in (self.gl, self.context):
            ctypes.pythonapi.Py_IncRef(ctypes.py_object(one))


class OpenGLProcess:
    """The surfaces of this process."""

    def __init__(self) -> None:
        self._turn = threading.Lock()
        self._surfaces: set[Surface] = set()
        self._discarded: deque[Surface] = deque()
        self._inherited = False
        forks.watch(self)

    def check(self) -> None:
        """Raise RenderingUnavailable in a process that was forked from one that had drawn."""
        if self._inherited:
            raise RenderingUnavailable(_FORKED)

    @contextlib.contextmanager
    def turn(self) -> Iterator[None]:
        """Wait until no other thread draws; until the end of the block none does.

        Raises:
            RenderingUnavailable: in a process that was forked from one that had drawn.
        """
        self.check()
        with self._turn:
            self._free_discarded()
            yield
        self._sweep()

    def open(self, model: Any) -> Surface:
        """A surface for the pictures of a model."""
        surface = Surface(model)
        if not self._surfaces:
            atexit.unregister(self._close)
            atexit.register(self._close)  # registered after the back end's own exit handler, so it runs before that
        self._surfaces.add(surface)
        return surface

    def discard(self, surface: Surface) -> None:
        """Free a surface: now if nothing is drawn, else after that. The garbage collector may call this at any time."""
        self._discarded.append(surface)
        self._sweep()

    def forked(self) -> None:
        """Leave alone what the parent made."""
        if self._surfaces or _drawn_by_others():
            self._inherited = True
        for surface in self._surfaces:
            surface.abandon()
        if self._surfaces:
            atexit.unregister(self._close)
            _stay_initialized()
        self._surfaces, self._discarded, self._turn = set(), deque(), threading.Lock()

    def _sweep(self) -> None:
        while self._discarded and self._turn.acquire(blocking=False):
            try:
                self._free_discarded()
            finally:
                self._turn.release()

    def _free_discarded(self) -> None:
        with contextlib.suppress(IndexError):
            while True:
                self._free(self._discarded.popleft())

    def _free(self, surface: Surface) -> None:
        if surface in self._surfaces:
            self._surfaces.remove(surface)
            surface.free()

    def _close(self) -> None:
        for surface in tuple(self._surfaces):
            self.discard(surface)


def _drawn_by_others() -> bool:
    """Whether the program has drawn with MuJoCo's own renderer through EGL."""
    egl = sys.modules.get("mujoco.egl")
    return egl is not None and getattr(egl, "EGL_DISPLAY", None) is not None


def _stay_initialized() -> None:
    """Forget the exit handler by which MuJoCo ends EGL: in a forked process it would wait for the driver's threads."""
    egl = sys.modules.get("mujoco.egl")
    if egl is not None:
        atexit.unregister(egl.EGL.eglTerminate)


PROCESS = OpenGLProcess()
"""A driver has one state in each process, so there is one record of it."""
