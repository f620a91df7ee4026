"""Episodes of a world: the same every time, no engine work while nothing moves, and one contract for all robots."""

from __future__ import annotations

import hashlib
import math
import os
import subprocess
import sys
from pathlib import Path

import msgspec
import pytest
import world_house as tiny
from world_house import COFFEE, COUNTER, FRIDGE, TABLE, do, on, reason, task, wait

from hthor import houses, plugins, rules
from hthor.errors import HthorError, TaskError, UnknownName
from hthor.houses.space import solids
from hthor.types import BodySpec, Move, Open, Pick, Place, Placement, Pose, RobotSpec, Rotate
from hthor.world import World
from hthor.world.model.engine import mujoco

TESTS = Path(__file__).parent


def play(world: World, robot_moves: bool = True) -> str:
    """A short story with everything in it; the hash of all its states."""
    objects = (on(TABLE, "apple"), on(FRIDGE, "tomato", surface=1), on(COFFEE, "lettuce"))
    human, robot = Pose(x=2.5, y=3.4, yaw=-math.pi / 2), Pose(x=9.0, y=1.0, yaw=2.0)
    world.reset(task(*objects, human=human, robots=(robot,)))
    digest = hashlib.sha256()
    story = [Pick(object="apple"), Move(forward=-0.2), Rotate(yaw=math.pi / 2), Rotate(yaw=-math.pi / 2)]
    story += [Move(forward=0.2), Place(on=TABLE, position=(3.2, 2.97, 0.7)), Pick(object="apple")]
    story += [Place(on=TABLE), Rotate(yaw=-math.pi / 2), Move(forward=0.5), Move(forward=0.5), Rotate(yaw=0.927)]
    story += [Move(forward=0.5), Move(forward=0.5), Rotate(yaw=-2.498), Open(thing=FRIDGE), Pick(object="tomato")]
    for tick in range(120):
        if world.idle("human") and story:
            world.start("human", story.pop(0))
        if robot_moves and "robot" in world.seats and world.idle("robot"):
            world.start("robot", Rotate(yaw=0.3) if tick % 3 else Move(forward=0.3))
        events = world.advance()
        snapshot = world.snapshot()
        seen = world.senses("human").detections() if tick % 2 == 0 else ()
        mine = [thing for thing in seen if thing.id != "robot"]
        news = [event for event in events if event.seat == "human"]
        digest.update(repr((world.pose("human"), snapshot.things, snapshot.in_view, mine, news)).encode())
        digest.update(world.senses("human").scan().ranges.tobytes())
    return digest.hexdigest()


@pytest.fixture(scope="module")
def world() -> World:
    return World(tiny.house(), robots=("scout",))


def test_every_reset_gives_the_same_story(world: World) -> None:
    first = play(world)
    do(world, "human", Rotate(yaw=1.0))
    assert play(world) == first


def test_every_process_gives_the_same_story_and_wakes_no_renderer(world: World) -> None:
    code = (
        "import sys, test_world_episode as t\n"
        "print(t.play(w := t.World(t.tiny.house(), robots=('scout',))))\n"
        "frame = w.frame('robot')\n"
        "late = ('OpenGL', 'glfw', 'mujoco.egl', 'hthor.world.rendering.opengl_renderer')\n"
        "print([m for m in sys.modules if m.startswith(late)])"
    )
    environment = {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "MUJOCO_GL")}
    environment |= {"PYTHONPATH": os.pathsep.join([str(TESTS), str(TESTS.parent), *sys.path]), "PYTHONHASHSEED": "7"}
    command = [sys.executable, "-W", "error", "-c", code]
    out = subprocess.run(command, capture_output=True, text=True, env=environment)
    assert out.stderr == ""
    assert out.stdout.split() == [play(world), "[]"]


def test_a_robot_in_nobody_s_way_changes_nothing(world: World) -> None:
    assert play(world) == play(World(tiny.house()))
    assert play(world, robot_moves=False) == play(world)


def test_the_story_ends_as_told(world: World) -> None:
    play(world)
    assert world.holding("human") == "tomato"


def test_skipping_sleep_gives_the_states_of_stepping_always(world: World) -> None:
    def fall(lazy: bool) -> list[bytes]:
        world.reset(task(on(TABLE, "apple"), on(TABLE, "mug", u=0.3), human=Pose(x=2.5, y=3.4, yaw=-math.pi / 2)))
        env, states = world.env, []
        do(world, "human", Pick(object="apple"))
        do(world, "human", Place(on=TABLE, position=(2.9, 2.8, 0.7)))
        for _ in range(60):
            if lazy:
                world.advance()
            else:
                mujoco.mj_step(env.model, env.data, 5)
            states.append(env.data.qpos.tobytes())
        return states

    assert fall(lazy=True) == fall(lazy=False)


def test_nothing_is_computed_while_nothing_moves(world: World, monkeypatch: pytest.MonkeyPatch) -> None:
    world.reset(task(on(TABLE, "apple")))
    wait(world, 2)
    assert world.still
    monkeypatch.setattr(world.env, "pin", lambda: pytest.fail("the engine was touched"))
    do(world, "human", Move(forward=0.5))
    wait(world, 20)


def test_it_is_a_composer_environment_too(world: World) -> None:
    world.reset(task(on(TABLE, "apple")))
    step = world.env.step(world.env.action_spec().generate_value())
    assert (step.reward, step.discount) == (0.0, 1.0)
    assert world.env.control_timestep() == pytest.approx(rules.TICK_S)


def test_objects_start_where_the_task_says_asleep_and_stay(world: World) -> None:
    apple = on(TABLE, "apple")
    world.reset(task(apple))
    before = {state.id: state for state in world.truth()}
    assert set(before) == {"apple", "book|old", "vase|1", COUNTER, FRIDGE}
    assert (before["apple"].position, before["apple"].support) == (apple.position, TABLE)
    wait(world, 30)
    assert {state.id: state for state in world.truth()} == before


def test_a_fall_ends_on_what_is_below(world: World) -> None:
    """An object let go near a table's edge may roll off; it then lies on the floor, on nothing."""
    world.reset(task(Placement(id="apple", kind="apple", position=(6.5, 3.0, 0.04)), human=Pose(x=6.0, y=3.0)))
    state = next(state for state in world.truth() if state.id == "apple")
    assert state.support == ""
    assert reason(world, "human", Pick(object="apple")) == ""


def test_tasks_of_another_house_or_with_unknown_objects_are_refused(world: World) -> None:
    with pytest.raises(TaskError, match="house_sha256"):
        world.reset(msgspec.structs.replace(task(), house_sha256="other"))
    with pytest.raises(TaskError, match=r"Did you mean 'apple'\?"):
        world.reset(task(msgspec.structs.replace(on(TABLE, "apple"), id="appel")))


def test_worlds_that_cannot_be_built_say_why() -> None:
    with pytest.raises(UnknownName, match=r"Did you mean 'scout'\?"):
        World(tiny.house(), robots=("scot",))
    with pytest.raises(HthorError, match="is taken"):
        World(tiny.house(), objects=((TABLE, "apple"),))
    with pytest.raises(HthorError, match="cannot be picked up"):
        World(tiny.house(), objects=(("couch", "sofa"),))


def test_teleporting_into_furniture_is_an_error(world: World) -> None:
    with pytest.raises(HthorError, match="not free for human"):
        world.teleport("human", Pose(x=2.5, y=2.6))


def test_snapshots_are_cheap_and_fresh(world: World) -> None:
    world.reset(task(on(TABLE, "apple"), human=Pose(x=2.5, y=3.4, yaw=-math.pi / 2)))
    first = world.snapshot()
    wait(world, 1)
    assert world.snapshot().things is first.things
    do(world, "human", Pick(object="apple"))
    assert first.things["apple"].held_by == ""
    assert world.snapshot().things["apple"].held_by == "human"


@pytest.mark.parametrize("name", plugins.names("robot"))
def test_every_robot_keeps_the_contract(name: str) -> None:
    spec: RobotSpec = plugins.load("robot", name)
    assert isinstance(spec, RobotSpec)
    assert spec.name == name
    assert 0.0 < spec.radius < 0.4
    assert 0.0 < spec.eye <= spec.height <= 2.0
    assert spec.pitch_limit <= rules.PITCH_LIMIT_RAD
    assert spec.sight_range <= rules.DETECTOR_RANGE_M
    assert "navigate" in spec.capabilities
    assert ("pick" in spec.capabilities) == (spec.strength > 0.0 and spec.reach > spec.radius)
    world = World(tiny.house(), robots=(name, name))
    first, second = Pose(x=4.0, y=2.0, yaw=math.pi), Pose(x=6.2, y=2.6)
    world.reset(task(on(TABLE, "apple"), human=Pose(x=9.5, y=1.0), robots=(first, second)))
    _fits(world, "robot", spec)
    assert reason(world, "robot", Move(forward=0.3)) == ""
    assert reason(world, "robot", Rotate(yaw=0.5, pitch=-0.2)) == ""
    assert world.senses("robot").scan().ranges.shape == (spec.scan_beams,)
    assert world.senses("robot").detections()


def _fits(world: World, seat: str, spec: BodySpec) -> None:
    """What is drawn stays within a hand's breadth of the cylinder that the world moves, and reaches its height."""
    from hthor.world.model.bodies import bodies

    parts = bodies.look(spec)
    assert max(part.centre[2] + part.half[2] for part in parts) == pytest.approx(spec.height, abs=0.03)
    assert min(part.centre[2] - part.half[2] for part in parts) >= -1e-9
    for part in parts:
        assert abs(part.centre[1]) + part.half[1] <= spec.radius + 0.06


def test_the_avatar_fits_its_body(world: World) -> None:
    _fits(world, "human", world.bodies["human"])


@pytest.mark.parametrize(
    "name",
    [name if name in ("cedar", "willow") else pytest.param(name, marks=pytest.mark.nightly) for name in houses.names()],
)
def test_our_own_houses_can_be_lived_in(name: str) -> None:
    world = World(name, robots=("scout",))
    wait(world, 10)
    assert world.still
    assert set(solids.furniture_slabs(world.house)) == set(solids.furniture_slabs(houses.load(name)))


def test_sample_houses_can_be_lived_in(samples: list[Path]) -> None:
    databases = samples[0].parent / "databases"
    world = World(houses.load(samples[0], assets=databases), robots=("tender",))
    before = world.truth()
    wait(world, 10)
    assert world.still
    assert world.truth() == before
