"""`hthor humans`: who the people are."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Any

import typer

from hthor.commands.humans import profile, validate
from hthor.commands.options import Json
from hthor.console import formats, output
from hthor.console.formats import Format, Shape

if TYPE_CHECKING:
    from hthor.humans.population.describe import ParameterChange, ParameterDescription, PopulationDescription

app = typer.Typer(no_args_is_help=True, help="Populations, kinds of people and human models.")

_LARGE = 1000.0
_LEGEND = (
    "people sd: how far people are from the mean, one standard deviation (of the logarithm, as a percentage; of the "
    "logit; or in the unit itself). grade: what could identify it: A the published results (A- weakly), B logs of "
    "sessions (B- weakly), C the literature only, own nothing at hand. the data: what the data that this population "
    "was fitted to say about the parameter."
)

Name = Annotated[
    str,
    typer.Argument(
        metavar="NAME",
        help="A name of 'hthor humans list', or a file: pop.npz, my_kind.json, my_human.py. cautious@pop.npz is that "
        "kind out of that population.",
    ),
]


@app.command("list")
def list_humans(shape: Shape = Format.TABLE, json: Json = False) -> None:
    """List every population, kind of people and human model that --humans accepts by name."""
    from hthor.humans.population import resolve

    rows = _everybody()
    if formats.asks_json(json, shape):
        output.put_json(rows)
        return
    output.put_table(
        ("name", "sort", "purpose", "sha256"), [(*list(row.values())[:3], row["sha256"][:10]) for row in rows], shape
    )
    population = resolve.default_population()
    output.put_line(
        f"proxy is the model of all populations; by itself it stands for the population {population}.", shape
    )


@app.command("describe")
def describe(name: Name, json: Json = False) -> None:
    """Show every parameter with its prior, source and posterior, and the conditions these people were validated for."""
    from hthor.humans.population import describe, resolve

    found = describe.describe_population(resolve.resolve_humans(name))
    if json:
        output.put_json(found)
        return
    _put_head(found)
    if found.changes:
        output.put_table(
            ("parameter", "change", "mean before", "after", "reason"), [_change_row(c) for c in found.changes]
        )
        output.put_line(f"see also: hthor humans describe {found.population}")
        return
    headings = ("parameter", "mean", "5, 50 and 95 %", "prior 5, 50 and 95 %", "people sd", "grade", "the data")
    output.put_table(headings, [_trait_row(trait) for trait in found.traits])
    output.put_table(
        ("parameter", "meaning", "source of the prior"), [(t.name, t.meaning, t.source) for t in found.traits]
    )
    output.put_line(_LEGEND)
    _put_foot(found)


@app.command("sample")
def sample(
    name: Name,
    n: Annotated[int, typer.Option("--n", min=1, help="Number of participants.")] = 18,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the study, as in hthor eval.")] = 0,
    json: Json = False,
) -> None:
    """Show the participants of a study with this seed: the traits in which they differ, or with --json all traits."""
    from hthor.humans.population import describe, resolve

    found = resolve.resolve_humans(name)
    rows = describe.sample_participants(found, n, seed)
    if json:
        output.put_json(rows)
        return
    columns = describe.varying_parameters(found)
    held = [(row["participant"], *(float(_number(row[name])) for name in columns)) for row in rows]
    output.put_table(("participant", *columns), held)


app.command("validate")(validate.validate)
app.command("profile")(profile.profile)


def _everybody() -> list[dict[str, Any]]:
    """One row per name: populations, kinds, models; the hash is empty for a model that needs a source to have one."""
    from hthor import plugins
    from hthor.errors import HthorError
    from hthor.humans.population import kinds, population_file, resolve

    def row(name: str, sort: str) -> dict[str, Any]:
        try:
            found = resolve.resolve_humans(name)
        except HthorError:
            return {"name": name, "sort": sort, "purpose": plugins.summary("human model", name), "sha256": ""}
        return {"name": name, "sort": sort, "purpose": found.purpose, "sha256": found.sha256}

    return [
        *(row(name, "population") for name in population_file.names()),
        *(row(name, "kind") for name in kinds.names()),
        *(row(name, "model") for name in plugins.names("human model")),
    ]


def _put_head(found: PopulationDescription) -> None:
    lines = [f"{found.name}: {found.purpose}" if found.purpose else found.name]
    lines += [found.reason] if found.reason else []
    draws = f"{found.draws} draws, worth {found.effective_draws:g}"
    lines.append(f"human model {found.model}, population {found.population}: {draws}")
    lines.append(f"sha256 {found.sha256}")
    for line in lines:
        output.put_line(line)


def _put_foot(found: PopulationDescription) -> None:
    its = found.validity
    lines = ["fixed: " + ", ".join(f"{name} {_number(value)}" for name, value in found.fixed.items())]
    if its.suite:
        settings = ", ".join(f"{key} {_number(value)}" for key, value in its.settings.items())
        lines.append(f"fitted to: {', '.join(found.statistics)} (targets {its.targets} {its.targets_sha256[:10]})")
        lines.append(
            f"valid for: suite {its.suite} {its.suite_sha256[:10]}, world {its.simulation}, mind {its.mind}; {settings}"
        )
    else:
        lines.append("valid for: nothing in particular, as it was fitted to no data")
    for title, numbers in (("design effects", found.design_effects), ("figures", found.figures)):
        if numbers:
            lines.append(f"{title}: " + ", ".join(f"{name} {_number(value)}" for name, value in numbers.items()))
    lines.append(f"made by: {found.command} (seed {found.seed})")
    lines += [f"note: {note}" for note in found.notes]
    for line in lines:
        output.put_line(line)


def _trait_row(trait: ParameterDescription) -> tuple[object, ...]:
    between = {"": "–", "log": f"{100.0 * trait.person_sd:.0f} %", "logit": f"{trait.person_sd:.2f} logit"}
    return (
        f"{trait.name} [{trait.unit}]" if trait.unit else trait.name,
        _number(trait.mean),
        _three(trait.quantiles),
        _three(trait.prior_quantiles),
        between.get(trait.scale, f"{trait.person_sd:.2f}"),
        trait.grade,
        trait.says,
    )


def _three(values: Sequence[float]) -> str:
    return "".join(f"{_number(value):>7}" for value in values)


def _change_row(change: ParameterChange) -> tuple[object, ...]:
    sign = {"add": f"{change.value:+g}", "times": f"× {change.value:g}", "set": f"= {change.value:g}"}[change.verb]
    return change.parameter, sign, _number(change.before), _number(change.after), change.reason


def _number(value: float | str) -> str:
    if isinstance(value, str):
        return value
    return f"{value:.0f}" if abs(value) >= _LARGE else f"{value:.3g}"
