"""What the shell offers for a value when the user presses the tab key.

Where no name fits, the shell offers files, as most values may be files too.
"""

from __future__ import annotations

import typing
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any

from hthor.console import completion_values

if TYPE_CHECKING:
    import typer

VARIABLE = "_HTHOR_COMPLETE"
"""The shell sets it when it asks."""

OFFERS: dict[str, Callable[..., list[str]]] = {
    "agent": completion_values.agents,
    "humans": completion_values.people,
    "prior": completion_values.people,
    "humans name": completion_values.people,
    "suite": completion_values.suites,
    "suites": completion_values.suites,
    "kind": completion_values.kinds,
    "robot": completion_values.robots,
    "robots": completion_values.robots,
    "house": completion_values.houses,
    "files": completion_values.houses,
    "assets": completion_values.packs,
    "assets name": completion_values.packs,
    "engine": completion_values.engines,
    "isolation": completion_values.levels,
    "require_isolation": completion_values.levels,
    "detector": completion_values.detectors,
    "camera": completion_values.cameras,
    "run": completion_values.runs,
    "runs": completion_values.runs,
    "folders": completion_values.runs,
}
"""By the parameter's name, with the group's before it where it means something else elsewhere."""


def attach(app: typer.Typer, group: str = "") -> None:
    """Have every command of the tree offer values for the parameters that have some."""
    for command in app.registered_commands:
        if command.callback is None:
            continue
        hints = typing.get_type_hints(command.callback, include_extras=True)
        command.callback.__annotations__ = hints  # as strings they would be evaluated again, without what is set here
        for name, hint in hints.items():
            offer = OFFERS.get(f"{group} {name}") or OFFERS.get(name)
            for info in getattr(hint, "__metadata__", ()) if offer else ():
                info.autocompletion = _fitting(offer) if offer else None
    for below in app.registered_groups:
        if below.typer_instance is not None:
            attach(below.typer_instance, str(below.name))


def _fitting(offer: Callable[..., list[str]]) -> Callable[[str], Any]:
    def complete(incomplete: str) -> list[str]:
        names: Iterable[str] = offer(incomplete) if offer is completion_values.runs else offer()
        return [name for name in names if name.startswith(incomplete)]

    return complete
