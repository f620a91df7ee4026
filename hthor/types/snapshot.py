"""The true state of a trial's world at one moment."""

from collections.abc import Mapping

from msgspec import Struct

from hthor.types.house import Pose
from hthor.types.observations import ThingState


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
