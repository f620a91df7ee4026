"""Putting bodies where an episode begins: on free floor and clear of each other."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hthor.geometry.plane import wrap
from hthor.types import Pose, Vec2
from hthor.world.state.body_state import BodyState


def place_bodies(seats: Sequence[BodyState], human: Pose, robots: Sequence[Pose]) -> None:
    """Put every seat at its start, or at the free place nearest to it.

    A robot without a start of its own stands nearest to the first robot's, clear of the bodies before it.
    """
    first = robots[0] if robots else human
    for number, seat in enumerate(seats):
        given = human if number == 0 else robots[number - 1] if number <= len(robots) else None
        pose = first if given is None else given
        x, y = (
            seat.space.nearest_free(pose.x, pose.y) if given is not None else _clear_place(seat, pose, seats[:number])
        )
        limit = seat.spec.pitch_limit
        pitch = max(-limit, min(limit, pose.pitch))
        seat.clear(Pose(x=float(x), y=float(y), yaw=wrap(pose.yaw), pitch=float(pitch)))


def _clear_place(seat: BodyState, pose: Pose, others: Sequence[BodyState]) -> Vec2:
    space, free = seat.space, seat.space.free.copy()
    for row, column in zip(*(free & _cells_near(seat, others)).nonzero(), strict=True):
        if not _is_clear(space.centre_of(int(row), int(column)), seat, others):
            free[row, column] = False
    if _is_clear((pose.x, pose.y), seat, others):
        return space.nearest_free(pose.x, pose.y)
    return space.nearest_free(pose.x, pose.y, free)


def _cells_near(seat: BodyState, others: Sequence[BodyState]) -> NDArray[np.bool_]:
    """(ny, nx) cells around the others, a little more than those from which the body would touch them."""
    space, cells = seat.space, np.zeros_like(seat.space.free)
    for other in others:
        reach = math.ceil((seat.spec.radius + other.spec.radius) / space.cell) + 1
        row, column = space.cell_of(other.pose.x, other.pose.y)
        cells[max(row - reach, 0) : row + reach + 1, max(column - reach, 0) : column + reach + 1] = True
    return cells


def _is_clear(place: Vec2, seat: BodyState, others: Sequence[BodyState]) -> bool:
    return all(math.dist(place, (o.pose.x, o.pose.y)) >= seat.spec.radius + o.spec.radius for o in others)
