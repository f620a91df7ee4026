"""What a simulated trial's course hangs on, as hashes: a stored one is never taken for one of another world or person.

Code counts by what it means: comments, docstrings and white space do not. What decides T* alone does not either, and
neither do priors' sources: simulated trials outlive changes of those. Knows nothing of files of trials.
"""

from __future__ import annotations

import ast
import functools
import hashlib
from collections.abc import Iterator, Sequence
from pathlib import Path

import msgspec
from msgspec import Struct

from hthor import jsonio, rules
from hthor.eval import provenance
from hthor.humans.registry import PARAMETERS
from hthor.tasks import Suite

_ROOTS = ("hthor.episode", "hthor.world", "hthor.humans.models.proxy", "hthor.eval.cast", "hthor.calibration.sitting")
_AGENTS = ("hthor.agents.silent", "hthor.agents.frontier", "hthor.agents.oracle", "hthor.world.robots.scout")
_APART = (
    "hthor.looks",  # pictures, which neither these robots nor the person see
    "hthor.cli",
    "hthor.eval",  # but for the cast
    "hthor.guest",
    "hthor.houses.generator",  # each task names its house's hash, and where everything in it lies
    "hthor.tasks.arrange",
    "hthor.tasks.ground",
    "hthor.tasks.starts",
    "hthor.tasks.difficulty",
    "hthor.tasks.library",
    "hthor.tasks.validate",
    "hthor.humans.people",  # who is sampled; here people come of points
    "hthor.humans.registry",  # counts by its priors and effects
    "hthor.rules",  # counts by its values
)
_LEAST_TIME = ("t_star", "least_times")
_T_STAR = "T_STAR"
_DATA = (".json", ".xml", ".txt", ".csv", ".npz")
_NOT_COURSE = ("t_star", "difficulty", "split")


class Identity(Struct, frozen=True, kw_only=True):
    """Hashes of all that decides the course of trials of a suite: ``parts`` by the name of what they are of."""

    parts: dict[str, str]

    @property
    def sha256(self) -> str:
        """Hash of them all."""
        return jsonio.sha256(self.parts)

    def differences(self, other: Identity) -> list[str]:
        """Names of what is not the same in both."""
        names = sorted({*self.parts, *other.parts})
        return [name for name in names if self.parts.get(name) != other.parts.get(name)]


def of(suite: Suite) -> Identity:
    """What trials of this suite hang on, in this version of everything."""
    kinds = tuple(sorted({f"hthor.tasks.kinds.{task.kind}" for task in suite.tasks}))
    numbers = {name: value for name, value in rules.as_dict().items() if not name.startswith(_T_STAR)}
    priors = [(one.name, one.prior, one.effect, one.scale) for one in PARAMETERS]
    versions = {name: version for name, version in provenance.versions().items() if name != "hthor"}
    return Identity(
        parts={
            f"suite {suite.name}": jsonio.sha256([_course(task) for task in suite.tasks]),
            "rules": jsonio.sha256(numbers),
            "parameters and their priors": jsonio.sha256(priors),
            **{f"version of {name}": version for name, version in versions.items()},
            **_code((*_ROOTS, *_AGENTS, *kinds)),
        }
    )


def _course(task: object) -> dict[str, object]:
    """A task without what has no part in the course of its trials."""
    told: dict[str, object] = msgspec.to_builtins(task)
    return {name: value for name, value in told.items() if name not in _NOT_COURSE}


@functools.cache
def _code(roots: tuple[str, ...]) -> dict[str, str]:
    """Hash of every module that the roots need, and of the data files beside them, by file name."""
    found = {path.relative_to(provenance.PACKAGE).as_posix(): meaning(path) for path in _needed(roots).values()}
    folders = {path.parent for path in _needed(roots).values()}
    for folder in sorted(folders):
        for path in sorted(folder.iterdir()):
            if path.suffix in _DATA:
                name = path.relative_to(provenance.PACKAGE).as_posix()
                found[name] = hashlib.sha256(path.read_bytes()).hexdigest()
    return dict(sorted(found.items()))


@functools.cache
def _needed(roots: tuple[str, ...]) -> dict[str, Path]:
    """Files of the modules that ``roots`` import, directly or by way of others, and their own."""
    found: dict[str, Path] = {}
    left = list(roots)
    while left:
        name = left.pop()
        path = _file(name)
        if path is None or name in found or (_is_apart(name) and name not in roots):
            continue
        found[name] = path
        left += [name.rpartition(".")[0], *_imports(path)]
    return found


def _is_apart(name: str) -> bool:
    return any(name == other or name.startswith(f"{other}.") for other in _APART)


def _file(name: str) -> Path | None:
    head, *rest = name.split(".")
    if head != "hthor" or not rest:
        return None
    place = provenance.PACKAGE.joinpath(*rest)
    return next((path for path in (place.with_suffix(".py"), place / "__init__.py") if path.is_file()), None)


def _imports(path: Path) -> Iterator[str]:
    """Names of everything of ours that a file may import, wherever in it, but for what only type checkers read."""
    for node in _walk(ast.parse(path.read_bytes())):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            yield node.module
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def _walk(tree: ast.AST) -> Iterator[ast.AST]:
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
            continue
        yield node
        yield from _walk(node)


def of_statistics() -> str:
    """Hash of the code that turns tables of trials into populations."""
    files = sorted(Path(__file__).parent.glob("*.py"))
    return jsonio.sha256({path.name: meaning(path) for path in files})


def meaning(path: Path) -> str:
    """Hash of a module without its comments, docstrings and white space, and without how it works out T*."""
    tree = ast.parse(path.read_bytes())
    for node in ast.walk(tree):
        if isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)):
            node.body = _body(node.body)
    return hashlib.sha256(ast.dump(tree).encode()).hexdigest()


def _body(statements: Sequence[ast.stmt]) -> list[ast.stmt]:
    return [one for one in statements if not _is_text(one) and getattr(one, "name", "") not in _LEAST_TIME]


def _is_text(statement: ast.stmt) -> bool:
    return isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant)
