"""`hthor priors`: the table of scene priors, shown or computed again."""

from __future__ import annotations

import sys
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from hthor.commands.options import Json
from hthor.console import output

if TYPE_CHECKING:
    from collections.abc import Sequence

    from hthor.catalog.priors import Origin, Table, Triplet

app = typer.Typer(no_args_is_help=True, help="Scene priors: where people expect things.")

_SHOWN = 8
_HEADINGS = ("relation", "reference", "seen", "frequency", "similarity", "weight", "optional", "source")


@app.command("show")
def show(
    target: Annotated[
        str | None, typer.Argument(metavar="TARGET", help="Show only the triplets of this target object.")
    ] = None,
    json: Json = False,
) -> None:
    """Show the scene priors: target, relation, place, frequency, word similarity and weight."""
    from hthor.catalog import priors

    rows = priors.triplets() if target is None else priors.triplets_of(target)
    if json:
        output.put_json({"origins": priors.table().origins, "triplets": rows})
        return
    for name, group in groupby(rows, key=lambda row: row.target):
        triplets = list(group)
        sys.stdout.write(f"{name}: {triplets[0].of} in the scenes\n")
        sys.stdout.flush()
        output.put_table(_HEADINGS, [_cells(row) for row in triplets])
    for origin in priors.table().origins:
        sys.stdout.write(f"{_words(origin)}\n")


@app.command("build")
def build(
    out: Annotated[
        Path | None, typer.Option(help="The file to write. [default: standard output]", show_default=False)
    ] = None,
    check: Annotated[
        bool,
        typer.Option(
            "--check", help="Compare with the table that ships instead of writing; exit code 1 if a number differs."
        ),
    ] = False,
    wheel: Annotated[
        Path | None,
        typer.Option(
            help="The procthor wheel to count in. [default: the installed package, of the extra 'priors']",
            show_default=False,
        ),
    ] = None,
    json: Annotated[
        bool, typer.Option("--json", help="Print the verdict of --check, or the names of written files, as JSON.")
    ] = False,
) -> None:
    """Recompute the table from scenes and a sentence encoder (needs the extra 'priors'; downloads nothing)."""
    from hthor import jsonio
    from hthor.catalog.priors import making, scenes

    making.need()
    seen = scenes.read_scenes(wheel)
    table = making.make_table(seen, making.vectors, making.origin())
    if out is not None:
        jsonio.write(out, making.encoded(table))
        output.say(f"wrote {out}")
        if json and not check:
            output.put_files([out], json, triplets=len(table.triplets))
    elif not check:
        sys.stdout.write(making.encoded(table).decode())
    if check:
        _check(table, json)


def _check(table: Table, json: bool) -> None:
    from hthor.catalog import priors
    from hthor.catalog.priors import making

    shipped = priors.table()
    gaps = making.find_differences(shipped, table)
    same = making.encoded(shipped) == making.encoded(table)
    if json:
        rows = [{"triplet": " ".join(key), "number": part, "difference": gap} for key, part, gap in gaps]
        output.put_json({"same": same, "largest_difference": gaps[0][2] if gaps else 0.0, "differences": rows})
    else:
        sys.stdout.write(_verdict(same, len(table.triplets), gaps))
    if not same:
        raise typer.Exit(1)


def _verdict(same: bool, count: int, gaps: Sequence[tuple[tuple[str, str, str], str, float]]) -> str:
    if same:
        return f"same: all {count} triplets equal those that ship, byte for byte (largest difference 0)\n"
    if not gaps:
        return "differs: every number equals what ships, but sources or counts do not (largest difference 0)\n"
    lines = [f"  {' '.join(key)}: {part} by {gap:.3f}\n" for key, part, gap in gaps[:_SHOWN]]
    more = f"  and {len(gaps) - _SHOWN} more\n" if len(gaps) > _SHOWN else ""
    return f"differs: {len(gaps)} numbers, by at most {gaps[0][2]:.3f}\n{''.join(lines)}{more}"


def _cells(row: Triplet) -> list[Any]:
    numbers = [f"{number:.3f}" for number in (row.frequency, row.similarity, row.weight)]
    return [row.relation, row.reference, row.seen, *numbers, "yes" if row.optional else "", row.source.frequency]


def _words(origin: Origin) -> str:
    place = f"{origin.package} {origin.version}, {origin.licence}"
    return f"{origin.part}: {origin.content} ({place}; sha256 of {Path(origin.file).name} {origin.sha256[:12]})"
