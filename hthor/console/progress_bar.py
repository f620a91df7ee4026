"""Progress bars on standard error, drawn by rich; where no terminal can be redrawn, nothing is printed."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Protocol, TypeVar

from hthor.console import output

if TYPE_CHECKING:
    from rich.console import Console
    from rich.progress import Progress

_Item = TypeVar("_Item")


class Advance(Protocol):
    """Moves a bar one step on, and replaces the words behind it if words are given."""

    def __call__(self, words: str = "") -> None: ...


def make_progress(console: Console) -> Progress:
    """A display of rich's whose tasks have a field ``words``, for what is written behind a bar; it vanishes in the end.

    All progress that hthor shows is drawn by this display.
    """
    from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn

    title, state = TextColumn("[bold]{task.description}", markup=True), TextColumn("{task.fields[words]}")
    return Progress(SpinnerColumn(), title, BarColumn(), state, console=console, refresh_per_second=4, transient=True)


@contextmanager
def bar(name: str, total: int, unit: str, *, shown: bool = True) -> Iterator[Advance]:
    """A bar for ``total`` steps, called ``unit`` behind the bar ("3/20 frames").

    Args:
        shown: whether to draw it if standard error is a terminal.
    """
    if not (shown and output.live()):
        yield _ignore
        return
    from rich.markup import escape

    done = 0
    with make_progress(output.console(talk=True)) as display:
        task = display.add_task(escape(name), total=total, words=f"0/{total} {unit}")

        def advance(words: str = "") -> None:
            nonlocal done
            done += 1
            display.update(task, completed=done, words=f"{done}/{total} {unit}{words and f', {words}'}")

        yield advance


def _ignore(words: str = "") -> None:
    del words


def watched(items: Iterable[_Item], name: str, total: int, unit: str, *, shown: bool = True) -> Iterator[_Item]:
    """The items, with a bar that goes on after each; see `bar`."""
    with bar(name, total, unit, shown=shown) as advance:
        for item in items:
            yield item
            advance()


def duration(seconds: float) -> str:
    """A time in words, such as "2 min 05 s"."""
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    if hours:
        return f"{hours} h {minutes:02d} min"
    return f"{minutes} min {rest:02d} s" if minutes else f"{rest} s"
