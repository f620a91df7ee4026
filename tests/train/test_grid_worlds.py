"""Worlds of pose grids: zones, episodes, the detector's noise, shortest paths."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

torch = pytest.importorskip("torch", reason="needs torch: pip install 'hthor[torch]'", exc_type=ImportError)

from small_grids import make_grid  # noqa: E402

from hthor.agents.skills.detector_noise import FALSE_ALARM, MISS, MISS_PER_M  # noqa: E402
from hthor.agents.skills.semantic_cells import CELLS, CLASSES, GOALS  # noqa: E402
from hthor.catalog import TARGETS  # noqa: E402
from hthor.train.grid_paths import UNREACHABLE, path_lengths  # noqa: E402
from hthor.train.grid_worlds import CLOSE, DONE, TURNS, GridWorlds  # noqa: E402

torch.set_num_threads(1)
GRIDS = [make_grid(seed) for seed in range(2)]


@given(st.integers(0, 2**32 - 1), st.integers(1, 40))
def test_path_lengths_are_the_least_that_satisfy_every_step(seed: int, count: int) -> None:
    rng = np.random.default_rng(seed)
    successors = rng.integers(0, count, (count, 5)).astype(np.int32)
    visible = rng.integers(0, 1 << 14, count).astype(np.uint16) & rng.integers(0, 1 << 14, count).astype(np.uint16)
    length = path_lengths(successors, visible)
    assert np.array_equal(length == 0, (visible[:, None] >> np.arange(len(GOALS)) & 1) == 1)
    best = np.minimum(length[successors].min(axis=1) + 1, UNREACHABLE)
    assert np.array_equal(length, np.where(length == 0, 0, best))


def test_rooms_are_zones_that_no_step_leaves() -> None:
    houses, rooms = GridWorlds(GRIDS, "houses"), GridWorlds(GRIDS, "rooms")
    assert (houses.house.tolist(), rooms.house.tolist()) == ([0, 1], [0, 0, 1, 1])
    zone = torch.bucketize(torch.arange(len(rooms.next)), rooms.first[1:], right=True)
    assert (zone[rooms.next] == zone.unsqueeze(1)).all()
    between = int((GRIDS[0].rooms < 0).sum()) * TURNS
    assert len(rooms.next) == len(houses.next) - 2 * between
    assert (rooms.length >= 0).all()
    crosses = (houses.next // TURNS != (torch.arange(len(houses.next)) // TURNS).unsqueeze(1)).any(1)
    assert crosses.any()


@pytest.mark.parametrize("zones", ["houses", "rooms"])
def test_episodes_begin_level_with_a_goal_that_is_out_of_view_and_near_enough(zones: str) -> None:
    worlds = GridWorlds(GRIDS, zones)  # type: ignore[arg-type]
    episodes = worlds.draw(500, torch.Generator().manual_seed(0))
    again = worlds.draw(500, torch.Generator().manual_seed(0))
    assert all(torch.equal(one, other) for one, other in zip(episodes, again, strict=True))
    assert not worlds.found(episodes.pose, episodes.goal).any()
    assert (episodes.pose % 2 == 0).all()
    assert int(episodes.least.min()) >= 2
    close = worlds.draw(500, torch.Generator().manual_seed(0), close=0.5).least <= CLOSE + 1
    share = float((episodes.least <= CLOSE + 1).float().mean())
    assert float(close.float().mean()) == pytest.approx(0.5 + 0.5 * share, abs=0.05)
    zone = torch.bucketize(episodes.pose, worlds.first[1:], right=True)
    counts = torch.bincount(zone, minlength=len(worlds.house))
    assert int(counts.min()) > 0.7 * 500 / len(worlds.house)


def test_a_shortest_path_leads_to_the_goal_in_the_least_number_of_actions() -> None:
    worlds = GridWorlds(GRIDS, "houses")
    pose, goal, least = worlds.draw(50, torch.Generator().manual_seed(1))
    for _ in range(int(least.max())):
        ahead = torch.stack([worlds.length[worlds.next[pose, action], goal] for action in range(DONE)], 1)
        action = torch.where(worlds.found(pose, goal), DONE, ahead.argmin(1))
        pose, least = worlds.go(pose, action), least - (action != DONE).long()
    assert worlds.found(pose, goal).all()
    assert (least == 1).all()


def test_the_detector_s_noise_is_as_frequent_as_stated() -> None:
    worlds = GridWorlds(GRIDS, "houses")
    pose = torch.randint(0, len(worlds.next), (4_000,), generator=torch.Generator().manual_seed(2))
    clean, ranges = worlds.look(pose, None)
    noisy, same = worlds.look(pose, torch.Generator().manual_seed(3))
    assert torch.equal(ranges, same)
    assert torch.equal(clean, torch.from_numpy(np.concatenate([grid.shown for grid in GRIDS]))[pose].long())
    small = worlds.noise.small[clean]
    expected = float((MISS + MISS_PER_M * 10.0 * ranges[small]).mean())
    assert float((noisy != clean)[small].float().mean()) == pytest.approx(expected, rel=0.05)
    changed = (noisy != clean) & ~small
    assert float(changed.float().sum() / (~small).sum()) == pytest.approx(FALSE_ALARM, rel=0.25)
    assert {CLASSES[index] for index in noisy[changed].unique().tolist()} <= set(TARGETS)
    assert noisy.shape == (4_000, CELLS)
