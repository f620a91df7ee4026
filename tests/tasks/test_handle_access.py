"""Where a thing for two may stand: both its ends can be taken, whichever is taken first."""

from __future__ import annotations

import math

import world_house as tiny

from hthor import houses, tasks
from hthor.tasks.arrangement.handle_access import are_ends_accessible
from hthor.types import Placement


def trunk(x: float, y: float, yaw: float) -> Placement:
    return Placement(id="trunk", kind="trunk", position=(x, y, 0.2), yaw=yaw, support="room|1")


def test_both_ends_can_be_taken_where_there_is_room_round_the_trunk() -> None:
    assert are_ends_accessible(tiny.house(), trunk(1.2, 1.6, 0.0))


def test_not_in_the_only_doorway_which_it_would_close() -> None:
    assert not are_ends_accessible(tiny.house(), trunk(5.0, 2.0, 0.0))
    assert not are_ends_accessible(tiny.house(), trunk(5.0, 2.0, math.pi / 2))


def test_not_with_one_end_at_a_wall() -> None:
    assert not are_ends_accessible(tiny.house(), trunk(0.6, 1.6, 0.0))


def test_every_trunk_of_the_suite_can_be_taken_by_two() -> None:
    for task in tasks.load_suite("carry").tasks:
        (placement,) = (one for one in task.objects if one.id == task.goal.target)
        assert are_ends_accessible(houses.load(task.house), placement), task.id
