"""Laws of mapping, planning and walking, on maps made from simulated scans of a synthetic flat."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from law_cases import cases

from hthor import houses, navigation
from hthor.houses.space.free_space import FreeSpace
from hthor.houses.space.geodesic import Geodesics
from hthor.navigation import Courtesy, Follower, GridMap, Planner, Survey, face, frontiers, park, unvisited
from hthor.navigation.grid_map import CELL_M, FREE, OCCUPIED, UNKNOWN
from hthor.navigation.path_follower import shift, toward
from hthor.navigation.planner import path_length
from hthor.types import BodySpec, Detection, Move, Observation, Outcome, Pose, Rotate, Scan, Wait

RADIUS = 0.2
BODY = BodySpec(
    name="disc",
    title="disc",
    radius=RADIUS,
    height=1.0,
    eye=0.9,
    fov=(1.2, 1.2),
    speed=1.0,
    turn_rate=1.8,
    sight_range=1.5,
    scan_range=5.0,
    scan_beams=61,
    pitch_limit=0.5,
    capabilities=frozenset({"navigate"}),
)


def rectangle(x0: float, y0: float, x1: float, y1: float) -> list[tuple[float, float, float, float]]:
    return [(x0, y0, x1, y0), (x1, y0, x1, y1), (x1, y1, x0, y1), (x0, y1, x0, y0)]


# Two rooms of 4 m by 4 m with a doorway of 0.9 m between them, and a table in the second.
FLAT = [*rectangle(0, 0, 8, 4), (4, 0, 4, 2.5), (4, 3.4, 4, 4), *rectangle(5.5, 1, 6.5, 2)]


def scan(pose: Pose, walls: list[tuple[float, float, float, float]] = FLAT, fov: float = 1.2, beams: int = 61) -> Scan:
    bearings = np.linspace(-fov / 2, fov / 2, beams)
    ranges = np.full(beams, 5.0)
    for k, bearing in enumerate(bearings):
        ux, uy = math.cos(pose.yaw + bearing), math.sin(pose.yaw + bearing)
        for x0, y0, x1, y1 in walls:
            ex, ey = x1 - x0, y1 - y0
            det = ux * ey - uy * ex
            if abs(det) > 1e-12:
                t = ((x0 - pose.x) * ey - (y0 - pose.y) * ex) / det
                u = ((x0 - pose.x) * uy - (y0 - pose.y) * ux) / det
                if t > 1e-9 and -1e-9 <= u <= 1 + 1e-9:
                    ranges[k] = min(ranges[k], t)
    return Scan(origin=pose, bearings=bearings, ranges=ranges, limit=5.0)


def look_around(grid: GridMap, x: float, y: float) -> None:
    for k in range(6):
        grid.integrate(scan(Pose(x=x, y=y, yaw=k * math.pi / 3)))


@pytest.fixture
def known() -> GridMap:
    """A map of the whole flat."""
    grid = GridMap(1.0, 1.0)
    for x, y in ((1, 1), (3, 3), (1, 3), (3, 1), (4.5, 3), (7.3, 3.3), (7.3, 0.7), (5, 0.6), (5, 2), (6, 3), (6, 0.5)):
        look_around(grid, x, y)
    return grid


def test_a_scan_makes_the_near_floor_free_and_the_walls_occupied() -> None:
    grid = GridMap(1.0, 1.0)
    look_around(grid, 1.0, 1.0)
    assert grid.at(2.0, 2.0) == FREE
    assert OCCUPIED in (grid.at(-0.01, 1.0), grid.at(0.01, 1.0))
    assert grid.at(6.0, 1.5) == UNKNOWN
    assert grid.at(500.0, 0.0) == UNKNOWN


def test_no_free_cell_lies_behind_a_wall(known: GridMap) -> None:
    rows, columns = np.nonzero(known.cells == FREE)
    x, y = (columns + known.left + 0.5) * CELL_M, (rows + known.bottom + 0.5) * CELL_M
    assert x.min() > -CELL_M
    assert y.min() > -CELL_M
    assert x.max() < 8 + CELL_M
    assert y.max() < 4 + CELL_M
    assert not np.any((x > 5.55) & (x < 6.45) & (y > 1.05) & (y < 1.95))


def test_a_map_grows_and_keeps_what_it_knew() -> None:
    grid = GridMap(0.0, 0.0, extent_m=2.0)
    shape = grid.cells.shape
    look_around(grid, 1.0, 1.0)
    free = (grid.cells == FREE).sum()
    grid.mark_blocked(-30.0, 20.0)
    assert grid.cells.shape > shape
    assert (grid.cells == FREE).sum() == free
    assert grid.at(-30.0, 20.0) == OCCUPIED
    assert grid.at(2.0, 2.0) == FREE


def test_a_map_includes_a_place_that_no_scan_has_shown() -> None:
    grid = GridMap()
    planner = Planner(grid, RADIUS, optimistic=True)
    far = (17.0, -3.0)
    assert planner.path((0.0, 0.0), far) is None
    grid.include(*far)
    assert grid.at(*far) == UNKNOWN
    path = planner.path((0.0, 0.0), far)
    assert path is not None
    assert path[-1] == far


def test_a_near_way_point_is_reached_without_turning() -> None:
    behind, far = (-0.3, 0.0), (-2.0, 0.0)
    follower = Follower(sidestep_m=0.5)
    follower.take((behind,))
    motion = follower.next(Pose(x=0.0, y=0.0))
    assert isinstance(motion, Move)
    assert motion.forward == pytest.approx(-0.3)
    follower.take((far,))
    assert isinstance(follower.next(Pose(x=0.0, y=0.0)), Rotate)


def test_a_planner_follows_a_map_that_grows() -> None:
    grid = GridMap(1.0, 1.0, extent_m=3.0)
    planner = Planner(grid, RADIUS)
    assert planner.fits(1.0, 1.0)
    look_around(grid, 1.0, 1.0)
    assert not planner.fits(0.1, 1.0)
    look_around(grid, 4.5, 3.0)
    assert planner.path((1.0, 1.0), (7.0, 3.0)) is not None


def test_near_needs_a_look_from_close_by() -> None:
    grid = GridMap(1.0, 1.0)
    grid.integrate(scan(Pose(x=1.0, y=1.0)), look_m=0.9)
    assert grid.was_near(1.8, 1.0)
    assert not grid.was_near(2.1, 1.0)
    grid.forget_near()
    assert not grid.was_near(1.8, 1.0)


def test_a_path_keeps_its_distance_and_goes_through_the_door(known: GridMap) -> None:
    planner = Planner(known, RADIUS)
    path = planner.path((1.0, 1.0), (7.3, 0.7))
    assert path is not None
    assert path[0] == (1.0, 1.0)
    assert path[-1] == (7.3, 0.7)
    for a, b in itertools.pairwise(path):
        for k in range(101):
            x, y = a[0] + (b[0] - a[0]) * k / 100, a[1] + (b[1] - a[1]) * k / 100
            assert clearance(x, y) > RADIUS - CELL_M / 2


def clearance(x: float, y: float) -> float:
    best = math.inf
    for x0, y0, x1, y1 in FLAT:
        ex, ey = x1 - x0, y1 - y0
        t = max(0.0, min(1.0, ((x - x0) * ex + (y - y0) * ey) / (ex * ex + ey * ey)))
        best = min(best, math.hypot(x - x0 - t * ex, y - y0 - t * ey))
    return best


SPOTS = st.sampled_from(
    [(0.5, 0.5), (1.0, 3.2), (3.0, 2.0), (3.4, 0.5), (4.6, 3.0), (5.0, 0.6), (7.2, 3.3), (7.0, 1.5)]
)


@settings(max_examples=cases(30))
@given(SPOTS, SPOTS)
def test_paths_there_and_back_are_about_equal_and_field_agrees(a: tuple[float, float], b: tuple[float, float]) -> None:
    planner = Planner(whole(), RADIUS)
    there, back = planner.distance(a, b), planner.distance(b, a)
    assert there == pytest.approx(back, rel=0.03, abs=0.1)
    assert there >= math.dist(a, b) - 1e-9
    (lattice,) = planner.distances(a, [b])
    assert lattice >= there - 0.15
    assert lattice <= 1.3 * there + 0.3
    walked = planner.field(a).path(b)
    assert walked is not None
    assert path_length(walked) == pytest.approx(there, rel=0.05, abs=0.1)


@settings(max_examples=cases(30))
@given(SPOTS, st.lists(st.lists(SPOTS, min_size=1, max_size=4), max_size=4))
def test_the_nearest_of_each_group_is_the_nearest_by_the_distances_of_all(
    a: tuple[float, float], groups: list[list[tuple[float, float]]]
) -> None:
    planner = Planner(whole(), RADIUS)
    far = planner.distances(a, [point for group in groups for point in group])
    for (metres, number), group in zip(planner.nearest(a, groups), groups, strict=True):
        apart, far = far[: len(group)], far[len(group) :]
        assert metres == pytest.approx(min(apart), abs=1e-9)
        assert apart[number] == pytest.approx(metres, abs=1e-9)


def test_the_nearest_of_nothing_or_of_what_cannot_be_reached_is_infinitely_far() -> None:
    planner = Planner(whole(), RADIUS, optimistic=False)
    near, none, away = planner.nearest((1.0, 1.0), [[(90.0, 90.0), (1.0, 3.2)], [], [(90.0, 90.0)]])
    assert near[1] == 1
    assert none == away == (math.inf, -1)


@settings(max_examples=cases(30))
@given(SPOTS, SPOTS, st.floats(0.1, 12.0))
def test_a_path_of_bounded_length_is_the_same_path_or_none(
    a: tuple[float, float], b: tuple[float, float], most: float
) -> None:
    """A search counts costs from cell to cell and distances count from the points: they agree within three cells."""
    planner = Planner(whole(), RADIUS)
    (lattice,) = planner.distances(a, [b])
    found, any_length = planner.path(a, b, most=most), planner.path(a, b)
    assert found in (None, any_length)
    if abs(lattice - most) > 3 * CELL_M:
        assert (found is not None) == (lattice < most)


_WHOLE: list[GridMap] = []


def whole() -> GridMap:
    if not _WHOLE:
        grid = GridMap(1.0, 1.0)
        for x, y in ((1, 1), (3, 3), (1, 3), (3, 1), (4.5, 3), (7.3, 3.3), (7.3, 0.7), (5, 0.6), (5, 2), (6, 3)):
            look_around(grid, x, y)
        _WHOLE.append(grid)
    return _WHOLE[0]


def test_a_place_on_the_table_is_reached_within_arms_length(known: GridMap) -> None:
    planner = Planner(known, RADIUS)
    apple = (6.0, 1.6)
    path = planner.path((1.0, 1.0), apple, within=0.8)
    assert path is not None
    assert math.dist(path[-1], apple) <= 0.8 + 1e-9
    assert planner.path((1.0, 1.0), apple, within=0.3) is None
    assert math.isinf(planner.distance((1.0, 1.0), apple, within=0.3))
    field = planner.field((1.0, 1.0))
    assert field.distance(apple, within=0.8) == pytest.approx(path_length(path), rel=0.1)
    assert math.isinf(field.distance(apple, within=0.3))


def test_unknown_floor_is_for_optimists() -> None:
    grid = GridMap(1.0, 1.0)
    look_around(grid, 1.0, 1.0)
    assert Planner(grid, RADIUS, optimistic=True).path((1.0, 1.0), (7.3, 0.7)) is not None
    assert Planner(grid, RADIUS, optimistic=False).path((1.0, 1.0), (7.3, 0.7)) is None


def test_a_body_too_close_to_a_wall_gets_away(known: GridMap) -> None:
    planner = Planner(known, RADIUS)
    path = planner.path((0.12, 1.0), (3.0, 1.0))
    assert path is not None
    assert path[0] == (0.12, 1.0)
    assert path[1][0] > 0.2


def test_a_marked_obstacle_closes_the_door(known: GridMap) -> None:
    planner = Planner(known, RADIUS)
    assert planner.path((1.0, 1.0), (7.0, 3.0)) is not None
    for y in (2.75, 2.95, 3.15):
        known.mark_blocked(4.0, y)
    assert planner.path((1.0, 1.0), (7.0, 3.0)) is None


def test_a_frontier_is_found_behind_the_door_and_none_in_a_known_flat(known: GridMap) -> None:
    grid = GridMap(1.0, 1.0)
    for x, y in ((1, 1), (3, 1), (1, 3), (3, 3)):
        look_around(grid, x, y)
    planner = Planner(grid, RADIUS, optimistic=False)
    found = frontiers(grid, planner, Pose(x=1.0, y=1.0))
    assert found
    assert all(place.centre[0] > 4.0 for place in found)
    survey = Survey(grid, planner, Pose(x=1.0, y=1.0))
    assert survey.frontiers == found
    path = survey.path(found[0])
    assert path is not None
    assert path_length(path) <= found[0].distance + 2.0
    assert frontiers(known, Planner(known, RADIUS), Pose(x=1.0, y=1.0)) == []


def test_furniture_seen_from_far_is_still_to_be_visited() -> None:
    grid = GridMap(1.0, 1.0)
    look_around(grid, 1.0, 1.0)
    planner = Planner(grid, RADIUS, optimistic=False)
    before = sum(place.size for place in unvisited(grid, planner, Pose(x=1.0, y=1.0)))
    look_around(grid, 3.4, 1.0)
    after = sum(place.size for place in unvisited(grid, planner, Pose(x=1.0, y=1.0)))
    assert 0 < after < before


@pytest.mark.parametrize("step", [0.1, 0.5])
def test_following_a_path_arrives(known: GridMap, step: float) -> None:
    path = Planner(known, RADIUS).path((1.0, 1.0), (7.3, 0.7))
    assert path is not None
    follower, pose = Follower(step=step), Pose(x=1.0, y=1.0, yaw=2.0)
    follower.take(path)
    for _ in range(400):
        motion = follower.next(pose)
        if motion is None:
            break
        pose = moved(pose, motion)
        assert not isinstance(motion, Move) or math.hypot(motion.forward, motion.left) <= step + 1e-9
    assert follower.done
    assert math.dist((pose.x, pose.y), (7.3, 0.7)) < 0.05


def moved(pose: Pose, motion: object) -> Pose:
    if isinstance(motion, Rotate):
        return Pose(x=pose.x, y=pose.y, yaw=pose.yaw + motion.yaw, pitch=pose.pitch + motion.pitch)
    assert isinstance(motion, Move)
    cos, sin = math.cos(pose.yaw), math.sin(pose.yaw)
    return Pose(
        x=pose.x + cos * motion.forward - sin * motion.left,
        y=pose.y + sin * motion.forward + cos * motion.left,
        yaw=pose.yaw,
        pitch=pose.pitch,
    )


@given(st.floats(-3.0, 3.0), st.floats(-2.0, 2.0), st.floats(-2.0, 2.0))
def test_motions_lead_where_they_say(yaw: float, x: float, y: float) -> None:
    pose = Pose(x=0.3, y=-0.2, yaw=yaw)
    ended = moved(pose, shift(pose, (x, y), step=10.0))
    assert math.dist((ended.x, ended.y), (x, y)) < 1e-9
    turned = toward(pose, (x, y))
    if isinstance(turned, Rotate):
        assert isinstance(toward(moved(pose, turned), (x, y)), Move)


def test_facing_turns_and_tilts_within_the_limit() -> None:
    turn = face(Pose(x=0.0, y=0.0), (0.0, 1.0, 0.5), eye_height=1.0, pitch_limit=0.3)
    assert turn is not None
    assert turn.yaw == pytest.approx(math.pi / 2)
    assert turn.pitch == pytest.approx(-0.3)
    assert face(Pose(x=0.0, y=0.0), (1.0, 0.0, 1.0), eye_height=1.0) is None


class Seen:
    def __init__(self, *people: tuple[float, float]) -> None:
        self.people = people

    def detections(self) -> tuple[Detection, ...]:
        return tuple(
            Detection(
                id="human",
                kind="person",
                family="person",
                position=(x, y, 0.9),
                size=(0.4, 0.4, 1.75),
                yaw=0.0,
                distance=math.hypot(x, y),
            )
            for x, y in self.people
        )


def look(tick: int, *people: tuple[float, float], by: str = "") -> Observation:
    outcome = Outcome(motion="move", ok=not by, by=by)
    return Observation(tick=tick, pose=Pose(x=0.0, y=0.0), idle=True, senses=Seen(*people), outcome=outcome)


def test_courtesy_steps_aside_as_long_as_it_is_followed_and_goes_on() -> None:
    courtesy = Courtesy(BODY, lambda a, b: abs(b[0]) < 2 and abs(b[1]) < 2)
    assert courtesy.motion(look(0), 0.0) is None
    assert courtesy.motion(look(1, (2.5, 0.0)), 0.1) is None
    aside = courtesy.motion(look(2, (0.7, 0.0)), 0.2)
    assert isinstance(aside, Move)
    assert math.hypot(aside.forward, aside.left) == pytest.approx(0.5)
    assert aside.forward < 0
    assert isinstance(courtesy.motion(look(7, (0.8, 0.0)), 0.7), Move)
    assert courtesy.motion(look(30, (0.8, 0.0)), 3.0) is None


def test_courtesy_ends_when_the_person_has_passed() -> None:
    courtesy = Courtesy(BODY, lambda a, b: abs(b[0]) < 2 and abs(b[1]) < 2)
    assert isinstance(courtesy.motion(look(2, (0.7, 0.0)), 0.2), Move)
    assert courtesy.motion(look(9), 0.9) is None


def test_courtesy_after_a_bump_from_behind_steps_once_and_waits() -> None:
    courtesy = Courtesy(BODY, lambda a, b: True)
    assert isinstance(courtesy.motion(look(0, by="human"), 0.0), Move)
    assert isinstance(courtesy.motion(look(5), 0.5), Wait)


def test_courtesy_without_room_waits_and_a_bump_counts() -> None:
    courtesy = Courtesy(BODY, lambda a, b: False)
    assert isinstance(courtesy.motion(look(0, by="human"), 0.0), Wait)
    assert Courtesy(BODY, lambda a, b: True).motion(look(0, by="table"), 0.0) is None


def test_a_parked_body_is_in_nobodys_way(known: GridMap) -> None:
    planner = Planner(known, RADIUS)
    free = (known.cells == FREE) & (planner.levels < 2)
    origin = (known.left * CELL_M, known.bottom * CELL_M)
    doorway, apple = (4.0, 2.95), (4.9, 2.9)
    spot = park(free, origin, CELL_M, doorway, apple, apart_m=1.2)
    assert spot is not None
    assert math.dist(spot, apple) >= 1.2
    assert planner.fits(*spot)
    grid = Planner(known, RADIUS)
    for k in range(12):  # its outline as an obstacle: all rooms can still be reached
        angle = k * math.pi / 6
        known.mark_blocked(spot[0] + 0.2 * math.cos(angle), spot[1] + 0.2 * math.sin(angle))
    assert grid.path((1.0, 1.0), (7.3, 0.7)) is not None
    assert park(free & False, origin, CELL_M, doorway, apple, apart_m=1.2) is None


def test_unknown_names_are_refused() -> None:
    with pytest.raises(AttributeError, match="no attribute 'Teleport'"):
        _ = navigation.Teleport
    assert set(navigation.__all__) == set(navigation._HOMES)


@pytest.fixture(scope="module")
def real(samples_of_houses: list) -> FreeSpace:
    return FreeSpace(houses.load(str(samples_of_houses[-1])), RADIUS, 1.0)


@pytest.fixture(scope="module")
def samples_of_houses(request: pytest.FixtureRequest) -> list:
    return list(request.getfixturevalue("samples"))


def test_paths_are_at_most_eight_percent_longer_than_the_shortest(real: FreeSpace) -> None:
    """In a real house, on a map that knows the walls, against exact any-angle paths of the same clearance."""
    planner = Planner(drawn(real), RADIUS)
    wider = FreeSpace(real.house, RADIUS + CELL_M / 2, 1.0)
    ways, (x, y) = Geodesics(wider), (real.house.start.x, real.house.start.y)
    cells = wider.centres(wider.component(*wider.nearest_free(x, y)))
    spots = [tuple(float(c) for c in cell) for cell in cells[:: max(1, len(cells) // 12)]]
    ratios = []
    for a in spots:
        for b, best in zip(spots, ways.distances(a, spots), strict=True):
            if best > 1.0:
                path = planner.path(a, b)
                assert path is not None
                ratios.append(path_length(path) / best)
    assert len(ratios) > 50
    assert np.mean(ratios) < 1.03
    assert np.quantile(ratios, 0.95) < 1.08
    assert max(ratios) < 1.12


def drawn(space: FreeSpace) -> GridMap:
    """The map that a body would have after seeing every cell."""
    grid = GridMap(*space.origin, extent_m=2.0)
    rows, columns = np.nonzero(~space.raw)
    for row, column in zip(rows.tolist(), columns.tolist(), strict=True):
        grid.mark_blocked(*space.centre_of(row, column))
    return grid
