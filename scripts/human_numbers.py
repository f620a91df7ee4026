"""The tables of docs/humans.md that list every number of the human models, written from the code.

    python scripts/human_numbers.py docs/humans.md

A module constant is described by the string below it, ``[unit] Sentence. Source: ...`` or ``[unit] Sentence. Our
choice: reason``; a fixed parameter by the comment beside it, in the same form. Free parameters have a table of their
own in the page, which a test compares with the registry.
"""

from __future__ import annotations

import ast
import itertools
import re
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import NamedTuple

from hthor.humans.population.parameter_registry import free_parameter_names

HUMANS = Path(__file__).parents[1] / "hthor" / "humans"
BEGIN = "<!-- All below is written by: python scripts/human_numbers.py docs/humans.md -->\n"
END = "<!-- All above is written by: python scripts/human_numbers.py docs/humans.md -->\n"
_DESCRIBED = re.compile(r"\[([^\]]+)\] (.+?[.]) ((?:Our choice|Source: ).*)", re.DOTALL)

_FIELD = re.compile(r"^    (\w+): float = (\S+)  # (.*)$", re.MULTILINE)


class Number(NamedTuple):
    """A number of the human models: where it stands, its value as written, and its description in the code."""

    module: str
    name: str
    value: str
    description: str

    def parts(self) -> tuple[str, str, str] | None:
        """Unit, sentence and source; None when the description has another form."""
        match = _DESCRIBED.fullmatch(" ".join(self.description.split()))
        return (match[1], match[2], match[3]) if match else None


def constants(folder: Path = HUMANS) -> Iterator[Number]:
    """Every numeric module constant, in the order of files and lines."""
    for path in sorted(folder.rglob("*.py")):
        body = ast.parse(path.read_text()).body
        for node, below in zip(body, [*body[1:], None], strict=True):
            targets = node.targets if isinstance(node, ast.Assign) else [getattr(node, "target", None)]
            value = getattr(node, "value", None)
            if isinstance(node, ast.Assign | ast.AnnAssign) and value is not None and is_numeric(value):
                written = below.value if isinstance(below, ast.Expr) else None
                text = written.value if isinstance(written, ast.Constant) and isinstance(written.value, str) else ""
                names = ", ".join(ast.unparse(target) for target in targets if target is not None)
                yield Number(path.relative_to(folder).as_posix(), names, ast.unparse(value), text)


def fixed_parameters(folder: Path = HUMANS) -> Iterator[Number]:
    """Every parameter without a prior, by the comment beside it."""
    module = "population/parameters.py"
    for name, value, comment in _FIELD.findall((folder / module).read_text()):
        if name not in free_parameter_names():
            yield Number(module, name, value, comment)


def is_numeric(node: ast.expr) -> bool:
    """Whether an expression is a number, or a tuple or an arithmetic expression of numbers."""
    match node:
        case ast.Constant(value=value):
            return isinstance(value, int | float) and not isinstance(value, bool)
        case ast.Tuple(elts=parts):
            return bool(parts) and all(map(is_numeric, parts))
        case ast.UnaryOp(operand=operand):
            return is_numeric(operand)
        case ast.BinOp(left=left, right=right):
            return is_numeric(left) or is_numeric(right)
        case ast.Call(func=ast.Attribute(value=ast.Name(id="math"))):
            return all(map(is_numeric, node.args))
    return False


def tables() -> str:
    """The generated part of the page."""
    lines = ["", "### Fixed parameters of a participant", *_table(fixed_parameters()), "", "### Constants in the code"]
    for module, numbers in itertools.groupby(constants(), key=lambda number: number.module):
        lines += ["", f"`{module}`", *_table(numbers)]
    return "\n".join(lines) + "\n\n"


def _table(numbers: Iterable[Number]) -> list[str]:
    rows = ["", "| name | value | what | source |", "|---|---|---|---|"]
    for number in numbers:
        unit, sentence, source = number.parts() or ("", number.description, "")
        rows.append(f"| `{number.name}` | {_spelt(number.value)} {unit} | {sentence} | {source.rstrip('.')} |")
    return rows


def _spelt(value: str) -> str:
    """A value as the page spells it: angles in degrees as the code has them, no other Python."""
    return re.sub(r"math\.radians\(([\d.]+)\)", r"\1 degrees in", value)


def page(text: str) -> str:
    """The page with its generated part renewed."""
    head, tail = text.split(BEGIN)[0], text.split(END)[1]
    return head + BEGIN + tables() + END + tail


if __name__ == "__main__":
    path = Path(sys.argv[1])
    path.write_text(page(path.read_text()))
