"""What the tasks assume of the person's body is what the world gives it."""

from __future__ import annotations

from hthor import rules
from hthor.tasks.arrangement import reachability as assumed
from hthor.world.model.bodies.avatar import HUMAN


def test_tasks_and_world_mean_the_same_body() -> None:
    assert (
        HUMAN.radius,
        HUMAN.height,
        HUMAN.eye,
        HUMAN.reach,
    ) == (assumed.RADIUS_M, assumed.HEIGHT_M, assumed.EYE_M, assumed.REACH_M)


def test_nobody_is_faster_than_the_shortest_time_assumes() -> None:
    assert HUMAN.speed <= rules.PACE_M_S
    assert HUMAN.handling >= rules.HANDLING_S
