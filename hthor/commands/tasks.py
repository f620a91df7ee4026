"""`hthor tasks`: list, show, draw and check tasks."""

from __future__ import annotations

import os
import shlex
import sys
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from hthor.commands.eval.evaluate import Json
from hthor.console import formats, output
from hthor.console.formats import Format, Shape

if TYPE_CHECKING:
    from collections.abc import Callable

    from hthor.eval.task_check.proof import Fault, Verdict
    from hthor.tasks import Suite
    from hthor.types import Placement, TaskSpec

app = typer.Typer(no_args_is_help=True, help="Tasks and suites of them.")

TaskId = Annotated[str, typer.Argument(metavar="TASK", help="A task's id, such as navigation/alder/apple-in-fridge.")]
Own = Annotated[
    str | None, typer.Option("--suite", help="The suite it is in: a name or a file. [default: any of ours]")
]

_SAY_EVERY_S = 20.0


@app.callback()
def _group() -> None:
    """Tasks and suites of them."""


@app.command("list")
def list_tasks(
    suite: Annotated[
        str | None, typer.Argument(metavar="[SUITE]", help="List the tasks of this suite: a name or a file.")
    ] = None,
    house: Annotated[str, typer.Option(help="Only tasks in this house.")] = "",
    kind: Annotated[str, typer.Option(help="Only tasks of this kind, or whose short name is this.")] = "",
    target: Annotated[str, typer.Option(help="Only tasks with this target.")] = "",
    difficulty: Annotated[Literal["easy", "medium", "hard"] | None, typer.Option(help="Only tasks so hard.")] = None,
    split: Annotated[Literal["seen", "new"] | None, typer.Option(help="Only tasks in houses so known.")] = None,
    shape: Shape = Format.TABLE,
    json: Json = False,
) -> None:
    """The suites, or the tasks of one."""
    from hthor import tasks as rooms

    wanted = {"house": house, "kind": kind, "target": target, "difficulty": difficulty or "", "split": split or ""}
    if suite is None:
        if any(wanted.values()):
            given = next(name for name, value in wanted.items() if value)
            raise typer.BadParameter("name the suite whose tasks are meant", param_hint=f"--{given}")
        rows = [_suite_row(rooms.suite(name)) for name in rooms.suites()]
        output.put_json(rows) if formats.asks_json(json, shape) else _put(rows, ("sha256",), shape)
        return
    found = rooms.suite(suite)
    rows = [row for row in map(_task_row, found.tasks) if _fits(row, wanted)]
    if formats.asks_json(json, shape):
        output.put_json(rows)
        return
    _put([{name: row[name] for name in _told(rows)} for row in rows], shape=shape)
    part = f"{len(rows)} of " if any(wanted.values()) else ""
    whole = f"{len(found.tasks)} tasks, suite {found.name}, version {found.version}, {found.sha256[:10]}"
    (sys.stdout if shape is Format.TABLE else sys.stderr).write(f"{part}{whole}\n")


@app.command("show")
def show_task(task: TaskId, suite: Own = None, json: Json = False) -> None:
    """Tell all about a task: what is asked, where everything is, who starts where, how long it takes at least."""
    from hthor import houses
    from hthor.tasks.generation import difficulty
    from hthor.tasks.suites import library

    shelf, spec = library.find(task, suite)
    house = houses.load(spec.house)
    hard = difficulty.measured(spec, house)
    if json:
        output.put_json({"suite": shelf.name, "task": spec, "before": round(hard.before, 3), "score_s": hard.score})
        return
    sys.stdout.write(f"{spec.id}: {spec.instruction}\n\n")
    share = (
        f"{hard.level}: takes at least {hard.least:.1f} s, {100 * hard.before:.0f} % of where it is expected is nearer"
    )
    facts = [
        ("suite", f"{shelf.name} {shelf.version}"),
        ("kind", spec.kind),
        ("house", spec.house + (f" ({spec.split})" if spec.split else "")),
        ("difficulty", share),
        ("time limit", f"{spec.time_limit:.0f} s"),
        ("T*", f"{spec.t_star:.1f} s"),
        ("person", _pose(spec.human_start)),
        *((f"robot {number}", _pose(pose)) for number, pose in enumerate(spec.robot_starts, 1)),
    ]
    width = max(len(name) for name, _ in facts)
    sys.stdout.write("".join(f"{name:<{width}}  {text}\n" for name, text in facts))
    targets = {job.target for job in spec.goal.todo}
    rows = [{"object": _starred(one, targets), "where": _where(one), "x": one.position[0], "y": one.position[1],
             "z": round(one.position[2], 3)} for one in spec.objects]  # fmt: skip
    _put(rows)
    sys.stdout.write("* what the task is about\n")
    sys.stderr.write(f"next:  hthor tasks draw {spec.id} --out task.png\n")


@app.command("draw")
def draw_task(
    task: TaskId,
    out: Annotated[Path | None, typer.Option(help="The file: .png, .svg or .pdf. [default: TASK.png]")] = None,
    suite: Own = None,
    json: Json = False,
) -> None:
    """Draw a task from above: objects, destination, starts, and the shortest walk that does it."""
    from hthor.eval.task_check import omniscient_solver
    from hthor.report.drawing import task_figure
    from hthor.tasks.suites import library
    from hthor.world import World

    _, spec = library.find(task, suite)
    world = World(spec.house, objects=[(one.id, one.kind) for one in spec.objects])
    path = out or Path(spec.id.replace("/", "-") + ".png")
    limit = 10 * spec.time_limit
    task_figure.draw(spec, world.house, omniscient_solver.solve(world, spec, limit_s=limit), path)
    output.put_files([path], json, task=spec.id)


@app.command("make")
def make_suite(
    houses: Annotated[
        list[str], typer.Argument(metavar="HOUSE...", help="Houses: house files (ProcTHOR's JSON), or names of ours.")
    ],
    out: Annotated[
        Path,
        typer.Option(
            help="The suite's file, mysuite.json, with copies of the houses in mysuite.houses; or the folder of both."
        ),
    ] = Path("mysuite.json"),
    tasks: Annotated[int, typer.Option(min=1, help="How many tasks in each house.")] = 10,
    kind: Annotated[
        list[str] | None,
        typer.Option(
            help="Tasks of this kind: its name or short name. Repeat it for several.",
            show_default="a quarter searches, the others deliveries",
        ),
    ] = None,
    difficulty: Annotated[
        Literal["easy", "medium", "hard"] | None, typer.Option(help="Only tasks so hard.", show_default="any")
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="Equal seeds give equal tasks in equal houses.")] = 0,
    name: Annotated[str, typer.Option(help="What to call the suite.", show_default="as the file")] = "",
    jobs: Annotated[int | None, typer.Option(min=1, help="Worker processes. [default: one a CPU]")] = None,
    json: Json = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="No progress, only the result.")] = False,
) -> None:
    """Make a suite of tasks in houses of your own, for 'hthor eval --suite'.

    Each task is proved as 'hthor tasks check' does it, and drawn again when it does not pass.
    """
    from hthor.eval.config import task_selection
    from hthor.eval.task_check import make_suite as proved
    from hthor.tasks.suites import custom_suite, suite_files

    given = suite_files.sources(houses)
    suite_files.clear(out)
    kinds = tuple(dict.fromkeys(task_selection.find_kind(one).name for one in kind or ()))
    recipe = custom_suite.Recipe(
        name=suite_files.named(name or out.stem), tasks=tasks, kinds=kinds, difficulty=difficulty or "", seed=seed
    )
    columns: dict[int, tuple[TaskSpec, ...]] = {}
    with _watched(recipe.name, len(given), quiet, "houses") as tell:
        for number, column in proved.columns(recipe, given, jobs=jobs or len(os.sched_getaffinity(0))):
            columns[number] = column
            tell(False)
    made = suite_files.files(
        recipe.name, custom_suite.VERSION, given, [columns[number] for number in range(len(given))]
    )
    path = suite_files.write(out, made)
    total, command = sum(map(len, columns.values())), f"hthor eval --suite {shlex.quote(str(path))} --agent frontier"
    if json:
        output.put_json({"suite": str(path), "name": recipe.name, "tasks": total, "houses": len(given)})
        return
    where = f"{len(given)} houses" if len(given) > 1 else "one house"
    sys.stdout.write(f"{path}: {total} tasks in {where}, each proved\n")
    sys.stdout.write(f"next:  {command}\n")


@app.command("check")
def check_tasks(
    suites: Annotated[list[str], typer.Argument(metavar="SUITE...", help="Suites to check: names or files.")],
    jobs: Annotated[int | None, typer.Option(min=1, help="Worker processes. [default: one a CPU]")] = None,
    json: Json = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="No progress, only the result.")] = False,
) -> None:
    """Prove that every task is what it says and can be done: exit code 1 when one is not, and all that is wrong.

    Each is set up in the real world: everything must stay where it is put, be where the task says, and a person who
    knows everything must meet the goal, in no less than T* and within the time limit.
    """
    from hthor.eval.task_check import proof
    from hthor.tasks.suites import library

    shelves = [_some(library.read(name), name) for name in suites]
    workers = jobs or len(os.sched_getaffinity(0))
    rows: list[dict[str, Any]] = []
    faults: list[Fault] = []
    for shelf in shelves:
        began = time.monotonic()
        with _watched(shelf.name, len(shelf.tasks), quiet) as tell:
            own = []
            for verdict in proof.verdicts(shelf.tasks, jobs=workers):
                own.append(verdict)
                tell(bool(verdict.faults))
        rows.append({**_verdict_row(shelf, own), "wall_s": round(time.monotonic() - began, 1)})
        order = {task.id: number for number, task in enumerate(shelf.tasks)}
        faults += proof.repeated(shelf.tasks)
        unsound = sorted((one for one in own if one.faults), key=lambda one: order[one.task])
        faults += [fault for verdict in unsound for fault in verdict.faults]
    if json:
        for row in rows:
            del row["wall_s"]  # the same tasks give the same document
        output.put_json({"suites": rows, "faults": faults})
    else:
        for fault in faults:
            sys.stdout.write(f"{fault.task}: {fault.field}: {fault.reason}\n")
        _put(rows)
    if faults:
        raise typer.Exit(1)


def _some(suite: Suite, given: str) -> Suite:
    """The suite, if there is anything in it."""
    from hthor.errors import TaskError

    if not suite.tasks:
        raise TaskError(given, "tasks", "is empty; a suite needs at least one task")
    return suite


# --------------------------------------------------------------------------------------------------------------- rows


def _suite_row(suite: Suite) -> dict[str, Any]:
    levels = Counter(task.difficulty for task in suite.tasks if task.difficulty)
    return {
        "name": suite.name,
        "version": str(suite.version),
        "tasks": len(suite.tasks),
        "kinds": sorted({task.kind for task in suite.tasks}),
        "houses": len({task.house for task in suite.tasks}),
        "easy, medium, hard": [levels[name] for name in ("easy", "medium", "hard")] if levels else [],
        "sha256": suite.sha256,
    }


def _task_row(task: TaskSpec) -> dict[str, Any]:
    return {
        "id": task.id,
        "kind": task.kind,
        "house": task.house,
        "target": task.goal.target,
        "instruction": task.instruction,
        "t_star_s": round(task.t_star, 1),
        "difficulty": task.difficulty,
        "split": task.split,
    }


def _told(rows: Sequence[dict[str, Any]]) -> list[str]:
    """The columns that tell something: not what ids and instructions say already, nor what all tasks have in common."""
    if not rows:
        return []
    known = {"target", "house"} if all(row["house"] in row["id"].split("/") for row in rows) else {"target"}
    same = {name for name in ("kind", "difficulty", "split") if len({row[name] for row in rows}) == 1}
    return [name for name in rows[0] if name not in known | same]


def _fits(row: dict[str, Any], wanted: dict[str, str]) -> bool:
    return all(not value or _is(row, name, value) for name, value in wanted.items())


def _is(row: dict[str, Any], name: str, value: str) -> bool:
    if name != "kind" or row["kind"] == value:
        return bool(row[name] == value)
    from hthor import plugins

    return bool(plugins.load("task kind", row["kind"]).short == value)


def _verdict_row(suite: Suite, verdicts: Sequence[Verdict]) -> dict[str, Any]:
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


def _starred(placed: Placement, targets: set[str]) -> str:
    return f"{placed.id} *" if placed.id in targets else placed.id


def _where(placed: Placement) -> str:
    near = f", near {placed.near}" if placed.near else ""
    return f"{placed.relation} {placed.support or 'the floor'}{near}"


def _pose(pose: Any) -> str:
    return f"({pose.x:.2f}, {pose.y:.2f}) m, heading {pose.yaw:.2f} rad"


def _put(rows: Sequence[dict[str, Any]], short: Sequence[str] = (), shape: Format = Format.TABLE) -> None:
    """Rows as a table, long hashes cut short."""
    headings = list(rows[0]) if rows else ["nothing"]
    cells = [[row[name][:10] if name in short else row[name] for name in headings] for row in rows]
    output.put_table(headings, cells, shape)


@contextmanager
def _watched(name: str, total: int, quiet: bool, unit: str = "tasks") -> Iterator[Callable[[bool], None]]:
    """Progress on standard error: a bar where somebody watches, a line now and then where nobody does."""
    done, bad, said = 0, 0, time.monotonic()
    first: tuple[int, float] | None = None
    bar = None
    if not quiet and output.live():
        from tqdm import tqdm

        bar = tqdm(total=total, desc=name, unit=unit[:-1], leave=False)

    def tell(faulty: bool) -> None:
        nonlocal done, bad, said, first
        done, bad = done + 1, bad + faulty
        first = first or (done, time.monotonic())
        if bar is not None:
            bar.update()
            if unit == "tasks":
                bar.set_postfix(unsound=bad, refresh=False)
        elif not quiet and (time.monotonic() - said > _SAY_EVERY_S or done == total):
            said = time.monotonic()
            pace = (done - first[0]) / max(said - first[1], 1e-9)  # the first had to wait for the workers to start
            left = f", {(total - done) / pace:.0f} s left" if done > first[0] and done < total else ""
            told = f", {bad} unsound" if unit == "tasks" else ""
            sys.stderr.write(f"{name}: {done}/{total} {unit}{told}{left}\n")

    try:
        yield tell
    finally:
        if bar is not None:
            bar.close()
