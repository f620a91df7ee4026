"""The renderers of the profile ``nice`` in a process: as many as fit, for the worlds that drew last."""

from __future__ import annotations

import contextlib
import weakref
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

from hthor.world.rendering.opengl_process import PROCESS

if TYPE_CHECKING:
    from hthor.world.rendering.opengl_renderer import OpenGLRenderer

CODE_PART = "pictures"

RENDERERS_MAX = 12
"""The most renderers at a time. Each takes about 100 MB, and making one again takes three times as long as a picture;
our choice, so that the ten scenes that ship fit.
"""


class RendererSlot:
    """Holds the renderer of one world, which is made when a picture needs it and may be freed between two pictures.

    Args:
        make: makes the renderer.
    """

    def __init__(self, make: Callable[[], OpenGLRenderer]) -> None:
        self._make = make
        self._renderer: OpenGLRenderer | None = None

    @contextlib.contextmanager
    def drawing(self) -> Iterator[OpenGLRenderer]:
        """The renderer, which no other thread uses until the end of the block.

        Raises:
            RenderingUnavailable: when no OpenGL back end works, or the process was forked from one that had drawn.
        """
        with PROCESS.turn():
            if self._renderer is None:
                _make_room()
                self._renderer = self._make()
            _note_use(self)
            yield self._renderer

    def free(self) -> None:
        """Free the renderer; the next picture makes a new one."""
        self._renderer = None


_filled: list[weakref.ref[RendererSlot]] = []  # the slot used last is last; changed in a turn only


def _note_use(slot: RendererSlot) -> None:
    _filled[:] = [one for one in _filled if (held := one()) is not None and held is not slot and held._renderer]
    _filled.append(weakref.ref(slot))


def _make_room() -> None:
    """Free the renderers that were not used for the longest time, so that one more fits."""
    full = [slot for one in _filled if (slot := one()) is not None and slot._renderer]
    for slot in full[: max(0, len(full) + 1 - RENDERERS_MAX)]:
        slot.free()
