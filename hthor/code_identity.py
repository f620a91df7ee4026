"""What code does, as a hash over the syntax of modules and of all that they import.

Comments, docstrings, annotations of functions, white space, and the names and places of modules do not count; every
other change does. A package or a module that has no part in the course of a trial says so in a line of its own,
``CODE_PART = "pictures"`` (what robots' cameras show) or ``CODE_PART = "tools"`` (all else: processes, proofs, makers
of files); what is below a package belongs to the same part. Who asks for a hash says which parts count.
"""

from __future__ import annotations

import ast
import functools
import hashlib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path

from msgspec import Struct

PACKAGE = Path(__file__).resolve().parent
SIMULATION, PICTURES, TOOLS = "simulation", "pictures", "tools"
_MARK = "CODE_PART"
_DATA = (".json", ".xml", ".txt", ".csv", ".npz")
_FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda)
_DOCUMENTED = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)


class Module(Struct, frozen=True, kw_only=True):
    """A module as its source says it.

    ``tokens`` is its syntax, with a ``Bound`` where a name stands that an import of ours binds. ``imports`` are the
    modules of ours that it imports, wherever in it, but for what only type checkers read. ``data`` is the hash of
    each data file beside a module that knows where it lies. ``part`` is empty where the module does not say.
    """

    name: str
    tokens: tuple[str | Bound, ...]
    imports: tuple[str, ...]
    data: tuple[str, ...]
    part: str


class Bound(Struct, frozen=True):
    """A name that stands for modules of ours, or for something in them: pairs of a module and an attribute."""

    targets: tuple[tuple[str, str], ...]


class Sources:
    """The modules of a package by their names, read when they are asked for.

    Args:
        root: the package's folder.
    """

    def __init__(self, root: Path = PACKAGE) -> None:
        self._root = root
        self._read: dict[str, Module | None] = {}

    def module(self, name: str) -> Module | None:
        """The module of this name, None when the package has none."""
        if name not in self._read:
            path = self._path(name)
            self._read[name] = None if path is None else _parse(name, path, self._path)
        return self._read[name]

    def part(self, name: str) -> str:
        """What a module has to do with trials, as it or the nearest package above it says."""
        while name:
            found = self.module(name)
            if found is not None and found.part:
                return found.part
            name = name.rpartition(".")[0]
        return SIMULATION

    def sha256(self, roots: Iterable[str], parts: Sequence[str] = (SIMULATION,), files: Iterable[Path] = ()) -> str:
        """Hash of what these modules do, with all that they import of the ``parts`` that count.

        Args:
            roots: names of modules.
            parts: a module of another part counts only where it is a root.
            files: somebody else's, of which only what they import of ours counts.

        Raises:
            ValueError: when the package has no such module.
            SyntaxError: when one of the files is no Python.
        """
        names = sorted({*roots, *(name for path in files for name in _parse("", path, self._path).imports)})
        if missing := [name for name in names if self.module(name) is None]:
            raise ValueError(f"there is no module {missing[0]}")
        hashes: dict[str, str] = {}
        for ring in _rings(names, lambda name: self._needed(name, parts)):
            hashes |= _hashes([self._module(name) for name in ring], hashes)
        return _digest(sorted(hashes[name] for name in names))

    def closure(self, roots: Iterable[str], parts: Sequence[str] = (SIMULATION,)) -> list[str]:
        """Names of the modules that a hash of these roots covers."""
        return sorted(
            name for ring in _rings(sorted(set(roots)), lambda name: self._needed(name, parts)) for name in ring
        )

    def _needed(self, name: str, parts: Sequence[str]) -> list[str]:
        return [one for one in self._module(name).imports if self.part(one) in parts]

    def _module(self, name: str) -> Module:
        found = self.module(name)
        assert found is not None
        return found

    def _path(self, name: str) -> Path | None:
        head, *rest = name.split(".")
        if head != self._root.name:
            return None
        place = self._root.joinpath(*rest)
        files = (place / "__init__.py", place.with_suffix(".py")) if rest else (place / "__init__.py",)
        return next((path for path in files if path.is_file()), None)


@functools.cache
def ours() -> Sources:
    """hthor's own modules, as they were when this process first asked."""
    return Sources()


def is_python(path: Path) -> bool:
    """Whether a file can be read as Python of this version."""
    try:
        ast.parse(path.read_bytes())
    except (SyntaxError, ValueError, RecursionError):
        return False
    return True


# --------------------------------------------------------------------------------------------------------- a module


def _parse(name: str, path: Path, find: Callable[[str], Path | None], text: bytes | None = None) -> Module:
    tree = ast.parse(path.read_bytes() if text is None else text)
    reader = _Reader(_bindings(tree, find))
    reader.read(tree)
    part = next((_marked(node) for node in tree.body if _marked(node)), "")
    if part not in ("", SIMULATION, PICTURES, TOOLS):
        raise ValueError(f"{path}: {_MARK} is '{part}'; valid: '{PICTURES}', '{SIMULATION}', '{TOOLS}'")
    beside = sorted(one for one in path.parent.iterdir() if one.suffix in _DATA) if reader.knows_its_place else []
    return Module(
        name=name,
        tokens=tuple(reader.tokens),
        imports=tuple(sorted({module for bound in reader.bound.values() for module, _ in bound.targets} - {name})),
        data=tuple(hashlib.sha256(one.read_bytes()).hexdigest() for one in beside),
        part=part,
    )


def _bindings(tree: ast.Module, find: Callable[[str], Path | None]) -> dict[str, Bound]:
    """What of ours the names stand for that a file's imports bind, but for what only type checkers read."""
    found: dict[str, set[tuple[str, str]]] = {}
    for node in _executed(tree):
        if isinstance(node, ast.Import):
            for alias in node.names:
                if find(alias.name) is not None:
                    found.setdefault(alias.asname or alias.name.partition(".")[0], set()).add((alias.name, ""))
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            for alias in node.names:
                own, held = f"{node.module}.{alias.name}", alias.asname or alias.name
                if find(own) is not None:
                    found.setdefault(held, set()).add((own, ""))
                elif find(node.module) is not None:
                    found.setdefault(held, set()).add((node.module, alias.name))
    return {name: Bound(tuple(sorted(targets))) for name, targets in found.items()}


def _executed(tree: ast.AST) -> Iterator[ast.AST]:
    """Every node below, but for what only type checkers read."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.If) and isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING":
            continue
        yield node
        yield from _executed(node)


class _Reader:
    """Turns syntax into tokens that are the same for every spelling, and in every version of Python."""

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
        """Annotations of functions and in them do nothing; those of classes are the fields of records."""
        if field in ("kind", "type_comment", "type_params", "ctx"):
            return True
        if isinstance(node, ast.AnnAssign):
            return field == "annotation" and self._in_function > 0
        return (isinstance(node, ast.arg) and field == "annotation") or field == "returns"

    def _foreign(self, node: ast.Import | ast.ImportFrom) -> None:
        """An import of somebody else's; one of ours counts by the names that it binds."""
        module = getattr(node, "module", None) or ""
        for alias in node.names:
            if (alias.asname or alias.name.partition(".")[0]) not in self.bound:
                self.tokens.append(f"import {module} {alias.name} {alias.asname}")


def _statements(body: Sequence[ast.stmt]) -> list[ast.stmt]:
    """Without docstrings, and without what only type checkers read."""
    return [
        one
        for one in body
        if not (isinstance(one, ast.Expr) and isinstance(one.value, ast.Constant))
        and not (isinstance(one, ast.If) and isinstance(one.test, ast.Name) and one.test.id == "TYPE_CHECKING")
        and not _marked(one)
    ]


def _marked(node: ast.stmt) -> str:
    """The part that a statement says its module belongs to, empty when it is another statement."""
    if not isinstance(node, ast.Assign) or not isinstance(node.value, ast.Constant):
        return ""
    is_mark = any(isinstance(target, ast.Name) and target.id == _MARK for target in node.targets)
    return str(node.value.value) if is_mark else ""


# -------------------------------------------------------------------------------------------------- many modules


def _rings(roots: Sequence[str], needed: Callable[[str], Iterable[str]]) -> list[tuple[str, ...]]:
    """The modules that these need, in groups that import one another in a circle, whatever a group needs before it.

    (Tarjan's algorithm; most groups are a single module.)
    """
    found: list[tuple[str, ...]] = []
    order: dict[str, int] = {}
    lowest: dict[str, int] = {}
    stack: list[str] = []

    def visit(name: str) -> None:
        order[name] = lowest[name] = len(order)
        stack.append(name)
        for other in needed(name):
            if other not in order:
                visit(other)
                lowest[name] = min(lowest[name], lowest[other])
            elif other in stack:
                lowest[name] = min(lowest[name], order[other])
        if lowest[name] == order[name]:
            place = stack.index(name)
            found.append(tuple(sorted(stack[place:])))
            del stack[place:]

    for root in roots:
        if root not in order:
            visit(root)
    return found


def _hashes(ring: Sequence[Module], known: Mapping[str, str]) -> dict[str, str]:
    """Hashes of modules that import one another, from those of all else that they import.

    A module that does not count stands as "apart", one of the same circle as "here": within a circle, modules are told
    apart by what else they say.
    """
    inside = {module.name for module in ring}

    def token(one: str | Bound) -> str:
        if isinstance(one, str):
            return one
        names = [("here" if m in inside else known.get(m, "apart"), attribute) for m, attribute in one.targets]
        return f"bound {sorted(names)}"

    own = {
        one.name: _digest([*map(token, one.tokens), *sorted(known[m] for m in one.imports if m in known), *one.data])
        for one in ring
    }
    if len(ring) == 1:
        return own
    together = sorted(own.values())
    return {name: _digest([digest, *together]) for name, digest in own.items()}


def _digest(texts: Iterable[str]) -> str:
    return hashlib.sha256("\n".join(texts).encode("utf-8", "backslashreplace")).hexdigest()
