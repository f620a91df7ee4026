"""Writes frames to a video file: VP8 in WebM, which browsers play and OpenCV's own FFmpeg writes.

The same frames give the same bytes.
"""

import contextlib
import os
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import cv2

from hthor.console import progress_bar
from hthor.errors import HthorError

HOLD_S = 2
"""How long the last frame stays [s]."""
_TRACK_UID, _TAG_UID, _FIXED_UID = b"\x73\xc5\x88", b"\x63\xc5\x88", bytes(range(1, 9))


def write_webm(path: Path, frames: Iterable[Any], count: int, size: tuple[int, int], rate: float) -> None:
    """Write a video, with a progress bar on a terminal.

    Args:
        frames: (H, W, 3) uint8 each, blue first. count: how many there are.
        size: width and height of a frame [pixels]. rate: frames per second.

    Raises:
        HthorError: if the OpenCV on this machine cannot write such a video to ``path``.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    with _without_ffmpeg_notes():
        film = cv2.VideoWriter(str(path), cv2.CAP_FFMPEG, cv2.VideoWriter.fourcc(*"VP80"), rate, size)
    if not film.isOpened():
        raise HthorError(f"{path}: cannot write a video there; is the folder writable, and does the name end in .webm?")
    frame = None
    for frame in progress_bar.watched(frames, path.name, count, "frames"):
        film.write(frame)
    for _ in range(round(HOLD_S * rate) if frame is not None else 0):
        film.write(frame)
    film.release()
    _fix_track_number(path)


@contextlib.contextmanager
def _without_ffmpeg_notes() -> Iterator[None]:
    """Suppress FFmpeg's text on standard error: FFmpeg reports every codec name in WebM as a mistake."""
    sys.stderr.flush()
    kept = os.dup(2)
    try:
        with open(os.devnull, "wb") as null:
            os.dup2(null.fileno(), 2)
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)


def _fix_track_number(path: Path) -> None:
    """Replace the random number that FFmpeg gives to a video's track, in the track's header and in references to it."""
    data = path.read_bytes()
    at = data.find(_TRACK_UID)
    if at < 0:
        return
    drawn = data[at + len(_TRACK_UID) :][: len(_FIXED_UID)]
    for name in (_TRACK_UID, _TAG_UID):
        data = data.replace(name + drawn, name + _FIXED_UID, 1)
    path.write_bytes(data)
