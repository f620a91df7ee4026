"""A world without an engine and agents by a script, for tests of the episode."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from hthor import houses, tasks
from hthor.types import (
    HUMAN,
    Action,
    AgentRef,
    BodySpec,
    Briefing,
    HumanSeat,
    Motion,
    Observation,
    Outcome,
    Pose,
    RobotSeat,
    Snapshot,
    TaskSpec,
    ThingState,
    TrialSpec,
)
from hthor.types.events import Event

TASK = next(task for task in tasks.load_suite("smoke").tasks if task.kind == "object_goal_navigation")
BODY = BodySpec(
    name="box",
    title="box",
    radius=0.2,
    height=1.0,
    eye=0.9,
    fov=(1.0, 1.0),
    speed=1.0,
    turn_rate=1.0,
    sight_range=1.5,
    scan_range=5.0,
    scan_beams=3,
    pitch_limit=0.5,
    capabilities=frozenset({"navigate"}),
)


class Stage:
    """Time passes, motions take ``busy`` ticks, and the target comes into view at tick ``seen``."""

    def __init__(self, seats: tuple[str, ...] = (HUMAN, "robot"), *, seen: int = 10**9, busy: int = 1) -> None:
        self.seats, self.bodies = seats, dict.fromkeys(seats, BODY)
        self.house = houses.load(TASK.house)
        self.label_kinds = ("wall", "apple", "floor")
        self.seen, self.busy = seen, busy
        self.started: list[tuple[int, str, Motion]] = []
        self.frames, self.carrying = 0, False
        self.things: dict[str, ThingState] = {thing.id: thing for thing in self.truth()}

    def reset(self, task: TaskSpec, seed: int = 0) -> None:
        self.tick, self.free_at = 0, dict.fromkeys(self.seats, 0)

    def idle(self, seat: str) -> bool:
        return self.tick >= self.free_at[seat]

    def start(self, seat: str, motion: Motion) -> None:
        self.started.append((self.tick, seat, motion))
        self.free_at[seat] = self.tick + self.busy

    def advance(self) -> tuple[Event, ...]:
        self.tick += 1
        return ()

    def outcome(self, seat: str) -> Outcome | None:
        return None

    def pose(self, seat: str) -> Pose:
        return Pose(x=self.tick / 1000, y=0.0)

    def holding(self, seat: str) -> str:
        return ""

    def room(self, seat: str) -> str:
        return "kitchen"

    def senses(self, seat: str) -> Any:
        return None

    frozen_senses = senses

    def truth(self) -> tuple[ThingState, ...]:
        return (ThingState(id="apple", kind="apple", position=(0.0, 0.0, 0.0)),)

    def snapshot(self) -> Snapshot:
        view = (TASK.goal.target,) if self.tick >= self.seen else ()
        held = {HUMAN: "apple" if self.carrying else ""}
        return Snapshot(tick=self.tick, poses={}, things=self.things, in_view={HUMAN: view}, holding=held)

    def frame(self, seat: str) -> Callable[[], Any]:
        def render() -> int:
            self.frames += 1
            return self.frames

        return render


class Mind:
    """Does what ``script`` says at each tick, and remembers what it observed."""

    def __init__(self, script: Callable[[Observation], Action] = lambda _: Action()) -> None:
        self.script, self.observed = script, list[Observation]()

    def begin(self, briefing: Briefing) -> None:
        self.briefing = briefing

    def act(self, observation: Observation) -> Action:
        self.observed.append(observation)
        return self.script(observation)

    def rate(self, met: bool, tick: int) -> int | None:
        return 5 if met else 3

    def state(self) -> dict[str, Any]:
        return {}


def trial(*privileges: str) -> TrialSpec:
    agent = AgentRef(name="a", source="a", sha256="0", privileges=privileges)
    return TrialSpec(
        task=TASK,
        robots=(RobotSeat(seat="robot", robot="box", agent=agent),),
        humans=(HumanSeat(seat="human", model="proxy", sha256="0", participant=0),),
        session=0,
        index=0,
        seed=0,
        suite_sha256="0",
        rules_sha256="0",
        code_sha256="0",
    )
