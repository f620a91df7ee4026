"""The modules of a package, and one hash of some of them with all that they import."""

import functools
import hashlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path

from hthor.code_identity.syntax import SIMULATION, Bound, Module, parse

PACKAGE = Path(__file__).resolve().parents[1]


class Sources:
    """The modules of the package in folder ``root`` by name; each is read when it is first needed."""

    def __init__(self, root: Path = PACKAGE) -> None:
        self._root = root
        self._read: dict[str, Module | None] = {}
        self._containing: dict[bytes, list[str]] = {}

    def module(self, name: str) -> Module | None:
        """The module of this name, None when the package has none."""
        if name not in self._read:
            path = self._path(name)
            self._read[name] = None if path is None else parse(name, path, self._path)
        return self._read[name]

    def part(self, name: str) -> str:
        """The part that a module belongs to, as it or the nearest package above it declares."""
        while name:
            found = self.module(name)
            if found is not None and found.part:
                return found.part
            name = name.rpartition(".")[0]
        return SIMULATION

    def roots(self, of: str) -> list[str]:
        """Names of the modules that say ``CODE_ROOT = "OF"``, such as "trial"."""
        return [name for name in self.containing(b"CODE_ROOT") if self._module(name).root == of]

    def containing(self, words: bytes) -> list[str]:
        """Names of the modules whose source contains these bytes."""
        if words not in self._containing:
            paths = [path for path in sorted(self._root.rglob("*.py")) if words in path.read_bytes()]
            parts = [path.relative_to(self._root.parent).with_suffix("").parts for path in paths]
            self._containing[words] = [".".join(one[:-1] if one[-1] == "__init__" else one) for one in parts]
        return self._containing[words]

    def sha256(self, roots: Iterable[str], parts: Sequence[str] = (SIMULATION,), files: Iterable[Path] = ()) -> str:
        """Hash of these modules with all that they import.

        Args:
            roots: names of modules.
            parts: the parts that count; a module of another part counts only if it is a root.
            files: files outside the package; only the modules that they import from it count.

        Raises:
            ValueError: when the package has no such module.
            SyntaxError: when one of the files is not Python.
        """
        names = sorted({*roots, *(name for path in files for name in parse("", path, self._path).imports)})
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
    """hthor's own modules, as they were when this process first called this."""
    return Sources()


def _rings(roots: Sequence[str], needed: Callable[[str], Iterable[str]]) -> list[tuple[str, ...]]:
    """These modules and those that they need, dependencies first, in groups that import one another in a circle.

    Tarjan's algorithm for strongly connected components; most groups are a single module.
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
    """Hashes of modules that import one another, from the hashes of all others that they import.

    An imported module that does not count appears as "apart", a module of the same circle as "here"; within a circle,
    modules are distinguished by the rest of their syntax.
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
