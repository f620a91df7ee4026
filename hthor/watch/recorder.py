"""A world that notes, while a trial is played in it, where everything is at every tick, and the messages' pictures."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any

from hthor.live.scenery import PoseChanges
from hthor.types import TaskSpec
from hthor.types.events import Event, Sent
from hthor.watch import recording
from hthor.watch.recording import Track


class RecordedWorld:
    """A `hthor.world.World` that is also recorded.

    Watching changes nothing, as poses and pictures are only read.
    """

    def __init__(self, world: Any) -> None:
        self._world = world
        self._forget()

    def __getattr__(self, name: str) -> Any:
        return getattr(self._world, name)

    def reset(self, task: TaskSpec, seed: int = 0) -> None:
        """Begin a task, and the recording with it."""
        self._forget()
        self._world.reset(task, seed=seed)
        self._note()

    def advance(self) -> tuple[Event, ...]:
        """Move on by a tick."""
        events: tuple[Event, ...] = self._world.advance()
        self._note()
        return events

    def frame(self, seat: str) -> Callable[[], Any]:
        """The picture of a message that the seat sends now; kept for `pictures`."""
        draw: Callable[[], Any] = self._world.frame(seat)
        self._sent[self._world.tick, seat] = draw
        return draw

    def pictures(self, messages: Iterable[Sent]) -> dict[int, Any]:
        """The pictures of some messages, (H, W, 3) uint8, by their number; people's messages have none."""
        return {one.message: self._sent[one.tick, one.seat]() for one in messages if (one.tick, one.seat) in self._sent}

    def tracks(self) -> tuple[Track, ...]:
        """Where every part of the scene was."""
        return tuple(recording.make_track(part, self._ticks[part], self._poses[part]) for part in sorted(self._poses))

    def _forget(self) -> None:
        self._changes = PoseChanges()
        self._ticks: dict[int, list[int]] = {}
        self._poses: dict[int, list[Sequence[int]]] = {}
        self._sent: dict[tuple[int, str], Callable[[], Any]] = {}

    def _note(self) -> None:
        poses, moved = self._changes.take(self._world.scene_poses())
        for part in moved:
            self._ticks.setdefault(part, []).append(self._world.tick)
            self._poses.setdefault(part, []).append(poses[part].tolist())
