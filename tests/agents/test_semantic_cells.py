"""The cells of a picture, against the definition pixel by pixel."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hthor import houses
from hthor.agents.skills.semantic_cells import CELLS, CLASSES, FAR_M, GRID, LEVELS, PARTS, ROBOT, CellReader
from hthor.catalog import TARGETS
from hthor.world import World

LABELS = ("wall", "apple", "sofa", "mug", "tender")


@given(st.integers(0, 2**32 - 1), st.integers(7, 30), st.integers(7, 30))
def test_a_cell_shows_a_thing_to_bring_or_what_most_of_its_pixels_show(seed: int, width: int, height: int) -> None:
    rng = np.random.default_rng(seed)
    labels = rng.integers(-1, len(LABELS), (height, width)).astype(np.int32)
    depth = rng.uniform(0.1, 14.0, (height, width)).astype(np.float32)
    cells = CellReader(LABELS, (width, height)).read(labels, depth)
    names = [*LABELS[:-1], ROBOT, "nothing"]  # a robot's own name is no class; -1 is the last
    for cell in range(CELLS):
        rows = [row for row in range(height) if row * GRID // height == cell // GRID]
        columns = [column for column in range(width) if column * GRID // width == cell % GRID]
        found = [(names[labels[row, column]], depth[row, column]) for row in rows for column in columns]
        count = {name: sum(name == one for one, _ in found) for name in names}
        shown, behind = CLASSES[cells.shown[cell]], CLASSES[cells.behind[cell]]
        small = {name: number for name, number in count.items() if name in TARGETS and number}
        large = {name: number for name, number in count.items() if name not in TARGETS and number}
        assert count[shown] == max((small or large).values())
        assert (shown in TARGETS) == bool(small)
        assert behind not in TARGETS
        assert not large or count[behind] == max(large.values())
        mean = np.mean([metres for name, metres in found if name == shown])
        assert cells.depth[cell] == pytest.approx(min(mean / FAR_M, 1.0) * LEVELS, abs=0.51)


@pytest.mark.parametrize("name", houses.names())
def test_every_kind_that_a_picture_can_show_is_a_class(name: str) -> None:
    house = houses.load(name)
    kinds = {thing.kind for thing in house.things} | {opening.kind for opening in house.openings}
    assert kinds <= set(CLASSES)


def test_labels_name_the_kinds_that_detections_name() -> None:
    world = World("hazel", robots=["scout"])
    kinds = dict(zip(world.names, world.label_kinds, strict=True))
    assert set(kinds.values()) <= {*CLASSES, "scout"}
    assert (kinds["human"], kinds["robot"], kinds["fridge"]) == ("person", "scout", "fridge")
    assert {kinds[wall.id] for wall in world.house.walls if wall.id in kinds} == {"wall"}
    assert {*PARTS} - {ROBOT} <= {*kinds.values()}
    for one in world.detections("robot"):
        assert kinds[one.id] == one.kind
