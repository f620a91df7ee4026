"""The names and sizes by which users choose a robot's camera."""

import math
import re

from hthor.errors import HthorError, UnknownName
from hthor.types import CameraSpec

OWN = "own"
"""The camera that the robot's body declares."""
LARGEST = 4096
"""Longest side of a picture [pixels]."""
NAMED = {
    spec.name: spec
    for spec in (
        CameraSpec(name="square", size=(128, 128), fov=math.radians(90.0)),
        CameraSpec(name="thor", size=(300, 300), fov=math.radians(90.0)),  # AI2-THOR's default
        CameraSpec(name="habitat", size=(640, 480), fov=math.radians(79.0)),  # Habitat's ObjectNav challenge
        CameraSpec(name="realsense", size=(640, 360), fov=math.radians(69.4)),  # Intel RealSense D435, colour
    )
}
_SIZE = re.compile(r"([1-9][0-9]{0,4})x([1-9][0-9]{0,4})")
_EXAMPLE = "Expected WIDTHxHEIGHT in pixels, such as 320x240"


def parse(text: str) -> CameraSpec:
    """The camera with a name ("own" or one of `NAMED`), with a size ("320x240"), or with both ("thor:128x128").

    Raises:
        HthorError: when the text is none of these.
    """
    name, colon, size = text.partition(":")
    if not colon and _SIZE.fullmatch(name):
        name, size = OWN, name
    if name != OWN and name not in NAMED:
        raise UnknownName("camera", name, (OWN, *NAMED), "A size may follow: own:320x240.")
    spec = NAMED.get(name, CameraSpec(name=OWN))
    if not size and not colon:
        return spec
    width, height = _size(size)
    return CameraSpec(name=f"{name}:{width}x{height}", size=(width, height), fov=spec.fov)


def canonical_name(name: str, size: str = "") -> str:
    """The canonical spelling of a camera's name and size.

    Args:
        name: a text that `parse` reads. size: such as "320x240"; empty for the camera's own size.

    Raises:
        HthorError: when `parse` raises it, or when ``name`` and ``size`` both give a size.
    """
    if size and (":" in name or _SIZE.fullmatch(name)):
        raise HthorError(f"the camera '{name}' has a size already; leave out the size '{size}'.")
    return parse(f"{name}:{size}" if size else name).name


def _size(text: str) -> tuple[int, int]:
    found = _SIZE.fullmatch(text)
    if found is None:
        raise HthorError(f"'{text}' is not a picture size. {_EXAMPLE}.")
    width, height = int(found[1]), int(found[2])
    if max(width, height) > LARGEST:
        raise HthorError(f"pictures of {text} are too large: at most {LARGEST} pixels a side. {_EXAMPLE}.")
    return (width, height)
