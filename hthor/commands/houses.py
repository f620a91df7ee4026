"""`hthor houses`: list, check, generate, show and count houses."""

from __future__ import annotations

import sys
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from hthor.commands.options import Json
from hthor.console import formats, output, progress_bar
from hthor.console.formats import Format, Shape

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from hthor.houses.checks.house_rules import Finding
    from hthor.types import HouseSpec
    from hthor.world.validation.house_soundness import ValidHome

app = typer.Typer(no_args_is_help=True, help="Floor plans.")

House = Annotated[str, typer.Argument(metavar="HOUSE", help="A house's name, or a house file (ProcTHOR's JSON).")]
_ROOMS = (4, 7)
_SHOWN = 4


@app.command("list")
def list_houses(shape: Shape = Format.TABLE, json: Json = False) -> None:
    """List the houses that ship with hthor."""
    from hthor import houses

    rows = [{"name": name, **_size(house), "sha256": house.sha256} for name, house in _own(houses)]
    if formats.asks_json(json, shape):
        output.put_json(rows)
        return
    table = [[row["name"], len(row["rooms"]), f"{row['area_m2']:.0f}", row["things"], row["rooms"]] for row in rows]
    output.put_table(["name", "rooms", "m2", "things", "which"], table, shape)


@app.command("check")
def check_house(
    house: House,
    radius: Annotated[
        float | None,
        typer.Option(
            min=0.01,
            max=2.0,
            help="Radius of the body that must fit through the house [m]. [default: 0.2; with --strict 0.25]",
        ),
    ] = None,
    strict: Annotated[
        bool,
        typer.Option(
            "--strict", help="Apply the rules of hthor's own houses: what other houses may lack is an error too."
        ),
    ] = False,
    full: Annotated[
        bool,
        typer.Option(
            "--full", help="Strict, and also tested in the physics engine: no penetration, and surfaces hold objects."
        ),
    ] = False,
    json: Json = False,
) -> None:
    """Check whether a house is sound: exit code 1 if it is not, 2 if the file is broken."""
    from hthor import houses

    size = radius if radius is not None else 0.25 if strict or full else 0.2
    spec = houses.load(house)
    if full:
        from hthor.world.validation.house_soundness import check_soundness

        findings = check_soundness(spec, size)
    else:
        findings = houses.check(spec, size, strict=strict)
    errors = sum(finding.severity == "error" for finding in findings)
    if json:
        output.put_json({"house": house, "radius": size, "sound": not errors, "findings": findings})
    else:
        _put_findings(findings)
        verdict = "unsound" if errors else "sound"
        how = ", judged strictly and proved" if full else ", judged strictly" if strict else ""
        counts = f"({errors} errors, {len(findings) - errors} warnings)"
        sys.stdout.write(f"{house}: {verdict} for a radius of {size} m{how} {counts}\n")
    if errors:
        raise typer.Exit(1)


@app.command("generate")
def generate(
    seed: Annotated[int, typer.Option(min=0, help="The same seed gives the same house, byte for byte.")] = 0,
    rooms: Annotated[
        int | None,
        typer.Option(min=_ROOMS[0], max=_ROOMS[1], help="Number of rooms. [default: 4 to 7, drawn by the seed]"),
    ] = None,
    count: Annotated[int, typer.Option(min=1, help="Number of houses: of this seed and the following ones.")] = 1,
    out: Annotated[
        Path | None,
        typer.Option(
            help="The file to write, or - for standard output; for several houses, their folder. Left out: "
            "home-ROOMS-SEED.json, of several the folder homes."
        ),
    ] = None,
    json: Json = False,
) -> None:
    """Generate furnished houses that pass every check."""
    if count > 1 and out is not None and str(out) == "-":
        raise typer.BadParameter("several houses need a folder, not standard output", param_hint="--out")
    if json and out is not None and str(out) == "-":
        raise typer.BadParameter("only one of --json and --out - can have standard output", param_hint="--json")
    rows = []
    for home in _made(seed, rooms, count):
        path = _keep(home, out, count)
        rows.append(_row(home, path))
        if not json:
            (sys.stderr if path is None else sys.stdout).write(_words(rows[-1]) + "\n")
    if json:
        output.put_json(rows[0] if count == 1 else rows)


@app.command("show")
def show(
    house: House,
    out: Annotated[Path | None, typer.Option(help="The file: .png, .svg or .pdf. [default: HOUSE.png]")] = None,
    scale: Annotated[float, typer.Option(min=5.0, max=200.0, help="Resolution [pixels per metre].")] = 60.0,
    plain: Annotated[bool, typer.Option("--plain", help="Leave out the names of rooms.")] = False,
    json: Json = False,
) -> None:
    """Draw a house from above, without ceilings, with room names and a scale."""
    from hthor import houses
    from hthor.report.drawing import figure_file, floor_plan
    from hthor.world import World

    spec = houses.load(house)
    path = out or Path(f"{spec.id}.png")
    figure_file.check_name(path)
    world = World(spec)
    made = floor_plan.labelled_figure(world.top_view(scale), spec, world.top_view_bounds, named=not plain)
    figure_file.write_figure(made, path)
    output.put_files([path], json, house=spec.id)


@app.command("census")
def census(
    files: Annotated[
        list[str] | None, typer.Argument(metavar="[HOUSE]...", help="Houses to describe: names or house files.")
    ] = None,
    generated: Annotated[int, typer.Option(min=0, help="Also generate this many houses of 4 to 7 rooms.")] = 0,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the first generated house.")] = 0,
    shape: Shape = Format.TABLE,
    json: Json = False,
) -> None:
    """Compare statistics of rooms, doors, objects and paths: generated houses, hthor's own, and the given ones."""
    from hthor import houses
    from hthor.houses import house_statistics as counting

    groups = {
        "generated": [home.house for home in _made(seed, None, generated)] if generated else [],
        "hthor's own": [house for _, house in _own(houses)],
        "given": [houses.load(file) for file in files or ()],
    }
    columns = [
        counting.summarize_houses(name, [counting.measure_house(house) for house in group])
        for name, group in groups.items()
        if group
    ]
    if formats.asks_json(json, shape):
        output.put_json(columns)
        return
    headings = ["10 % - median - 90 %", *(f"{column.name} ({column.houses})" for column in columns)]
    labels = list(dict.fromkeys(label for column in columns for label in column.figures))
    rows = [[label, *(_spread(column.figures.get(label)) for column in columns)] for label in labels]
    output.put_table(headings, rows, shape)


def _own(houses: Any) -> list[tuple[str, HouseSpec]]:
    return [(name, houses.load(name)) for name in houses.names()]


def _size(house: HouseSpec) -> dict[str, Any]:
    from hthor.geometry.plane import signed_area

    area = sum(abs(signed_area(room.polygon)) for room in house.rooms)
    rooms = [room.name or room.kind for room in house.rooms]
    return {"rooms": rooms, "area_m2": round(area, 1), "things": len(house.things)}


def _put_findings(findings: Sequence[Finding]) -> None:
    """Print every error, and the first few warnings of each rule."""
    told: Counter[str] = Counter()
    for finding in findings:
        told[finding.rule] += finding.severity == "warning"
        if finding.severity == "error" or told[finding.rule] <= _SHOWN:
            sys.stdout.write(f"{finding}\n")
    for rule, number in told.items():
        if number > _SHOWN:
            sys.stdout.write(f"warning: and {number - _SHOWN} more ({rule})\n")


def _made(seed: int, rooms: int | None, count: int) -> Iterable[ValidHome]:
    """The homes of ``count`` seeds one by one, with progress on standard error if it is a terminal."""
    from hthor.world.validation import house_soundness

    low, high = _ROOMS
    for number in progress_bar.watched(range(seed, seed + count), "houses", count, "houses", shown=count > 1):
        yield house_soundness.generate_valid_home(
            number, rooms if rooms is not None else low + number % (high - low + 1)
        )


def _keep(home: ValidHome, out: Path | None, count: int) -> Path | None:
    """Write a home where the user wants it; None when that is standard output."""
    from hthor import jsonio

    data, name = jsonio.pretty(home.document), f"{home.house.id}.json"
    if out is not None and str(out) == "-":
        sys.stdout.write(data.decode())
        return None
    path = (out or Path("homes")) / name if count > 1 else out or Path(name)
    jsonio.write(path, data)
    return path


def _row(home: ValidHome, path: Path | None) -> dict[str, Any]:
    tally = Counter(finding.rule for finding in home.refused)
    return {
        "file": None if path is None else str(path),
        "seed": home.seed,
        **_size(home.house),
        "attempt": home.attempt,
        "refused": dict(sorted(tally.items())),
        "sound": True,
        "sha256": home.house.sha256,
    }


def _words(row: dict[str, Any]) -> str:
    where = row["file"] or "standard output"
    again = f", attempt {row['attempt'] + 1}" if row["attempt"] else ""
    return f"{where}: {len(row['rooms'])} rooms, {row['area_m2']:.0f} m2, {row['things']} things, sound{again}"


def _spread(spread: Any) -> str:
    return "" if spread is None else f"{spread.low:.1f} - {spread.median:.1f} - {spread.high:.1f}"
