"""Plug-ins: one file in a package is one plug-in, found by its file name.

A plug-in may also be a file of the user's, named by its path. Once loaded it is found by its file name like any other.
"""

from __future__ import annotations

import ast
import functools
import hashlib
import importlib
import importlib.util
import sys
import traceback
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any, Literal, overload

from hthor.errors import HthorError, UnknownName

if TYPE_CHECKING:
    from hthor.types import Mind, RobotSpec

_PACKAGES = {
    "agent": ("hthor.agents", "Agent"),
    "human model": ("hthor.humans.models", "Model"),
    "metric": ("hthor.eval.metrics.definitions", "METRICS"),
    "robot": ("hthor.world.robots", "SPEC"),
    "task kind": ("hthor.tasks.kinds", "KIND"),
}
_SUFFIX = ".py"
_FILES = {("agent", "none"): "silent"}
"""Plug-ins with another name than their file; both names are accepted."""


@functools.cache
def names(sort: str) -> tuple[str, ...]:
    """The names of every plug-in of a sort that ships with hthor, without importing any.

    Args:
        sort: "agent", "human model", "metric", "robot" or "task kind".
    """
    stems = (path.stem for path in _folder(sort).glob("*.py") if not path.stem.startswith("_"))
    return tuple(sorted(plugin_name(sort, stem) for stem in stems))


def plugin_name(sort: str, file: str) -> str:
    """The name of the plug-in in a file of this name; usually both names are the same."""
    return next((name for (one, name), stem in _FILES.items() if (one, stem) == (sort, file)), file)


def file_stem(sort: str, name: str) -> str:
    """The name of a plug-in's file."""
    return _FILES.get((sort, name), name)


def is_built_in(sort: str, name: str) -> bool:
    """Whether a plug-in of this name ships with hthor; a user's own never has the same name."""
    return plugin_name(sort, name) in names(sort)


def package(sort: str) -> str:
    """The name of the package of one sort of plug-ins."""
    return _PACKAGES[sort][0]


def file(sort: str, name: str) -> Path:
    """The file of a plug-in that ships with hthor."""
    return _folder(sort) / f"{file_stem(sort, name)}{_SUFFIX}"


def _folder(sort: str) -> Path:
    return Path(__file__).parent.joinpath(*package(sort).split(".")[1:])


def module_name(sort: str, name: str) -> str:
    """The module of a plug-in that ships with hthor."""
    return f"{package(sort)}.{file_stem(sort, name)}"


@overload
def load(sort: Literal["agent"], name: str) -> type[Mind]: ...
@overload
def load(sort: Literal["robot"], name: str) -> RobotSpec: ...
@overload
def load(sort: str, name: str) -> Any: ...
def load(sort: str, name: str) -> Any:
    """The plug-in's class or record, which its file defines under the name that its sort requires.

    Args:
        name: its name, or the path of a Python file that defines one.

    Raises:
        UnknownName: when no plug-in has that name.
        HthorError: when the file does not define that name, or does not load.
    """
    known, attribute = names(sort), _PACKAGES[sort][1]
    if plugin_name(sort, name) in known:
        module = importlib.import_module(module_name(sort, name))
    elif name.endswith(_SUFFIX):
        module = _from_file(sort, Path(name))
    elif (user_module := loaded(sort, name)) is not None:
        module = user_module
    else:
        raise UnknownName(sort, name, known)
    try:
        return getattr(module, attribute)
    except AttributeError:
        raise HthorError(f"{module.__file__}: a {sort} file must define '{attribute}'.") from None


def loaded(sort: str, name: str) -> ModuleType | None:
    """The plug-in's module if it was loaded before, built in or from a file."""
    return sys.modules.get(module_name(sort, name))


@functools.cache
def summary(sort: str, name: str) -> str:
    """The first sentence of a plug-in's file (by its name or path), up to a semicolon; read without importing it."""
    path = Path(name) if name.endswith(_SUFFIX) else file(sort, name)
    text = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or ""
    return " ".join(text.split("\n\n")[0].split()).split("; ")[0].rstrip(".")


def sha256(path: str) -> str:
    """Hash of a user's plug-in: of its file alone, not of what it imports."""
    return hashlib.sha256(Path(path).read_bytes()).hexdigest()


def user_error(error: BaseException) -> HthorError | None:
    """The error as a message to the user (file, line, function, text), if a plug-in of theirs raised it.

    None when the error did not pass through any file of the user's.
    """
    frames = [frame for frame in traceback.extract_tb(error.__traceback__) if frame.filename in _own()]
    if not frames:
        return None
    words = "".join(traceback.format_exception_only(error)).strip()
    return HthorError(f"{frames[-1].filename}:{frames[-1].lineno}, in {frames[-1].name}: {words}")


def _own() -> set[str]:
    """The user's files that are loaded as plug-ins."""
    ours, packages = str(Path(__file__).parent), {package for package, _ in _PACKAGES.values()}
    modules = [module for name, module in sys.modules.items() if name.rpartition(".")[0] in packages]
    files = [getattr(module, "__file__", None) or "" for module in modules]
    return {file for file in files if file and not Path(file).is_relative_to(ours)}


def _from_file(sort: str, path: Path) -> ModuleType:
    """Load a user's file as if it were in the package of its sort."""
    if not path.is_file():
        raise UnknownName(sort, str(path), names(sort), "A path must lead to a Python file.")
    if plugin_name(sort, path.stem) in names(sort) or not path.stem.isidentifier():
        raise HthorError(f"{path}: a {sort}'s file name must be a Python name that no {sort} of ours has; rename it.")
    name, place = f"{package(sort)}.{path.stem}", path.resolve()
    known = sys.modules.get(name)
    if known is not None:
        if known.__file__ == str(place):
            return known
        raise HthorError(f"{path}: a {sort} called '{path.stem}' was loaded from {known.__file__}; rename one of them.")
    spec = importlib.util.spec_from_file_location(name, place)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
    except (Exception, SystemExit) as error:
        del sys.modules[name]
        raise HthorError(f"{path}: {type(error).__name__}: {error}. The file must load by itself.") from error
    return module
