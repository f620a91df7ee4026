"""What every robot keeps to, whoever wrote it: its numbers fit each other, its looks fit its numbers, and it works."""

from __future__ import annotations

import math
from pathlib import Path

import msgspec
import numpy as np
import pytest
import world_house as tiny
from hypothesis import given
from hypothesis import strategies as st
from world_house import COUNTER, TABLE, do, on, reason, task

from hthor import catalog, code_identity, plugins, rules
from hthor.errors import HthorError, UnknownName
from hthor.trials import Sources, TrialRunner, robot_team
from hthor.types import Close, Move, Open, Part, Pick, Place, Pose, RobotSpec, Rotate
from hthor.world import World
from hthor.world.model.bodies import avatar, bodies

NAMES = plugins.names("robot")
SPECS = [bodies.load_robot(name) for name in NAMES]
FIGURES = [avatar.HUMAN, *SPECS]
_HANDS_M = 0.17
"""How far fingers or a tray may stick out beyond the middle of the hand."""

every_robot = pytest.mark.parametrize("spec", SPECS, ids=NAMES)
every_body = pytest.mark.parametrize("spec", FIGURES, ids=[spec.name for spec in FIGURES])


def test_the_four_robots_differ_in_what_they_are_for() -> None:
    scout, tender, puck, porter = (bodies.load_robot(name) for name in ("scout", "tender", "puck", "porter"))
    assert scout.capabilities == puck.capabilities == {"navigate"}
    assert tender.capabilities == porter.capabilities == {"navigate", "pick", "open"}
    assert puck.height < scout.height < porter.height < tender.height
    assert porter.radius > tender.radius
    assert porter.strength > tender.strength
    assert porter.speed < tender.speed < scout.speed


# ------------------------------------------------------------------------------------------------------------- numbers


@every_robot
def test_a_robot_is_called_what_its_file_is(spec: RobotSpec) -> None:
    assert isinstance(spec, RobotSpec)
    assert bodies.load_robot(spec.name) is spec
    assert spec.title


@every_body
def test_numbers_make_sense(spec: RobotSpec) -> None:
    assert 0.05 < spec.radius <= 0.40
    assert 0.05 < spec.eye < spec.height <= 2.0
    assert all(0.3 < angle < math.pi for angle in spec.fov)
    assert 0.1 <= spec.speed <= 3.0
    assert 0.3 <= spec.turn_rate <= 2 * math.pi
    assert 0.0 < spec.sight_range <= 20.0
    assert spec.radius < spec.scan_range
    assert spec.scan_beams >= 2
    assert 0.0 <= spec.pitch_limit <= math.pi / 2


@every_robot
def test_the_paper_s_bounds_hold(spec: RobotSpec) -> None:
    assert spec.sight_range == rules.DETECTOR_RANGE_M
    assert spec.pitch_limit <= rules.PITCH_LIMIT_RAD


@every_body
def test_capabilities_reach_and_strength_agree(spec: RobotSpec) -> None:
    assert spec.capabilities <= {"navigate", "pick", "open"}
    if spec.capabilities & {"pick", "open"}:
        assert spec.reach > spec.radius
        assert 0.0 <= spec.reach_low < spec.reach_high
        assert spec.handling >= rules.HANDLING_S
    if "pick" in spec.capabilities:
        targets = [catalog.kind(name) for name in catalog.TARGETS]
        assert all(kind.mass <= spec.strength for kind in targets)
    else:
        assert spec.strength == 0.0


@every_body
def test_who_picks_works_where_things_are_kept(spec: RobotSpec) -> None:
    if "pick" not in spec.capabilities:
        pytest.skip("has no hand")
    for name in catalog.RECEPTACLES:
        heights = [catalog.kind(name).size[2] / 2 + place.centre[2] for place in catalog.kind(name).surfaces()]
        assert all(spec.reach_low <= height + 0.1 <= spec.reach_high for height in heights), name


# --------------------------------------------------------------------------------------------------------------- looks


def _corners(part: Part) -> np.ndarray:
    signs = np.array(np.meshgrid((-1, 1), (-1, 1), (-1, 1))).reshape(3, -1).T
    return np.array(part.centre) + signs * part.half


def _outreach(part: Part) -> float:
    """How far a solid gets from the body's axis [m]."""
    x, y, _ = part.centre
    if part.shape == "sphere" or (part.shape == "cylinder" and part.axis == "z"):
        return math.hypot(x, y) + part.half[0]
    return float(np.linalg.norm(_corners(part)[:, :2], axis=1).max())


@every_body
def test_looks_are_as_tall_as_the_body_and_stand_on_the_floor(spec: RobotSpec) -> None:
    heights = np.concatenate([_corners(part)[:, 2] for part in bodies.look(spec)])
    assert heights.min() == pytest.approx(0.0, abs=1e-6)
    assert heights.max() == pytest.approx(spec.height, abs=0.005)
    meshes = np.concatenate([piece.mesh.vertices for piece in bodies.pieces(spec)])
    assert meshes[:, 2].min() == pytest.approx(0.0, abs=0.003)
    assert meshes[:, 2].max() == pytest.approx(spec.height, abs=0.015)


@every_body
def test_looks_stay_inside_the_disc_but_for_the_hands(spec: RobotSpec) -> None:
    reach = math.hypot(*bodies.hand(spec)[:2]) + _HANDS_M if "pick" in spec.capabilities else 0.0
    for part in bodies.look(spec):
        low = part.centre[2] - part.half[2] < 0.6 * bodies.hand(spec)[2]
        limit = spec.radius if low or not reach else max(reach, spec.radius + 0.1)
        assert _outreach(part) <= limit + 0.011, part
    meshes = np.concatenate([piece.mesh.vertices for piece in bodies.pieces(spec)])
    assert np.linalg.norm(meshes[:, :2], axis=1).max() <= max(spec.radius, reach) + 0.011


@every_body
def test_solids_are_solid(spec: RobotSpec) -> None:
    for part in bodies.look(spec):
        assert min(part.half) > 0.0
        assert part.moves in ("", "head")
        if part.shape == "cylinder":
            across = [half for axis, half in zip("xyz", part.half, strict=True) if axis != part.axis]
            assert across[0] == across[1]


@every_body
def test_meshes_are_sound(spec: RobotSpec) -> None:
    for piece in bodies.pieces(spec):
        mesh = piece.mesh
        assert piece.moves in ("", "head")
        assert np.isfinite(mesh.vertices).all()
        assert mesh.faces.min() >= 0
        assert mesh.faces.max() < len(mesh.vertices) == len(mesh.normals) == len(mesh.uv)
        assert np.linalg.norm(mesh.normals, axis=1) == pytest.approx(1.0, abs=1e-4)
    assert sum(len(piece.mesh.faces) for piece in bodies.pieces(spec)) < 60_000


@every_body
def test_meshes_face_outwards(spec: RobotSpec) -> None:
    for piece in bodies.pieces(spec):
        a, b, c = (piece.mesh.vertices[piece.mesh.faces[:, k]] for k in range(3))
        cross = np.cross(b - a, c - a)
        along = np.einsum("ij,ij->i", cross, piece.mesh.normals[piece.mesh.faces[:, 0]])
        assert np.linalg.norm(cross, axis=1)[along < 0.0].sum() <= 0.03 * np.linalg.norm(cross, axis=1).sum()


def test_no_two_bodies_look_alike() -> None:
    assert len({bodies.look(spec) for spec in FIGURES}) == len(FIGURES)


# ------------------------------------------------------------------------------------------------------- head and hand


@every_body
def test_the_eye_is_in_the_head(spec: RobotSpec) -> None:
    heads = [part for part in bodies.look(spec) if part.moves == "head"]
    assert heads
    low = min(part.centre[2] - part.half[2] for part in heads)
    high = max(part.centre[2] + part.half[2] for part in heads)
    assert low <= spec.eye <= high


@every_body
@given(share=st.floats(-1.0, 1.0))
def test_the_head_turns_about_the_neck_and_looks_where_the_camera_does(spec: RobotSpec, share: float) -> None:
    pitch = share * spec.pitch_limit
    rotation, offset = bodies.head_transform(spec, pitch)
    neck = np.array(bodies.neck(spec))
    assert rotation @ neck + offset == pytest.approx(neck)
    assert rotation @ rotation.T == pytest.approx(np.eye(3))
    assert np.linalg.det(rotation) == pytest.approx(1.0)
    assert rotation @ (1.0, 0.0, 0.0) == pytest.approx((math.cos(pitch), 0.0, math.sin(pitch)))


@every_body
def test_what_is_held_lies_on_the_hand_within_reach(spec: RobotSpec) -> None:
    if "pick" not in spec.capabilities:
        pytest.skip("has no hand")
    x, y, z = bodies.hand(spec)
    assert spec.radius < math.hypot(x, y) < spec.reach
    assert spec.reach_low <= z <= spec.reach_high
    assert x > 0.0
    for name in catalog.TARGETS:
        size = catalog.kind(name).size
        centre = bodies.grasp_point(spec, size)
        assert centre[:2] == (x, y)
        assert centre[2] - size[2] / 2 == pytest.approx(z)
        beside = [part for part in bodies.look(spec) if not part.moves]
        assert min(_gap(part, centre) for part in beside) <= max(size) / 2 + 0.012, "something holds it"


def _gap(part: Part, point: tuple[float, float, float]) -> float:
    """Distance from a point to a solid's bounding box [m]."""
    away = np.maximum(np.abs(np.array(point) - part.centre) - part.half, 0.0)
    return float(np.linalg.norm(away))


# ---------------------------------------------------------------------------------------------------------- in a world


@pytest.fixture(scope="module")
def world() -> World:
    return World(tiny.house(), robots=NAMES)


def _seat(world: World, spec: RobotSpec) -> str:
    return next(seat for seat, body in world.bodies.items() if body.name == spec.name)


def _reset(world: World) -> None:
    aside = [Pose(x=6.0 + 0.7 * number, y=1.4 + 1.2 * (number % 2)) for number in range(len(NAMES))]
    world.reset(task(on(TABLE, "apple"), human=Pose(x=5.6, y=3.4), robots=tuple(aside)))


@every_robot
def test_every_robot_moves_and_turns_and_tilts(world: World, spec: RobotSpec) -> None:
    _reset(world)
    seat = _seat(world, spec)
    world.teleport(seat, Pose(x=1.5, y=1.2))
    assert reason(world, seat, Move(forward=0.4)) == ""
    assert reason(world, seat, Rotate(yaw=math.pi / 2, pitch=spec.pitch_limit / 2)) == ""
    pose = world.pose(seat)
    assert (pose.x, pose.y) == pytest.approx((1.9, 1.2))
    assert (pose.yaw, pose.pitch) == pytest.approx((math.pi / 2, spec.pitch_limit / 2))


@every_robot
def test_every_robot_senses(world: World, spec: RobotSpec) -> None:
    _reset(world)
    seat = _seat(world, spec)
    world.teleport(seat, Pose(x=1.0, y=1.0))
    scan = world.scan(seat)
    assert len(scan.ranges) == spec.scan_beams
    assert (scan.ranges <= spec.scan_range).all()
    assert scan.ranges.min() < spec.scan_range
    assert isinstance(world.detections(seat), tuple)


@every_robot
def test_every_robot_that_picks_fetches_an_object(world: World, spec: RobotSpec) -> None:
    _reset(world)
    seat = _seat(world, spec)
    standing = Pose(x=2.5, y=2.6 + 0.45 + spec.radius + 0.06, yaw=-math.pi / 2)
    world.teleport(seat, standing)
    if "pick" not in spec.capabilities:
        assert "cannot pick" in reason(world, seat, Pick(object="apple"))
        return
    assert reason(world, seat, Pick(object="apple")) == ""
    assert world.holding(seat) == "apple"
    held = next(state.position for state in world.truth() if state.id == "apple")
    assert math.dist(held[:2], (standing.x, standing.y)) == pytest.approx(math.hypot(*bodies.hand(spec)[:2]))
    world.teleport(seat, Pose(x=4.1, y=1.15, yaw=-math.pi / 2))
    events = do(world, seat, Place(on=COUNTER))
    assert [event.kind for event in events] == ["placed"]
    assert next(state.support for state in world.truth() if state.id == "apple") == COUNTER


@every_robot
def test_every_robot_that_opens_opens_the_fridge(world: World, spec: RobotSpec) -> None:
    _reset(world)
    seat = _seat(world, spec)
    world.teleport(seat, Pose(x=0.9, y=2.5, yaw=math.pi / 2 + 0.3))
    if "open" in spec.capabilities:
        assert reason(world, seat, Open(thing=tiny.FRIDGE)) == ""
        assert reason(world, seat, Close(thing=tiny.FRIDGE)) == ""
    else:
        assert "cannot open" in reason(world, seat, Open(thing=tiny.FRIDGE))


# ------------------------------------------------------------------------------------------------------- a user's file

MINE = """
from hthor.types import RobotSpec
from hthor.world.model.bodies.primitives import ball

SPEC = RobotSpec(
    name="{name}", title="my robot", radius=0.15, height=0.3, eye=0.2, fov=(1.5, 1.5), speed=1.0, turn_rate=2.0,
    sight_range=1.5, scan_range=4.0, scan_beams=31, pitch_limit=0.5, capabilities=frozenset({{"navigate"}}),
)


def look():
    return (ball((0.0, 0.0, 0.15), 0.15, (1.0, 0.0, 0.0, 1.0), "head"),)
"""


def test_a_user_s_robot_is_one_file(tmp_path: Path) -> None:
    file = tmp_path / "rover_of_mine.py"
    file.write_text(MINE.format(name="rover_of_mine"))
    spec = bodies.load_robot(str(file))
    assert spec.name == "rover_of_mine"
    assert [part.shape for part in bodies.look(spec)] == ["sphere"]
    assert len(bodies.pieces(spec)) == 1
    world = World(tiny.house(), robots=(str(file),))
    assert world.bodies["robot"] == spec
    assert bodies.load_robot("rover_of_mine") == spec, "known by its name once it was loaded"
    assert len(plugins.sha256(str(file))) == 64


def test_a_run_knows_the_file_and_notices_a_change(tmp_path: Path) -> None:
    file = tmp_path / "rover_that_changes.py"
    file.write_text(MINE.format(name="rover_that_changes"))
    shape = robot_team.load_robot_info(str(file))
    assert (shape.name, shape.path) == ("rover_that_changes", str(file))
    (seat,) = robot_team.form_team([shape], ["frontier"]).seats
    assert seat.robot_sha256 == plugins.sha256(str(file))
    stage = TrialRunner(Sources(robot_paths={"robot": shape.path}))
    assert stage._robot(seat) == bodies.load_robot(str(file))
    file.write_text(file.read_text() + "# faster")
    with pytest.raises(HthorError, match="was changed while its run was going on"):
        stage._robot(seat)


def test_robots_that_ship_with_hthor_are_covered_by_the_code_s_hash() -> None:
    assert robot_team.load_robot_info("porter") == robot_team.RobotInfo(
        name="porter", sha256=code_identity.robot_sha256("porter")
    )
    with pytest.raises(UnknownName, match="or give the path of a Python file"):
        robot_team.load_robot_info("portr")


def test_a_body_made_from_a_record_has_a_plain_look() -> None:
    spec = msgspec.structs.replace(bodies.load_robot("scout"), name="nobody_s")
    assert len(bodies.look(spec)) == 3
    assert bodies.neck(spec)[2] < spec.height
    assert World(tiny.house(), robots=(spec,)).bodies["robot"].name == "nobody_s"


@pytest.mark.parametrize(
    ("name", "text", "expected"),
    [
        ("scout.py", "", "rename it"),
        ("wrong_name.py", MINE.format(name="other"), "a RobotSpec called 'other'"),
        ("no_spec.py", "x = 1", "must define 'SPEC'"),
        ("no_robot.py", "SPEC = 3", "it is a int"),
        ("broken.py", "import nonsense_that_is_not_there", "The file must load by itself"),
        ("two words.py", "", "rename it"),
    ],
)
def test_bad_files_are_refused_with_the_reason(tmp_path: Path, name: str, text: str, expected: str) -> None:
    (tmp_path / name).write_text(text)
    with pytest.raises(HthorError, match=expected):
        bodies.load_robot(str(tmp_path / name))


def test_two_files_of_one_name_are_told_apart(tmp_path: Path) -> None:
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "twin.py").write_text(MINE.format(name="twin"))
    bodies.load_robot(str(tmp_path / "a" / "twin.py"))
    assert bodies.load_robot(str(tmp_path / "a" / "twin.py")).name == "twin"
    with pytest.raises(HthorError, match="rename one of them"):
        bodies.load_robot(str(tmp_path / "b" / "twin.py"))


def test_unknown_robots_are_named() -> None:
    with pytest.raises(UnknownName, match="Did you mean 'scout'"):
        bodies.load_robot("scot")
    with pytest.raises(UnknownName, match="must lead to a Python file"):
        bodies.load_robot("nowhere/robot.py")
