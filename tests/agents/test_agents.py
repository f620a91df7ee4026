"""Robots' minds in a small flat world of their own, and in the real one."""

from __future__ import annotations

import importlib.util
import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hthor import agents, houses, plugins
from hthor.agents.skills.message_timing import MessageTiming, place_phrase, sighting_text
from hthor.errors import AgentError, MissingExtra
from hthor.geometry.plane import wrap
from hthor.guest import load_info
from hthor.types import (
    HUMAN,
    Action,
    BodySpec,
    Briefing,
    Detection,
    Goal,
    HouseSpec,
    Message,
    Move,
    Observation,
    Outcome,
    Placement,
    Pose,
    Receipt,
    Room,
    Rotate,
    Scan,
    Send,
    TaskSpec,
    Thing,
    ThingState,
    Wait,
    Wall,
)
from tests.support.guest_agents import BRIEFING, look

BODY = BodySpec(
    name="disc",
    title="disc",
    radius=0.18,
    height=0.95,
    eye=0.9,
    fov=(1.2, 1.2),
    speed=1.0,
    turn_rate=1.8,
    sight_range=1.5,
    scan_range=5.0,
    scan_beams=61,
    pitch_limit=0.52,
    capabilities=frozenset({"navigate"}),
)
Segment = tuple[float, float, float, float]


def rectangle(x0: float, y0: float, x1: float, y1: float) -> list[Segment]:
    return [(x0, y0, x1, y0), (x1, y0, x1, y1), (x1, y1, x0, y1), (x0, y1, x0, y0)]


TABLE = rectangle(5.4, 1.2, 6.2, 2.0)
WALLS = [*rectangle(0, 0, 7, 4), (3.5, 0, 3.5, 2.5), (3.5, 3.5, 3.5, 4)]
APPLE = (5.6, 1.6, 0.8)


def hit(x: float, y: float, ux: float, uy: float, segments: list[Segment], limit: float) -> float:
    for x0, y0, x1, y1 in segments:
        ex, ey = x1 - x0, y1 - y0
        det = ux * ey - uy * ex
        if abs(det) > 1e-12:
            t, u = ((x0 - x) * ey - (y0 - y) * ex) / det, ((x0 - x) * uy - (y0 - y) * ux) / det
            if 1e-9 < t < limit and -1e-9 <= u <= 1 + 1e-9:
                limit = t
    return limit


class Flat:
    """Two rooms, a doorway, a table with an apple on it in the far room; a robot, and a person who may stand about."""

    def __init__(self, person: tuple[float, float] | None = None, holds: bool = False) -> None:
        self.tick, self.pose, self.busy = 0, Pose(x=1.0, y=1.0, yaw=1.0), 0
        self.person, self.holds, self.apple = person, holds, APPLE
        self.outcome: Outcome | None = None
        self.receipt: Receipt | None = None
        self.sent: list[tuple[int, Send]] = []
        self.news = False

    def scan(self) -> Scan:
        bearings = np.linspace(-0.6, 0.6, 61)
        angles = self.pose.yaw + bearings
        ranges = [hit(self.pose.x, self.pose.y, math.cos(a), math.sin(a), WALLS + TABLE, 5.0) for a in angles]
        return Scan(origin=self.pose, bearings=bearings, ranges=np.array(ranges), limit=5.0)

    def detections(self) -> tuple[Detection, ...]:
        found = [
            self._see("apple", "apple", "object", self.apple, "table", HUMAN if self.holds else ""),
            self._see("table", "dining_table", "furniture", (5.8, 1.6, 0.4), "", ""),
        ]
        if self.person is not None:
            found.append(self._see(HUMAN, "person", "person", (*self.person, 0.9), "", ""))
        return tuple(seen for seen in found if seen is not None)

    def _see(self, name: str, kind: str, family: Any, at: Any, support: str, held: str) -> Detection | None:
        dx, dy = at[0] - self.pose.x, at[1] - self.pose.y
        apart = math.hypot(dx, dy)
        bearing = abs(wrap(math.atan2(dy, dx) - self.pose.yaw))
        if apart > 1.5 or bearing > 0.6 or hit(self.pose.x, self.pose.y, dx / apart, dy / apart, WALLS, apart) < apart:
            return None
        size = (0.1, 0.1, 0.1)
        return Detection(
            id=name,
            kind=kind,
            family=family,
            position=at,
            size=size,
            yaw=0.0,
            distance=apart,
            support=support,
            held_by=held,
        )

    def observe(self, truth: tuple[ThingState, ...] = ()) -> Observation:
        self.news = False
        return Observation(
            tick=self.tick,
            pose=self.pose,
            idle=self.busy <= 0,
            senses=self,
            outcome=self.outcome,
            receipt=self.receipt,
            truth=truth,
        )

    def truth(self) -> tuple[ThingState, ...]:
        held = HUMAN if self.holds else ""
        return (ThingState(id="apple", kind="apple", position=self.apple, support="table", held_by=held),)

    def perform(self, action: Action) -> None:
        if isinstance(action.say, Send):
            self.sent.append((self.tick, action.say))
            self.receipt = Receipt(message=len(self.sent) - 1, status="shown", tick=self.tick)
        if self.busy > 0:
            return
        motion = action.motion
        if isinstance(motion, Move):
            assert math.hypot(motion.forward, motion.left) <= 0.5 + 1e-9
            self._move(motion)
        elif isinstance(motion, Rotate):
            pitch = self.pose.pitch + motion.pitch
            assert abs(pitch) <= BODY.pitch_limit + 1e-9
            self.pose = Pose(x=self.pose.x, y=self.pose.y, yaw=self.pose.yaw + motion.yaw, pitch=pitch)
            self.busy = math.ceil(abs(motion.yaw) / BODY.turn_rate / 0.1)
            self.outcome = Outcome(motion="rotate", ok=True)
        else:
            assert isinstance(motion, Wait)
            self.busy = round(motion.seconds / 0.1)

    def _move(self, motion: Move) -> None:
        cos, sin = math.cos(self.pose.yaw), math.sin(self.pose.yaw)
        dx, dy = cos * motion.forward - sin * motion.left, sin * motion.forward + cos * motion.left
        length = math.hypot(dx, dy)
        self.busy, self.outcome = max(1, math.ceil(length / 0.1)), Outcome(motion="move", ok=True)
        for k in range(1, 51):
            x, y = self.pose.x + dx * k / 50, self.pose.y + dy * k / 50
            by = "wall" if self._clearance(x, y) < BODY.radius - 0.03 else ""
            if self.person is not None and math.dist((x, y), self.person) < BODY.radius + 0.2:
                by = HUMAN
            if by:
                self.outcome = Outcome(motion="move", ok=False, reason="blocked", by=by)
                return
            self.pose = Pose(x=x, y=y, yaw=self.pose.yaw, pitch=self.pose.pitch) if k == 50 else self.pose

    def _clearance(self, x: float, y: float) -> float:
        best = math.inf
        for x0, y0, x1, y1 in WALLS + TABLE:
            ex, ey = x1 - x0, y1 - y0
            t = max(0.0, min(1.0, ((x - x0) * ex + (y - y0) * ey) / (ex * ex + ey * ey)))
            best = min(best, math.hypot(x - x0 - t * ex, y - y0 - t * ey))
        return best


def briefing(house: HouseSpec | None = None, destination: str = "") -> Briefing:
    return Briefing(
        seat="robot",
        instruction="Find an apple.",
        target="apple",
        destination=destination,
        relation="on" if destination else "find",
        body=BODY,
        tick_s=0.1,
        time_limit=90.0,
        house=house,
    )


def live(mind: Any, flat: Flat, ticks: int, told: Briefing | None = None, until: int = 99) -> list[tuple[int, Send]]:
    """Run a mind in the flat; stop when it has sent ``until`` messages."""
    mind.begin(told or briefing())
    omniscient = "object_poses" in mind.privileges
    for _ in range(ticks):
        if flat.busy <= 0 or flat.news:
            flat.perform(mind.act(flat.observe(flat.truth() if omniscient else ())))
        flat.tick, flat.busy = flat.tick + 1, flat.busy - 1
        if len(flat.sent) >= until:
            break
    return flat.sent


def flat_house() -> HouseSpec:
    """The flat as the oracle gets it."""
    corners = ((0.0, 0.0), (7.0, 0.0), (7.0, 4.0), (0.0, 4.0))
    return HouseSpec(
        id="flat",
        sha256="",
        rooms=(Room(id="room", kind="kitchen", name="kitchen", polygon=corners),),
        walls=tuple(
            Wall(id=f"wall{k}", room="room", a=(x0, y0), b=(x1, y1), height=2.5)
            for k, (x0, y0, x1, y1) in enumerate(WALLS)
        ),
        openings=(),
        things=(
            Thing(id="table", kind="dining_table", asset="", centre=(5.8, 1.6, 0.4), size=(0.8, 0.8, 0.8), yaw=0.0),
        ),
        height=2.5,
        start=Pose(x=1.0, y=1.0),
    )


def load(path: Path) -> Any:
    spec = importlib.util.spec_from_file_location(f"agent_{path.stem}", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module.Agent


@pytest.fixture
def frontier() -> Any:
    return plugins.load("agent", "frontier")()


@pytest.fixture(params=["frontier", "nearest"])
def explorer(request: pytest.FixtureRequest) -> Any:
    """A robot that explores, and tells of what it finds."""
    return plugins.load("agent", request.param)()


@pytest.fixture
def oracle() -> Any:
    return plugins.load("agent", "oracle")()


def test_every_agent_follows_the_contract() -> None:
    names = plugins.names("agent")
    assert {"frontier", "oracle", "none"} <= set(names)
    for name in names:
        try:
            made = plugins.load("agent", name)
        except MissingExtra:
            continue
        assert isinstance(getattr(made, "privileges", ()), tuple)
        assert made.__doc__
        assert callable(made.begin)
        assert callable(made.act)
        folder = plugins.file("agent", name).parent
        assert all((folder / file).is_file() for file in getattr(made, "ingredients", ()))
    assert plugins.load("agent", "none").absent
    assert plugins.load("agent", "silent") is plugins.load("agent", "none"), "the word of before"


def test_the_silent_agent_waits() -> None:
    agent = plugins.load("agent", "silent")()
    agent.begin(briefing())
    assert isinstance(agent.act(Flat().observe()).motion, Wait)


def test_a_robot_that_explores_finds_what_is_in_the_other_room_and_says_it_once(explorer: Any) -> None:
    flat = Flat()
    ((tick, message),) = live(explorer, flat, 900)
    assert tick < 600
    assert (message.object, message.position) == ("apple", APPLE)
    assert message.text.replace(" on the dining table", "") == "I found the apple in front of me."
    turn = abs(wrap(math.atan2(APPLE[1] - flat.pose.y, APPLE[0] - flat.pose.x) - flat.pose.yaw))
    assert turn < 0.1, "it should watch the target"


def test_a_robot_that_explores_offers_once_more_after_a_refusal(explorer: Any) -> None:
    flat = Flat()
    live(explorer, flat, 900, until=1)
    ((first, _),) = flat.sent
    flat.receipt = Receipt(message=0, status="declined", tick=first + 20)
    flat.news = True
    explorer.begin = lambda told: None
    live(explorer, flat, 300)
    second = flat.sent[1][0]
    assert first + 120 <= second <= first + 150, "it waits ten seconds, and comes back from where it stood aside"
    flat.receipt = Receipt(message=1, status="declined", tick=second)
    live(explorer, flat, 300)
    assert len(flat.sent) == 2


def test_a_robot_that_explores_says_nothing_of_what_the_person_holds(explorer: Any) -> None:
    assert live(explorer, Flat(holds=True), 900) == []


def test_nothing_is_said_while_the_target_is_out_of_range(frontier: Any) -> None:
    flat = Flat()
    flat.apple = (50.0, 50.0, 1.0)
    assert live(frontier, flat, 900) == []


def test_a_person_in_the_doorway_is_not_pushed(frontier: Any, oracle: Any) -> None:
    for agent, told in ((frontier, briefing()), (oracle, briefing(flat_house()))):
        flat = Flat(person=(3.5, 3.0))
        sent = live(agent, flat, 600, told)
        assert sent == []
        assert math.dist((flat.pose.x, flat.pose.y), (3.5, 3.0)) >= BODY.radius + 0.2
        flat.person = None
        agent.begin = lambda told: None
        assert len(live(agent, flat, 900, until=1)) == 1


def test_the_oracle_goes_straight_to_the_target_and_speaks_when_it_sees_it(oracle: Any) -> None:
    flat = Flat()
    ((tick, message),) = live(oracle, flat, 900, briefing(flat_house()))
    assert tick < 120
    assert message.object == "apple"
    assert 1.2 <= math.dist((flat.pose.x, flat.pose.y), APPLE[:2]) <= 4.0, "it should wait nearby, not in front"


def test_the_oracle_shows_the_destination_once_the_person_has_the_target(oracle: Any) -> None:
    flat = Flat(person=(1.2, 3.4), holds=True)
    flat.apple = (1.2, 3.4, 1.0)
    sent = live(oracle, flat, 900, briefing(flat_house(), "dining_table"))
    assert [message.text for _, message in sent] == ["The dining table is here."]
    assert sent[0][1].object == "table"


def test_the_oracle_offers_three_times_at_most(oracle: Any) -> None:
    flat = Flat()
    live(oracle, flat, 900, briefing(flat_house()), until=1)
    oracle.begin = lambda told: None
    for _ in range(4):
        flat.receipt = Receipt(message=len(flat.sent) - 1, status="declined", tick=flat.tick)
        live(oracle, flat, 200)
    assert len(flat.sent) == 3


def test_offers_wait_ten_seconds() -> None:
    offers = MessageTiming(briefing(), most=2)
    assert offers.due(0, None)
    offers.note(0)
    declined = Receipt(message=0, status="declined", tick=5)
    assert not offers.due(104, declined)
    assert offers.due(105, declined)
    assert not offers.due(500, Receipt(message=0, status="accepted", tick=5))
    offers.note(105)
    assert not offers.due(500, declined)


def test_words() -> None:
    assert place_phrase("fridge") == "in the fridge"
    assert place_phrase("coffee_table") == "on the coffee table"
    flat = Flat()
    flat.pose = Pose(x=4.5, y=1.6)
    apple = flat.detections()[0]
    assert sighting_text(apple, {}) == "I found the apple in front of me."
    assert sighting_text(apple, {"table": "dining_table"}) == "I found the apple on the dining table in front of me."


def test_runs_are_repeated_exactly() -> None:
    ends = []
    for _ in range(2):
        flat = Flat()
        live(plugins.load("agent", "frontier")(), flat, 300)
        ends.append((flat.pose, flat.sent))
    assert ends[0] == ends[1]


def test_the_template_works_as_it_is(tmp_path: Path) -> None:
    path = agents.write_template(tmp_path / "my_agent.py")
    assert len(path.read_text().splitlines()) < 80
    assert load_info(path).privileges == ("ideal_detector",)
    ((tick, message),) = live(load(path)(), Flat(), 900)
    assert tick < 800
    assert message.object == "apple"


def test_the_template_answers_what_it_knows(tmp_path: Path) -> None:
    mind = load(agents.write_template(tmp_path / "my_agent.py"))()
    mind.begin(BRIEFING)
    mug = Message(id=5, sender="human2", tick=0, text="Where is the mug?", object="mug", question=True)
    apple = Message(id=6, sender="human2", tick=0, text="Where is the apple?", object="apple", question=True)
    assert mind.act(look(inbox=(mug,))).say.answers is None
    said = mind.act(look(inbox=(mug, apple))).say
    assert (said.answers, said.object, said.position) == (6, "apple", (1, 2, 0.8))


def test_the_template_overwrites_nothing_unasked(tmp_path: Path) -> None:
    path = tmp_path / "mine.py"
    path.write_text("precious")
    with pytest.raises(AgentError, match="exists already"):
        agents.write_template(path)
    assert path.read_text() == "precious"
    agents.write_template(path, force=True)
    assert "class Agent" in path.read_text()
    with pytest.raises(AgentError, match=r"must end in \.py"):
        agents.write_template(tmp_path / "mine.txt")


def test_the_example_finds_the_apple(root: Path) -> None:
    path = root / "examples" / "sweeper.py"
    ((_, message),) = live(load(path)(), Flat(), 900)
    assert message.object == "apple"


def errand(house: HouseSpec) -> TaskSpec:
    """An apple on the bed that is farthest from the start."""
    bed = max((thing for thing in house.things if thing.kind == "bed"), key=lambda thing: thing.centre)
    top = bed.centre[2] + bed.size[2] / 2
    return TaskSpec(
        id="errand",
        kind="object_goal_navigation",
        house=house.id,
        house_sha256=house.sha256,
        human_start=house.start,
        robot_starts=(house.start,),
        objects=(Placement(id="apple", kind="apple", position=(*bed.centre[:2], top), support=bed.id),),
        goal=Goal(target="apple", relation="find"),
        instruction="Find an apple.",
        time_limit=90.0,
        t_star=10.0,
    )


@pytest.mark.parametrize("name", ["frontier", "oracle"])
def test_a_minute_in_a_real_house(name: str) -> None:
    """Nothing raises, every motion is legal, and the body gets about."""
    pytest.importorskip("hthor.world", reason="the world is not there")
    from hthor.world import World

    house = houses.load(houses.names()[0])
    world = World(house, robots=("scout",), objects=(("apple", "apple"),))
    world.reset(errand(house))
    agent = plugins.load("agent", name)()
    told = briefing(house if name == "oracle" else None)
    agent.begin(told)
    start, refused, far = world.pose("robot"), [], 0.0
    for _ in range(600):
        if world.idle("robot"):
            observation = Observation(
                tick=world.tick,
                pose=world.pose("robot"),
                idle=True,
                senses=world.senses("robot"),
                outcome=world.outcome("robot"),
                truth=world.truth() if name == "oracle" else (),
            )
            world.start("robot", agent.act(observation).motion)
        refused += [event for event in world.advance() if event.seat == "robot" and event.kind == "refused"]
        far = max(far, math.dist((start.x, start.y), (world.pose("robot").x, world.pose("robot").y)))
    assert not refused
    assert far > 1.5
