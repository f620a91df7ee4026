"""The page on the human model lists what the code has: every parameter and constant, with unit and source."""

from __future__ import annotations

import ast
import re
import sys
from pathlib import Path

import pytest

from hthor.humans.population.distributions import Beta, HalfNormal, LogNormal, LogUniform, Normal, Prior, Uniform
from hthor.humans.population.parameter_registry import PARAMETERS, Parameter
from hthor.humans.population.parameters import Parameters

sys.path.insert(0, str(Path(__file__).parents[2] / "scripts"))
import human_numbers

PAGE = (Path(__file__).parents[2] / "docs" / "humans.md").read_text()
ROWS = {
    cells[0].strip("`"): cells
    for cells in (
        [cell.strip() for cell in line.strip("|").split("|")] for line in PAGE.splitlines() if line[:3] == "| `"
    )
    if len(cells) == 7
}


def spelt(number: float) -> str:
    """As the page spells numbers: .25, 1, 4."""
    return f"{number:g}".replace("0.", ".", 1) if abs(number) < 1 else f"{number:g}"


def law(prior: Prior | None) -> str:
    match prior:
        case Uniform(low, high):
            return f"U({spelt(low)}, {spelt(high)})"
        case LogUniform(low, high):
            return f"LogU({spelt(low)}, {spelt(high)})"
        case Normal(mean, sd):
            return f"N({spelt(mean)}, {spelt(sd)})"
        case LogNormal(median, sd):
            return f"LogN({spelt(median)}, {spelt(sd)})"
        case Beta(a, b):
            return f"Beta({spelt(a)}, {spelt(b)})"
        case HalfNormal(sd):
            return f"HN({spelt(sd)})"
    raise AssertionError(prior)


@pytest.mark.parametrize("parameter", PARAMETERS, ids=lambda parameter: parameter.name)
def test_every_free_parameter_is_told_as_it_is(parameter: Parameter) -> None:
    assert parameter.name in ROWS, "a row of the table of free parameters"
    _, unit, what, prior, effect, grade, source = ROWS[parameter.name]
    scale = "" if parameter.scale == "log" else f", {parameter.scale}"
    assert unit == parameter.unit
    assert prior == law(parameter.prior)
    assert effect == (f"{spelt(parameter.effect)}{scale}" if parameter.effect else "")
    assert grade == f"{parameter.grade}{', fit' if parameter.fitted else ''}"
    assert what
    assert source


def test_no_row_is_about_nothing() -> None:
    assert set(ROWS) == {parameter.name for parameter in PARAMETERS}


def test_the_page_lists_every_fixed_number_from_the_code() -> None:
    assert human_numbers.page(PAGE) == PAGE, "write it again: python scripts/human_numbers.py docs/humans.md"


@pytest.mark.parametrize("number", list(human_numbers.constants()), ids=lambda number: f"{number.module}:{number.name}")
def test_every_numeric_constant_has_a_unit_a_sentence_and_a_source(number: human_numbers.Number) -> None:
    assert number.parts(), "write below it: [unit] Sentence. Our choice. (or: Source: ...)"


@pytest.mark.parametrize("number", list(human_numbers.fixed_parameters()), ids=lambda number: number.name)
def test_every_fixed_parameter_has_a_unit_a_sentence_and_a_source(number: human_numbers.Number) -> None:
    assert number.parts(), "write beside it: [unit] Sentence. Our choice (or: Source: ...)"


def test_every_parameter_is_free_or_fixed() -> None:
    fixed = {number.name for number in human_numbers.fixed_parameters()}
    assert fixed == set(Parameters.__struct_fields__) - {parameter.name for parameter in PARAMETERS}


@pytest.mark.parametrize("text", ["", "A sentence. Our choice.", "[m] A sentence.", "[m] Our choice."])
def test_a_description_without_unit_sentence_or_source_is_refused(text: str) -> None:
    assert human_numbers.Number("a.py", "A", "1.0", text).parts() is None


@pytest.mark.parametrize(
    "room", ["behaviours", "communication", "core", "memory", "models", "motor", "perception", "search"]
)
def test_numbers_that_matter_are_constants_with_a_name(room: str) -> None:
    """Besides 0, 1, 2 and .5, guards against zero, indices and numbers of decimals."""
    for path in sorted((human_numbers.HUMANS / room).glob("*.py")):
        for function in (node for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, ast.FunctionDef)):
            found = {node.value for node in ast.walk(function) if _is_number(node)} - _uncounted(function)
            assert {value for value in found if value not in (0, 1, 2, 0.5) and value > 1e-6} == set(), path


def _is_number(node: ast.AST) -> bool:
    return isinstance(node, ast.Constant) and isinstance(node.value, int | float) and not isinstance(node.value, bool)


def _uncounted(function: ast.FunctionDef) -> set[float]:
    """Indices, decimals of `round`, and the size of a cache."""
    nodes = list(ast.walk(function))
    parts = [part for node in nodes if isinstance(node, ast.Subscript) for part in ast.walk(node.slice)]
    parts += [
        part
        for node in nodes
        if isinstance(node, ast.Call) and ast.unparse(node.func) == "round"
        for part in node.args[1:]
    ]
    parts += [part for decorator in function.decorator_list for part in ast.walk(decorator)]
    return {part.value for part in parts if _is_number(part)}


def test_every_source_in_the_text_is_in_the_list_and_the_other_way_round() -> None:
    text, listed = PAGE.split("## Sources")
    cited = {int(number) for number in re.findall(r"\[(\d+)\]", text)}
    sources = {int(number) for number in re.findall(r"^(\d+)\. ", listed, re.MULTILINE)}
    assert cited == sources == set(range(1, len(sources) + 1))


def test_every_file_that_the_page_names_exists() -> None:
    folder = Path(__file__).parents[2] / "hthor" / "humans"
    named = {name for name in re.findall(r"`([a-z_/]+\.py)`", PAGE) if not name.startswith("tests/")}
    assert named
    assert [name for name in sorted(named) if not (folder / name).exists()] == []
