"""`hthor calibrate`."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from hthor.commands.options import Json
from hthor.console import output

if TYPE_CHECKING:
    from hthor.calibration.from_logs.run import EstimateRow

_FROM_LOGS = Path("calibration") / "logs"


def calibrate(
    target: Annotated[
        list[str] | None,
        typer.Option(
            help="The data to fit: published results by name or file (paper), or logs of sessions (a run's folder or "
            "trials.jsonl); repeat the option for several logs.",
            show_default="paper",
        ),
    ] = None,
    suite: Annotated[str, typer.Option(help="The suite that the people do ('hthor tasks list').")] = "paper",
    out: Annotated[
        Path | None, typer.Option(help="Folder of the calibration.", show_default="calibration/TARGET-SUITE-SEED")
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="The same seed gives the same population, byte for byte.")] = 0,
    jobs: Annotated[int | None, typer.Option(min=1, help="Worker processes.", show_default="one per CPU")] = None,
    sessions: Annotated[
        int | None, typer.Option(min=30, help="Number of training sessions, of ten trials each.", show_default="4000")
    ] = None,
    studies: Annotated[
        int | None, typer.Option(min=10, help="Number of simulated studies for the checks.", show_default="200")
    ] = None,
    quick: Annotated[
        bool,
        typer.Option(
            "--quick",
            help="A small calibration that takes minutes and shows that everything works; its population is not for "
            "use.",
        ),
    ] = False,
    until: Annotated[
        str, typer.Option(help="Stop after this stage, such as training or studies.", show_default="the last")
    ] = "",
    prior: Annotated[str, typer.Option(help="With logs: the population to update.")] = "proxy",
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Print what would be done, and where; write nothing.")
    ] = False,
    json: Json = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print the result only, no progress.")] = False,
) -> None:
    """Fit the human proxies to published results, or to logs of sessions.

    Everything that was simulated is kept: the same command resumes an interrupted calibration, and a larger calibration
    continues a smaller one. The folder holds the population (population.npz and .json), the evidence for it, and the
    tables of simulated trials. Exit code 1 when a gate was not passed.
    """
    targets = tuple(target or ("paper",))
    if all(_is_log(word) for word in targets):
        folder = out or _FROM_LOGS
        if dry_run:
            _foretell({"targets": list(targets), "prior": prior, "folder": str(folder)}, json)
        else:
            _fit_logs(targets, prior, folder, json)
        return
    from hthor.calibration.pipeline import config, run

    options = config.CalibrationOptions(
        targets=targets,
        suite=suite,
        out=out,
        seed=seed,
        jobs=jobs,
        sessions=sessions,
        studies=studies,
        quick=quick,
        until=until,
    )
    if dry_run:
        brief = config.resolve_options(options)
        sizes = {name: getattr(brief.sizes, name) for name in brief.sizes.__struct_fields__}
        _foretell(
            {
                "targets": [brief.targets.name],
                "suite": brief.suite.name,
                "folder": str(brief.folder),
                "seed": seed,
                "jobs": brief.jobs,
                "until": until,
                **sizes,
            },
            json,
        )
        return
    talk = output.console(talk=True)
    from hthor.calibration.pipeline import terminal

    reporter = terminal.SilentProgress() if quiet else terminal.PrintedProgress(talk, live=output.live())
    found = run.run_calibration(options, reporter)
    if found is None:
        if json:
            output.put_json({"folder": str(config.resolve_options(options).folder), "until": until})
        return
    if json:
        output.put_json(found)
    else:
        for part in terminal.result_tables(found):
            output.console().print(part)
        folder = config.resolve_options(options).folder
        talk.print(f"files: {folder}/population.json, population.npz, evidence.json, result.json", soft_wrap=True)
    if not found.passed:
        raise typer.Exit(1)


def _foretell(brief: dict[str, Any], json: bool) -> None:
    """Print what a calibration would do; how long it takes depends on what its folder already has."""
    if json:
        output.put_json({"resumes": Path(brief["folder"]).exists(), **brief})
        return
    output.put_table(
        ("what", "value"), [(name, one if isinstance(one, list) else str(one)) for name, one in brief.items()]
    )
    there = "continues from what is there" if Path(brief["folder"]).exists() else "starts from the beginning"
    output.put_line(f"it {there}; nothing was written.")


def _is_log(target: str) -> bool:
    """Whether a target is a run's folder or its log, not published results."""
    from hthor.calibration import targets

    return target not in targets.target_names() and (Path(target).is_dir() or target.endswith(".jsonl"))


def _fit_logs(targets: Sequence[str], prior: str, folder: Path, json: bool) -> None:
    """Estimate parameters from logs, and update a population with them."""
    from hthor.calibration.from_logs import run

    talk = output.console(talk=True)

    def tell(what: str) -> None:
        if not json:
            talk.print(f"estimating: {what}" if what not in ("reading", "updating") else f"{what} ...", highlight=False)

    found, _ = run.estimate_from_logs([Path(word) for word in targets], prior, folder, tell)
    if json:
        output.put_json(found)
        return
    output.put_table(("parameter", "before", "after", "estimate", "data", "how"), [_cells(row) for row in found.rows])
    output.put_line(f"{found.trials} trials, {found.sessions} sessions, {found.people} people; before: {found.prior}.")
    output.put_line(found.display.words)
    for note in found.notes:
        output.put_line(note)
    output.put_line(f"files: {folder}/population.json, population.npz, estimates.json")
    output.put_line(f"next:  hthor eval --humans {shlex.quote(str(folder))}/population.npz --agent frontier")


def _cells(row: EstimateRow) -> tuple[str, ...]:
    one = row.estimate
    name = f"{row.name} [{row.unit}]" if row.unit else row.name
    before, after = (
        f"{middle:.3g} ({low:.3g} … {high:.3g})"
        for middle, low, high in (
            (row.before, row.before_low, row.before_high),
            (row.after, row.after_low, row.after_high),
        )
    )
    if one is None:
        return name, before, after, "–", "–", "no direct measure; weighted by the others"
    how = one.method if one.words == "estimated" else f"{one.words}; {one.method}"
    return name, before, after, f"{one.value:.3g} ({one.low:.3g} … {one.high:.3g})", str(one.n), how
