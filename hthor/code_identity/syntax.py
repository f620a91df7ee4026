"""A module's syntax as tokens, independent of its layout, documentation, name and place."""

from __future__ import annotations

import ast
import hashlib
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from msgspec import Struct

SIMULATION, PICTURES, TOOLS = "simulation", "pictures", "tools"
_PART, _ROOT = "CODE_PART", "CODE_ROOT"
_DATA = (".json", ".xml", ".txt", ".csv", ".npz")
_FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda)
_DOCUMENTED = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)


class Module(Struct, frozen=True, kw_only=True):
    """A module, read from its source.

    Attributes:
        tokens: its syntax, with a ``Bound`` for each name that an import from the package binds.
        imports: the modules of the package that it imports anywhere, without imports for type checkers only.
        data: hashes of the data files in its folder, if it uses its own ``__file__``.
        part: its ``CODE_PART``, and ``root`` its ``CODE_ROOT``; empty if it has none.
    """

    name: str
    tokens: tuple[str | Bound, ...]
    imports: tuple[str, ...]
    data: tuple[str, ...]
    part: str
    root: str


class Bound(Struct, frozen=True):
    """A name for modules of the package or for something in them: pairs of a module and an attribute."""

    targets: tuple[tuple[str, str], ...]


def is_python(path: Path) -> bool:
    """Whether a file can be read as Python of this version."""
    try:
        ast.parse(path.read_bytes())
    except (SyntaxError, ValueError, RecursionError):
        return False
    return True


def parse(name: str, path: Path, find: Callable[[str], Path | None], text: bytes | None = None) -> Module:
    """A module, read from its file or from ``text`` instead."""
    tree = ast.parse(path.read_bytes() if text is None else text)
    reader = _Reader(_bindings(tree, find))
    reader.read(tree)
    marks = dict(mark for node in tree.body if (mark := _mark(node)))
    if marks.get(_PART, SIMULATION) not in (SIMULATION, PICTURES, TOOLS):
        raise ValueError(f"{path}: {_PART} is '{marks[_PART]}'; valid: '{PICTURES}', '{SIMULATION}', '{TOOLS}'")
    beside = sorted(one for one in path.parent.iterdir() if one.suffix in _DATA) if reader.knows_its_place else []
    return Module(
        name=name,
        tokens=tuple(reader.tokens),
        imports=tuple(sorted({module for bound in reader.bound.values() for module, _ in bound.targets} - {name})),
        data=tuple(hashlib.sha256(one.read_bytes()).hexdigest() for one in beside),
        part=marks.get(_PART, ""),
        root=marks.get(_ROOT, ""),
    )


def _bindings(tree: ast.Module, find: Callable[[str], Path | None]) -> dict[str, Bound]:
    """What each name that a file imports stands for, without imports for type checkers only."""
    targets_of: dict[str, set[tuple[str, str]]] = {}
    for node in _executed(tree):
        if isinstance(node, ast.Import):
            for alias in node.names:
                if find(alias.name) is not None:
                    targets_of.setdefault(alias.asname or alias.name.partition(".")[0], set()).add((alias.name, ""))
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            for alias in node.names:
                module, name = f"{node.module}.{alias.name}", alias.asname or alias.name
                if find(module) is not None:
                    targets_of.setdefault(name, set()).add((module, ""))
                elif find(node.module) is not None:
                    targets_of.setdefault(name, set()).add((node.module, alias.name))
    return {name: Bound(tuple(sorted(targets))) for name, targets in targets_of.items()}


def _executed(tree: ast.AST) -> Iterator[ast.AST]:
    """Every node below, except code that only type checkers read."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.If) and isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING":
            continue
        yield node
        yield from _executed(node)


class _Reader:
    """Turns syntax into tokens that are the same for every layout and every version of Python."""

    def __init__(self, bound: dict[str, Bound]) -> None:
        self.bound = bound
        self.tokens: list[str | Bound] = []
        self.knows_its_place = False
        self._in_function = 0

    def read(self, node: ast.AST) -> None:
        """Add the tokens of a node and of all below it."""
        if isinstance(node, (ast.Import, ast.ImportFrom)):
            self._foreign(node)
            return
        if isinstance(node, ast.Name) and node.id in self.bound:
            self.tokens += ["Name", self.bound[node.id]]
            return
        self.knows_its_place |= isinstance(node, ast.Name) and node.id == "__file__"
        self.tokens.append(type(node).__name__)
        self._in_function += isinstance(node, _FUNCTIONS)
        for field, value in ast.iter_fields(node):
            if value not in (None, []) and not self._is_only_typed(node, field):
                self.tokens.append(field)
                self._value(_statements(value) if field == "body" and isinstance(node, _DOCUMENTED) else value)
        self._in_function -= isinstance(node, _FUNCTIONS)
        self.tokens.append(")")

    def _value(self, value: object) -> None:
        if isinstance(value, ast.AST):
            self.read(value)
        elif isinstance(value, list):
            for one in value:
                self._value(one)
        else:
            self.tokens.append(f"{type(value).__name__} {value!r}")

    def _is_only_typed(self, node: ast.AST, field: str) -> bool:
        """Whether a field is an annotation without effect: in functions, not in classes, where it defines a record."""
        if field in ("kind", "type_comment", "type_params", "ctx"):
            return True
        if isinstance(node, ast.AnnAssign):
            return field == "annotation" and self._in_function > 0
        return (isinstance(node, ast.arg) and field == "annotation") or field == "returns"

    def _foreign(self, node: ast.Import | ast.ImportFrom) -> None:
        """Add an import from outside; imports from the package count by the names that they bind."""
        module = getattr(node, "module", None) or ""
        for alias in node.names:
            if (alias.asname or alias.name.partition(".")[0]) not in self.bound:
                self.tokens.append(f"import {module} {alias.name} {alias.asname}")


def _statements(body: Sequence[ast.stmt]) -> list[ast.stmt]:
    """The statements without docstrings and without code that only type checkers read."""
    return [
        one
        for one in body
        if not (isinstance(one, ast.Expr) and isinstance(one.value, ast.Constant))
        and not (isinstance(one, ast.If) and isinstance(one.test, ast.Name) and one.test.id == "TYPE_CHECKING")
        and not _mark(one)
    ]


def _mark(node: ast.stmt) -> tuple[str, str] | None:
    """The name and the value of a ``CODE_PART`` or ``CODE_ROOT`` statement; None for other statements."""
    if not isinstance(node, ast.Assign) or not isinstance(node.value, ast.Constant):
        return None
    names = [target.id for target in node.targets if isinstance(target, ast.Name)]
    return (names[0], str(node.value.value)) if names and names[0] in (_PART, _ROOT) else None
