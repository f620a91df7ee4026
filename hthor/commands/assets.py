"""`hthor assets`: furniture packs in the user's cache."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from hthor.commands.options import Json
from hthor.console import output

if TYPE_CHECKING:
    from hthor.looks.pack import Pack

app = typer.Typer(no_args_is_help=True, help="Furniture packs: optional models for rendered images.")

Name = Annotated[str, typer.Argument(metavar="NAME", help="A pack's name ('hthor assets list').")]


@app.command("build")
def build(
    deb: Annotated[
        Path | None,
        typer.Option(
            help="Debian's package sweethome3d-furniture. [default: the installed one, or apt-get download]",
            show_default=False,
        ),
    ] = None,
    cc_by: Annotated[
        bool,
        typer.Option(
            "--cc-by", help="Also take models that require attribution; the pack then contains ATTRIBUTION.md."
        ),
    ] = False,
    name: Annotated[
        str | None, typer.Option(help="Name of the pack. [default: photoreal; with --cc-by photoreal-by]")
    ] = None,
    out: Annotated[
        Path | None, typer.Option(help="The folder to write. [default: the pack's name, in the user's cache]")
    ] = None,
    json: Json = False,
) -> None:
    """Build a pack of furniture models; only of public-domain models, unless --cc-by is given."""
    from hthor.looks import pack as packs
    from hthor.looks.pack import debian, making

    called = packs.tidy(name or ("photoreal-by" if cc_by else "photoreal"))
    folder = packs.home() / called if out is None else out
    packs.overwritable(folder)
    talk = output.console(talk=True)
    files, source = debian.libraries(deb)
    output.say(f"building '{called}' from {source} ...", talk)
    made = making.convert_models(files, source, folder, called, cc_by=cc_by)
    for pick, reason in made.skipped:
        output.say(f"left out {pick.kind} {pick.model}: {reason}", talk)
    if json:
        output.put_json(_row(made.pack))
        return
    sys.stdout.write(f"{folder}\n")
    models, kinds = len(made.pack.contents.models), len(made.pack.kinds)
    output.say(f"{models} models of {kinds} kinds, {_megabytes(made.pack):.1f} MB.", talk)
    if (folder / "ATTRIBUTION.md").exists():
        output.say(f"Publish {folder}/ATTRIBUTION.md together with its images.", talk)


@app.command("list")
def list_packs(json: Json = False) -> None:
    """List the packs in the user's cache."""
    from hthor.looks import pack as packs

    rows = [_row(packs.load(name)) for name in packs.installed()]
    if json:
        output.put_json(rows)
        return
    if not rows:
        sys.stdout.write("no packs yet; 'hthor assets build' makes one\n")
        return
    output.put_rows([{**row, "kinds": len(row["kinds"])} for row in rows], ("sha256",))


@app.command("path")
def path(name: Name, json: Json = False) -> None:
    """Print the folder of a pack."""
    from hthor.looks import pack as packs

    output.put_files([packs.find(name)], json)


@app.command("remove")
def remove(name: Name, json: Json = False) -> None:
    """Delete a pack from the user's cache."""
    from hthor.looks import pack as packs

    output.put_files([packs.remove(name)], json, removed=True)


def _row(pack: Pack) -> dict[str, Any]:
    return {
        "name": pack.name,
        "models": len(pack.contents.models),
        "kinds": pack.kinds,
        "licences": list(pack.contents.licences),
        "megabytes": round(_megabytes(pack), 1),
        "sha256": pack.sha256,
    }


def _megabytes(pack: Pack) -> float:
    return sum(file.stat().st_size for file in pack.folder.rglob("*") if file.is_file()) / 1e6
