"""The command line: every command of `hthor`, put together. A command's work is imported when it is called."""

import contextlib
import os
import sys

from hthor.console import python_version

python_version.check()  # type: ignore[no-untyped-call]  # before anything is imported that another Python could not read

from typing import Annotated

import typer

from hthor import __version__, activity
from hthor.commands import (
    assets,
    calibrate,
    compare,
    correct,
    doctor,
    houses,
    live,
    priors,
    replay,
    report,
    score,
    suite,
    train,
    watch,
)
from hthor.commands.agent import agent, serve
from hthor.commands.eval import evaluate
from hthor.commands.humans import humans
from hthor.commands.leaderboard import board, list_entries, verify
from hthor.commands.runs import merge, migrate, runs
from hthor.commands.tasks import make, tasks
from hthor.console import completion, exit_status, help_text, output, waiting_notice
from hthor.errors import HthorError

app = typer.Typer(
    name="hthor",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    epilog=exit_status.words(),
    rich_markup_mode=None if os.environ.get("TERM") == "dumb" else "rich",
)
app.command("eval")(evaluate.evaluate)
app.command("live")(live.live)
app.command("merge")(merge.merge)
app.command("migrate")(migrate.migrate)
app.command("score")(score.score)
app.command("correct")(correct.correct)
app.command("compare")(compare.compare)
app.command("power")(compare.power)
app.command("replay")(replay.replay)
app.command("watch")(watch.watch)
app.command("report")(report.report)
app.command("case")(report.case)
app.command("calibrate")(calibrate.calibrate)
app.command("doctor")(doctor.doctor)
app.add_typer(runs.app, name="runs")
board.app.command("verify")(verify.verify)
board.app.command("record")(verify.record)
board.app.command("list")(list_entries.list_entries)
app.add_typer(board.app, name="leaderboard")
app.add_typer(assets.app, name="assets")
app.add_typer(houses.app, name="houses")
tasks.app.command("make")(make.make_suite)
tasks.app.command("check")(make.check_tasks)
app.add_typer(tasks.app, name="tasks")
app.add_typer(suite.app, name="suite")
app.add_typer(priors.app, name="priors")
app.add_typer(train.app, name="train")
app.add_typer(humans.app, name="humans")
agent.agent.command("serve")(serve.serve)
for _name, _group in agent.GROUPS.items():
    app.add_typer(_group, name=_name)
help_text.attach(app)


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
    _check_arguments()
    from hthor import code_identity

    code_identity.keep_compiled()  # here, so that no command can miss it


def _open_streams() -> None:
    """Open empty standard streams in a process that was started without them, as some job runners do."""
    for handle, name, mode in ((0, "stdin", "r"), (1, "stdout", "w"), (2, "stderr", "w")):
        if getattr(sys, name) is None:
            if (null := os.open(os.devnull, os.O_RDWR)) != handle:
                os.dup2(null, handle)
                os.close(null)
            os.set_inheritable(handle, True)
            setattr(sys, name, os.fdopen(handle, mode))


def _read_names_as_utf8() -> None:
    """Begin again in Python's UTF-8 mode if a name is UTF-8, but Python reads names in another way.

    ``PYTHONUTF8=0`` in the locale C has Python read them as ASCII, and then no file with such a name can be opened.
    """
    names = [*sys.argv[1:]]
    with contextlib.suppress(OSError):
        names.append(os.getcwd())
    if sys.getfilesystemencoding() == "utf-8" or not sys.executable or all(map(_is_encodable, names)):
        return
    with contextlib.suppress(UnicodeError):
        for name in names:
            os.fsencode(name).decode("utf-8")
        os.environ["PYTHONUTF8"] = "1"  # for the processes that this one starts
        os.execv(sys.executable, [sys.executable, "-X", "utf8", *sys.orig_argv[1:]])


def _is_encodable(name: str) -> bool:
    """Whether a name has none of the marks that Python puts in place of bytes that it cannot read."""
    from hthor import jsonio

    return jsonio.is_text(name)


def _check_arguments() -> None:
    """Refuse names that are not UTF-8: file names may be any bytes, but what hthor writes is UTF-8."""
    from hthor import jsonio

    for given in sys.argv[1:]:
        if not jsonio.is_text(given):
            raise HthorError(f"{given!a} is not UTF-8. Rename the file or folder, or type the name again.")
    with contextlib.suppress(OSError):
        if not jsonio.is_text(os.getcwd()):
            raise HthorError(f"the name of this folder, {os.getcwd()!a}, is not UTF-8. Rename it, or go elsewhere.")


def main() -> None:
    """Run `hthor` with the arguments of this process, and turn the user's errors into one clear line."""
    _read_names_as_utf8()
    _open_streams()
    if "FORCE_COLOR" not in os.environ and not sys.stdout.isatty():
        os.environ["_TYPER_FORCE_DISABLE_TERMINAL"] = "1"  # typer would also colour for GITHUB_ACTIONS and PY_COLORS
    if completion.VARIABLE in os.environ:
        completion.attach(app)
    groups = [str(group.name) for group in app.registered_groups]
    notes = activity.read_by(lambda words: output.say(f"note: {words}"))
    with waiting_notice.shown(sys.argv[1:], groups), notes:
        exit_status.conclude(app)
