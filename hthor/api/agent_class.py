"""Agents that are given as classes: the word of the command line for a class, and a file for one that is in no file.

A class of a notebook, or of a script that is running, is written into a file of its own together with all that it uses
from there. So it runs isolated and in every worker like other agents, and its identity is its source.
"""

import __future__

import ast
import builtins
import hashlib
import importlib
import inspect
import linecache
import os
import symtable
import sys
import textwrap
from collections.abc import Iterator
from pathlib import Path
from types import CodeType, FunctionType, ModuleType
from typing import Any

from hthor import installation, jsonio, plugins
from hthor.errors import AgentError

_INSTEAD = "Pass it with agent_args, or put the agent in a file."


def agent_word(agent: object) -> str:
    """The agent in the words of the command line.

    Args:
        agent: a word, a path, or a class.

    Raises:
        AgentError: when it is none of these, or its class cannot be written into a file.
    """
    if isinstance(agent, (str, os.PathLike)):
        return str(Path(agent)) if isinstance(agent, os.PathLike) else agent
    if not isinstance(agent, type):
        kind = type(agent).__name__
        raise AgentError(f"agent {kind}: give the class {kind}, not an object of it; its arguments go to agent_args.")
    if "." in agent.__qualname__:
        raise AgentError(f"agent {agent.__qualname__}: define the class at the top level, so that it can be imported.")
    if agent.__module__ == "__main__":
        return str(_write(agent))
    return _imported(agent)


def _imported(agent: type) -> str:
    """The word for a class of a module that can be imported."""
    name = agent.__module__
    head, _, stem = name.rpartition(".")
    if head == plugins.package("agent") and plugins.load("agent", plugins.plugin_name("agent", stem)) is agent:
        return plugins.plugin_name("agent", stem)
    file = getattr(sys.modules.get(name), "__file__", None) or ""
    if not file.endswith(".py"):
        raise AgentError(f"agent {agent.__name__}: its module {name} is no Python file.")
    return f"{name}:{agent.__name__}" if head else f"{file}:{agent.__name__}"


def _write(agent: type) -> Path:
    """The file of a class that is in no module, made unless it is there."""
    data = _Extract(agent).module().encode()
    folder = installation.cache() / "agents" / hashlib.sha256(data).hexdigest()[:16]
    file = folder / f"{agent.__name__}.py"
    if not file.is_file():
        jsonio.write(file, data)
    return file


class _Extract:
    """Collects the source of a class, and of all that it uses of the program or notebook in which it was defined."""

    def __init__(self, agent: type) -> None:
        self._agent = agent
        self._space = vars(sys.modules["__main__"])
        self._imports: set[str] = set()
        self._values: dict[str, str] = {}
        self._definitions: dict[str, str] = {}

    def module(self) -> str:
        """The text of a module that defines the class, and all that it uses; the same for the same sources."""
        self._define(self._agent.__name__, self._agent)
        late = self._space.get("annotations") is __future__.annotations
        top = ["from __future__ import annotations"] if late else []
        values = [f"{name} = {text}" for name, text in sorted(self._values.items())]
        parts = ["\n".join(top), "\n".join(sorted(self._imports)), "\n".join(values), *self._definitions.values()]
        alias = [] if self._agent.__name__ == "Agent" else [f"Agent = {self._agent.__name__}"]
        return "\n\n\n".join(filter(None, [*parts, *alias])) + "\n"

    def _define(self, name: str, value: Any) -> None:
        """Add a class or a function after all that it uses."""
        source = _source(value)
        self._definitions[name] = ""  # those that use each other come once
        for used in _global_names(source):
            if used in self._space and used not in self._definitions and used not in self._values:
                self._add(used, self._space[used])
        del self._definitions[name]
        self._definitions[name] = source

    def _add(self, name: str, value: Any) -> None:
        if isinstance(value, ModuleType):
            self._imports.add(f"import {value.__name__}" + ("" if value.__name__ == name else f" as {name}"))
        elif (line := _import_line(name, value)) is not None:
            self._imports.add(line)
        elif isinstance(inspect.unwrap(value) if callable(value) else value, (type, FunctionType)):
            self._define(name, value)
        elif _is_literal(value):
            self._values[name] = repr(value)
        elif getattr(builtins, name, None) is not value:
            kind = type(value).__name__
            raise AgentError(
                f"agent {self._agent.__name__} uses '{name}', an object of the type {kind}, which cannot be written "
                f"into a file. {_INSTEAD}"
            )


def _import_line(name: str, value: Any) -> str | None:
    """The statement that imports a value under this name; None where it is from no module that can be imported."""
    module, own = getattr(value, "__module__", None), getattr(value, "__name__", None)
    if not isinstance(module, str) or not isinstance(own, str) or module == "__main__":
        return None
    try:
        found = getattr(importlib.import_module(module), own, None)
    except ImportError:
        return None
    return f"from {module} import {own}" + ("" if own == name else f" as {name}") if found is value else None


def _is_literal(value: object) -> bool:
    try:
        return bool(ast.literal_eval(repr(value)) == value)
    except (ValueError, SyntaxError):
        return False


def _global_names(source: str) -> list[str]:
    """The names that a source uses and does not define itself, sorted."""

    def of(table: symtable.SymbolTable) -> Iterator[str]:
        top = table.get_type() == "module"
        for one in table.get_symbols():
            if one.is_referenced() and (top or one.is_global()):
                yield one.get_name()
        for inner in table.get_children():
            yield from of(inner)

    return sorted(set(of(symtable.symtable(source, "<agent>", "exec"))))


def _source(value: Any) -> str:
    """The source of a class or a function, with its decorators.

    Raises:
        AgentError: when the file or cell in which it was defined is not known any more.
    """
    kind: type[ast.ClassDef] | type[ast.FunctionDef] = ast.ClassDef if isinstance(value, type) else ast.FunctionDef
    for code in _codes(value):
        text = _file_text(code.co_filename)
        for node in ast.parse(text).body:
            if not isinstance(node, kind) or node.name != value.__name__:
                continue
            first = min([node.lineno, *(one.lineno for one in node.decorator_list)])
            if first <= code.co_firstlineno <= (node.end_lineno or 0):
                return textwrap.dedent("\n".join(text.splitlines()[first - 1 : node.end_lineno]))
    raise AgentError(f"{value.__name__}: the source that defines it was not found. Put the agent in a file.")


def _codes(value: Any) -> Iterator[CodeType]:
    """The compiled code of a function, or of the methods of a class: it says where the source is."""
    members = vars(value).values() if isinstance(value, type) else (value,)
    for one in members:
        inner = getattr(one, "__func__", None) or getattr(one, "fget", None) or one
        code = getattr(inspect.unwrap(inner), "__code__", None) if callable(inner) else None
        if isinstance(code, CodeType):
            yield code


def _file_text(file: str) -> str:
    """The text of a file, of a notebook's cell, or of ``python -c``; empty where it is not known."""
    if file == "<string>" and "-c" in sys.orig_argv:
        return sys.orig_argv[sys.orig_argv.index("-c") + 1]
    text = "".join(linecache.getlines(file))
    try:
        ast.parse(text)
    except SyntaxError:
        return ""  # a cell with commands of the notebook, which are no Python
    return text
