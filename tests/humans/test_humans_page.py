"""The page on the human model says what the code has: every parameter, its unit, prior, effect and value."""

from __future__ import annotations

import re
from pathlib import Path

import msgspec
import pytest

from hthor.humans.population.distributions import Beta, HalfNormal, LogNormal, LogUniform, Normal, Prior, Uniform
from hthor.humans.population.parameter_registry import PARAMETERS, Parameter
from hthor.humans.population.parameters import Parameters

PAGE = (Path(__file__).parents[2] / "docs" / "humans.md").read_text()
ROWS = {
    cells[0].strip("`"): cells
    for cells in (
        [cell.strip() for cell in line.strip("|").split("|")] for line in PAGE.splitlines() if line[:3] == "| `"
    )
    if len(cells) == 7
}
FIXED = [name for name in Parameters.__struct_fields__ if name not in ROWS]


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


@pytest.mark.parametrize("name", FIXED)
def test_every_fixed_number_stands_there(name: str) -> None:
    (line,) = [line for line in PAGE.splitlines() if line.startswith("| `") and f"`{name}`" in line.split("|")[1]]
    names = re.findall(r"`(\w+)`", line.split("|")[1])
    values = [value.split(" ")[0] for value in line.split("|")[2].strip().split(", ")]
    assert values[names.index(name)] == spelt(msgspec.structs.asdict(Parameters())[name])


def test_every_source_in_the_text_is_in_the_list_and_the_other_way_round() -> None:
    text, listed = PAGE.split("## Sources")
    cited = {int(number) for number in re.findall(r"\[(\d+)\]", text)}
    sources = {int(number) for number in re.findall(r"^(\d+)\. ", listed, re.MULTILINE)}
    assert cited == sources == set(range(1, len(sources) + 1))


def test_every_file_that_the_page_names_exists() -> None:
    folder = Path(__file__).parents[2] / "hthor" / "humans"
    named = set(re.findall(r"`([a-z_]+\.py)`", PAGE))
    assert named
    assert [name for name in sorted(named) if not (folder / name).exists()] == []
