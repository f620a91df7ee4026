"""Pictures of what every seat saw at some moments of a logged trial, which is played again with cameras.

Taking pictures changes nothing, which is checked: the record of the repeated trial must equal the logged record.
"""

from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

from msgspec import Struct

from hthor import activity
from hthor.comms import display
from hthor.eval.records.trial_record import TrialRecord
from hthor.eval.replay import repeated_trial
from hthor.eval.replay.session_history import RunFiles
from hthor.guest import AgentInputs
from hthor.types import TaskSpec
from hthor.types.events import Event, Sent

SIZE = (400, 300)
"""Width and height of the pictures of a case [pixels]."""
_FINER = 2
"""Pictures are drawn this many times larger and then averaged, which makes edges smooth."""

Views = dict[int, dict[str, Any]]
"""Pictures (H, W, 3) uint8 by tick and seat."""


class Seen(Struct, frozen=True, kw_only=True, eq=False):
    """What was seen in a trial: ``views`` of every seat, and ``images`` of messages (H, W, 3) uint8 by their number."""

    views: Views
    images: dict[int, Any] = {}


class CameraFrames:
    """A world that also keeps what its seats see at some ticks, for drawing later.

    Args:
        ticks: when to look. profile: how pictures are drawn, fast or nice. seats: whose views; by default everybody's.
        height: [pixels] of pictures with the whole field of view and the shape of each seat's own camera; 0 for
            pictures of `SIZE`, which show the middle of the field of view.
    """

    def __init__(
        self, world: Any, ticks: Collection[int], profile: str, seats: Collection[str] = (), height: int = 0
    ) -> None:
        self._world, self._ticks, self._profile = world, frozenset(ticks), profile
        self._seats, self._height = tuple(seats), height
        self._kept: dict[int, dict[str, Callable[[], Any]]] = {}
        self._sent: dict[tuple[int, str], Callable[[], Any]] = {}

    def __getattr__(self, name: str) -> Any:
        return getattr(self._world, name)

    def reset(self, task: TaskSpec, seed: int = 0) -> None:
        self._kept.clear()
        self._sent.clear()
        self._world.reset(task, seed=seed)
        self._look()

    def advance(self) -> tuple[Event, ...]:
        events: tuple[Event, ...] = self._world.advance()
        self._look()
        return events

    def frame(self, seat: str) -> Callable[[], Any]:
        """The picture of a message that the seat sends now; kept for `images`."""
        draw: Callable[[], Any] = self._world.frame(seat)
        self._sent[self._world.tick, seat] = draw
        return draw

    def images(self, messages: Iterable[Sent]) -> dict[int, Any]:
        """Draw and return the pictures of some messages, by their number; people's messages have none."""
        return {one.message: self._sent[one.tick, one.seat]() for one in messages if (one.tick, one.seat) in self._sent}

    def views(self) -> Views:
        """Draw and return the pictures."""
        return {tick: {seat: self.draw(tick, seat) for seat in kept} for tick, kept in self._kept.items()}

    def draw(self, tick: int, seat: str) -> Any:
        """Draw one picture, (H, W, 3) uint8."""
        return _averaged(self._kept[tick][seat]())

    def _look(self) -> None:
        world = self._world
        if world.tick in self._ticks:
            seats = self._seats or world.seats
            self._kept[world.tick] = {seat: world.frame(seat, self._size(seat), self._profile) for seat in seats}

    def _size(self, seat: str) -> tuple[int, int]:
        """Width and height in which a seat's view is drawn, before it is averaged [pixels]."""
        if not self._height:
            return (_FINER * SIZE[0], _FINER * SIZE[1])
        width, height = self._world.camera(seat).size
        return (_FINER * 2 * round(self._height * width / height / 2), _FINER * self._height)  # videos need even sides


def render_frames(
    folder: Path,
    wanted: TrialRecord,
    ticks: Collection[int],
    *,
    profile: str = "fast",
    agents: Sequence[str] = (),
    humans: str = "",
    given: AgentInputs | None = None,
) -> Seen:
    """Play a trial again and return pictures of what its seats saw, and of the messages on people's panels.

    Args:
        folder: of the run. wanted: the trial. ticks: when to take pictures.
        profile: how pictures are drawn, fast or nice.
        agents: files of the run's agents that are not built in. humans: the human model, if the log's name does not
        find it. given: arguments and files that the agents were given.

    Raises:
        RunError: if trials before it are missing, another version of hthor played them, or the trial ends differently.
        HthorError: if a file that was not given is needed.
    """
    files = RunFiles(agents=tuple(agents), humans=humans)
    frames = film_trial(folder, wanted, ticks, files, profile=profile, given=given)
    return Seen(views=frames.views(), images=frames.images(_on_panels(wanted, ticks)))


def film_trial(
    folder: Path,
    wanted: TrialRecord,
    ticks: Collection[int],
    files: RunFiles,
    *,
    profile: str = "fast",
    seats: Collection[str] = (),
    height: int = 0,
    given: AgentInputs | None = None,
) -> CameraFrames:
    """Play a trial again and return what its seats saw, which is drawn on request.

    Args:
        folder: of the run. wanted: the trial. ticks, profile, seats, height: see `CameraFrames`.
        files: the user's files that the run's folder lacks. given: arguments and files that the agents were given.

    Raises:
        RunError, HthorError: see `render_frames`.
    """
    world = repeated_trial.repeat_trial(
        folder, wanted, files, lambda world: CameraFrames(world, ticks, profile, seats, height), given
    )
    activity.say(f"drawing what was seen in {folder.name}")
    return world


def _on_panels(record: TrialRecord, ticks: Collection[int]) -> Iterator[Sent]:
    """The messages that were on people's panels at some ticks."""
    for tick in sorted(ticks):
        for human in record.spec.humans:
            state = display.state_at(record.events, human.seat, tick)
            if state.message is not None and state.on["panel"]:
                yield state.message


def _averaged(picture: Any) -> Any:
    """The picture in its final size."""
    high, wide, _ = picture.shape
    parts = picture.reshape(high // _FINER, _FINER, wide // _FINER, _FINER, 3).astype("float32")
    return parts.mean(axis=(1, 3)).round().astype("uint8")
