"""`hthor tasks`: list, show, draw and check tasks."""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from hthor.commands.options import Json
from hthor.console import formats, output
from hthor.console.formats import Format, Shape
from hthor.errors import HthorError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from hthor.tasks import Suite
    from hthor.types import Placement, TaskSpec
    from hthor.world import World

app = typer.Typer(no_args_is_help=True, help="Tasks and suites of tasks.")

TaskId = Annotated[str, typer.Argument(metavar="TASK", help="A task's id, such as navigation/alder/apple-in-fridge.")]
Own = Annotated[
    str | None, typer.Option("--suite", help="The task's suite: a name or a file. [default: search hthor's suites]")
]


@app.command("list")
def list_tasks(
    suite: Annotated[
        str | None, typer.Argument(metavar="[SUITE]", help="List the tasks of this suite: a name or a file.")
    ] = None,
    house: Annotated[str, typer.Option(help="List only tasks in this house.")] = "",
    kind: Annotated[str, typer.Option(help="List only tasks of this kind, by its name or short name.")] = "",
    target: Annotated[str, typer.Option(help="List only tasks with this target object.")] = "",
    difficulty: Annotated[
        Literal["easy", "medium", "hard"] | None, typer.Option(help="List only tasks of this difficulty.")
    ] = None,
    split: Annotated[
        Literal["seen", "new"] | None, typer.Option(help="List only tasks in seen or in new houses.")
    ] = None,
    shape: Shape = Format.TABLE,
    json: Json = False,
) -> None:
    """List the suites, or the tasks of one suite."""
    from hthor import tasks as rooms

    wanted = {"house": house, "kind": kind, "target": target, "difficulty": difficulty or "", "split": split or ""}
    if suite is None:
        if any(wanted.values()):
            given = next(name for name, value in wanted.items() if value)
            raise typer.BadParameter("name a suite; this option selects among its tasks", param_hint=f"--{given}")
        rows = [_suite_row(rooms.load_suite(name)) for name in rooms.suite_names()]
        output.put_json(rows) if formats.asks_json(json, shape) else output.put_rows(rows, ("sha256",), shape)
        return
    found = rooms.load_suite(suite)
    rows = [row for row in map(_task_row, found.tasks) if all(_is(row, *pair) for pair in wanted.items())]
    if formats.asks_json(json, shape):
        output.put_json(rows)
        return
    output.put_rows([{name: row[name] for name in _told(rows)} for row in rows], shape=shape)
    part = f"{len(rows)} of " if any(wanted.values()) else ""
    whole = f"{len(found.tasks)} tasks, suite {found.name}, version {found.version}, {found.sha256[:10]}"
    (sys.stdout if shape is Format.TABLE else sys.stderr).write(f"{part}{whole}\n")


@app.command("show")
def show_task(task: TaskId, suite: Own = None, json: Json = False) -> None:
    """Show a task: instruction, objects, start poses, and the least time it takes."""
    from hthor.tasks.generation import difficulty
    from hthor.tasks.suites import library

    shelf, spec = library.find_task(task, suite)
    house = shelf.houses.load(spec.house)
    hard = difficulty.measure_difficulty(spec, house)
    if json:
        output.put_json({"suite": shelf.name, "task": spec, "before": round(hard.before, 3), "score_s": hard.score})
        return
    sys.stdout.write(f"{spec.id}: {spec.instruction}\n\n")
    first = "of the ways at random are wrong" if spec.goal.relation == "go" else "of the expected places come first"
    share = f"{hard.level}: takes at least {hard.least:.1f} s, {100 * hard.before:.0f} % {first}"
    facts = [
        ("suite", f"{shelf.name} {shelf.version}"),
        ("kind", spec.kind),
        ("house", spec.house + (f" ({spec.split})" if spec.split else "")),
        ("difficulty", share),
        ("time limit", f"{spec.time_limit:.0f} s"),
        ("T*", f"{spec.t_star:.1f} s"),
        ("person", _pose(spec.human_start)),
        *((f"person {number}", _pose(pose)) for number, pose in enumerate(spec.other_human_starts, 2)),
        *((f"robot {number}", _pose(pose)) for number, pose in enumerate(spec.robot_starts, 1)),
    ]
    width = max(len(name) for name, _ in facts)
    sys.stdout.write("".join(f"{name:<{width}}  {text}\n" for name, text in facts))
    targets = {job.target for job in spec.goal.todo}
    rows = [{"object": one.id + (" *" if one.id in targets else ""), "where": _where(one), "x": one.position[0],
             "y": one.position[1], "z": round(one.position[2], 3)} for one in spec.objects]  # fmt: skip
    output.put_rows(rows)
    sys.stdout.write("* what the task is about\n")
    sys.stderr.write(f"next:  hthor tasks draw {spec.id} --out task.png\n")


@app.command("draw")
def draw_task(
    task: TaskId,
    out: Annotated[
        Path | None,
        typer.Option(help="The file: .png, .svg or .pdf. [default: TASK.png, or TASK-pipeline.png and so on]"),
    ] = None,
    suite: Own = None,
    pipeline: Annotated[
        bool,
        typer.Option("--pipeline", help="Draw how the task was made: knowledge graph, scene graph and placed scene."),
    ] = False,
    angles: Annotated[
        bool,
        typer.Option("--angles", help="Draw a rearrangement from three angles, before and after the shuffle."),
    ] = False,
    nice: Annotated[
        bool,
        typer.Option(
            "--nice",
            help="With --pipeline and --angles, render with textures and shadows; needs OpenGL, and the pixels depend "
            "on it.",
        ),
    ] = False,
    json: Json = False,
) -> None:
    """Draw a task from above: objects, destination, start poses, and the shortest solution.

    With --pipeline or --angles, draw the house in three dimensions instead.
    """
    from hthor.report.drawing import figure_file
    from hthor.tasks.suites import library
    from hthor.world import World

    if pipeline and angles:
        raise HthorError("--pipeline and --angles are two figures; give one of them.")
    end = "-pipeline" if pipeline else "-angles" if angles else ""
    found, spec = library.find_task(task, suite)
    path = out or Path(spec.id.replace("/", "-") + f"{end}.png")
    figure_file.check_name(path)
    world = World(found.houses.load(spec.house), objects=[(one.id, one.kind) for one in spec.objects])
    figure_file.write_figure(_figure(spec, world, end, "nice" if nice else "fast"), path)
    output.put_files([path], json, task=spec.id)


def _figure(task: TaskSpec, world: World, end: str, profile: str) -> Figure:
    """One of the three figures of a task."""
    from hthor.eval.task_check import omniscient_solver
    from hthor.report.drawing import task_figure
    from hthor.report.drawing.overviews import pipeline_figure, rearrangement_figure

    if end == "-pipeline":
        return pipeline_figure.pipeline_figure(task, world, profile)
    if end == "-angles":
        return rearrangement_figure.rearrangement_figure(task, world, profile)
    solution = omniscient_solver.solve(world, task, limit_s=10 * task.time_limit)
    return task_figure.task_figure(task, world.house, solution)


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
    """The columns worth showing: not those that ids and instructions repeat, nor those with one value for all tasks."""
    if not rows:
        return []
    known = {"target", "house"} if all(row["house"] in row["id"].split("/") for row in rows) else {"target"}
    same = {name for name in ("kind", "difficulty", "split") if len({row[name] for row in rows}) == 1}
    return [name for name in rows[0] if name not in known | same]


def _is(row: dict[str, Any], name: str, value: str) -> bool:
    """Whether a row has this value, or no value is wanted; a kind may also be named by its short name."""
    if not value or name != "kind" or row["kind"] == value:
        return bool(not value or row[name] == value)
    from hthor import plugins

    return bool(plugins.load("task kind", row["kind"]).short == value)


def _where(placed: Placement) -> str:
    near = f", near {placed.near}" if placed.near else ""
    return f"{placed.relation} {placed.support or 'the floor'}{near}"


def _pose(pose: Any) -> str:
    return f"({pose.x:.2f}, {pose.y:.2f}) m, heading {pose.yaw:.2f} rad"
