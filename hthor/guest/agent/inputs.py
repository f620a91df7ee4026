"""What a user gives an agent beyond its own folder: arguments, and files that it may read."""

import os
from collections.abc import Iterable
from pathlib import Path

from msgspec import Struct

from hthor.errors import HthorError
from hthor.guest.agent import arguments
from hthor.guest.agent.reference import AgentReference

_HINT = "Name the folder with --readable too, so that the agent may read it and its files count as the agent's."


class AgentInputs(Struct, frozen=True, kw_only=True):
    """Arguments by their keys, and absolute paths of files and folders; a file among the arguments is readable too."""

    args: dict[str, str] = {}
    readable: tuple[str, ...] = ()

    def extra_paths(self, agent: AgentReference) -> tuple[str, ...]:
        """Files and folders outside its own folder that this agent may read.

        Raises:
            HthorError: when an argument names a folder that it may not read.
        """
        if agent.url and (self.args or self.readable):
            option = "--agent-args" if self.args else "--readable"
            raise HthorError(f"{agent.text} is served elsewhere, so {option} is for 'hthor agent serve' there.")
        found = list(self.readable)
        for key, value in self.args.items():
            if not os.path.isabs(value) or _within(value, [agent.root, *found]):
                continue
            if os.path.isfile(value):
                found.append(value)
            elif os.path.isdir(value):
                raise HthorError(f"--agent-args {key}={value}: that folder is not the agent's own. {_HINT}")
        return tuple(dict.fromkeys(found))


def parse_inputs(args: Iterable[str] = (), readable: Iterable[Path | str] = ()) -> AgentInputs:
    """The inputs that a user typed.

    Raises:
        HthorError: when an argument cannot be read, or there is no such file or folder.
    """
    places: list[str] = []
    for path in readable:
        if not Path(path).exists():
            raise HthorError(f"--readable {path}: there is no such file or folder.")
        places.append(os.path.realpath(path))
    names = [os.path.basename(place) for place in places]
    if twice := sorted({name for name in names if names.count(name) > 1 and len(set(places)) == len(places)}):
        raise HthorError(f"--readable names two files or folders called '{twice[0]}'; rename one of them.")
    found = arguments.parse_arguments(args)
    folders = [place for place in places if os.path.isdir(place)]
    for key, value in found.items():  # a folder without a slash could be any word
        if os.path.isdir(value) and os.path.realpath(value) in folders:
            found[key] = os.path.realpath(value)
    return AgentInputs(args=found, readable=tuple(dict.fromkeys(places)))


def _within(path: str, folders: Iterable[str]) -> bool:
    return any(folder and Path(path).is_relative_to(folder) for folder in folders)
