"""The controls with a map: what they know, and that they find everything."""

from __future__ import annotations

import msgspec
import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="needs torch: pip install 'hthor[torch]'", exc_type=ImportError)

from small_grids import make_grid  # noqa: E402

from hthor import rules  # noqa: E402
from hthor.agents.skills.semantic_cells import GOALS  # noqa: E402
from hthor.train.evaluation import evaluate  # noqa: E402
from hthor.train.grid_worlds import GridWorlds  # noqa: E402
from hthor.train.map_walker import SCAN_M, VIEW_RAD, Explorer, Kind, MapWalker, Terrain  # noqa: E402
from hthor.train.pose_grid import HEADINGS, TILTS_RAD  # noqa: E402

KINDS: tuple[Kind, ...] = ("frontier", "nearest")


def test_a_scan_shows_places_in_view_and_range_with_nothing_between() -> None:
    grid = make_grid(0)
    terrain = Terrain(grid.places, grid.ahead)
    for place, pose in ((0, 0), (12, 12 * HEADINGS + 3), (40, 40 * HEADINGS + 6)):
        offset = grid.places - grid.places[place]
        apart = np.hypot(offset[:, 0], offset[:, 1])
        error = np.arctan2(offset[:, 1], offset[:, 0]) - pose % HEADINGS * np.pi / 4.0
        away = np.abs(np.angle(np.exp(1j * error)))
        seen = np.flatnonzero(terrain.seen[pose])
        assert place in seen
        assert (apart[seen] <= SCAN_M).all()
        assert (away[seen][apart[seen] > 0.0] <= VIEW_RAD / 2.0 + 1e-9).all()
        assert np.array_equal(terrain.near[pose], terrain.seen[pose] & (apart <= rules.DETECTOR_RANGE_M))
    other_room = np.flatnonzero(grid.rooms == 1)
    corner = int(np.argmin(grid.places.sum(axis=1)))  # of room 0, from where the passage is not in line
    from_corner = terrain.seen[corner * HEADINGS : (corner + 1) * HEADINGS].any(axis=0)
    assert np.count_nonzero(from_corner[other_room]) < len(other_room) / 2


@pytest.mark.parametrize("kind", KINDS)
def test_an_explorer_sees_every_place_from_close_by(kind: Kind) -> None:
    terrain = Terrain(*GridWorlds([make_grid(1)], "houses").lattices[0])
    explorer, pose = Explorer(terrain, kind), 0
    looked = np.zeros(len(terrain.ahead), np.bool_)
    for _ in range(150):
        looked |= terrain.near[pose]
        pose = int(terrain.successors[pose][explorer.act(pose)])
    assert looked.all()


@pytest.mark.parametrize("kind", KINDS)
def test_they_find_everything_that_is_seen_from_close_by(kind: Kind) -> None:
    grid = make_grid(0)
    near = Terrain(grid.places, grid.ahead).near  # a goal is seen from where its place is looked at
    visible = np.zeros(len(near), np.uint16)
    for goal in range(len(GOALS)):
        visible |= near[:, goal * 3].astype(np.uint16) << goal
    grid = msgspec.structs.replace(grid, visible=np.repeat(visible, len(TILTS_RAD)).astype(np.uint16))
    worlds = GridWorlds([grid], "houses")
    episodes = worlds.draw(12, torch.Generator().manual_seed(0))
    found = evaluate(MapWalker(worlds, episodes.goal, kind), worlds, episodes, 150)
    assert found.found.all()
    assert (found.actions >= found.least).all()
    again = evaluate(MapWalker(worlds, episodes.goal, kind), worlds, episodes, 150)
    assert torch.equal(found.actions, again.actions)
