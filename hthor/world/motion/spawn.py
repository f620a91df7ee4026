"""Places bodies on free floor, clear of each other, at the start of an episode or by hand."""

import math
from collections.abc import Iterable, Sequence

import numpy as np
from msgspec import UNSET
from numpy.typing import NDArray

from hthor.errors import HthorError, TaskError
from hthor.geometry.plane import wrap
from hthor.types import HouseSpec, Pose, TaskSpec, Vec2, is_person
from hthor.world import numbers
from hthor.world.state.body_state import BodyState


def place_bodies(seats: Sequence[BodyState], people: Sequence[Pose], robots: Sequence[Pose]) -> None:
    """Put every seat at its start, or at the free place nearest to it, with its head straight.

    Those with a start of their own come first. A person without one stands as near as possible to the first person's
    start, a robot without one to the first robot's, clear of all bodies that already have their places.

    Args:
        people: the starts of the first people, at least of one. robots: the starts of the first robots.
    """
    persons = [seat for seat in seats if is_person(seat.name)]
    machines = [seat for seat in seats if not is_person(seat.name)]
    placed: list[BodyState] = []
    for seat, pose in (*zip(persons, people, strict=False), *zip(machines, robots, strict=False)):
        _stand(seat, pose, seat.space.nearest_free(pose.x, pose.y))
        placed.append(seat)
    rest = [(seat, people[0]) for seat in persons[len(people) :]]
    rest += [(seat, (robots or people)[0]) for seat in machines[len(robots) :]]
    for seat, pose in rest:
        _stand(seat, pose, _clear_place(seat, pose, placed))
        placed.append(seat)


def _stand(seat: BodyState, pose: Pose, place: Vec2) -> None:
    limit = seat.spec.pitch_limit
    pitch = max(-limit, min(limit, pose.pitch))
    seat.clear(Pose(x=float(place[0]), y=float(place[1]), yaw=wrap(pose.yaw), pitch=float(pitch)))


def _clear_place(seat: BodyState, pose: Pose, others: Sequence[BodyState]) -> Vec2:
    space = seat.space
    place = space.nearest_free(pose.x, pose.y)
    if _is_clear(place, seat, others):
        return place
    free = space.free.copy()
    for row, column in zip(*(free & _cells_near(seat, others)).nonzero(), strict=True):
        if not _is_clear(space.centre_of(int(row), int(column)), seat, others):
            free[row, column] = False
    return space.nearest_free(pose.x, pose.y, free)


def _cells_near(seat: BodyState, others: Sequence[BodyState]) -> NDArray[np.bool_]:
    """(ny, nx) bool, the cells from which the body would touch one of the others, and a few cells more."""
    space, cells = seat.space, np.zeros_like(seat.space.free)
    for other in others:
        reach = math.ceil((seat.spec.radius + other.spec.radius) / space.cell) + 1
        row, column = space.cell_of(other.pose.x, other.pose.y)
        cells[max(row - reach, 0) : row + reach + 1, max(column - reach, 0) : column + reach + 1] = True
    return cells


def _is_clear(place: Vec2, seat: BodyState, others: Sequence[BodyState]) -> bool:
    return all(math.dist(place, (o.pose.x, o.pose.y)) >= seat.spec.radius + o.spec.radius for o in others)


def check_fits(body: BodyState, pose: Pose, seats: Iterable[BodyState]) -> None:
    """Raise HthorError unless ``body`` can be at ``pose``: on free floor, clear of others, head and camera in range."""
    if pose.head is not UNSET and not body.has_neck:
        raise HthorError(f"{body.name} has no neck, so its head cannot be turned")
    limit = body.spec.pitch_limit
    if abs(pose.pitch) > limit + 1e-9:
        raise HthorError(
            f"pitch must be from {-limit:.2f} to {limit:.2f} rad for {body.name}, "
            f"got {numbers.format_number(pose.pitch)} rad"
        )
    here = f"({numbers.format_number(pose.x)}, {numbers.format_number(pose.y)})"
    if not body.space.is_free(pose.x, pose.y):
        raise HthorError(f"{here} is not free for {body.name}; try space['{body.name}'].nearest_free")
    for other in seats:
        least = body.spec.radius + other.spec.radius - 1e-9
        if other is not body and math.dist((pose.x, pose.y), (other.pose.x, other.pose.y)) < least:
            raise HthorError(
                f"{other.name} is in the way at {here}: {body.name} must stay {least:.2f} m away from "
                f"({other.pose.x:.2f}, {other.pose.y:.2f})"
            )


def check_task(task: TaskSpec, house: HouseSpec) -> None:
    """Raise TaskError for a task of another house or another version of it, or with a number that is not finite."""
    if task.house_sha256 and house.sha256 and task.house_sha256 != house.sha256:
        if task.house != house.id:
            problem = f"made for house '{task.house}', and this is house '{house.id}'; make a world of that house"
            raise TaskError(task.id, "house", problem)
        problem = f"made for another version of house '{task.house}'; generate the task again"
        raise TaskError(task.id, "house_sha256", problem)
    try:
        for placement in task.objects:
            numbers.point3(f"position of {placement.id}", placement.position)
            numbers.number(f"yaw of {placement.id}", placement.yaw, "radians")
        for pose in (task.human_start, *task.other_human_starts, *task.robot_starts):
            numbers.pose(pose)
    except HthorError as error:
        raise TaskError(task.id, "objects or starts", str(error)) from None
