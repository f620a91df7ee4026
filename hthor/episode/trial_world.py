"""The world's side of a trial: what an `Episode` asks of the world that it runs in."""

from collections.abc import Callable, Mapping, Sequence
from typing import Protocol

from hthor.types import BodySpec, Event, HouseSpec, Motion, Outcome, Pose, Senses, Snapshot, TaskSpec, ThingState
from hthor.types.sensors import RgbImage


class TrialWorld(Protocol):
    """A house with bodies in it, which moves on tick by tick; `hthor.world.World` is one.

    A seat names a body: "human", "robot", "robot2" ... Time is counted in ticks of `rules.TICK_S` seconds from `reset`.
    Positions are in metres and angles in radians, in the house's frame: x and y on the floor, z up, yaw
    counter-clockwise from x. A seat that does not exist raises KeyError.
    """

    @property
    def seats(self) -> Sequence[str]:
        """All seats, the human's first."""

    @property
    def bodies(self) -> Mapping[str, BodySpec]:
        """The body in each seat."""

    @property
    def house(self) -> HouseSpec:
        """The house's floor plan."""

    @property
    def tick(self) -> int:
        """Ticks since `reset`."""

    def reset(self, task: TaskSpec, seed: int = 0) -> None:
        """Go back to tick 0 of a task: its objects placed, its bodies at their start poses.

        Args:
            task: of this world's house and objects.
            seed: the root of all random draws of the world, such as detection errors.
        """

    def idle(self, seat: str) -> bool:
        """Whether the body carries out no motion, so that `start` may be called."""

    def start(self, seat: str, motion: Motion) -> None:
        """Begin a motion of an idle body. A motion that is impossible ends at once; `outcome` says why."""

    def outcome(self, seat: str) -> Outcome | None:
        """How the body's last motion ended; None before the first and during one."""

    def advance(self) -> tuple[Event, ...]:
        """Move on by one tick, and return what happened in it."""

    def pose(self, seat: str) -> Pose:
        """Where the body is, and where it looks [m, rad]."""

    def holding(self, seat: str) -> str:
        """The id of the object in the body's hands, empty for none."""

    def room(self, seat: str) -> str:
        """The id of the room that the body is in."""

    def senses(self, seat: str) -> Senses:
        """The body's sensors, to be read during this tick only."""

    def truth(self) -> tuple[ThingState, ...]:
        """The true states of all objects, for agents with the privilege "object_poses"."""

    def snapshot(self) -> Snapshot:
        """The true state of the world at this tick, by which the goal is judged."""

    def frame(self, seat: str) -> Callable[[], RgbImage]:
        """What the body's camera shows at this tick: draws the picture, (height, width, 3) uint8, when called."""
