"""Help that fills the screen: paragraphs lose the line breaks that their docstrings have."""

from __future__ import annotations

import inspect
import re

import typer

_BREAK = re.compile(r"(?<!\n)\n(?!\n)")


def unbroken(text: str) -> str:
    """The text with one line a paragraph."""
    return _BREAK.sub(" ", inspect.cleandoc(text))


def flow(app: typer.Typer) -> None:
    """Have every command of the tree tell its help so."""
    for command in app.registered_commands:
        words = command.help or (command.callback and command.callback.__doc__) or ""
        command.help = unbroken(words)
    for group in app.registered_groups:
        if group.typer_instance is not None:
            flow(group.typer_instance)
