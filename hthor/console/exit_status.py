"""How a command ends: its exit code, and its error as a message or a JSON document."""

import os
import sys
import traceback
from collections.abc import Callable
from typing import Any, NoReturn

from hthor import plugins
from hthor.console import output
from hthor.errors import HthorError

INTERNAL, USAGE, INTERRUPTED = 1, 2, 130

CODES = {
    0: "success",
    INTERNAL: "a check failed (of a house, task, suite, table, calibration, merge, incomplete evaluation or "
    "leaderboard entry), or an internal error",
    USAGE: "wrong usage or input",
    3: "the agent failed in more trials than --max-faults",
    4: "the agent's file does not load, or breaks the contract",
    5: "isolation is weaker than required, 'hthor doctor' found that something necessary does not work, or "
    "'hthor leaderboard verify' refuted an entry",
    6: "compare --fail-if-worse found a run that is worse than the first",
    75: "another process is writing the run",
    INTERRUPTED: "interrupted; the same command resumes",
}


def words() -> str:
    """The exit codes as one sentence."""
    return f"Exit codes: {'; '.join(f'{code} {meaning}' for code, meaning in CODES.items())}."


def conclude(command: Callable[..., Any]) -> None:
    """Run the command line to its end, and turn user errors into one clear line.

    With ``--json`` an error is also a document on standard output, unless the command wrote its own before it failed.
    """
    output.documents.clear()
    if "--json" not in sys.argv[1:]:
        _perform(lambda: command(prog_name="hthor"))
        return
    try:
        code = _perform(lambda: command(prog_name="hthor", standalone_mode=False))
    except Exception as error:
        if (words := _usage(error)) is not None:
            _fail(words, getattr(error, "exit_code", USAGE))
        sys.stderr.write(traceback.format_exc())
        _fail("".join(traceback.format_exception_only(error)).strip(), INTERNAL, told=True)
    if code == INTERRUPTED:
        _fail("interrupted.", INTERRUPTED)
    sys.exit(code if isinstance(code, int) else 0)


def _perform(command: Callable[[], Any]) -> Any:
    try:
        return command()
    except HthorError as error:
        _fail(str(error), error.exit_code)
    except KeyboardInterrupt:
        _fail("interrupted.", INTERRUPTED)
    except BrokenPipeError:
        _unread()
    except SystemExit as error:
        if isinstance(error.__context__, BrokenPipeError):  # typer and rich exit with 1 in this case
            _unread()
        _blame(error)
        raise
    except OSError as error:
        _blame(error)
        # An unreadable or unwritable path, a full disk: for the user to fix, like wrong input.
        place = f"{error.filename}: " if error.filename else ""
        _fail(f"{place}{error.strerror or error}.", USAGE)
    except Exception as error:
        _blame(error)
        raise


def _blame(error: BaseException) -> None:
    if (own := plugins.user_error(error)) is not None:
        _fail(str(own), own.exit_code)


def _unread() -> NoReturn:
    """End when the reader of our output has gone, as `head` does. Otherwise Python would complain again at exit."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    sys.exit(0)


def _fail(words: str, code: int, *, told: bool = False) -> NoReturn:
    if not told:
        sys.stderr.write(f"error: {words}\n")
    if "--json" in sys.argv[1:] and not output.documents:
        output.put_json({"error": words, "exit_code": code})
    sys.exit(code)


def _usage(error: Exception) -> str | None:
    """The message of a usage error; None for other errors. (The parser's exception classes are not public.)"""
    if not hasattr(error, "format_message"):
        return None
    text = str(error.format_message()).rstrip(".") + "."
    context = getattr(error, "ctx", None)
    return f"{text} Try '{context.command_path} --help'." if context is not None else text
