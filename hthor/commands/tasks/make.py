"""`hthor tasks make` and `hthor tasks check`: both prove tasks in worker processes."""

from __future__ import annotations

import os
import shlex
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from hthor.commands.options import Json
from hthor.console import output, progress_bar

if TYPE_CHECKING:
    from collections.abc import Callable

    from hthor.eval.task_check.solvability import TaskFault, TaskVerdict
    from hthor.tasks import Suite
    from hthor.types import TaskSpec

_SAY_EVERY_S = 20.0


def make_suite(
    houses: Annotated[
        list[str],
        typer.Argument(
            metavar="HOUSE...", help="Houses: house files (ProcTHOR's JSON) or names of hthor's own houses."
        ),
    ],
    out: Annotated[
        Path,
        typer.Option(
            help="The suite's file, mysuite.json, with copies of the houses in mysuite.houses; or the folder of both."
        ),
    ] = Path("mysuite.json"),
    tasks: Annotated[int, typer.Option(min=1, help="Number of tasks in each house.")] = 10,
    kind: Annotated[
        list[str] | None,
        typer.Option(
            help="Task kind, by its name or short name; repeat the option for several.",
            show_default="one quarter searches, three quarters deliveries",
        ),
    ] = None,
    difficulty: Annotated[
        Literal["easy", "medium", "hard"] | None,
        typer.Option(help="Generate only tasks of this difficulty.", show_default="any"),
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="The same seed gives the same tasks in the same houses.")] = 0,
    name: Annotated[str, typer.Option(help="Name of the suite.", show_default="the file's name")] = "",
    jobs: Annotated[int | None, typer.Option(min=1, help="Worker processes. [default: one per CPU]")] = None,
    json: Json = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print the result only, no progress.")] = False,
) -> None:
    """Generate a suite of tasks in your own houses, for 'hthor eval --suite'.

    Each task is checked as by 'hthor tasks check', and generated again if it does not pass.
    """
    from hthor.eval.config import task_selection
    from hthor.eval.task_check import make_suite as proved
    from hthor.tasks.generation import custom_suite
    from hthor.tasks.suites import suite_files

    given = suite_files.find_sources(houses)
    suite_files.check_unused(out)
    kinds = tuple(dict.fromkeys(task_selection.find_kind(one).name for one in kind or ()))
    recipe = custom_suite.Recipe(
        name=suite_files.check_name(name or out.stem), tasks=tasks, kinds=kinds, difficulty=difficulty or "", seed=seed
    )
    columns: dict[int, tuple[TaskSpec, ...]] = {}
    with _watched(recipe.name, len(given), quiet, "houses") as tell:
        for number, column in proved.make_tasks(recipe, given, jobs=jobs or len(os.sched_getaffinity(0))):
            columns[number] = column
            tell(False)
    made = suite_files.make_files(
        recipe.name, custom_suite.VERSION, given, [columns[number] for number in range(len(given))]
    )
    path = suite_files.write_files(out, made)
    total, command = sum(map(len, columns.values())), f"hthor eval --suite {shlex.quote(str(path))} --agent frontier"
    if json:
        output.put_json({"suite": str(path), "name": recipe.name, "tasks": total, "houses": len(given)})
        return
    where = f"{len(given)} houses" if len(given) > 1 else "one house"
    sys.stdout.write(f"{path}: {total} tasks in {where}, each checked\n")
    sys.stdout.write(f"next:  {command}\n")


def check_tasks(
    suites: Annotated[list[str], typer.Argument(metavar="SUITE...", help="Suites to check: names or files.")],
    jobs: Annotated[int | None, typer.Option(min=1, help="Worker processes. [default: one per CPU]")] = None,
    json: Json = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print the result only, no progress.")] = False,
) -> None:
    """Check that every task can be done; exit code 1 if one cannot, with every problem listed.

    Each task is set up in the physics engine. Objects must stay where they are put and be where the task says, and an
    omniscient person must reach the goal within the time limit and in no less than the least time.
    """
    from hthor.eval.task_check import solvability
    from hthor.tasks.suites import library

    shelves = [_some(library.read_suite(name), name) for name in suites]
    workers = jobs or len(os.sched_getaffinity(0))
    rows: list[dict[str, Any]] = []
    faults: list[TaskFault] = []
    for shelf in shelves:
        began = time.monotonic()
        with _watched(shelf.name, len(shelf.tasks), quiet) as tell:
            own = []
            for verdict in solvability.check_tasks(shelf.tasks, jobs=workers, houses=shelf.houses):
                own.append(verdict)
                tell(bool(verdict.faults))
        rows.append({**_verdict_row(shelf, own), "wall_s": round(time.monotonic() - began, 1)})
        order = {task.id: number for number, task in enumerate(shelf.tasks)}
        faults += solvability.repeated(shelf.tasks)
        unsound = sorted((one for one in own if one.faults), key=lambda one: order[one.task])
        faults += [fault for verdict in unsound for fault in verdict.faults]
    if json:
        for row in rows:
            del row["wall_s"]  # the same tasks give the same document
        output.put_json({"suites": rows, "faults": faults})
    else:
        for fault in faults:
            sys.stdout.write(f"{fault.task}: {fault.field}: {fault.reason}\n")
        output.put_rows(rows)
    if faults:
        raise typer.Exit(1)


def _some(suite: Suite, given: str) -> Suite:
    """The suite; raises TaskError when it has no tasks."""
    from hthor.errors import TaskError

    if not suite.tasks:
        raise TaskError(given, "tasks", "is empty; a suite needs at least one task")
    return suite


def _verdict_row(suite: Suite, verdicts: Sequence[TaskVerdict]) -> dict[str, Any]:
    played = sorted(verdict.seconds for verdict in verdicts if verdict.seconds)
    shares = [verdict.least / verdict.seconds for verdict in verdicts if verdict.seconds]
    return {
        "suite": suite.name,
        "tasks": len(verdicts),
        "unsound": sum(1 for verdict in verdicts if verdict.faults),
        "median_s": played[len(played) // 2] if played else 0.0,
        "slowest_s": played[-1] if played else 0.0,
        "least_share": round(max(shares, default=0.0), 3),
        "drift_mm": round(1000 * max((verdict.drift for verdict in verdicts), default=0.0), 1),
    }


@contextmanager
def _watched(name: str, total: int, quiet: bool, unit: str = "tasks") -> Iterator[Callable[[bool], None]]:
    """Progress on standard error: a bar on a terminal, otherwise a line now and then."""
    done, bad, said = 0, 0, time.monotonic()
    first: tuple[int, float] | None = None
    live = output.live()

    def tell(faulty: bool) -> None:
        nonlocal done, bad, said, first
        done, bad = done + 1, bad + faulty
        first = first or (done, time.monotonic())
        advance(f"{bad} unsound" if unit == "tasks" else "")
        if not (quiet or live) and (time.monotonic() - said > _SAY_EVERY_S or done == total):
            said = time.monotonic()
            pace = (done - first[0]) / max(said - first[1], 1e-9)  # the first had to wait for the workers to start
            left = f", {(total - done) / pace:.0f} s left" if done > first[0] and done < total else ""
            told = f", {bad} unsound" if unit == "tasks" else ""
            sys.stderr.write(f"{name}: {done}/{total} {unit}{told}{left}\n")

    with progress_bar.bar(name, total, unit, shown=not quiet) as advance:
        yield tell
