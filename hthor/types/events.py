"""Events of a trial, snapshots of its true state, and the contract of agents and human models."""

from collections.abc import Mapping
from typing import Any, Protocol

from msgspec import Struct

from hthor.types.actions import Action
from hthor.types.house import Pose
from hthor.types.observations import Briefing, Observation, ThingState


class Event(Struct, frozen=True, kw_only=True):
    """Something that a ``seat`` did at a ``tick``; ``kind`` names it, and its ``data`` depend on the kind."""

    tick: int
    seat: str
    kind: str
    data: dict[str, Any] = {}


class Snapshot(Struct, frozen=True, kw_only=True):
    """The true state at one tick, for judging and logging; never given to an agent or a human model.

    Attributes:
        poses: seat -> pose of its body. holding: seat -> id of the object in its hand, empty for none.
        things: id -> state of every object and every thing that opens.
        in_view: every person's seat -> ids of the objects in view within `rules.FIND_RANGE_M`.
    """

    tick: int
    poses: Mapping[str, Pose]
    things: Mapping[str, ThingState]
    in_view: Mapping[str, tuple[str, ...]]
    holding: Mapping[str, str]


class Mind(Protocol):
    """The program that controls the body in a seat: an agent for a robot, a human model for the person.

    A robot's agent is created for every trial; one human model plays all trials of a session.
    """

    def begin(self, briefing: Briefing) -> None:
        """Called once before a trial, before time starts to count.

        Raises:
            Exception: any exception of a robot's agent is logged as a fault; the trial goes on, and the robot's body
                stands still throughout it. An exception of a human model ends the run.
        """
        ...

    def act(self, observation: Observation) -> Action:
        """Called whenever the body is free for a new motion, and whenever the seat's inbox or receipt has changed.

        A tick lasts `rules.TICK_S` [s]. All seats that are called in a tick observe the same moment; only then do their
        actions take effect. In lock-step the world waits for the answer. With another clock (``TrialSpec.clock``) the
        action takes effect after as many ticks as the answer took, and until then the seat is not called again.

        Args:
            observation: valid only during this call; reading its sensors later raises `StaleObservation`.

        Returns:
            one motion and at most one utterance. While ``observation.idle`` is false the motion is ignored. A motion
            that a rule forbids is refused and costs one tick; the ``outcome`` of the next observation says why.

        Raises:
            Exception: any exception of a robot's agent, or a result that is not an `Action`, is logged as a fault: the
                body stays where it is for the rest of the trial. An exception of a human model ends the run.
        """
        ...
