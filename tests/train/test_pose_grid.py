"""Pose grids, against the live world and against their own laws; houses for training; word vectors."""

from __future__ import annotations

import math
from itertools import count, islice
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("torch", reason="needs torch: pip install 'hthor[torch]'", exc_type=ImportError)

from hthor import catalog, houses, tasks
from hthor.agents.skills.semantic_cells import CELLS, CLASSES, GOALS, CellReader
from hthor.errors import HthorError, UnknownName
from hthor.train import array_cache, grid_data, pose_grid
from hthor.train import houses as train_houses
from hthor.train.pose_grid import HEADINGS, TILTS_RAD, PoseGrid
from hthor.train.words import word_vectors
from hthor.types import HouseSpec, Placement, Pose
from hthor.world import World

POSES = 1_000


def _objects() -> tuple[Placement, ...]:
    return next(task for task in tasks.load_suite("smoke").tasks if task.house == "hazel").objects


@pytest.fixture(scope="module")
def world() -> World:
    house, objects = houses.load("hazel"), _objects()
    made = World(house, robots=["scout"], objects=[(one.id, one.kind) for one in objects])
    made.rearrange((), objects)
    return made


def test_a_grid_s_readings_are_those_of_the_live_world_from_a_thousand_poses(world: World) -> None:
    places, _ = pose_grid.lattice(world.house, world.space["robot"])
    person = world.pose("human")
    rng = np.random.default_rng(0)
    far = places[np.hypot(places[:, 0] - person.x, places[:, 1] - person.y) > 0.6]
    draws = (
        pose_grid.make_pose(*map(float, far[rng.integers(len(far))]), int(rng.integers(8)), int(rng.integers(2)))
        for _ in count()
    )
    person_number = world.names.index("human")
    reader = CellReader(world.label_kinds, world.camera("robot").size)
    poses: list[Pose] = []
    live = []
    for pose in draws:
        world.teleport("robot", pose)
        segmentation = world.picture("robot", "segmentation")
        if (segmentation == person_number).any():  # nobody else is in a grid's house
            continue
        cells = reader.read(segmentation, world.picture("robot", "depth"))
        live.append((cells, pose_grid.goal_bits(world.detections("robot"))))
        poses.append(pose)
        if len(poses) == POSES:
            break
    before = world.poses()
    cells, visible = pose_grid.survey(world, poses)
    assert world.poses() == before
    assert visible.tolist() == [bits for _, bits in live]
    assert np.count_nonzero(visible) > 50
    for number, name in enumerate(cells._fields):
        assert np.array_equal(cells[number], np.stack([one[number] for one, _ in live])), name


def test_pictures_of_a_grid_are_those_of_the_live_world(world: World) -> None:
    """Of a world whose person is elsewhere."""
    places, _ = pose_grid.lattice(world.house, world.space["robot"])
    poses = np.random.default_rng(1).integers(0, len(places) * HEADINGS * len(TILTS_RAD), 40).tolist()
    drawn = list(pose_grid.draw_pictures(world.house, _objects(), "scout", places, poses))
    person, compared = world.names.index("human"), 0
    for number, picture in zip(poses, drawn, strict=True):
        place, turned = divmod(number, HEADINGS * len(TILTS_RAD))
        x, y = places[place].tolist()
        if math.dist((x, y), (world.pose("human").x, world.pose("human").y)) < 0.6:
            continue
        world.teleport("robot", pose_grid.make_pose(x, y, *divmod(turned, len(TILTS_RAD))))
        if not (world.picture("robot", "segmentation") == person).any():
            assert np.array_equal(picture, world.picture("robot"))
            compared += 1
    assert compared > 20


def test_each_step_of_the_lattice_is_a_move_that_the_world_allows(world: World) -> None:
    places, ahead = pose_grid.lattice(world.house, world.space["robot"])
    space = world.space["robot"]
    steps = {(round(math.cos(h * math.pi / 4)), round(math.sin(h * math.pi / 4))): h for h in range(HEADINGS)}
    where = {tuple(np.rint((place - places[0]) / pose_grid.STEP_M).astype(int)): n for n, place in enumerate(places)}
    for (i, j), number in where.items():
        for (across, along), heading in steps.items():
            other = where.get((i + across, j + along), number)
            free = space.segment_free(tuple(places[number]), tuple(places[other]))
            assert ahead[number, heading] == (other if free else number)
            assert number == other or not free or ahead[other, (heading + 4) % HEADINGS] == number


def _next_by_hand(grid_ahead: np.ndarray, pose: int) -> list[int]:
    place, heading, tilt = pose // 16, pose // 2 % 8, pose % 2
    return [
        int(grid_ahead[place, heading]) * 16 + heading * 2 + tilt,
        place * 16 + (heading + 1) % 8 * 2 + tilt,
        place * 16 + (heading - 1) % 8 * 2 + tilt,
        place * 16 + heading * 2,
        place * 16 + heading * 2 + 1,
    ]


def test_actions_lead_to_the_next_pose() -> None:
    ahead = np.random.default_rng(1).integers(0, 12, (12, HEADINGS)).astype(np.int32)
    following = pose_grid.next_poses(ahead)
    assert following.tolist() == [_next_by_hand(ahead, pose) for pose in range(len(following))]


def _small_grid() -> PoseGrid:
    cells = np.zeros((2 * HEADINGS * len(TILTS_RAD), CELLS), np.uint8)
    return PoseGrid(
        places=np.zeros((2, 2)),
        rooms=np.zeros(2, np.int32),
        ahead=np.zeros((2, HEADINGS), np.int32),
        shown=cells + 3,
        behind=cells,
        depth=cells,
        visible=np.zeros(len(cells), np.uint16),
    )


def test_a_grid_is_kept_and_a_house_without_room_for_its_objects_is_left_out(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    built = []

    def build(house: HouseSpec, objects: object, robot: str) -> PoseGrid:
        built.append((house.id, robot))
        return _small_grid()

    monkeypatch.setattr(grid_data, "build_grid", build)
    monkeypatch.setattr(grid_data.houses, "make_house", lambda split, number: houses.load(("elder", "hazel")[number]))

    def arrangement(house: HouseSpec, number: int) -> tuple[()]:
        if house.id == "hazel" or number:
            raise HthorError("no place")
        return ()

    monkeypatch.setattr(grid_data.houses, "make_arrangement", arrangement)
    for house in range(2):
        for one in range(2):
            array_cache.write(grid_data._entry(("train", house, one)))
    found = grid_data.build_grids("train", 2, 2)  # all are there, so no process is started
    assert built == [("elder", "scout")]
    assert list(found) == [("train", 0, 0)]
    for name in PoseGrid.__struct_fields__:
        assert np.array_equal(getattr(found["train", 0, 0], name), getattr(_small_grid(), name))
    with pytest.raises(HthorError, match=r"no pose grid of \('train', 0, 1\)"):
        grid_data.load_grid(("train", 0, 1))
    monkeypatch.setattr(grid_data.houses, "make_house", lambda *_: houses.load("hazel"))
    array_cache.write(grid_data._entry(("test", 0, 0)))
    with pytest.raises(HthorError, match="none of the first 1 houses of the split 'test'"):
        grid_data.build_grids("test", 1, 1)


def test_the_same_number_gives_the_same_house_and_splits_share_none() -> None:
    made = [train_houses.make_house(split, 0) for split in train_houses.SPLITS]
    assert len({house.sha256 for house in made}) == len(made)
    shipped = {houses.load(name).sha256 for group in ("scenes", "unseen") for name in houses.names(group)}  # type: ignore[arg-type]
    assert shipped.isdisjoint(house.sha256 for house in made)
    train_houses.make_house.cache_clear()
    assert train_houses.make_house("train", 0) == made[0]
    with pytest.raises(UnknownName, match=r"unknown split 'tests'\. Did you mean 'test'"):
        train_houses.make_house("tests", 0)
    with pytest.raises(HthorError, match="0 to 99999, got 100000"):
        train_houses.make_house("train", train_houses.MOST)


def test_every_class_has_a_word_vector_of_length_one() -> None:
    vectors = word_vectors(CLASSES)
    assert vectors.shape == (len(CLASSES), 50)
    np.testing.assert_allclose(np.linalg.norm(vectors, axis=1), 1.0, rtol=1e-6)
    like = vectors @ vectors.T
    nearest = {name: CLASSES[int(np.argsort(like[CLASSES.index(name)])[-2])] for name in ("tomato", "tv_stand", "bed")}
    assert nearest == {"tomato": "lettuce", "tv_stand": "television", "bed": "dog_bed"}
    assert set(GOALS) == {*catalog.TARGETS, *catalog.RECEPTACLES}


@pytest.mark.nightly
def test_grids_of_houses_are_built_in_parallel_in_order(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    told: list[tuple[int, int]] = []
    grids = grid_data.build_grids("validation", 2, 1, jobs=2, progress=lambda *numbers: told.append(numbers))
    assert told == [(1, 2), (2, 2)]
    first = train_houses.make_house("validation", 0)
    alone = pose_grid.build_grid(first, train_houses.make_arrangement(first, 0))
    assert np.array_equal(grids["validation", 0, 0].shown, alone.shown)
    assert len(list(islice(tmp_path.rglob("*.npz"), 3))) == 2
