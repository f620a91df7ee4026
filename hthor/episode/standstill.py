"""How long a body has stood still, for goals that somebody meets by stopping at a place."""

from hthor.types import Pose, Snapshot

StandState = tuple[tuple[float, float, float] | None, int]
"""A copy of what a `Standstill` knows: a pose (x, y [m], yaw [rad]) and the tick since which the body has had it."""


class Standstill:
    """Whether a seat's body stands still: its place and heading do not change, while its head may turn.

    Args:
        seat: whose body. ticks: for how long it has to stand still.
    """

    def __init__(self, seat: str, ticks: int) -> None:
        self.seat, self.ticks = seat, ticks
        self.state: StandState = (None, 0)

    def lasts(self, snapshot: Snapshot) -> bool:
        """Whether the body has stood still for long enough; call at every tick at which it is where it should stop."""
        pose: Pose = snapshot.poses[self.seat]
        now = (pose.x, pose.y, pose.yaw)
        before, since = self.state
        if now != before:
            since = snapshot.tick
            self.state = (now, since)
        return snapshot.tick - since >= self.ticks

    def leave(self) -> None:
        """Forget the pose: the body is not where it should stop."""
        self.state = (None, 0)
