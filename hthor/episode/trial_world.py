"""The interface of the world that an `Episode` runs in."""

from collections.abc import Callable, Mapping, Sequence
from typing import Protocol

from hthor.types import (
    BodySpec,
    HouseSpec,
    Motion,
    Outcome,
    Placement,
    Pose,
    Senses,
    Snapshot,
    TaskSpec,
    ThingState,
)
from hthor.types.events import Event
from hthor.types.sensors import RgbImage


class TrialWorld(Protocol):
    """A house with bodies in it, simulated tick by tick; `hthor.world.World` implements it.

    A seat names a body: people sit at "human", "human2" ..., robots at "robot", "robot2" ... Time is counted in ticks
    of `rules.TICK_S` seconds from `reset`. Positions are in metres and angles in radians, in the house's frame: x and y
    on the floor, z up, yaw counter-clockwise from x. A seat that does not exist raises KeyError.
    """

    @property
    def seats(self) -> Sequence[str]:
        """All seats: the people's, then the robots'."""

    @property
    def bodies(self) -> Mapping[str, BodySpec]:
        """The body in each seat."""

    @property
    def house(self) -> HouseSpec:
        """The house's floor plan."""

    @property
    def label_kinds(self) -> Sequence[str]:
        """The kinds of what the numbers of a segmentation stand for in this episode, for ``pixel_labels``."""

    @property
    def tick(self) -> int:
        """Ticks since `reset`."""

    def reset(self, task: TaskSpec, seed: int = 0) -> None:
        """Begin a task at tick 0, with its objects in place and all bodies at their start poses.

        Args:
            task: a task in this world's house, with this world's objects.
            seed: the root of all random draws of the world, such as detection errors.
        """

    def restart(self, task: TaskSpec) -> None:
        """Begin a task as `reset` does, but between two ticks: the ticks and the random draws go on."""

    def rearrange(self, before: Sequence[Placement], after: Sequence[Placement]) -> None:
        """Move the objects whose places differ between two arrangements, between two ticks; also out of hands."""

    def idle(self, seat: str) -> bool:
        """Whether `start` may be called: the body carries out no motion, or drives with its hands free."""

    def start(self, seat: str, motion: Motion) -> None:
        """Begin a motion of an idle body. A motion that is impossible ends at once; `outcome` says why.

        A `Drive` may begin at any time. It lasts until another `Drive`, a `Move`, `Rotate` or `Wait` replaces it.
        """

    def outcome(self, seat: str) -> Outcome | None:
        """How the body's last motion ended; None before the first.

        While a body drives, its outcome says what stops it, and when it is free again.
        """

    def substep(self) -> None:
        """Move the bodies that drive by one of a tick's `hthor.types.SUBTICKS` steps; `advance` makes those left.

        Calling it is optional: with the same set-points at the same steps, the states are the same. After the last step
        of a tick it does nothing until `advance` was called.
        """

    def advance(self) -> tuple[Event, ...]:
        """Advance by one tick, and return the events of this tick."""

    def save_state(self) -> bytes:
        """The whole state of the world: after `load_state`, the same motions have the same results, byte for byte."""

    def load_state(self, state: bytes) -> None:
        """Go back to a state that `save_state` returned, of this world or of another of the same house, bodies and
        objects.

        Raises:
            HthorError: when the state is damaged or belongs to a different world; this world is then unchanged.
        """

    def pose(self, seat: str) -> Pose:
        """The position [m] and heading of the body, and the direction of its head and camera [rad]."""

    def holding(self, seat: str) -> str:
        """The id of the object in the body's hands, empty for none."""

    def room(self, seat: str) -> str:
        """The id of the room that the body is in."""

    def senses(self, seat: str) -> Senses:
        """The body's sensors, to be read during this tick only."""

    def frozen_senses(self, seat: str) -> Senses:
        """The body's sensors, which always answer as of now, even when the world has moved on.

        They may be read in another thread while the world goes on. Making them costs more than `senses`, because what
        cannot be computed later is computed now; pictures are drawn when they are read.
        """

    def truth(self) -> tuple[ThingState, ...]:
        """The true states of all objects, for agents with the privilege "object_poses"."""

    def snapshot(self) -> Snapshot:
        """The true state of the world at this tick, by which the goal is judged."""

    def frame(self, seat: str) -> Callable[[], RgbImage]:
        """A function that draws the picture of the body's camera at this tick, (height, width, 3) uint8."""
