"""Imports an agent's file and finds its class.

The agent's own modules are imported from their sources, never from compiled files next to them: those can be outdated
or come from other sources, so that other code would run than was hashed.
"""

import importlib
import importlib.util
import sys
import traceback
from importlib.machinery import EXTENSION_SUFFIXES, ExtensionFileLoader, FileFinder, SourceFileLoader
from pathlib import Path
from types import CodeType, ModuleType
from typing import Any

from hthor.guest.agent import inputs
from hthor.guest.agent.agent_paths import AgentPaths
from hthor.guest.protocol import versions, wire

_MODULE = "hthor_guest_agent"  # not the file's name, which could hide a module of the standard library


class ContractViolation(Exception):
    """The file does not follow the agent contract; the message is for its author."""


class SourceLoader(SourceFileLoader):
    """Compiles a module every time it is imported."""

    def get_code(self, fullname: str) -> CodeType:
        """The module's code."""
        path = self.get_filename(fullname)
        code: CodeType = self.source_to_code(self.get_data(path), path)
        return code


def import_from_sources(paths: AgentPaths) -> None:
    """From now on, import modules in an agent's folder from sources and extension modules only."""
    make = FileFinder.path_hook((ExtensionFileLoader, EXTENSION_SUFFIXES), (SourceLoader, [".py"]))

    def hook(path: str) -> Any:
        if path != paths.root and not paths.owns(path):
            raise ImportError("not the agent's own", path=path)
        return make(path)

    sys.path_hooks.insert(0, hook)
    for path in [path for path in sys.path_importer_cache if path == paths.root or paths.owns(path)]:
        del sys.path_importer_cache[path]


def load_agent(order: wire.Load) -> tuple[type[Any], wire.Ready]:
    """The class in an agent's file or module, and its description of itself.

    Raises:
        ContractViolation: when there is no agent class, or the file cannot be imported.
    """
    path = Path(order.path)
    module = _import(path, order)
    cls = _pick(module, path, order.cls)
    privileges = _names(cls, "privileges", path)
    unknown = [name for name in privileges if name not in wire.PRIVILEGES]
    if unknown:
        raise ContractViolation(
            f"{path}: {cls.__name__}.privileges names '{unknown[0]}'. Valid: {', '.join(wire.PRIVILEGES)}."
        )
    ready = wire.Ready(
        name=path.stem,
        privileges=privileges,
        robots=_names(cls, "robots", path),
        absent=bool(getattr(cls, "absent", False)),
        persistent=bool(getattr(cls, "persistent", False)),
        doc=wire.sanitize_text(str(cls.__doc__ or module.__doc__ or "").strip())[: wire.TEXT_MAX],
        ahead=True,
        gpus=_gpus(cls, path),
        wire=versions.VERSION,
    )
    try:
        inputs.convert_arguments(cls, order.args)
    except inputs.ArgumentMismatch as error:
        raise ContractViolation(f"{path}: {error}") from None
    return cls, ready


def _import(path: Path, order: wire.Load) -> ModuleType:
    if order.root not in sys.path or not order.module:
        sys.path.insert(0, order.root)
    try:
        return _by_name(path, order.module) if order.module else _by_file(path)
    except SyntaxError as error:
        line = f":{error.lineno}" if error.lineno else ""
        raise ContractViolation(f"{error.filename or path}{line}: {error.msg}") from None
    except ContractViolation:
        raise
    except BaseException as error:
        raise ContractViolation(f"{path}: importing it failed.\n{format_traceback(error)}") from None


def _by_name(path: Path, name: str) -> ModuleType:
    module = importlib.import_module(name)
    file = Path(module.__file__ or "").resolve()
    if file != path:
        raise ContractViolation(
            f"{name}: another file of this name was imported than the one that was asked for: {file}"
        )
    return module


def _by_file(path: Path) -> ModuleType:
    spec = importlib.util.spec_from_file_location(_MODULE, path, loader=SourceLoader(_MODULE, str(path)))
    if spec is None or spec.loader is None:
        raise ContractViolation(f"{path}: not a Python file; an agent is one file that ends in .py")
    module = importlib.util.module_from_spec(spec)
    sys.modules[_MODULE] = module
    spec.loader.exec_module(module)
    return module


def _pick(module: ModuleType, path: Path, wanted: str) -> type[Any]:
    """The class to use: the requested class, the only class, or the class called Agent."""
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
            raise ContractViolation(f"{path}: no agent class '{wanted}' (a class with begin and act). Found: {listed}.")
        return found[wanted]
    if not found:
        raise ContractViolation(
            f"{path}: no agent class found. Define 'class Agent' with begin(briefing) and act(observation)."
        )
    if len(found) > 1 and "Agent" not in found:
        raise ContractViolation(
            f"{path}: several agent classes: {listed}. Say which one: {path.name}:{next(iter(found))}."
        )
    return found.get("Agent") or next(iter(found.values()))


def _names(cls: type[Any], attribute: str, path: Path) -> tuple[str, ...]:
    value = getattr(cls, attribute, ())
    if not isinstance(value, (tuple, list)) or not all(isinstance(name, str) for name in value):
        raise ContractViolation(f"{path}: {cls.__name__}.{attribute} must be a tuple of names, got {value!r}.")
    return tuple(value)


def _gpus(cls: type[Any], path: Path) -> float:
    value = getattr(cls, "gpus", 0.0)
    if isinstance(value, bool) or not isinstance(value, (int, float)) or value < 0:
        raise ContractViolation(
            f"{path}: {cls.__name__}.gpus must be a number from 0 on, such as 0.25 or 1, got {value!r}."
        )
    return float(value)


def format_traceback(error: BaseException) -> str:
    """The traceback without hthor's own frames at the start; a long traceback is cut at the start."""
    ours = (str(Path(__file__).parents[1]), importlib.__file__ or "", "<frozen importlib")
    trace = error.__traceback__
    while trace is not None and trace.tb_frame.f_code.co_filename.startswith(ours):
        trace = trace.tb_next
    return wire.sanitize_text("".join(traceback.format_exception(type(error), error, trace)))[-wire.TEXT_MAX :]
