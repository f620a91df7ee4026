"""Laws of saved states: the same future, byte for byte, in the same world and in another; and frozen senses."""

from __future__ import annotations

import contextlib
import hashlib
import math
import random
import threading
import zlib
from collections.abc import Iterator
from typing import Any

import mirror_agent
import msgspec
import numpy as np
import pytest
import world_house as tiny
from world_house import TABLE, do, on, task, wait

from hthor.errors import HthorError, StaleObservation
from hthor.types import Close, Drive, Drop, Motion, Move, Open, Pick, Place, Pose, Rotate, Wait
from hthor.world import World, saved_state
from hthor.world.rendering.lazy_images import MODES
from hthor.world.seat_senses import MEASURED

OBJECTS = [(id, id.partition("_")[0]) for id in ("apple", "mug", "book", "bowl", "trunk", "trunk_2")]
DETECTORS = ("noisy", "miss=0.3,false_alarm=0.4,position_sigma=0.05")
DOOR = "door|1|2"


def build() -> World:
    """Two people and three robots in a house with a door, a fridge and a drawer."""
    house = tiny.house()
    openings = tuple(msgspec.structs.replace(one, openable=one.id == DOOR) for one in house.openings)
    things = (*house.things, tiny.thing("dresser|1", "dresser", 1.2, 0.3))
    house = msgspec.structs.replace(house, openings=openings, things=things)
    return World(house, robots=("tender", "porter", "scout"), objects=OBJECTS, detectors=DETECTORS, people=2)


@pytest.fixture(scope="module")
def worlds() -> tuple[World, World]:
    return build(), build()


class Script:
    """Draws what happens next: motions, drives, throws and jumps, whatever the state of the world."""

    def __init__(self, seed: int) -> None:
        self.random = random.Random(seed)

    def play(self, world: World, ticks: int) -> Iterator[bytes]:
        """Let ticks pass; all that can be seen of each."""
        draw = self.random
        for _ in range(ticks):
            for seat in world.seats:
                if draw.random() < 0.03:
                    self.jump(world, seat)
                if draw.random() < 0.4 and world.idle(seat):
                    world.start(seat, self.motion(world, seat))
                elif draw.random() < 0.02:
                    world.start(seat, Drive(forward=0.5, yaw=draw.uniform(-3, 3)))
            if draw.random() < 0.05:
                self.throw(world)
            for _ in range(draw.choice((0, 0, 2, 6))):
                world.substep()
            yield seen(world, world.advance())

    def motion(self, world: World, seat: str) -> Motion:
        draw, kind = self.random, self.random.random()
        if kind < 0.25:
            return Drive(
                forward=draw.uniform(-1, 1), left=draw.uniform(-1, 1), yaw=draw.uniform(-4, 4), pitch=draw.random()
            )
        if kind < 0.45:
            return Move(forward=draw.uniform(-0.35, 0.35), left=draw.uniform(-0.35, 0.35))
        if kind < 0.6:
            return draw.choice(
                (Rotate(yaw=draw.uniform(-2, 2), pitch=draw.uniform(-0.3, 0.3)), Wait(seconds=draw.random()))
            )
        if kind < 0.8:
            if world.holding(seat):
                return draw.choice((Drop(), Place(on=draw.choice((TABLE, tiny.COFFEE, "floor")))))
            return Pick(object=draw.choice([state.id for state in world.objects()]))
        return draw.choice((Open, Close))(thing=draw.choice((tiny.FRIDGE, DOOR, "dresser|1", "door|1|2")))

    def jump(self, world: World, seat: str) -> None:
        """Next to something."""
        draw = self.random
        targets = [state.position for state in world.truth()]
        (x, y, _), angle, far = draw.choice(targets), draw.uniform(-math.pi, math.pi), draw.uniform(0.45, 0.8)
        with contextlib.suppress(HthorError):
            world.teleport(seat, Pose(x=x + far * math.cos(angle), y=y + far * math.sin(angle), yaw=angle + math.pi))

    def throw(self, world: World) -> None:
        draw = self.random
        place = (draw.uniform(0.5, 9.5), draw.uniform(0.5, 3.5), draw.uniform(0.3, 2.0))
        velocity = [draw.uniform(-5, 5) for _ in range(3)]
        with contextlib.suppress(HthorError):
            world.put_object(draw.choice(OBJECTS)[0], place, velocity=velocity, yaw=draw.uniform(-3, 3))


def seen(world: World, events: Any) -> bytes:
    """All that can be seen of a world now."""
    now = world.snapshot()
    seats = [
        (
            world.idle(seat),
            world.outcome(seat),
            world.room(seat),
            world.detections(seat),
            world.scan(seat).ranges.tobytes(),
        )
        for seat in world.seats
    ]
    state = [
        events,
        dict(now.poses),
        dict(now.things),
        dict(now.in_view),
        dict(now.holding),
        seats,
        world.still,
        now.tick,
    ]
    return msgspec.msgpack.encode(state)


def prepare(world: World, seed: int) -> Script:
    """In the middle of something: of carrying together, of falls and swinging doors, or of anything."""
    script = Script(seed)
    world.reset(task(on(TABLE, "apple", 0.3, 0.1), on(tiny.FRIDGE, "mug", surface=0)), seed=seed)
    world.put_object("trunk", (7.0, 2.9, 0.21))
    world.put_object("trunk_2", (3.2, 1.2, 0.21))
    if seed % 3 == 0:
        world.teleport("human", Pose(x=6.3, y=2.9))
        world.teleport("robot2", Pose(x=7.7, y=2.9, yaw=math.pi))
        for seat in ("human", "robot2"):
            world.start(seat, Pick(object="trunk"))
        wait(world, 30)
        world.start("human", script.random.choice((Move(forward=-0.3), Drive(forward=-0.6, yaw=0.4), Rotate(yaw=1.0))))
        list(script.play(world, script.random.randint(1, 6)))
    elif seed % 3 == 1:
        for seat in world.seats:
            script.jump(world, seat)
        for _ in range(3):
            script.throw(world)
        list(script.play(world, script.random.randint(1, 12)))
    else:
        list(script.play(world, script.random.randint(1, 80)))
    for _ in range(script.random.choice((0, 0, 1, 3))):
        world.substep()
    return script


def check_future(worlds: tuple[World, World], seed: int) -> None:
    one, other = worlds
    script = prepare(one, seed)
    state, drawn = one.save_state(), script.random.getstate()
    future, end = list(script.play(one, 40)), one.save_state()
    list(Script(seed + 1000).play(other, seed % 11))  # the other world is in any state
    for world in (other, one):
        world.load_state(state)
        assert world.save_state() == state
        script.random.setstate(drawn)
        assert list(script.play(world, 40)) == future
        assert world.save_state() == end


@pytest.mark.parametrize("seed", range(9))
def test_a_saved_state_has_the_same_future(worlds: tuple[World, World], seed: int) -> None:
    check_future(worlds, seed)


@pytest.mark.nightly
@pytest.mark.parametrize("seed", range(9, 60))
def test_many_saved_states_have_the_same_future(worlds: tuple[World, World], seed: int) -> None:
    check_future(worlds, seed)


def test_what_the_engine_lost_is_not_in_a_state(worlds: tuple[World, World]) -> None:
    one, other = worlds
    one.reset()
    one.put_object("apple", (4.0, 2.0, 1.5))
    wait(one, 2)
    state = one.save_state()
    item = one.parts.objects.known("apple")
    assert item is not None
    one.env.data.qvel[item.dof] = 1e12
    with pytest.raises(HthorError, match="lost the state"):
        one.advance()
    one.env.data.qvel[item.dof] = 1e12
    one.load_state(state)
    other.load_state(state)
    assert [one.advance() for _ in range(30)] == [other.advance() for _ in range(30)]
    assert one.save_state() == other.save_state()


def test_an_observation_of_before_is_stale(worlds: tuple[World, World]) -> None:
    world, _ = worlds
    world.reset()
    state = world.save_state()
    senses = world.senses("human")
    assert senses.detections() is senses.detections()
    world.load_state(state)
    with pytest.raises(StaleObservation):
        senses.detections()
    senses = world.senses("human")
    world.substep()
    with pytest.raises(StaleObservation):
        senses.scan()


def test_events_to_come_are_kept(worlds: tuple[World, World]) -> None:
    one, other = worlds
    one.reset()
    one.start("human", Pick(object="nothing"))
    other.load_state(one.save_state())
    assert other.outcome("human") == one.outcome("human")
    assert [event.kind for event in other.advance()] == ["refused"]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"house": msgspec.structs.replace(tiny.house(), id="other")}, "its house is tiny .tiny., here it is other"),
        ({"people": 2}, "among its bodies, human2 is missing, here it is person"),
        ({"robots": ("puck",)}, "among its bodies, robot is tender .*, here it is puck"),
        ({"objects": ()}, "among its objects, apple is apple .*, here it is missing"),
        ({"objects": [("apple", "mug")]}, "among its objects, apple is apple .*, here it is mug"),
        ({"detectors": ("noisy",)}, "among its detectors, robot is ideal .*, here it is noisy"),
    ],
)
def test_the_state_of_another_world_is_refused(change, words: str) -> None:
    given: dict[str, Any] = {"house": tiny.house(), "robots": ("tender",), "objects": [("apple", "apple")]}
    one, other = World(**given), World(**{**given, **change})
    other.start("human", Move(forward=0.2))
    wait(other, 1)
    before = other.save_state()
    with pytest.raises(HthorError, match=f"this state belongs to a different world: {words}"):
        other.load_state(one.save_state())
    assert other.save_state() == before


def test_damaged_bytes_are_refused(worlds: tuple[World, World], monkeypatch: pytest.MonkeyPatch) -> None:
    world, _ = worlds
    world.reset()
    state = world.save_state()
    for k in range(0, len(state), 997):
        broken = bytearray(state)
        broken[k] ^= 0x10
        with pytest.raises(HthorError, match=r"this state is damaged|this is not the state of a world|has format"):
            world.load_state(bytes(broken))
    for cut in (0, 10, 60, len(state) - 1):
        with pytest.raises(HthorError, match=r"damaged|not the state"):
            world.load_state(state[:cut])
    for junk in (b"", "text", None, 3, b"hthor world state 2\n"):
        with pytest.raises(
            HthorError, match=r"not the state of a world|has format 2; this version of hthor loads format 1"
        ):
            world.load_state(junk)  # type: ignore[arg-type]
    body = zlib.compress(b"\x00" * 100)
    with pytest.raises(HthorError, match="this state is damaged"):
        world.load_state(b"hthor world state 1\n" + hashlib.sha256(body).digest() + body)
    assert world.save_state() == state
    monkeypatch.setattr(saved_state, "FORMAT", 2)
    with pytest.raises(HthorError, match="format 1; this version of hthor loads format 2"):
        world.load_state(state)


# ------------------------------------------------------------------------------------------------------ frozen senses


def readings(senses: Any) -> list[Any]:
    """All that there is to read, pictures last."""
    found = senses.detections()
    sightings = [senses.sighting(one.id) for one in found]
    return [sightings, *(mirror_agent.plain(getattr(senses, name)()) for name in (*MEASURED, *MODES))]


def test_frozen_senses_stay_at_their_moment(worlds: tuple[World, World]) -> None:
    world, _ = worlds
    prepare(world, 4)
    frozen = [world.frozen_senses(seat) for seat in world.seats]
    now = [readings(world.senses(seat)) for seat in world.seats]
    list(Script(5).play(world, 20))
    assert [readings(senses) for senses in frozen] == now
    world.reset(seed=99)
    assert [readings(senses) for senses in frozen] == now
    assert frozen[0].sighting("nothing").share == 0.0
    assert frozen[0].rgb() is frozen[0].rgb()


def test_frozen_senses_are_read_while_the_world_goes_on(worlds: tuple[World, World]) -> None:
    world, _ = worlds
    script = prepare(world, 7)
    wrong: list[str] = []

    def read(tick: int, seat: str, senses: Any, expected: list[Any]) -> None:
        try:
            if readings(senses) != expected:
                wrong.append(f"{seat} at tick {tick}")
        except Exception as error:
            wrong.append(f"{seat} at tick {tick}: {error!r}")

    threads = []
    for tick in range(25):
        for seat in ("human", "robot"):
            frozen, expected = world.frozen_senses(seat), readings(world.senses(seat))
            threads.append(threading.Thread(target=read, args=(tick, seat, frozen, expected)))
            threads[-1].start()
        list(script.play(world, 1))
        world.picture("human2")
    for thread in threads:
        thread.join()
    assert not wrong


def test_a_frozen_picture_is_drawn_once_and_late(worlds: tuple[World, World]) -> None:
    world, _ = worlds
    world.reset()
    frozen, picture = world.frozen_senses("human"), world.picture("human")
    frame = world.frame("human")
    do(world, "human", Rotate(yaw=2.0))
    assert not np.array_equal(world.picture("human"), picture)
    assert np.array_equal(frozen.rgb(), picture)
    assert np.array_equal(frame(), picture)


def test_nice_pictures_are_drawn_in_any_thread() -> None:
    world = World(tiny.house(), profile="nice")
    try:
        picture = world.picture("human")
    except HthorError as error:
        pytest.skip(str(error))
    frozen, drawn = world.frozen_senses("human"), []
    do(world, "human", Rotate(yaw=1.0))
    thread = threading.Thread(target=lambda: drawn.append(frozen.rgb()))
    thread.start()
    thread.join()
    assert np.array_equal(drawn[0], picture)
    assert np.array_equal(frozen.depth(), frozen.depth())
