"""The commands' names, what they share, and how errors look; a command's work is imported when it is called."""

from __future__ import annotations

import contextlib
import os
import sys
from typing import Annotated

import typer

from hthor import __version__
from hthor.cli import (
    assets,
    boards,
    calibrate,
    compare,
    completing,
    doctor,
    ending,
    flowing,
    folders,
    homes,
    lists,
    logged,
    patience,
    people,
    priors,
    reports,
    runs,
    serving,
    shards,
    standings,
    suite,
    tasks,
)

app = typer.Typer(
    name="hthor",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    epilog=ending.words(),
    rich_markup_mode=None if os.environ.get("TERM") == "dumb" else "rich",
)
app.command("eval")(runs.evaluate)
app.command("merge")(shards.merge)
app.command("score")(logged.score)
app.command("compare")(compare.compare)
app.command("power")(compare.power)
app.command("replay")(logged.replay)
app.command("report")(reports.report)
app.command("case")(reports.case)
app.command("calibrate")(calibrate.calibrate)
app.command("doctor")(doctor.doctor)
app.add_typer(folders.app, name="runs")
boards.app.command("list")(standings.list_entries)
app.add_typer(boards.app, name="leaderboard")
app.add_typer(assets.app, name="assets")
app.add_typer(homes.app, name="houses")
app.add_typer(tasks.app, name="tasks")
app.add_typer(suite.app, name="suite")
app.add_typer(priors.app, name="priors")
app.add_typer(people.app, name="humans")
lists.agent.command("serve")(serving.serve)
for _name, _group in lists.GROUPS.items():
    app.add_typer(_group, name=_name)
flowing.flow(app)


def _show_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"hthor {__version__}")
        raise typer.Exit


@app.callback()
def root(
    version: Annotated[  # noqa: ARG001
        bool, typer.Option("--version", callback=_show_version, is_eager=True, help="Show the version and exit.")
    ] = False,
) -> None:
    """Evaluate robots that help people in a shared house."""
    _refuse_what_is_no_text()
    from hthor.eval import provenance

    provenance.keep_compiled()  # here, so that no command can miss it


def _refuse_what_is_no_text() -> None:
    """Names of files may be any bytes, and what hthor writes is UTF-8: it could not say where a run lies."""
    from hthor.errors import HthorError
    from hthor.jsonio import is_text

    for given in sys.argv[1:]:
        if not is_text(given):
            raise HthorError(f"{given!a} is not UTF-8. Rename the file or folder, or type the name again.")
    with contextlib.suppress(OSError):
        if not is_text(os.getcwd()):
            raise HthorError(f"the name of this folder, {os.getcwd()!a}, is not UTF-8. Rename it, or go elsewhere.")


def _open_streams() -> None:
    """Give a process that was started without standard streams, as some job runners do, empty ones."""
    for handle, name, mode in ((0, "stdin", "r"), (1, "stdout", "w"), (2, "stderr", "w")):
        if getattr(sys, name) is None:
            if (null := os.open(os.devnull, os.O_RDWR)) != handle:
                os.dup2(null, handle)
                os.close(null)
            os.set_inheritable(handle, True)
            setattr(sys, name, os.fdopen(handle, mode))


def run() -> None:
    """Run the command of this process, and turn the user's errors into one clear line."""
    _open_streams()
    if "FORCE_COLOR" not in os.environ and not sys.stdout.isatty():
        os.environ["_TYPER_FORCE_DISABLE_TERMINAL"] = "1"  # typer would also colour for GITHUB_ACTIONS and PY_COLORS
    if completing.VARIABLE in os.environ:
        completing.attach(app)
    groups = [str(group.name) for group in app.registered_groups]
    with patience.shown(sys.argv[1:], groups):
        ending.conclude(app)
