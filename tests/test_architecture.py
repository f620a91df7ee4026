"""The shape of the package: no circles, few arrows, short functions, declared libraries, words that are read once."""

from __future__ import annotations

import ast
import re
import statistics
import sys
import tomllib
from collections import defaultdict
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import NamedTuple

import grimp
import pytest
from packaging.requirements import Requirement

PACKAGE = Path(__file__).resolve().parents[1] / "hthor"
FILES = sorted(PACKAGE.rglob("*.py"))
ROOMS = ("eval", "world", "humans", "calibration", "guest")
MOST_ARROWS, MEDIAN_FUNCTION = 200, 10
DISTRIBUTIONS = {"cv2": "opencv-python-headless", "skimage": "scikit-image", "sklearn": "scikit-learn"}
"""The name on PyPI of each library that is imported by another name."""
PRIVATE_WORDS = (
    "anew",
    "but for",
    "comes to nothing",
    "foretell",
    "foretells",
    "foretold",
    "hangs on what",
    "is told of",
    "knows nothing of",
    "lies about",
    "needful",
    "thereof",
    "whom",
    "whosoever",
)
"""Words of a private language that once filled these files; docs/glossary.md has those that are used instead."""


@cache
def graph() -> grimp.ImportGraph:
    return grimp.build_graph("hthor", cache_dir=None)


def arrows(package: str) -> dict[str, set[str]]:
    """Which children of a package import which others, with all that lies below them."""
    found: dict[str, set[str]] = defaultdict(set)
    owner = {child: child for child in graph().find_children(package)}
    for child in list(owner):
        owner |= dict.fromkeys(graph().find_descendants(child), child)
    for module, mine in owner.items():
        for other in graph().find_modules_directly_imported_by(module):
            if owner.get(other, mine) != mine:
                found[mine].add(owner[other])
    return found


def circle(edges: dict[str, set[str]]) -> list[str]:
    """Some nodes that import one another in a circle; none in a graph without."""
    done: set[str] = set()
    path: list[str] = []

    def visit(node: str) -> list[str]:
        if node in path:
            return path[path.index(node) :]
        if node in done:
            return []
        path.append(node)
        for other in sorted(edges.get(node, ())):
            if found := visit(other):
                return found
        path.pop()
        done.add(node)
        return []

    return next((found for node in sorted(edges) if (found := visit(node))), [])


def packages() -> list[str]:
    return sorted(name for name in graph().modules if graph().find_children(name))


def test_no_modules_import_one_another_in_a_circle() -> None:
    assert circle({name: set(graph().find_modules_directly_imported_by(name)) for name in graph().modules}) == []


@pytest.mark.parametrize("package", packages())
def test_no_parts_of_a_package_import_one_another_in_a_circle(package: str) -> None:
    assert circle(arrows(package)) == []


def test_rooms_have_few_inner_arrows() -> None:
    counts = {room: sum(map(len, arrows(f"hthor.{room}").values())) for room in ROOMS}
    assert sum(counts.values()) < MOST_ARROWS, counts


class Source(NamedTuple):
    """What the laws below ask of a module."""

    lengths: list[int]
    """The lines of each function."""
    texts: list[str]
    """What is written for people: docstrings, other strings and comments."""
    libraries: set[tuple[str, bool]]
    """The libraries that it imports, by their names on PyPI, and whether it can be imported without them."""


@cache
def sources() -> dict[Path, Source]:
    return {path: read(path) for path in FILES}


def read(path: Path) -> Source:
    text = path.read_text(encoding="utf-8")
    tree = ast.parse(text)
    nodes = list(ast.walk(tree))
    functions = (node for node in nodes if isinstance(node, ast.FunctionDef))
    strings = [node.value for node in nodes if isinstance(node, ast.Constant) and isinstance(node.value, str)]
    comments = re.findall(r"(?<!['\"])#[^'\"\n]*$", text, flags=re.MULTILINE)
    return Source(
        [(node.end_lineno or 0) - node.lineno + 1 for node in functions],
        strings + comments,
        set(libraries(tree, nodes)),
    )


def libraries(tree: ast.Module, nodes: list[ast.AST]) -> Iterator[tuple[str, bool]]:
    first = {id(node) for node in tree.body}
    for node in nodes:
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            names = [node.module or ""]
        else:
            continue
        for name in {name.partition(".")[0] for name in names} - {"hthor"} - sys.stdlib_module_names:
            yield DISTRIBUTIONS.get(name, name.replace("_", "-")), id(node) not in first


def test_the_median_function_is_short() -> None:
    assert statistics.median(length for one in sources().values() for length in one.lengths) < MEDIAN_FUNCTION


def test_private_words_do_not_come_back() -> None:
    pattern = re.compile(rf"\b({'|'.join(PRIVATE_WORDS)})\b", re.IGNORECASE)
    found = [
        f"{path.relative_to(PACKAGE)}: {match[0]}"
        for path, one in sources().items()
        for text in one.texts
        for match in pattern.finditer(" ".join(text.split()))
    ]
    assert not found


def test_every_imported_library_is_declared() -> None:
    project = tomllib.loads((PACKAGE.parent / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    core = {Requirement(line).name for line in project["dependencies"]}
    extras = {Requirement(line).name for lines in project["optional-dependencies"].values() for line in lines}
    imported = {(path.relative_to(PACKAGE), *library) for path, one in sources().items() for library in one.libraries}
    guarded = {path.parent for path in sources() if path.name == "__init__.py" and "MissingExtra" in path.read_text()}
    optional = {path for path, _, _ in imported if PACKAGE / path.parent in guarded}  # their package names the extra
    assert not {
        (path, name)
        for path, name, late in imported
        if name not in (core | extras if late or path in optional else core)
    }
    assert not core - {name for _, name, _ in imported}, "declared and never imported"
