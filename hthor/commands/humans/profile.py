"""`hthor humans profile`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from hthor.commands import person_table
from hthor.commands.options import Json
from hthor.console import output


def profile(
    run: Annotated[Path, typer.Argument(help="The folder of a run, best one of 'hthor live --calibrate'.")],
    population: Annotated[str, typer.Option(help="The population to compare with: a name or a file.")] = "proxy",
    person: Annotated[int | None, typer.Option(min=0, help="Only the person of this number in the run.")] = None,
    json: Json = False,
) -> None:
    """Measure each person of a run, parameter by parameter, and say how far they are from a population.

    A person is measured by what they did: their stick and path, their hands, and their answers. Other parameters are
    not known from one session, and the table says why. The pages of people at pages are written again, into the run's
    folder 'people'.
    """
    from hthor.calibration.person import person_files

    found = person_files.write(run, population, person)
    if json:
        output.put_json([one for one, _ in found])
        return
    for one, _ in found:
        person_table.put_profile(one)
    output.put_line(f"files: {', '.join(str(path) for _, paths in found for path in paths)}")
