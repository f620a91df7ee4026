"""Pictures of houses for people: four views and a plan on one sheet each, ``python -m
hthor.world.rendering.contact_sheet HOUSE...``.

Each view is the best of many places and directions that are tried in a room: the one that shows most of its things.
The same house gives the same sheet.
"""

import argparse
import math
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import cv2
import msgspec
import numpy as np

from hthor import houses
from hthor.errors import HthorError
from hthor.geometry import plane
from hthor.houses.space.free_space import FreeSpace
from hthor.looks import pack as packs
from hthor.looks.pack import Pack
from hthor.types import HUMAN, HouseSpec, Pose, Room
from hthor.world.model import inventory
from hthor.world.model.bodies import avatar
from hthor.world.model.composer_env import LazyComposerEnv
from hthor.world.model.composer_task import HouseTask
from hthor.world.model.geom_index import GeomIndex
from hthor.world.rendering.camera import PoseSnapshot
from hthor.world.rendering.opengl_renderer import OpenGLRenderer

VIEW = (480, 360)
"""Width and height of a view [pixels]."""
_LENS = msgspec.structs.replace(avatar.HUMAN, fov=(2.0 * math.atan(math.tan(0.56) * VIEW[0] / VIEW[1]), 1.12))
_GLANCE = (64, 48)
_PLACES, _TURNS, _TILT = 16, 10, -0.2
"""About how many places are tried in a room, how many directions at each place, and the camera's pitch [rad]."""
_CLEAR_M = 0.3
"""[m] Viewers stand this far from all obstacles, a little more than a body needs."""
_NEAR_M = 1.1
"""[m] Things nearer than this to the eye spoil a view."""
_GAP, _BAR = 6, 24
_PAPER, _INK = 250, (60, 55, 50)
_ORDER = ("kitchen", "living_room", "bedroom", "bathroom")


class Shot(NamedTuple):
    """A view of a room and how much it shows."""

    worth: float
    room: Room
    pose: Pose


class Photographer:
    """Takes pictures of a house as it stands, with nobody in it.

    Raises:
        RenderingUnavailable: when no OpenGL back end works.
    """

    def __init__(self, house: HouseSpec, pack: Pack | None = None) -> None:
        self.house = house
        seats = {HUMAN: _LENS}
        split = inventory.split_things(house, ())
        task = HouseTask(house, split, seats)
        env = LazyComposerEnv(task)
        env.begin()
        scene = GeomIndex(env, task)
        self._names, self._qpos = scene.names, env.data.qpos.copy()
        self._studio = OpenGLRenderer(house, split, seats, env.model, scene, pack)
        self._rooms = {thing.id: thing.room for thing in house.things}

    def view(self, pose: Pose, size: tuple[int, int] = VIEW, mode: str = "rgb") -> Any:
        """The view of a person at ``pose`` with the field of view of a sheet, see `OpenGLRenderer.view`."""
        return self._studio.view(PoseSnapshot(self._qpos, {HUMAN: (pose, _LENS)}), HUMAN, mode, size)

    def plan(self, pixels_per_metre: float) -> Any:
        """The house from above, (H, W, 3) uint8."""
        corners = np.array([corner for room in self.house.rooms for corner in room.polygon])
        (x0, y0), (x1, y1) = (corners.min(0) - 0.3).tolist(), (corners.max(0) + 0.3).tolist()
        away = Pose(x=x0 - 50.0, y=y0 - 50.0)
        return self._studio.top_view(
            PoseSnapshot(self._qpos, {HUMAN: (away, _LENS)}), (x0, y0, x1, y1), pixels_per_metre
        )

    def shots(self, room: Room) -> list[Shot]:
        """Views of a room, the best first; equally good views in the order in which they were found."""
        found = [Shot(self._worth(pose, room), room, pose) for pose in _poses(self.house, room)]
        return sorted(found, key=lambda shot: -shot.worth)

    def _worth(self, pose: Pose, room: Room) -> float:
        """A score of how many of the room's things are seen and how well; lower if something is close to the eye."""
        numbers, counts = np.unique(self.view(pose, _GLANCE, "segmentation"), return_counts=True)
        total = 0.0
        for number, count in zip(numbers.tolist(), counts.tolist(), strict=True):
            if number >= 0 and self._rooms.get(self._names[number]) == room.id:
                total += min(1.0, math.sqrt(count / (_GLANCE[0] * _GLANCE[1]) / 0.08))
        depth = self.view(pose, _GLANCE, "depth")
        near = float((depth < _NEAR_M).mean())
        return total * (1.0 - near) ** 2 + 0.35 * min(5.0, float(np.median(depth)))


def _poses(house: HouseSpec, room: Room) -> Iterator[Pose]:
    space = FreeSpace.of(house, _CLEAR_M)
    xs, ys = [corner[0] for corner in room.polygon], [corner[1] for corner in room.polygon]
    apart = max(0.5, math.sqrt((max(xs) - min(xs)) * (max(ys) - min(ys)) / _PLACES))
    for x in np.arange(min(xs) + _CLEAR_M, max(xs), apart).tolist():
        for y in np.arange(min(ys) + _CLEAR_M, max(ys), apart).tolist():
            if space.is_free(x, y) and plane.inside((x, y), room.polygon):
                for turn in range(_TURNS):
                    yield Pose(x=x, y=y, yaw=2.0 * math.pi * turn / _TURNS, pitch=_TILT)


def choose(photographer: Photographer, count: int = 4) -> list[Shot]:
    """The best view of one room of each kind, then of the other rooms, then the rooms' second best views."""
    by_room = [(room, photographer.shots(room)) for room in photographer.house.rooms]
    ranked = sorted((shots for _, shots in by_room if shots), key=lambda shots: -shots[0].worth)
    chosen: list[Shot] = []
    for kind in _ORDER:
        chosen += [shots[0] for shots in ranked if shots[0].room.kind == kind][:1]
    chosen += [shots[0] for shots in ranked if shots[0] not in chosen]
    first = {shot.room.id: shot for shot in chosen}
    for shots in sorted(ranked, key=lambda shots: chosen.index(shots[0])):
        chosen += [shot for shot in shots if math.cos(shot.pose.yaw - first[shot.room.id].pose.yaw) < 0.1][:1]
    return chosen[:count]


def sheet(house: HouseSpec, pack: Pack | None = None) -> Any:
    """Four views and the plan, each with its name, (H, W, 3) uint8; furniture is from ``pack`` where it has any."""
    photographer = Photographer(house, pack)
    fine = (2 * VIEW[0], 2 * VIEW[1])
    views = [
        _labelled(_shrunk(photographer.view(shot.pose, fine), 0.5), shot.room.name) for shot in choose(photographer)
    ]
    while len(views) < 4:
        views.append(np.full_like(views[0], _PAPER))
    rows = [_beside(views[:2]), _beside(views[2:])]
    right = np.concatenate([rows[0], np.full((_GAP, rows[0].shape[1], 3), _PAPER, np.uint8), rows[1]])
    area = sum(abs(plane.signed_area(room.polygon)) for room in house.rooms)
    title = f"{house.id}: {len(house.rooms)} rooms, {area:.0f} m2"
    left = _plan(photographer, right.shape[0] - _BAR, title)
    whole = _beside([left, right])
    return np.pad(whole, ((_GAP, _GAP), (_GAP, _GAP), (0, 0)), constant_values=_PAPER)


def _plan(photographer: Photographer, height: int, title: str) -> Any:
    """The plan, upright or turned, shrunk to fit ``height`` pixels, on paper of that height."""
    plan = photographer.plan(100.0)
    if plan.shape[1] > 1.3 * plan.shape[0]:
        plan = np.rot90(plan)
    scale = min(height / plan.shape[0], 1.3 * height / plan.shape[1])
    plan = _shrunk(plan, scale)
    paper = np.full((height, max(plan.shape[1], 320), 3), _PAPER, np.uint8)
    top, side = (height - plan.shape[0]) // 2, (paper.shape[1] - plan.shape[1]) // 2
    paper[top : top + plan.shape[0], side : side + plan.shape[1]] = plan
    return _labelled(paper, title)


def _shrunk(image: Any, scale: float) -> Any:
    return cv2.resize(image, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)


def _labelled(image: Any, text: str) -> Any:
    bar = np.full((_BAR, image.shape[1], 3), _PAPER, np.uint8)
    cv2.putText(bar, text, (4, _BAR - 8), cv2.FONT_HERSHEY_SIMPLEX, 0.5, _INK, 1, cv2.LINE_AA)
    return np.concatenate([bar, image])


def _beside(images: Sequence[Any]) -> Any:
    gap = np.full((images[0].shape[0], _GAP, 3), _PAPER, np.uint8)
    return np.concatenate([part for image in images for part in (gap, image)][1:], axis=1)


def main(arguments: Sequence[str] | None = None) -> int:
    """Make a sheet for each named house; returns 2 if a house cannot be read or drawn."""
    parser = argparse.ArgumentParser(
        prog="python -m hthor.world.rendering.contact_sheet", description="Four views and a plan of houses."
    )
    parser.add_argument("houses", nargs="+", metavar="HOUSE", help="a house's name or file")
    parser.add_argument("--out", type=Path, default=Path("docs/images/scenes"), help="folder for NAME.jpg")
    parser.add_argument("--quality", type=int, default=85, help="of the JPEG, 0 to 100")
    parser.add_argument("--assets", default="", metavar="PACK", help="a furniture pack made by 'hthor assets build'")
    given = parser.parse_args(arguments)
    given.out.mkdir(parents=True, exist_ok=True)
    try:
        pack = packs.load(given.assets) if given.assets else None
        for name in given.houses:
            house = houses.load(name)
            path = given.out / f"{house.id}.jpg"
            cv2.imwrite(str(path), sheet(house, pack)[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, given.quality])
            sys.stdout.write(f"{path}\n")
    except HthorError as error:
        sys.stderr.write(f"error: {error}\n")
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
