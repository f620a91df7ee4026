"""Inputs that a user gives an agent besides its own folder: arguments, and files that it may read."""

import difflib
import inspect
import os
import re
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

from msgspec import Struct

from hthor.errors import HthorError
from hthor.guest.agent.reference import AgentReference

_KEY = re.compile(r"[A-Za-z_]\w*")
_YES, _NO = ("true", "yes", "1", "on"), ("false", "no", "0", "off")
_HINT = "Name the folder with --readable too, so that the agent may read it and its files count as the agent's."


class ArgumentMismatch(ValueError):
    """The agent does not take these arguments; the message is for the user."""


def parse_arguments(texts: Iterable[str]) -> dict[str, str]:
    """The arguments that a user typed as ``key=value``; the path of a file that exists is made absolute.

    Raises:
        HthorError: when a text is not ``key=value``, or a key is given twice.
    """
    found: dict[str, str] = {}
    for text in texts:
        key, equals, value = text.partition("=")
        if not equals or not _KEY.fullmatch(key):
            raise HthorError(f"--agent-args '{text}' is not KEY=VALUE, such as checkpoint=weights/best.npz.")
        if key in found:
            raise HthorError(f"--agent-args gives '{key}' twice: '{found[key]}' and '{value}'.")
        is_path = os.path.isfile(value) or (os.sep in value and os.path.isdir(value))
        found[key] = os.path.abspath(value) if is_path else value
    return found


def convert_arguments(cls: type[Any], given: Mapping[str, str]) -> dict[str, Any]:
    """The arguments, converted to the types of the constructor's parameters (from annotations or defaults).

    Raises:
        ArgumentMismatch: when an argument has no parameter, is missing, or cannot be converted.
    """
    try:
        parameters = dict(inspect.signature(cls).parameters)
    except (TypeError, ValueError):
        parameters = {}
    open_ended = any(one.kind is inspect.Parameter.VAR_KEYWORD for one in parameters.values())
    named = {
        name: one
        for name, one in parameters.items()
        if one.kind in (inspect.Parameter.POSITIONAL_OR_KEYWORD, inspect.Parameter.KEYWORD_ONLY)
    }
    for key in given:
        if key not in named and not open_ended:
            near = difflib.get_close_matches(key, named, n=1, cutoff=0.5)
            guess = f" Did you mean '{near[0]}'?" if near else ""
            takes = f"It takes: {', '.join(named)}." if named else "Its constructor takes no arguments."
            raise ArgumentMismatch(f"{cls.__name__} has no argument '{key}' (--agent-args {key}=...).{guess} {takes}")
    missing = [name for name, one in named.items() if one.default is inspect.Parameter.empty and name not in given]
    if missing:
        raise ArgumentMismatch(
            f"{cls.__name__} needs the argument '{missing[0]}'. Give it: --agent-args {missing[0]}=VALUE"
        )
    return {key: _typed(key, value, named.get(key)) for key, value in given.items()}


def make_factory(cls: type[Any], given: Mapping[str, str]) -> Callable[[], Any]:
    """A function that makes a new agent with these arguments, which must suit its constructor."""
    values = convert_arguments(cls, given)
    return lambda: cls(**values)


def _typed(key: str, value: str, parameter: inspect.Parameter | None) -> Any:
    if parameter is None:
        return value
    wanted = parameter.annotation
    name = wanted if isinstance(wanted, str) else getattr(wanted, "__name__", "")
    if wanted is inspect.Parameter.empty:
        name = type(parameter.default).__name__
    name = name.replace(" ", "").removesuffix("|None").removeprefix("Optional[").removesuffix("]")
    try:
        if name == "bool":
            if value.lower() not in (*_YES, *_NO):
                raise ValueError
            return value.lower() in _YES
        return {"int": int, "float": float}.get(name, str)(value)
    except ValueError:
        raise ArgumentMismatch(f"--agent-args {key}={value}: the agent takes {name} there.") from None


def as_options(given: Mapping[str, str]) -> tuple[str, ...]:
    """The arguments as options of a command, ``--key=value``."""
    return tuple(f"--{key}={value}" for key, value in given.items())


class AgentInputs(Struct, frozen=True, kw_only=True):
    """Arguments by key, and absolute paths of readable files and folders; a file in an argument is readable too."""

    args: dict[str, str] = {}
    readable: tuple[str, ...] = ()

    def arguments(self, agent: AgentReference) -> dict[str, str]:
        """The constructor's arguments: these, and those that the agent's own reference gives."""
        return {**self.args, **agent.args}

    def extra_paths(self, agent: AgentReference) -> tuple[str, ...]:
        """Files and folders outside its own folder that this agent may read.

        Raises:
            HthorError: when an argument names a folder that it may not read.
        """
        if agent.elsewhere and (self.args or self.readable):
            option = "--agent-args" if self.args else "--readable"
            if agent.url:
                raise HthorError(f"{agent.text} is served elsewhere, so {option} is for 'hthor agent serve' there.")
            raise HthorError(f"{agent.text} is a program that you start yourself; give it there what {option} names.")
        found = [*self.readable, *(value for value in agent.args.values() if os.path.exists(value))]
        for key, value in self.args.items():
            if not os.path.isabs(value) or _within(value, [agent.root, *found]):
                continue
            if os.path.isfile(value) or (agent.built_in and os.path.isdir(value)):
                found.append(value)
            elif os.path.isdir(value):
                raise HthorError(f"--agent-args {key}={value}: that folder is not the agent's own. {_HINT}")
        return tuple(dict.fromkeys(found))


def parse_inputs(args: Iterable[str] = (), readable: Iterable[Path | str] = ()) -> AgentInputs:
    """The inputs that a user typed.

    Raises:
        HthorError: when an argument is not ``key=value``, or a file or folder does not exist.
    """
    places: list[str] = []
    for path in readable:
        if not Path(path).exists():
            raise HthorError(f"--readable {path}: there is no such file or folder.")
        places.append(os.path.realpath(path))
    names = [os.path.basename(place) for place in places]
    if twice := sorted({name for name in names if names.count(name) > 1 and len(set(places)) == len(places)}):
        raise HthorError(f"--readable names two files or folders called '{twice[0]}'; rename one of them.")
    found = parse_arguments(args)
    folders = [place for place in places if os.path.isdir(place)]
    for key, value in found.items():  # a folder's name without a slash could be any word
        if os.path.isdir(value) and os.path.realpath(value) in folders:
            found[key] = os.path.realpath(value)
    return AgentInputs(args=found, readable=tuple(dict.fromkeys(places)))


def _within(path: str, folders: Iterable[str]) -> bool:
    return any(folder and Path(path).is_relative_to(folder) for folder in folders)
