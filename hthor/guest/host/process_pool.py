"""Guests that wait between two users of the same agent, since a start costs more than many trials.

Only where each trial has a process anyway, so that nothing is carried over.
"""

from __future__ import annotations

import atexit

from msgspec import Struct

from hthor.guest.host.info import GuestInfo
from hthor.guest.host.process import Process

_MOST = 4
Key = tuple[object, ...]


class Parked(Struct, frozen=True, kw_only=True):
    """A guest's process, and what its agent said of itself."""

    process: Process
    info: GuestInfo
    ahead: bool


class _Lot:
    open = False
    places: list[tuple[Key, Parked]] = []  # noqa: RUF012 - there is one for the whole process


def keep() -> None:
    """Let guests of this process wait from now on when they are closed, until it ends."""
    if not _Lot.open:
        atexit.register(clear)
    _Lot.open = True


def put(key: Key, guest: Parked) -> bool:
    """Let a guest that has no trial wait; false when it is not to."""
    if not _Lot.open or guest.info.persistent or not guest.process.lives:
        return False
    _Lot.places.append((key, guest))
    while len(_Lot.places) > _MOST:
        _Lot.places.pop(0)[1].process.kill()
    return True


def take(key: Key) -> Parked | None:
    """A guest that waits for exactly this, if there is one."""
    for place in [place for place in _Lot.places if place[0] == key]:
        _Lot.places.remove(place)
        if place[1].process.lives:
            return place[1]
        place[1].process.kill()
    return None


def pids() -> list[int]:
    """The first processes of those that wait."""
    return [guest.process.pid for _, guest in _Lot.places]


def clear() -> None:
    """End all that wait, and let none wait any more."""
    _Lot.open = False
    while _Lot.places:
        _Lot.places.pop()[1].process.kill()
