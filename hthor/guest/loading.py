"""From an agent's file to its class; knows nothing of trials."""

from __future__ import annotations

import importlib.util
import sys
import traceback
from pathlib import Path
from types import ModuleType
from typing import Any

from hthor.guest import wire

_PRIVILEGES = ("house_map", "ideal_detector", "object_poses")
_MODULE = "hthor_guest_agent"  # not the file's name, which could hide a module of the standard library
TEXT_MAX = 8000
"""Longest text that is passed on, in characters."""


class Refusal(Exception):
    """The file does not follow the contract; the message goes to its author."""


def load(path: Path, wanted: str) -> tuple[type[Any], wire.Ready]:
    """The class of an agent's file, and what it says of itself.

    Raises:
        Refusal: when there is none, or the file cannot be imported.
    """
    module = _import(path)
    cls = _pick(module, path, wanted)
    privileges = _names(cls, "privileges", path)
    unknown = [name for name in privileges if name not in _PRIVILEGES]
    if unknown:
        raise Refusal(f"{path}: {cls.__name__}.privileges names '{unknown[0]}'. Valid: {', '.join(_PRIVILEGES)}.")
    ready = wire.Ready(
        name=path.stem,
        privileges=privileges,
        robots=_names(cls, "robots", path),
        absent=bool(getattr(cls, "absent", False)),
        persistent=bool(getattr(cls, "persistent", False)),
        doc=(cls.__doc__ or module.__doc__ or "").strip()[:TEXT_MAX],
    )
    return cls, ready


def _import(path: Path) -> ModuleType:
    sys.path.insert(0, str(path.parent))
    spec = importlib.util.spec_from_file_location(_MODULE, path)
    if spec is None or spec.loader is None:
        raise Refusal(f"{path}: not a Python file; an agent is one file that ends in .py")
    module = importlib.util.module_from_spec(spec)
    sys.modules[_MODULE] = module
    try:
        spec.loader.exec_module(module)
    except SyntaxError as error:
        line = f":{error.lineno}" if error.lineno else ""
        raise Refusal(f"{error.filename or path}{line}: {error.msg}") from None
    except BaseException as error:
        raise Refusal(f"{path}: importing it failed.\n{shown(error)}") from None
    return module


def _pick(module: ModuleType, path: Path, wanted: str) -> type[Any]:
    """The class to use: the one asked for, the only one, or the one called Agent."""
    found = {
        name: value
        for name, value in vars(module).items()
        if isinstance(value, type)
        and (value.__module__ == module.__name__ or name == "Agent")
        and callable(getattr(value, "begin", None))
        and callable(getattr(value, "act", None))
    }
    listed = ", ".join(found) or "none"
    if wanted:
        if wanted not in found:
            raise Refusal(f"{path}: no agent class '{wanted}' (a class with begin and act). Found: {listed}.")
        return found[wanted]
    if not found:
        raise Refusal(f"{path}: no agent class found. Define 'class Agent' with begin(briefing) and act(observation).")
    if len(found) > 1 and "Agent" not in found:
        raise Refusal(f"{path}: several agent classes: {listed}. Say which one: {path.name}:{next(iter(found))}.")
    return found.get("Agent") or next(iter(found.values()))


def _names(cls: type[Any], attribute: str, path: Path) -> tuple[str, ...]:
    value = getattr(cls, attribute, ())
    if not isinstance(value, (tuple, list)) or not all(isinstance(name, str) for name in value):
        raise Refusal(f"{path}: {cls.__name__}.{attribute} must be a tuple of names, got {value!r}.")
    return tuple(value)


def shown(error: BaseException) -> str:
    """The traceback without our own frames in front, its end kept when it is long."""
    ours = (str(Path(__file__).parent), "<frozen importlib")
    trace = error.__traceback__
    while trace is not None and trace.tb_frame.f_code.co_filename.startswith(ours):
        trace = trace.tb_next
    return "".join(traceback.format_exception(type(error), error, trace))[-TEXT_MAX:]
