"""`hthor agents`, `hthor agent` and `hthor robots`."""

import shlex
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from hthor.commands.agent import check as agents_of_mine
from hthor.commands.options import Json
from hthor.console import formats, output
from hthor.console.formats import Format, Shape

agents = typer.Typer(no_args_is_help=True, help="Agents that ship with hthor.")
agent = typer.Typer(no_args_is_help=True, help="Your own agent.")
robots = typer.Typer(no_args_is_help=True, help="Robot bodies.")

GROUPS = {"agents": agents, "agent": agent, "robots": robots}

for _group in GROUPS.values():
    _group.callback()(lambda: None)  # a group of one command would otherwise swallow the command's name


@agents.command("list")
def list_agents(shape: Shape = Format.TABLE, json: Json = False) -> None:
    """List the built-in agents and the privileges that they declare."""
    from hthor import plugins

    rows = [
        {"name": name, "privileges": _privileges(name), "purpose": plugins.summary("agent", name)}
        for name in plugins.names("agent")
    ]
    _put(rows, json, shape)


@agent.command("new")
def new_agent(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="The file to write, such as my_agent.py.")],
    force: Annotated[bool, typer.Option("--force", help="Overwrite an existing file.")] = False,
    json: Json = False,
) -> None:
    """Write a small, complete agent to start from."""
    from hthor import agents as minds
    from hthor.errors import AgentError, HthorError

    try:
        minds.write_template(file, force)
    except AgentError as error:  # exit code 4 is for agents that do not load
        raise HthorError(str(error)) from None
    output.put_files([file], json)
    quoted = shlex.quote(str(file))
    for line in output.following(f"hthor agent check {quoted}", f"hthor eval --agent {quoted} --humans proxy"):
        sys.stderr.write(f"{line}\n")


agent.command("check")(agents_of_mine.check)
agent.command("run")(agents_of_mine.run)


@robots.command("list")
def list_robots(shape: Shape = Format.TABLE, json: Json = False) -> None:
    """List the robots."""
    from hthor import plugins
    from hthor.trials import robot_team

    rows = []
    for name in plugins.names("robot"):
        spec = plugins.load("robot", name)
        rows.append(
            {
                "name": name,
                "alias": [alias for alias, body in robot_team.ALIASES.items() if body == name],
                "title": spec.title,
                "radius_m": spec.radius,
                "height_m": spec.height,
                "speed_m_s": spec.speed,
                "sight_m": spec.sight_range,
                "can": sorted(spec.capabilities),
            }
        )
    _put(rows, json, shape)


def _privileges(name: str) -> list[str]:
    """An agent's privileges; empty when a library that it needs is not installed."""
    from hthor import plugins
    from hthor.errors import MissingExtra

    try:
        return list(getattr(plugins.load("agent", name), "privileges", ()))
    except (ImportError, MissingExtra):
        return []


def _put(rows: Sequence[dict[str, Any]], json: bool, shape: Format) -> None:
    """Print rows as JSON, or as a table."""
    if formats.asks_json(json, shape):
        output.put_json(rows)
    else:
        output.put_rows(rows, shape=shape)
