"""`hthor suite`: suites from a secret salt, made, revealed and verified."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from hthor.commands.options import Json
from hthor.console import output, progress_bar

if TYPE_CHECKING:
    from hthor.tasks.generation.secret_suites import MapHouses, Proof
    from hthor.tasks.suites.commitment import Commitment

app = typer.Typer(no_args_is_help=True, help="Official suites, generated from a secret salt in unseen houses.")

Folder = Annotated[Path, typer.Argument(metavar="FOLDER", help="The suite's folder, written by 'hthor suite make'.")]
Jobs = Annotated[int | None, typer.Option(min=1, help="Worker processes. [default: one per CPU]")]
_SALT = "The file with the secret salt ('hthor suite salt'). It is never printed and never part of a result."
SaltFile = Annotated[Path, typer.Option("--salt-file", help=_SALT)]


@app.command("salt")
def salt(
    out: Annotated[Path, typer.Option(help="The file to write, readable only by you.")], json: Json = False
) -> None:
    """Make a secret salt of 256 bits. Keep it: the suite cannot be revealed without it."""
    from hthor.tasks.suites import commitment as salts

    salts.create_salt(out)
    output.put_files([out], json)
    sys.stderr.write(f"next:  hthor suite make NAME --salt-file {shlex.quote(str(out))}\n")


@app.command("make")
def make(
    name: Annotated[str, typer.Argument(metavar="NAME", help="Name of the suite, such as official-2027a.")],
    salt_file: SaltFile,
    houses: Annotated[int, typer.Option(min=1, help="Number of houses, of 4 to 7 rooms each.")] = 40,
    tasks: Annotated[int, typer.Option(min=1, help="Number of tasks in all houses together.")] = 2000,
    out: Annotated[Path | None, typer.Option(help="The folder to write. [default: NAME]", show_default=False)] = None,
    jobs: Jobs = None,
    json: Json = False,
) -> None:
    """Make a suite from a salt: houses, tasks, and a commitment that can be published at once."""
    from hthor.errors import HthorError
    from hthor.tasks.generation import secret_suites
    from hthor.tasks.suites import commitment

    folder = out or Path(name)
    secret_suites.check_name(name)
    held = _salt(salt_file, folder)
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise HthorError(f"{folder} exists and is not empty. Choose another folder with --out.")
    order = secret_suites.SuiteOrder(name=name, houses=houses, tasks=tasks)
    files = secret_suites.make_files(order, held, _proof(), _each(jobs, houses))
    path = secret_suites.write_suite(order, held, folder, files, _made_with())
    made = commitment.load_commitment(path)
    if json:
        output.put_json({"folder": str(folder), "commitment": made})
        return
    sys.stdout.write(f"{folder}: {made.tasks} tasks in {made.houses} houses, suite {made.suite_sha256[:10]}\n")
    sys.stdout.write(f"publish now:    {path} (salt {made.salt[:10]})\n")
    sys.stdout.write(f"keep secret until the season is over: {salt_file}, and the rest of {folder}\n")
    sys.stderr.write(f"next:  hthor eval --suite {shlex.quote(str(folder))} --agent frontier\n")


@app.command("reveal")
def reveal(folder: Folder, salt_file: SaltFile, json: Json = False) -> None:
    """Publish the salt of a suite. From then on anybody can make the suite again, so it no longer serves as a test."""
    from hthor.tasks.suites import commitment

    path = commitment.reveal_salt(folder, _salt(salt_file, folder))
    output.put_files([path], json)
    sys.stderr.write(f"next:  hthor suite verify {shlex.quote(str(folder))}\n")


@app.command("verify")
def verify(
    folder: Folder,
    published: Annotated[
        Path | None, typer.Option("--commitment", help="The published commitment. [default: FOLDER/commitment.json]")
    ] = None,
    salt_file: Annotated[
        Path | None, typer.Option("--salt-file", help="The salt, if you have it before it is revealed.")
    ] = None,
    jobs: Jobs = None,
    json: Json = False,
) -> None:
    """Check a suite against its commitment; once the salt is revealed, make the suite again and compare every byte."""
    from hthor.tasks.generation import secret_suites
    from hthor.tasks.suites import commitment

    held = commitment.load_commitment(published or folder / commitment.COMMITMENT)
    salt = commitment.read_revealed_salt(folder) if salt_file is None else _salt(salt_file, folder)
    found = list(commitment.find_changes(folder, held))
    if salt is not None:
        found += secret_suites.differences(folder, held, salt, _proof(), _each(jobs, held.houses))
    state = "differs" if found else "sealed" if salt is None else "verified"
    if json:
        problems = [{"file": file, "problem": problem} for file, problem in found]
        output.put_json({"folder": str(folder), "name": held.name, "state": state, "problems": problems})
    else:
        for file, problem in found:
            sys.stdout.write(f"{file}: {problem}\n")
        sys.stdout.write(f"{folder}: {_verdict(held, state, len(found))}\n")
    if found:
        _tell_versions(held)
        raise typer.Exit(1)


def _verdict(held: Commitment, state: str, problems: int) -> str:
    if state == "verified":
        return f"verified: {held.houses} houses and {held.tasks} tasks follow from the salt, byte for byte"
    if state == "sealed":
        return "sealed: the files are those that were committed to; the salt is not revealed, so no more can be said"
    return f"NOT the suite of the commitment ({problems} {'problem' if problems == 1 else 'problems'})"


def _tell_versions(held: Commitment) -> None:
    """Print which versions differ from those that made the suite, as they can be the reason for a difference."""
    changed = [
        f"{key} {held.made_with.get(key, 'unknown')[:10]} (here {value[:10]})"
        for key, value in _made_with().items()
        if held.made_with.get(key) != value
    ]
    if changed:
        sys.stderr.write(f"it was made with {', '.join(changed)}; another version may give another result\n")


def _made_with() -> dict[str, str]:
    from hthor import code_identity, installation

    return {**installation.versions(), "code": code_identity.makers_sha256()}


def _salt(path: Path, folder: Path) -> Any:
    """The salt in a file, which must not be in the folder that will be published."""
    from hthor.tasks.generation import secret_suites
    from hthor.tasks.suites import commitment as salts

    secret_suites.check_salt_outside(path, folder)
    held = salts.read_salt(path)
    if salts.is_exposed(path):
        sys.stderr.write(f"warning: others can read {path}; 'chmod 600 {path}' keeps it secret\n")
    return held


def _proof() -> Proof:
    """Houses are proved as by `hthor houses check --full`, tasks as by `hthor tasks check`."""
    from hthor.eval.task_check import solvability
    from hthor.tasks.generation.secret_suites import Proof
    from hthor.world.validation.house_soundness import check_soundness

    return Proof(house=check_soundness, task=solvability.is_solvable)


def _each(jobs: int | None, total: int) -> MapHouses:
    """A function that makes houses in several processes, with progress on standard error if it is a terminal."""
    import functools
    import os
    from concurrent.futures import ProcessPoolExecutor
    from multiprocessing import get_context

    from hthor import code_identity

    count = min(jobs or len(os.sched_getaffinity(0)), total)

    def each(work: Callable[[Any], Any], items: Iterable[Any]) -> Iterator[Any]:
        watched = functools.partial(progress_bar.watched, name="houses", total=total, unit="houses")
        if count == 1:
            yield from watched(map(work, items))
            return
        code_identity.keep_compiled()
        with ProcessPoolExecutor(count, get_context("spawn")) as pool:
            yield from watched(pool.map(work, items))

    return each
