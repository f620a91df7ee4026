"""Settings of a run that depart from the benchmark's, with which it cannot be ranked; knows nothing of results."""

from __future__ import annotations

from hthor.detectors import OWN
from hthor.eval.session import people_for
from hthor.eval.setup import PROCEDURAL, Setup


def of(plan: Setup, crew: tuple[str, ...] = ()) -> dict[str, str]:
    """What is set otherwise, and how.

    Args:
        crew: the bodies that the suite is made for, empty when that is not known.
    """
    found: dict[str, str] = {}
    if plan.participants != people_for(plan.trials):
        found["participants"] = str(plan.participants)
    if plan.limit:
        found["limit"] = str(plan.limit)
    if plan.houses:
        found["house"] = ", ".join(plan.houses)
    if plan.difficulty:
        found["difficulty"] = plan.difficulty
    if plan.step_limit_s:
        found["step_limit"] = f"{plan.step_limit_s:g}"
    if plan.kind is not None:
        found["kind"] = plan.kind.name
    if plan.assets.name != PROCEDURAL:
        found["assets"] = plan.assets.name
    for seat in plan.seats:
        if seat.detector != OWN:
            found["detector"] = seat.detector
        if seat.camera:
            found["camera"] = seat.camera
        if seat.robot_sha256:
            found["robot"] = f"{seat.robot}.py"
    bodies = tuple(seat.robot for seat in plan.seats)
    if bodies and crew and bodies != crew:
        found["robots"] = ",".join(bodies)
    return found
