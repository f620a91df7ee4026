"""How long bodies rest: carry out no motion, or only wait."""

from collections.abc import Iterable

from hthor.types import Drive, Motion, Move, Rotate, Wait

RestState = tuple[dict[str, int], dict[str, int | None], dict[str, bool]]


class RestTime:
    """Adds up for how many ticks each seat's body rests; all bodies rest at first."""

    def __init__(self, seats: Iterable[str]) -> None:
        self._since: dict[str, int | None] = dict.fromkeys(seats, 0)
        self._ticks = dict.fromkeys(self._since, 0)
        self._driving: dict[str, bool] = {}  # seats that drive, and whether they stand

    def note(self, tick: int, seat: str, *, resting: bool) -> None:
        """Note whether the seat's body rests from this tick on."""
        since = self._since[seat]
        if since is not None and not resting:
            self._ticks[seat] += tick - since
        self._since[seat] = None if not resting else tick if since is None else since

    def restart(self, tick: int) -> None:
        """Begin to count at this tick, as if nobody had rested before."""
        self._ticks = dict.fromkeys(self._ticks, 0)
        self._since = {seat: None if since is None else tick for seat, since in self._since.items()}

    def note_motion(self, tick: int, seat: str, motion: Motion, *, started: bool) -> None:
        """Note a motion that begins; ``started`` is false if the body is still free: refused, or a `Drive`."""
        if isinstance(motion, Drive):
            self._driving[seat] = motion.forward == motion.left == 0.0
            if not started:
                self.note(tick, seat, resting=self._driving[seat])
            return
        if self._driving and isinstance(motion, (Move, Rotate, Wait)):
            self._driving.pop(seat, None)
        resting = isinstance(motion, Wait) or not started
        if resting != (self._since[seat] is not None):  # most motions change nothing
            self.note(tick, seat, resting=resting)

    def note_unasked(self, tick: int, seat: str) -> None:
        """Note that a free body begins no motion: it rests, or goes on driving."""
        self.note(tick, seat, resting=self._driving.get(seat, True))

    def totals(self, tick: int) -> dict[str, int]:
        """[ticks] For how long each seat has rested up to this tick."""
        return {
            seat: ticks + (0 if (since := self._since[seat]) is None else tick - since)
            for seat, ticks in self._ticks.items()
        }

    def save_state(self) -> RestState:
        """A copy of what was noted."""
        return dict(self._ticks), dict(self._since), dict(self._driving)

    def load_state(self, state: RestState) -> None:
        """Continue from a copy."""
        ticks, since, driving = state
        self._ticks, self._since, self._driving = dict(ticks), dict(since), dict(driving)
