"""Shared by the guests of one worker: idle processes, and isolation levels that did not start on this machine.

Starting a process takes longer than many trials. An idle process is reused only for the same agent and settings, and
only if each trial gets its own process anyway, so that nothing is carried over.
"""

import threading
import weakref

from msgspec import Struct

from hthor.guest.host.info import GuestInfo
from hthor.guest.host.process import GuestProcess

_MOST = 4
Key = tuple[object, ...]
"""Everything that two guests must share to be interchangeable."""


class IdleGuest(Struct, frozen=True, kw_only=True):
    """A guest's process that waits for its next user, and its agent's description of itself."""

    process: GuestProcess
    info: GuestInfo
    ahead: bool


class GuestPool:
    """Idle guests of one owner, ``most`` at most; they end with the pool. Several threads may use it.

    ``unavailable`` maps levels of isolation that did not start to the reason; they are not tried again.
    """

    def __init__(self, most: int = _MOST) -> None:
        self.unavailable: dict[str, str] = {}
        self._most = most
        self._idle: list[tuple[Key, IdleGuest]] = []
        self._lock = threading.Lock()
        weakref.finalize(self, _end, self._idle)

    def put(self, key: Key, guest: IdleGuest) -> bool:
        """Keep a guest that has no trial; False when the pool does not keep it."""
        if not self._most or guest.info.persistent or not guest.process.lives:
            return False
        guest.process.count_cpu()
        with self._lock:
            self._idle.append((key, guest))
            _end(self._idle, self._most)
        return True

    def take(self, key: Key) -> IdleGuest | None:
        """An idle guest with exactly this key, if there is one."""
        with self._lock:
            for place in [place for place in self._idle if place[0] == key]:
                self._idle.remove(place)
                if place[1].process.lives:
                    return place[1]
                place[1].process.kill()
        return None

    def pids(self) -> list[int]:
        """The first processes of the idle guests."""
        return [guest.process.pid for _, guest in self._idle]

    def close(self) -> None:
        """End all idle guests, and keep none from now on."""
        with self._lock:
            self._most = 0
            _end(self._idle)


def _end(idle: list[tuple[Key, IdleGuest]], most: int = 0) -> None:
    """End the oldest idle guests until at most this many are left."""
    while len(idle) > most:
        idle.pop(0)[1].process.kill()
