"""People beside one another: a stranger far away changes nothing; they avoid, let by and leave things to each other."""

from __future__ import annotations

import math

import msgspec
import pytest
import world_house as tiny
from still_person import StillPerson

from hthor import houses, tasks
from hthor.episode import EpisodeLog, play
from hthor.houses.space.free_space import FreeSpace
from hthor.humans.core.other_people import OtherPeople
from hthor.humans.core.trial_context import HumanContext
from hthor.humans.memory.spatial_memory import SpatialMemory
from hthor.humans.motor.locomotion import Walker
from hthor.humans.population.parameters import Parameters
from hthor.tasks.suite import make_suite
from hthor.trials import TrialRunner
from hthor.trials.sessions import make_sessions
from hthor.types import Action, Briefing, Detection, Goal, HumanSeat, Observation, Pose, TaskSpec, TrialSpec, Vec2, Wait
from hthor.types.events import InWay
from hthor.world import World
from hthor.world.model.bodies import avatar

OTHER = "human2"


# -------------------------------------------------------------------------------------- a stranger who is far away


class Witness:
    """A mind that notes what another does, and the first tick at which it sees the stranger."""

    def __init__(self, mind) -> None:
        self.mind, self.course, self.met = mind, [], math.inf

    def __getattr__(self, name: str):
        return getattr(self.mind, name)

    def act(self, observation: Observation) -> Action:
        if any(seen.id == OTHER for seen in observation.detections):
            self.met = min(self.met, observation.tick)
        action = self.mind.act(observation)
        journal = msgspec.json.encode(list(getattr(self.mind, "journal", ())))
        self.course.append((observation.tick, observation.pose, msgspec.json.encode(action.motion), journal))
        return action

    def until(self, tick: float) -> list[tuple[int, Pose, bytes, bytes]]:
        """Tick, pose, motion and whole journal at each decision before a tick."""
        return [step for step in self.course if step[0] < tick]


def with_a_stranger(task: TaskSpec) -> TaskSpec:
    """The task with a start for a second person: the free place farthest from all others, facing away from them."""
    space = FreeSpace.of(houses.load(task.house), avatar.HUMAN.radius, avatar.HUMAN.height)
    rows, columns = space.free.nonzero()
    starts = [(pose.x, pose.y) for pose in (task.human_start, *task.robot_starts[:1])]
    spots = [space.centre_of(int(row), int(column)) for row, column in zip(rows, columns, strict=True)]
    x, y = max(spots, key=lambda spot: min(math.dist(spot, start) for start in starts))
    away = Pose(x=x, y=y, yaw=math.atan2(y - starts[0][1], x - starts[0][0]))
    return msgspec.structs.replace(task, other_human_starts=(away,))


def one_trial(runner: TrialRunner, task: TaskSpec, agent: str, humans: str) -> tuple[EpisodeLog, list[Witness]]:
    suite = make_suite("one", 1, (task,))
    session = make_sessions(suite, agent=agent, humans=humans)[0]
    with runner.enter(session) as company:
        first, robots = Witness(company.humans["human"]), company.ready_agents()
        people = {"human": first, **({OTHER: StillPerson()} if OTHER in company.humans else {})}
        watched = {seat: Witness(mind) for seat, mind in robots.items()}
        log = play(session.trials[0], runner.world(session.trials[0]), people, watched)
        company.finish_trial()
    return log, [first, *watched.values()]


def met_at(log: EpisodeLog, minds: list[Witness]) -> float:
    """The first tick at which anybody sees the stranger, walks into them, or is done because of them."""
    touched = [event.tick for event in log.events if isinstance(event, InWay) and event.by == OTHER]
    return min([*touched, *(mind.met for mind in minds)])


@pytest.fixture(scope="module")
def runner() -> TrialRunner:
    return TrialRunner()


@pytest.mark.parametrize(
    ("house", "agent"),
    [
        ("alder", "frontier"),
        ("willow", "none"),
        pytest.param("alder", "none", marks=pytest.mark.nightly),
        pytest.param("willow", "frontier", marks=pytest.mark.nightly),
        pytest.param("juniper", "none", marks=pytest.mark.nightly),
        pytest.param("juniper", "frontier", marks=pytest.mark.nightly),
    ],
)
def test_a_still_stranger_far_away_changes_nothing_up_to_the_first_meeting(runner, house, agent):
    for task in [task for task in tasks.load_suite("smoke").tasks if task.house == house][:2]:
        given = with_a_stranger(task)
        alone, (first, *_) = one_trial(runner, given, agent, "proxy")
        beside, minds = one_trial(runner, given, agent, "proxy,proxy")
        meeting = met_at(beside, minds)
        assert meeting > 0
        assert first.until(meeting) == minds[0].until(meeting)
        events = [[e for e in log.events if e.tick < meeting and e.seat != OTHER] for log in (alone, beside)]
        assert events[0] == events[1]
        if meeting == math.inf:
            assert alone.ticks == beside.ticks
            assert alone.paths["human"] == beside.paths["human"]
            assert alone.ratings["human"] == beside.ratings["human"]


# ------------------------------------------------------------------------------------------- in each other's way


class Crosser:
    """Walks to a point, with the legs of a proxy."""

    def __init__(self, goal: Vec2, root: int) -> None:
        self.goal, self.root, self.journal = goal, root, ()

    def begin(self, briefing: Briefing) -> None:
        traits = msgspec.structs.replace(Parameters(), stop_every=math.inf, v_pace=0.8)
        self.human, self.walk = HumanContext(traits, self.root, briefing), None

    def act(self, observation: Observation) -> Action:
        self.human.now = observation
        self.human.others.see(observation.tick, observation.detections)
        if self.walk is None:
            self.walker = Walker(self.human, SpatialMemory(tau=600.0), observation.pose.x, observation.pose.y)
            self.walk = self.walker.go(self.goal)
        self.walker.map.sense()
        return Action(motion=next(self.walk, None) or Wait(seconds=0.3))

    def rate(self, met: bool, tick: int) -> int | None:
        return None


def cross(starts: tuple[Pose, Pose], goals: tuple[Vec2, Vec2], root: int) -> tuple[EpisodeLog, World]:
    """Two people walk to two points for 30 s."""
    task = tiny.task(tiny.on(tiny.COFFEE, "apple"), human=starts[0], robots=(Pose(x=9.5, y=0.4),))
    goal = Goal(target="apple", relation="on", destination="dining_table")
    task = msgspec.structs.replace(
        task, kind="mobile_manipulation", goal=goal, other_human_starts=starts[1:], time_limit=30.0
    )
    seats = tuple(HumanSeat(seat=seat, model="crosser", sha256="0", participant=0) for seat in ("human", OTHER))
    hashes = dict.fromkeys(("suite_sha256", "rules_sha256", "code_sha256"), "0")
    trial = TrialSpec(task=task, robots=(), humans=seats, session=0, index=0, seed=0, **hashes)
    world = World(tiny.house(), robots=(), objects=[("apple", "apple")], people=2)
    log = play(trial, world, {"human": Crosser(goals[0], root), OTHER: Crosser(goals[1], root)}, {})
    return log, world


@pytest.mark.parametrize("root", range(4))
def test_two_people_pass_each_other_in_a_doorway_even_with_the_same_luck(root):
    west, east = (4.0, 2.0), (6.2, 2.3)
    starts = (Pose(x=west[0], y=west[1]), Pose(x=east[0], y=east[1], yaw=math.pi))
    log, world = cross(starts, (east, west), root)
    for seat, goal in (("human", east), (OTHER, west)):
        pose = world.pose(seat)
        assert math.dist((pose.x, pose.y), goal) < 0.3, f"{seat} is at ({pose.x:.2f}, {pose.y:.2f})"
    assert sum(isinstance(event, InWay) for event in log.events) < 30


# ------------------------------------------------------------------------------------------- what others seem to do


def seen(seat: str, x: float, y: float = 0.0) -> Detection:
    return Detection(
        id=seat, kind="person", family="person", position=(x, y, 0.9), size=(0.4, 0.4, 1.7), yaw=0.0, distance=1.0
    )


def held(name: str, by: str) -> Detection:
    place = (0.0, 0.0, 1.0)
    return Detection(
        id=name, kind="mug", family="object", position=place, size=place, yaw=0.0, distance=1.0, held_by=by
    )


def test_what_somebody_with_free_hands_is_clearly_nearer_to_is_left_to_them():
    others, here, things = OtherPeople((OTHER, "robot"), 0.1), (0.0, 0.0), {"near": (2.0, 0.0), "far": (6.0, 0.0)}
    assert others.seats == (OTHER,)
    assert others.expected_to_take(5, here, things) == frozenset()
    others.see(5, [seen(OTHER, 5.0)])
    assert others.expected_to_take(5, here, things) == {"far"}
    assert others.is_nearer(5, here, things["far"])
    assert not others.is_nearer(5, here, things["near"])
    assert others.expected_to_take(5, (5.2, 0.0), things) == frozenset(), "as near as they are"
    assert others.expected_to_take(106, here, things) == frozenset(), "not seen for more than ten seconds"
    others.see(6, [seen(OTHER, 5.0), held("mug", by=OTHER)])
    assert others.expected_to_take(6, here, things) == frozenset()
    assert [one.since for one in others.recent(6)] == [5]


def test_alone_there_is_nobody_to_reckon_with():
    others = OtherPeople(("robot", "robot2"), 0.1)
    assert others.seats == ()
    assert others.recent(0) == []
    assert not others.is_nearer(0, (0.0, 0.0), (9.0, 0.0))
