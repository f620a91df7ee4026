"""Reports the current step of a long operation, and notes for the user, to listeners, if there are any."""

import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar

_Listener = Callable[[str], None]
_listener: ContextVar[_Listener | None] = ContextVar("listener", default=None)
_waiter: ContextVar[Callable[[], None] | None] = ContextVar("waiter", default=None)
_reader: ContextVar[_Listener | None] = ContextVar("reader", default=None)


def say(words: str) -> None:
    """Report the current step, such as "playing trial 3 of 10"."""
    if (listener := _listener.get()) is not None:
        listener(words)


def wait_for_people() -> None:
    """Report that from now on nothing is computed but what people ask for, so nobody wonders whether it still works."""
    if (waiter := _waiter.get()) is not None:
        waiter()


def note(words: str) -> None:
    """Tell the user something that they should know of a result but that is no error, as a sentence.

    Without a reader it is a warning of Python's.
    """
    if (reader := _reader.get()) is not None:
        reader(words)
    else:
        warnings.warn(words, stacklevel=2)


@contextmanager
def heard_by(listener: _Listener, waiter: Callable[[], None] | None = None) -> Iterator[None]:
    """Report all steps within the block to ``listener``, and to ``waiter`` when it waits for people."""
    before, waited = _listener.set(listener), _waiter.set(waiter)
    try:
        yield
    finally:
        _listener.reset(before)
        _waiter.reset(waited)


@contextmanager
def read_by(reader: _Listener) -> Iterator[None]:
    """Give all notes within the block to ``reader``, each once."""
    seen = set[str]()

    def read(words: str) -> None:
        if words not in seen:
            seen.add(words)
            reader(words)

    before = _reader.set(read)
    try:
        yield
    finally:
        _reader.reset(before)
