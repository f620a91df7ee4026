"""Writes the page of all commands from the commands themselves: `python scripts/cli_reference.py docs/cli.md`.

Everything after a page's marker is replaced; what stands before it is written by hand.
"""

from __future__ import annotations

import sys
import textwrap
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import typer.main

from hthor.cli import app

_WIDE = 116
MARK = "<!-- All below is written by: python scripts/cli_reference.py docs/cli.md -->\n"


def page(before: str) -> str:
    """A page with its second part written anew."""
    head, mark, _ = before.partition(MARK)
    if not mark:
        raise ValueError(f"the page has no line '{MARK.strip()}'")
    return head + MARK + "".join(f"\n{_section(name, command)}" for name, command in leaves())


def leaves() -> Iterator[tuple[str, Any]]:
    """Every command that does something, by its whole name, in the order of the help."""
    yield from _below("hthor", typer.main.get_command(app))


def options(command: Any) -> list[Any]:
    """A command's parameters that its help shows."""
    return [one for one in command.params if not getattr(one, "hidden", False) and one.name != "help"]


def _below(name: str, command: Any) -> Iterator[tuple[str, Any]]:
    if not hasattr(command, "commands"):
        yield name, command
        return
    for word, inner in command.commands.items():
        yield from _below(f"{name} {word}", inner)


def _section(name: str, command: Any) -> str:
    shown = options(command)
    arguments = [one for one in shown if one.param_type_name == "argument"]
    usage = " ".join([name, *(_metavar(one) for one in arguments)])
    words = "\n\n".join(textwrap.fill(part, _WIDE) for part in (command.help or "").split("\n\n"))
    lines = [f"## {name}\n", f"`{usage}`\n", f"{words}\n"]
    if shown:
        lines += ["| | | default |\n|---|---|---|", *(_row(one) for one in shown), ""]
    return "\n".join(lines)


def _row(one: Any) -> str:
    if one.param_type_name == "argument":
        name = _metavar(one)
    else:
        name = ", ".join([*sorted(one.opts, key=len, reverse=True), *one.secondary_opts])
    text = " ".join((one.help or "").split()).replace("|", "\\|")
    return f"| `{name}` | {text} | {_default(one)} |"


def _metavar(one: Any) -> str:
    return str(one.metavar or one.name.upper())


def _default(one: Any) -> str:
    if isinstance(one.show_default, str):
        return one.show_default
    if one.required:
        return "required"
    if one.show_default is False or one.default is False or one.default in (None, "", (), []):
        return ""
    return f"`{'--' + one.name.replace('_', '-') if one.default is True else one.default}`"


def main(path: Path) -> None:
    """Write the page in a file anew."""
    path.write_text(page(path.read_text(encoding="utf-8")), encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
