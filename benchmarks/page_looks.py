"""How the page of `hthor live` looks beside the profile `nice`: ``python -m benchmarks.page_looks [--out PICTURE]``.

Five rooms of five homes, each from one eye: on the left as `nice` draws it, on the right as the page does.
"""

from __future__ import annotations

import argparse
import math
import sys
import time
from pathlib import Path
from typing import Any

import cv2
import msgspec
import numpy as np

from benchmarks import page_browser
from hthor.live.gltf import house_file
from hthor.world import World
from hthor.world.model.bodies import avatar
from hthor.world.rendering.contact_sheet import VIEW, Photographer

ROOMS = (
    ("birch", "kitchen"),
    ("elder", "living_room"),
    ("maple", "bathroom"),
    ("juniper", "bedroom"),
    ("willow", "living_room"),
)
"""Pairs of a home and a kind of room, of which the best view is taken, see `hthor.world.rendering.contact_sheet`."""
_SIZE = (560, 420)
_HIGH_RAD = 1.12
LENS = msgspec.structs.replace(
    avatar.HUMAN, fov=(2.0 * math.atan(math.tan(_HIGH_RAD / 2) * VIEW[0] / VIEW[1]), _HIGH_RAD)
)
"""A person's eye with the field of view of `Photographer`, nearly that of the page."""
_GAP, _BAR, _PAPER, _INK = 6, 24, 250, (60, 55, 50)
_QUALITY = 84


def write(path: Path, rooms: tuple[tuple[str, str], ...] = ROOMS) -> None:
    """Draw the rooms side by side, one below the other."""
    with page_browser.browser() as browser:
        rows = [_row(browser, home, kind) for home, kind in rooms]
    rule = np.full((_GAP, rows[0].shape[1], 3), _PAPER, np.uint8)
    whole = np.concatenate([part for row in rows for part in (rule, row)][1:])
    cv2.imwrite(str(path), whole[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, _QUALITY])


def _row(browser: Any, home: str, kind: str) -> Any:
    world = World(home, robots=["tender"])
    photographer = Photographer(world.house)
    rooms = [room for room in world.house.rooms if room.kind == kind]
    shot = max((photographer.shots(room)[0] for room in rooms), key=lambda one: one.worth)
    fine = photographer.view(shot.pose, (2 * _SIZE[0], 2 * _SIZE[1]))
    nice = cv2.resize(fine, _SIZE, interpolation=cv2.INTER_AREA)
    began = time.process_time()
    file = house_file.house_file(world.scene, world.house)
    sys.stderr.write(f"{home}: {time.process_time() - began:.1f} s for its file of {len(file.data)} bytes\n")
    bodies = {number for numbers in world.scene.seats.values() for number in numbers}
    poses = {number: row for number, row in enumerate(world.scene_poses()) if number not in bodies}
    page = page_browser.HousePage(browser, file, sorted(bodies))
    try:
        drawn = page.picture(shot.pose, LENS, _SIZE, poses)
    finally:
        page.close()
    name = f"{home}, {shot.room.name}"
    gap = np.full((_SIZE[1] + _BAR, _GAP, 3), _PAPER, np.uint8)
    return np.concatenate([_labelled(nice, f"{name}: nice"), gap, _labelled(drawn, f"{name}: the page")], axis=1)


def _labelled(image: Any, text: str) -> Any:
    bar = np.full((_BAR, image.shape[1], 3), _PAPER, np.uint8)
    cv2.putText(bar, text, (4, _BAR - 8), cv2.FONT_HERSHEY_SIMPLEX, 0.5, _INK, 1, cv2.LINE_AA)
    return np.concatenate([bar, image])


def main() -> None:
    """Draw the picture."""
    options = argparse.ArgumentParser(prog="python -m benchmarks.page_looks", description=__doc__.splitlines()[0])
    options.add_argument("--out", type=Path, default=Path("docs/images/live_looks.jpg"))
    write(options.parse_args().out)


if __name__ == "__main__":
    main()
