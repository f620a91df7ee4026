"""What all parts measure on: the houses of a suite, a world of each, and a walk through it that never changes."""

from __future__ import annotations

from collections.abc import Iterator

from msgspec import Struct

from hthor import rules, tasks
from hthor.houses.space.geodesic import house_geodesics
from hthor.navigation.path_follower import Follower
from hthor.trials import TrialRunner
from hthor.trials.robot_team import RobotTeam
from hthor.trials.sessions import Session, make_sessions
from hthor.types import HUMAN, Motion, TaskSpec, Vec2, Wait
from hthor.world import World

TICKS = round(90.0 / rules.TICK_S)
"""Of one whole trial."""
ROBOT = "robot"
SUITE = "smoke"
"""What is measured unless somebody says otherwise: tasks in all ten scenes."""


class Scene(Struct, frozen=True):
    """A house of the suite with a task in it, and the world of a person and one robot there."""

    name: str
    task: TaskSpec
    world: World


def scenes(suite: str) -> tuple[Scene, ...]:
    """One for every house of the suite, with its first task."""
    stage, found = TrialRunner(), {}
    for session in make_sessions(tasks.load_suite(suite), agent="frontier"):
        for trial in session.trials:
            if trial.task.house not in found:
                found[trial.task.house] = Scene(trial.task.house, trial.task, stage.world(trial))
    return tuple(found[name] for name in sorted(found))


def hands(suite: str, agent: str | RobotTeam) -> tuple[Session, ...]:
    """The sessions of the suite with one robot's mind, or with a crew."""
    return make_sessions(tasks.load_suite(suite), agent=agent)


Walk = list[tuple[int, str, Motion]]
"""Motions and the tick and seat at which each begins."""


def walk(scene: Scene, ticks: int = TICKS) -> Walk:
    """Motions that take the person and the robot from thing to thing through the whole house."""
    world, written = scene.world, []
    world.reset(scene.task)
    tours = {seat: _tour(world, seat, seat != HUMAN) for seat in (HUMAN, ROBOT)}
    followers = {seat: Follower() for seat in tours}
    for tick in range(ticks):
        for seat, tour in tours.items():
            if world.idle(seat):
                motion = _next(world, seat, followers[seat], tour)
                written.append((tick, seat, motion))
                world.start(seat, motion)
        world.advance()
    return written


def _tour(world: World, seat: str, backwards: bool) -> Iterator[Vec2]:
    """Free places beside all things, again and again; the robot goes the other way round."""
    things = sorted(world.house.things, key=lambda thing: (thing.room, thing.id), reverse=backwards)
    spots = [world.space[seat].nearest_free(*thing.centre[:2]) for thing in things]
    while True:
        yield from spots


def _next(world: World, seat: str, follower: Follower, tour: Iterator[Vec2]) -> Motion:
    pose, spec = world.pose(seat), world.bodies[seat]
    outcome = world.outcome(seat)
    if follower.done or (outcome is not None and not outcome.ok):
        ways = house_geodesics(world.house, spec.radius, spec.height)
        follower.take(ways.path(world.space[seat].nearest_free(pose.x, pose.y), next(tour)))
    return follower.next(pose) or Wait(seconds=rules.TICK_S)
