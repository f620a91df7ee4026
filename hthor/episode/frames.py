"""Participants who act in every step of a tick, as people in a headset do, instead of when they are asked."""

from collections.abc import Callable, Mapping

from hthor.episode.episode import Episode
from hthor.types import SUBTICKS, Action, Controls, Drive, Observation


class SeatControls:
    """The controls of one seat of a running trial; see `hthor.types.Controls`."""

    def __init__(self, episode: Episode, seat: str) -> None:
        self._episode, self._seat = episode, seat

    @property
    def tick(self) -> int:
        """Ticks since the trial began."""
        return self._episode.tick

    @property
    def step(self) -> int:
        """The step of the tick that comes next."""
        return self._episode.step

    def observe(self) -> Observation:
        """What the seat observes as this tick begins."""
        return self._episode.observe(self._seat)

    def submit(self, action: Action, seen: Observation | None = None) -> None:
        """Act as the next tick begins."""
        self._episode.submit(self._seat, action, seen)

    def steer(self, drive: Drive) -> None:
        """Drive like this from the next step on."""
        self._episode.steer(self._seat, drive)


class Frames:
    """The steps of ticks in a trial with participants who act in every step.

    Args:
        participants: by seat; those with a method ``frame`` act in every step.

    Attributes:
        seats: the seats of these.
    """

    def __init__(self, episode: Episode, participants: Mapping[str, object]) -> None:
        self._episode = episode
        self._frames: dict[str, tuple[Callable[[Controls], None], Controls]] = {
            seat: (frame, SeatControls(episode, seat))
            for seat, one in participants.items()
            if (frame := getattr(one, "frame", None)) is not None
        }
        self.seats = self._frames.keys()

    def play(self) -> None:
        """Let them act in every step of the tick; nobody may observe this tick after them."""
        if self._frames:
            for _ in range(SUBTICKS):
                self.step()

    def step(self) -> None:
        """Let them act in one step of the tick, and make that step."""
        for frame, controls in self._frames.values():
            frame(controls)
        self._episode.substep()
