"""Laws of the free-space grid, of shortest paths in it, and of the judgement of houses."""

from __future__ import annotations

import heapq
import itertools
import math

import cv2
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from law_cases import cases

from hthor import houses
from hthor.errors import HthorError
from hthor.geometry.plane import distance_to_rectangle, signed_area
from hthor.houses.checks.house_checks import check
from hthor.houses.checks.house_rules import is_sound
from hthor.houses.space import solids
from hthor.houses.space.free_space import FreeSpace, obstacle_rectangles
from hthor.houses.space.geodesic import Geodesics
from hthor.types import HouseSpec, Opening, Pose, Room, Thing, Wall

HEIGHT = 2.5


def room(name, x0, y0, x1, y1):
    return Room(id=name, kind="kitchen", name=name, polygon=((x0, y0), (x1, y0), (x1, y1), (x0, y1)))


def walls_of(room, skip=()):
    corners = room.polygon
    pairs = zip(corners, (*corners[1:], corners[0]), strict=True)
    return [
        Wall(id=f"{room.id}|{k}", room=room.id, a=a, b=b, height=HEIGHT)
        for k, (a, b) in enumerate(pairs)
        if k not in skip
    ]


def thing(name, x, y, w, d, yaw=0.0, low=0.0, high=0.8, parent="", kind="desk"):
    centre, size = (x, y, (low + high) / 2), (w, d, high - low)
    return Thing(id=name, kind=kind, asset="", centre=centre, size=size, yaw=yaw, parent=parent)


def house(rooms, walls, openings=(), things=(), start=(0.5, 0.5)):
    return HouseSpec(
        id="test",
        sha256="",
        rooms=tuple(rooms),
        walls=tuple(walls),
        openings=tuple(openings),
        things=tuple(things),
        height=HEIGHT,
        start=Pose(x=start[0], y=start[1]),
    )


def one_room(*things, size=3.0):
    only = room("a", 0.0, 0.0, size, size)
    return house([only], walls_of(only), things=things)


def two_rooms(passable=True, width=0.9, high=2.1, things=()):
    left, right = room("left", 0.0, 0.0, 3.0, 3.0), room("right", 3.0, 0.0, 6.0, 3.0)
    door = Opening(
        id="door",
        kind="door",
        rooms=("left", "right"),
        a=(3.0, 1.0),
        b=(3.0, 1.0 + width),
        low=0.0,
        high=high,
        passable=passable,
    )
    return house([left, right], [*walls_of(left), *walls_of(right)], [door], things)


@st.composite
def cluttered(draw):
    """A small room with a few turned boxes in it."""
    coordinate, side = st.floats(0.2, 2.8), st.floats(0.03, 0.9)
    boxes = draw(st.lists(st.tuples(coordinate, coordinate, side, side, st.floats(-3.2, 3.2)), max_size=6))
    return one_room(*(thing(f"box{k}", *box) for k, box in enumerate(boxes)))


def places(space, picks):
    cells = space.centres(space.free)
    assume(len(cells) > 0)
    jitter = [(math.sin(7.0 * pick) * 0.02, math.cos(5.0 * pick) * 0.02) for pick in picks]
    return [
        (cells[int(p * len(cells)) % len(cells)][0] + jx, cells[int(p * len(cells)) % len(cells)][1] + jy)
        for p, (jx, jy) in zip(picks, jitter, strict=True)
    ]


shares = st.floats(0.0, 0.999)
laws = settings(max_examples=cases(30))


# ------------------------------------------------------------------------------------------------------------ the grid


@laws
@given(cluttered(), st.sampled_from([0.0, 0.12, 0.2, 0.35]))
def test_a_cell_is_free_exactly_when_the_disc_about_its_middle_touches_nothing(spec, radius):
    space = FreeSpace(spec, radius)
    boxes = [(t.centre[:2], t.size[:2], t.yaw) for t in spec.things]
    for row, column in itertools.product(range(0, space.free.shape[0], 2), range(0, space.free.shape[1], 2)):
        x, y = space.centre_of(row, column)
        gap = min([min(x, y, 3.0 - x, 3.0 - y) - 0.05, *(distance_to_rectangle((x, y), *box) for box in boxes)])
        if abs(gap - radius) > 1e-9 and abs(gap) > 1e-9:
            assert space.free[row, column] == (gap >= radius and gap > 0.0)


@laws
@given(cluttered())
def test_a_wider_body_is_never_freer(spec):
    spaces = [FreeSpace(spec, radius).free for radius in (0.0, 0.1, 0.2, 0.3)]
    assert all(not (wide & ~narrow).any() for narrow, wide in itertools.pairwise(spaces))


def test_even_a_thin_thing_shows_on_the_raw_raster():
    space = FreeSpace(one_room(thing("board", 1.5, 1.5, 2.0, 0.001, 0.3)), 0.2)
    crossed = [space.cell_of(1.5 + t * math.cos(0.3), 1.5 + t * math.sin(0.3)) for t in np.linspace(-0.95, 0.95, 77)]
    assert not any(all(space.raw[r + i, c + j] for i, j in itertools.product((-1, 0, 1), repeat=2)) for r, c in crossed)


@pytest.mark.parametrize(
    ("low", "high", "parent", "free"),
    [(0.0, 0.8, "", False), (0.0, 0.04, "", True), (1.9, 2.2, "", True), (1.4, 2.2, "", False), (0.7, 0.9, "x", True)],
    ids=["table", "rug", "high picture", "low picture", "on the table"],
)
def test_what_stands_in_the_way(low, high, parent, free):
    space = FreeSpace(one_room(thing("it", 1.5, 1.5, 0.4, 0.4, low=low, high=high, parent=parent)), 0.2, 1.8)
    assert space.is_free(1.5, 1.5) == free


def test_a_doorway_is_open_floor_and_a_closed_door_is_wall():
    left, right = (1.0, 1.45), (5.0, 1.45)
    assert FreeSpace(two_rooms(), 0.2).segment_free(left, right)
    assert not FreeSpace(two_rooms(passable=False), 0.2).segment_free(left, right)
    assert not FreeSpace(two_rooms(width=0.35), 0.2).segment_free((1.0, 1.175), (5.0, 1.175))
    assert not FreeSpace(two_rooms(high=1.5), 0.2, 1.8).segment_free(left, right)


def test_an_open_plan_has_no_wall_and_no_house_beyond_its_rooms():
    left, right = room("left", 0.0, 0.0, 3.0, 3.0), room("right", 3.0, 0.0, 6.0, 3.0)
    space = FreeSpace(house([left, right], [*walls_of(left, (1,)), *walls_of(right, (3,))]), 0.2)
    assert space.segment_free((0.5, 0.5), (5.5, 2.5))
    bare = FreeSpace(house([left], []), 0.2)
    assert bare.is_free(1.5, 0.225)
    assert not bare.is_free(1.5, 0.175)
    assert not bare.is_free(-5.0, 99.0)


def test_a_body_needs_a_size_and_a_house_a_room():
    with pytest.raises(HthorError, match="radius"):
        FreeSpace(one_room(), -1.0)
    with pytest.raises(HthorError, match="no rooms"):
        FreeSpace(house([], []), 0.2)
    with pytest.raises(HthorError, match="no free floor"):
        FreeSpace(one_room(size=0.4), 0.3).nearest_free(0.2, 0.2)


@laws
@given(cluttered(), shares, shares)
def test_cells_places_and_segments_agree(spec, p, q):
    space = FreeSpace(spec, 0.15)
    a, b = places(space, (p, q))
    assert space.is_free(*a)
    assert space.cell_of(*space.centre_of(*space.cell_of(*a))) == space.cell_of(*a)
    assert space.segment_free(a, b) == space.segment_free(b, a)
    share = space.advance(a, b)
    assert (share == 1.0) == space.segment_free(a, b)
    almost = share * (1.0 - 1e-9)  # the very end may lie on a border, where rounding decides
    walked = [(a[0] + s * almost * (b[0] - a[0]), a[1] + s * almost * (b[1] - a[1])) for s in np.linspace(0, 1, 200)]
    assert all(space.is_free(*place) for place in walked)


@laws
@given(cluttered(), st.floats(-1.0, 4.0), st.floats(-1.0, 4.0))
def test_nearest_free_is_free_and_nearest(spec, x, y):
    space = FreeSpace(spec, 0.2)
    assume(space.free.any())
    nearest = space.nearest_free(x, y)
    assert space.is_free(*nearest)
    if space.is_free(x, y):
        assert nearest == (x, y)
    else:
        gaps = np.hypot(*(space.centres(space.free) - (x, y)).T)
        assert math.dist(nearest, (x, y)) == pytest.approx(gaps.min())


@laws
@given(cluttered())
def test_components_are_those_of_four_neighbours(spec):
    space = FreeSpace(spec, 0.2)
    count, labels = cv2.connectedComponents(space.free.astype(np.uint8), connectivity=4)
    assert space.components.max() == count - 1
    pairs = set(zip(space.components[space.free].tolist(), labels[space.free].tolist(), strict=True))
    assert len(pairs) == count - 1
    for x, y in space.centres(space.free)[::97]:
        assert space.component(x, y)[space.cell_of(x, y)]


# ------------------------------------------------------------------------------------------------------ shortest paths


def grid_lengths(space, a):
    """Dijkstra's algorithm over eight neighbours from the cell of ``a``, not squeezing between two blocked cells."""
    free, start = space.free, space.cell_of(*a)
    lengths, heap = {start: 0.0}, [(0.0, start)]
    while heap:
        length, (r, c) = heapq.heappop(heap)
        if length > lengths[(r, c)]:
            continue
        for dr, dc in itertools.product((-1, 0, 1), repeat=2):
            if (dr or dc) and free[r + dr, c + dc] and (free[r + dr, c] or free[r, c + dc]):
                longer = length + math.hypot(dr, dc) * space.cell
                if longer < lengths.get((r + dr, c + dc), math.inf) - 1e-12:
                    lengths[(r + dr, c + dc)] = longer
                    heapq.heappush(heap, (longer, (r + dr, c + dc)))
    return lengths


def plain_distance(space, a, b):
    """The same by brute force: all corners of blocked cells, all lines of sight, no pruning."""
    ny, nx = space.free.shape
    nodes = [a, b]
    for row, column in itertools.product(range(1, ny), range(1, nx)):
        if space.free[row - 1 : row + 1, column - 1 : column + 1].sum() == 3:
            nodes.append((space.origin[0] + column * space.cell, space.origin[1] + row * space.cell))
    lengths, left = {0: 0.0}, set(range(len(nodes)))
    while left:
        k = min(left, key=lambda node: lengths.get(node, math.inf))
        left.discard(k)
        if k not in lengths or k == 1:
            break
        for other in left:
            longer = lengths[k] + math.dist(nodes[k], nodes[other])
            if longer < lengths.get(other, math.inf) and space.segment_free(nodes[k], nodes[other]):
                lengths[other] = longer
    return lengths.get(1, math.inf)


@laws
@given(cluttered(), shares, shares, shares)
def test_shortest_paths_keep_the_laws_of_distance(spec, p, q, r):
    space = FreeSpace(spec, 0.15)
    paths = Geodesics(space)
    a, b, c = places(space, (p, q, r))
    ab, bc, ac = paths.distance(a, b), paths.distance(b, c), paths.distance(a, c)
    assert paths.distance(b, a) == pytest.approx(ab, abs=1e-9)
    assert paths.distance(a, a) == 0.0
    assert ac <= ab + bc + 1e-9
    assert ab >= math.dist(a, b) - 1e-9
    if space.segment_free(a, b):
        assert ab == pytest.approx(math.dist(a, b), abs=1e-9)
    assert math.isfinite(ab) == (space.label(*a) == space.label(*b))
    assert paths.distances(a, [b, c]).tolist() == [ab, ac]


@laws
@given(cluttered(), shares, shares)
def test_a_path_is_free_and_as_long_as_the_distance(spec, p, q):
    space = FreeSpace(spec, 0.15)
    paths = Geodesics(space)
    a, b = places(space, (p, q))
    way = paths.path(a, b)
    if not math.isfinite(paths.distance(a, b)):
        assert way == ()
        return
    assert way[0] == a
    assert way[-1] == b
    assert all(space.segment_free(*leg) for leg in itertools.pairwise(way))
    assert sum(itertools.starmap(math.dist, itertools.pairwise(way))) == pytest.approx(paths.distance(a, b), abs=1e-9)


@laws
@given(cluttered(), shares)
def test_no_path_is_longer_than_over_the_grid(spec, p):
    space = FreeSpace(spec, 0.15)
    (a,) = places(space, (p,))
    a = space.centre_of(*space.cell_of(*a))
    over = grid_lengths(space, a)
    cells = list(over)[::17]
    exact = Geodesics(space).distances(a, [space.centre_of(*cell) for cell in cells])
    assert all(length <= over[cell] + 1e-9 for length, cell in zip(exact, cells, strict=True))


@settings(max_examples=cases(12))
@given(cluttered(), shares, shares)
def test_pruning_loses_no_path(spec, p, q):
    space = FreeSpace(spec, 0.25)
    a, b = places(space, (p, q))
    assert Geodesics(space).distance(a, b) == pytest.approx(plain_distance(space, a, b), abs=1e-9)


def of_cells(free):
    """A space with the given cells."""
    space = FreeSpace(one_room(), 0.2)
    space.free = free.copy()
    space.free.setflags(write=False)
    return space


def test_nothing_squeezes_between_two_cells_that_touch_at_a_corner():
    free = np.zeros((6, 6), bool)
    free[1:3, 1:3] = free[3:5, 3:5] = True
    space = of_cells(free)
    x, y = space.origin
    a, b = (x + 0.1, y + 0.1), (x + 0.2, y + 0.2)
    assert space.label(*a) != space.label(*b)
    assert not space.segment_free(a, b)
    assert Geodesics(space).path(a, b) == ()
    free[2, 3] = True
    space = of_cells(free)
    assert space.segment_free(a, b)
    assert Geodesics(space).distance(a, b) == pytest.approx(math.dist(a, b))


def test_a_path_bends_round_a_corner_of_known_length():
    spec = one_room(thing("block", 0.75, 1.5, 1.4, 1.0))
    space = FreeSpace(spec, 0.0)
    edge = 1.45
    way = Geodesics(space).path((0.5, 0.5), (0.5, 2.5))
    assert sum(way[1:-1], ()) == pytest.approx((edge, 1.0, edge, 2.0))


def test_fields_take_the_cheapest_source():
    paths = Geodesics(FreeSpace(one_room(), 0.2))
    field = paths.field([(0.5, 0.5), (2.5, 2.5)], [1.0, 0.0])
    assert field.at([(0.5, 0.5), (2.5, 0.5), (9.0, 9.0)]) == pytest.approx([1.0, 2.0, math.inf])
    assert field.path((2.5, 0.5))[0] == (2.5, 2.5)
    assert paths.field(np.empty((0, 2))).at([(0.5, 0.5)]).tolist() == [math.inf]


# ---------------------------------------------------------------------------------------------------------- judgement


def rules_of(findings):
    return [(finding.severity, finding.rule) for finding in findings]


def test_a_sound_house_has_no_findings():
    assert check(two_rooms(), 0.2) == ()
    assert is_sound(())


def test_a_closed_door_makes_a_room_unreachable():
    findings = check(two_rooms(passable=False), 0.2)
    assert rules_of(findings) == [("error", "room-reachable")]
    assert not is_sound(findings)
    assert "right" in str(findings[0])


def test_a_start_in_a_table_is_an_error():
    findings = check(two_rooms(things=[thing("table", 0.5, 0.5, 0.6, 0.6)]), 0.2)
    assert ("error", "start-free") in rules_of(findings)


def test_narrow_doors_overlaps_and_strays_are_warnings():
    chest = thing("chest", 4.5, 2.0, 1.0, 1.0)
    inside = thing("vase", 4.6, 2.0, 0.3, 0.3)
    stuck = thing("shelf", 4.0, 2.9, 0.5, 0.5)
    stray = thing("shed", 9.0, 9.0, 0.5, 0.5)
    findings = check(two_rooms(width=0.35, things=[chest, inside, stuck, stray]), 0.2)
    kinds = {rule for severity, rule in rules_of(findings) if severity == "warning"}
    assert kinds >= {"door-width", "thing-in-thing", "thing-in-wall", "thing-indoors", "receptacle-reachable"}


def test_overlap_is_the_least_shift_that_parts_two_boxes():
    one = solids.Slab((0.0, 0.0), (2.0, 1.0), 0.0, 0.0, 1.0)
    assert solids.overlap_depth(one, solids.Slab((0.9, 0.9), (2.0, 1.0), 0.0, 0.5, 2.0)) == pytest.approx(0.1)
    assert solids.overlap_depth(one, solids.Slab((0.9, 0.9), (2.0, 1.0), 0.0, 1.0, 2.0)) == 0.0
    assert solids.overlap_depth(one, solids.Slab((0.0, 1.6), (1.0, 1.0), math.pi / 4, 0.0, 1.0)) == 0.0


def test_a_wall_with_two_faces_is_one_wall_cut_at_its_doorway():
    spec = two_rooms()
    shared = [slab for slab in solids.wall_slabs(spec) if slab.centre[0] == pytest.approx(3.0)]
    assert len(shared) == 3
    spans = sorted((slab.centre[1] - slab.size[0] / 2, slab.centre[1] + slab.size[0] / 2, slab.low) for slab in shared)
    assert [value for span in spans for value in span] == pytest.approx(
        [-0.05, 1.0, 0.0, 1.0, 1.9, 2.1, 1.9, 3.05, 0.0]
    )


# -------------------------------------------------------------------------------------------------------- real houses


@pytest.mark.parametrize("name", houses.names())
def test_our_own_houses_are_sound(name):
    spec = houses.load(name)
    assert is_sound(check(spec, 0.20))
    assert all(signed_area(part.polygon) > 0 for part in spec.rooms)
    assert is_sound(check(spec, 0.25))


def test_every_room_of_the_sample_houses_can_be_reached(samples):
    for file in samples:
        findings = check(houses.load(file), 0.20)
        assert is_sound(findings), [str(finding) for finding in findings]


def test_shortest_paths_of_the_sample_houses_are_no_longer_than_over_the_grid(samples):
    spec = houses.load(samples[-1])
    space = FreeSpace(spec, 0.20)
    assert len(obstacle_rectangles(spec, 1.8)) > 20
    start = space.centre_of(*space.cell_of(*space.nearest_free(spec.start.x, spec.start.y)))
    over = grid_lengths(space, start)
    cells = list(over)[::301]
    exact = Geodesics(space).distances(start, [space.centre_of(*cell) for cell in cells])
    for length, cell in zip(exact, cells, strict=True):
        assert math.dist(start, space.centre_of(*cell)) - 1e-9 <= length <= over[cell] + 1e-9
