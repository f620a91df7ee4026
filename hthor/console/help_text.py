"""`--help`: words to type on the left, their meaning on the right, readable in 80 columns."""

from __future__ import annotations

import inspect
import re
import textwrap
from typing import TYPE_CHECKING, Any

import typer
from rich.markup import escape
from typer.core import TyperArgument, TyperCommand, TyperGroup, TyperOption

if TYPE_CHECKING:
    from collections.abc import Iterable

    from rich.console import Console

_BREAK = re.compile(r"(?<!\n)\n(?!\n)")
_LEFT = 26
"""Columns for names; a longer name has a line of its own, so that of 80 columns 50 are left for the meaning."""
_PLAIN: Any = {"highlight": False, "soft_wrap": True}
_AT_LEAST = re.compile(r"\bx>=(\S+?)(?=[\];])")
_TYPES = {"str": None, "int": "N", "int range": "N", "float": "X", "float range": "X", "path": "PATH"}
"""The placeholder for a value of each type; None for the option's own name."""


def unbroken(text: str) -> str:
    """The text with one line per paragraph, whatever line breaks its docstring has."""
    return _BREAK.sub(" ", inspect.cleandoc(text))


def attach(app: typer.Typer) -> None:
    """Give every command of the app this help."""
    app.info.cls = HelpGroup
    for command in app.registered_commands:
        text = command.help or (command.callback and command.callback.__doc__) or ""
        command.help, command.cls = unbroken(text), HelpCommand
    for group in app.registered_groups:
        if group.typer_instance is not None:
            group.cls = HelpGroup
            attach(group.typer_instance)


class HelpCommand(TyperCommand):
    """A command with this help."""

    def format_help(self, ctx: Any, formatter: Any) -> None:  # noqa: ARG002
        """Print the help to standard output."""
        _print(self, ctx)


class HelpGroup(TyperGroup):
    """A group of commands with this help."""

    def format_help(self, ctx: Any, formatter: Any) -> None:  # noqa: ARG002
        """Print the help to standard output."""
        _print(self, ctx)


def metavar(option: TyperOption, ctx: Any) -> str:
    """The placeholder for an option's value: its own word, its choices, or a word for its type."""
    if option.metavar is not None:
        return option.metavar
    kind = option.display_type(ctx).strip("<>").removeprefix("list[").removesuffix("]").lower()
    if kind in _TYPES:
        return _TYPES[kind] or str(option.opts[0]).strip("-").upper()
    return kind


def _print(command: TyperCommand | TyperGroup, ctx: Any) -> None:
    from hthor.console import output

    screen = output.console()
    params = command.get_params(ctx)
    arguments = [one for one in params if isinstance(one, TyperArgument) and not one.hidden]
    words = ["COMMAND"] if isinstance(command, TyperGroup) else [str(one.metavar or one.name) for one in arguments]
    screen.print(f"[bold]Usage:[/] {escape(' '.join([ctx.command_path, '[OPTIONS]', *words]))}\n", **_PLAIN)
    for paragraph in filter(None, (command.help or "").split("\n\n")):
        screen.print(escape(f"{unbroken(paragraph)}\n"), highlight=False)
    _section(screen, "Arguments", ((str(one.metavar or one.name), _meaning(one, ctx)) for one in arguments))
    if isinstance(command, TyperGroup):
        below = [(name, command.get_command(ctx, name)) for name in command.list_commands(ctx)]
        shown = [(name, one) for name, one in below if one is not None and not one.hidden]
        _section(screen, "Commands", ((name, unbroken(one.help or "").split("\n\n")[0]) for name, one in shown))
    options = [one for one in params if isinstance(one, TyperOption) and not one.hidden]
    _section(screen, "Options", ((_names(one, ctx), _meaning(one, ctx)) for one in options))
    if command.epilog:
        screen.print(escape(unbroken(command.epilog)), highlight=False)


def _section(screen: Console, title: str, rows: Iterable[tuple[str, str]]) -> None:
    """A title, and below it names with their meanings in two columns."""
    every = list(rows)
    if not every:
        return
    screen.print(f"[bold]{title}:[/]")
    left = min(_LEFT, max(len(name) for name, _ in every))
    for name, meaning in every:
        lines = textwrap.wrap(meaning, max(20, screen.width - left - 4), break_on_hyphens=False) or [""]
        if len(name) > left:
            lines.insert(0, "")
        screen.print(f"  [cyan]{escape(name)}[/]{' ' * (left - len(name))}  {escape(lines[0])}".rstrip(), **_PLAIN)
        for line in lines[1:]:
            screen.print(f"{' ' * (left + 4)}{escape(line)}", **_PLAIN)
    screen.print()


def _names(option: TyperOption, ctx: Any) -> str:
    """``--jobs, -j N``, or ``--control / --no-control``."""
    names = ", ".join(sorted(option.opts, key=len, reverse=True))
    if option.is_flag or option.count:
        return " / ".join([names, *option.secondary_opts])
    return f"{names} {metavar(option, ctx)}"


def _meaning(one: TyperOption | TyperArgument, ctx: Any) -> str:
    """The help of a parameter, its default and its range."""
    record = one.get_help_record(ctx)
    return _AT_LEAST.sub(r"at least \1", " ".join((record[1] if record else "").replace("\\[", "[").split()))
