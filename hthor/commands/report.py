"""`hthor report` and `hthor case`."""

from pathlib import Path
from typing import Annotated

import typer

from hthor.commands.options import AgentArgs, Json, Readable
from hthor.console import output

Runs = Annotated[list[Path], typer.Argument(metavar="RUN...", help="Folders of runs, such as runs/demo/frontier.")]

_PAPER = "paper"


def report(
    runs: Runs,
    out: Annotated[Path, typer.Option(help="Folder of the report.")] = Path("report"),
    pdf: Annotated[bool, typer.Option("--pdf", help="Also write every figure as figures/*.pdf.")] = False,
    json: Json = False,
) -> None:
    """Write a report on runs of one suite: results against no robot and the paper, figures, best and worst trials.

    Writes report.html, which needs nothing else, report.json with every number, and figures/*.svg. Runs of several
    populations get a section by population; the rest is of the first run. Nothing is simulated.
    """
    from hthor.calibration import targets
    from hthor.report.analysis.document import Published, Share
    from hthor.report.page import write_report

    study = targets.load_targets(_PAPER)
    counts = {f"{metric} {name}": one for metric in ("sr", "adoption") for name, one in getattr(study, metric).items()}
    write_report.write_report(
        runs,
        out,
        Published(
            name=study.name,
            source=study.source,
            sha256=study.sha256,
            suite=_PAPER,
            figures={name: round(value / 100.0, 6) for name, value in study.published.items()},
            counts={name: Share(k=one.k, n=one.n, inferred=one.inferred) for name, one in counts.items()},
        ),
        pdf=pdf,
    )
    page = out / "report.html"
    output.put_files([page, out / "report.json", out / "figures"] if json else [page], json)


def case(
    runs: Runs,
    task: Annotated[str, typer.Argument(metavar="TASK", help="A task id, such as smoke/maple/navigation-02.")],
    out: Annotated[Path, typer.Option(help="The file: .png, .svg or .pdf; or a folder for an SVG and a PNG.")] = Path(
        "report"
    ),
    person: Annotated[
        int | None,
        typer.Option(help="The participant, by number.", show_default="the first who did the task in every run"),
    ] = None,
    nice: Annotated[
        bool,
        typer.Option(
            "--nice", help="Render views with textures and shadows; needs OpenGL, and the pixels depend on it."
        ),
    ] = False,
    agent: Annotated[
        list[str] | None,
        typer.Option(
            help="The file of an agent that is not built in; repeat the option for several.", show_default=False
        ),
    ] = None,
    agent_args: AgentArgs = None,
    readable: Readable = None,
    humans: Annotated[str, typer.Option(help="The file of the people, if the runs used one.", show_default=False)] = "",
    json: Json = False,
) -> None:
    """Draw one task with several robots: paths from above, and the views of people and robots at key moments.

    One row per run. The session is played again for the views, and must equal the log.
    """
    from hthor.guest.agent import inputs
    from hthor.report.page import case_study as cases

    more = inputs.parse_inputs(agent_args or (), readable or ())
    profile = "nice" if nice else "fast"
    paths = cases.write_case_study(
        runs, task, out, person=person, profile=profile, agents=agent or (), humans=humans, given=more
    )
    output.put_files(paths, json, task=task)
