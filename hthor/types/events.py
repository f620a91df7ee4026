"""What has happened, what is true, and the contract of agents and human models."""

from collections.abc import Mapping
from typing import Any, Protocol

from msgspec import Struct

from hthor.types.actions import Action
from hthor.types.house import Pose
from hthor.types.observations import Briefing, Observation, ThingState


class Event(Struct, frozen=True, kw_only=True):
    """Something that happened: at which ``tick``, by which ``seat``, of which ``kind``, with ``data`` by kind."""

    tick: int
    seat: str
    kind: str
    data: dict[str, Any] = {}


class Snapshot(Struct, frozen=True, kw_only=True):
    """The truth at one tick, for judging and logging; never given to an agent or a human model.

    Attributes:
        poses: seat -> pose of its body. holding: seat -> id of the object in hand, empty for none.
        things: id -> state of every object and every thing that opens.
        in_view: the person's seat -> ids of the objects in view within `rules.FIND_RANGE_M`.
    """

    tick: int
    poses: Mapping[str, Pose]
    things: Mapping[str, ThingState]
    in_view: Mapping[str, tuple[str, ...]]
    holding: Mapping[str, str]


class Mind(Protocol):
    """What decides for the body in a seat: an agent for a robot, a human model for the person.

    A robot's mind is new in every trial; a human model goes through the trials of a session.
    """

    def begin(self, briefing: Briefing) -> None:
        """Called once before a trial, before time starts to count.

        Raises:
            Exception: of any kind from a robot's mind is logged as a fault: its body stands still for the whole trial,
                which goes on. From a human model it ends the run.
        """
        ...

    def act(self, observation: Observation) -> Action:
        """Called whenever the body is free for a new motion, and whenever the mail of the seat has changed.

        Ticks last `rules.TICK_S` [s]. All seats that are asked in a tick see the same moment; then their actions take
        effect. In lock-step the world waits for the answer. In real time (``TrialSpec.realtime``) the action takes
        effect as many ticks later as the answer took, and the seat is not asked again before.

        Args:
            observation: valid only during this call; reading its sensors later raises `StaleObservation`.

        Returns:
            one motion and at most one utterance. While ``observation.idle`` is false only the utterance counts. A
            motion that a law forbids is refused and costs one tick; the next observation's ``outcome`` says why.

        Raises:
            Exception: of any kind, or a result that is no `Action`, from a robot's mind is logged as a fault: the body
                stays where it is for the rest of the trial. From a human model it ends the run.
        """
        ...
