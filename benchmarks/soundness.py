"""Are the tasks that are made in houses sound, and can they be played? Drawn, proved again, and evaluated.

Run as ``python -m benchmarks.soundness HOUSE.json ... --tasks 38``, or ``--generated 50 --tasks 6`` for houses of the
generator. For every house tasks are made as ``hthor tasks make`` does; all are proved again as ``hthor tasks check``
does, and played by ``hthor eval``, which must end without a fault. Beside that it counts how many of the first draws,
before any is drawn again, start with one object inside another, and how many are sound.
"""

from __future__ import annotations

import argparse
import functools
import json
import os
import subprocess
import sys
import tempfile
from collections import Counter
from pathlib import Path

from hthor import code_identity, houses, jsonio
from hthor.eval.task_check import make_suite as proved
from hthor.eval.task_check import solvability
from hthor.eval.task_check.solvability import TaskVerdict
from hthor.houses import HouseLibrary
from hthor.tasks.generation import custom_suite
from hthor.tasks.generation.custom_suite import Recipe
from hthor.tasks.suites import suite_files
from hthor.tasks.suites.suite_files import HouseSource
from hthor.world.validation import house_soundness


def main() -> None:
    """Measure and print."""
    options = argparse.ArgumentParser(prog="python -m benchmarks.soundness", description=__doc__.splitlines()[0])
    options.add_argument("houses", nargs="*", help="house files, or names")
    options.add_argument("--generated", type=int, default=0, help="so many houses of the generator, seeds from --first")
    options.add_argument("--first", type=int, default=5000, help="the first seed (%(default)s)")
    options.add_argument("--tasks", type=int, default=6, help="how many tasks in each house (%(default)s)")
    options.add_argument("--agent", default="frontier", help="who plays them; - plays none (%(default)s)")
    options.add_argument("--jobs", type=int, default=len(os.sched_getaffinity(0)), help="processes (%(default)s)")
    options.add_argument("--raw", action="store_true", help="also count how many first draws are sound")
    given = options.parse_args()
    code_identity.keep_compiled()
    with tempfile.TemporaryDirectory() as folder:
        _measure(given, Path(folder))


def _measure(given: argparse.Namespace, folder: Path) -> None:
    files = [*given.houses, *_generated(given, folder / "generated")]
    found = suite_files.find_sources(files)
    recipe = Recipe(name="soundness", tasks=given.tasks)
    if given.raw:
        _count("first draws", [one for _, own in _shared(_first, recipe, found, given.jobs) for one in own])
    made = dict(proved.make_tasks(recipe, found, jobs=given.jobs))
    columns = [made[number] for number in range(len(found))]
    path = suite_files.write_files(
        folder / "suite.json", suite_files.make_files(recipe.name, custom_suite.VERSION, found, columns)
    )
    tasks = [task for column in columns for task in column]
    library = HouseLibrary(folder=path.with_suffix(".houses"))
    _count("made", list(solvability.check_tasks(tasks, jobs=given.jobs, houses=library)))
    if given.agent != "-":
        _play(path, given, folder / "run")


def _shared(work: object, recipe: Recipe, found: tuple[HouseSource, ...], jobs: int) -> object:
    return solvability.run_in_workers(functools.partial(work, recipe), found, jobs=jobs)  # type: ignore[arg-type]


def _first(recipe: Recipe, source: HouseSource) -> list[TaskVerdict]:
    """Verdicts on the first draws in one house."""
    house = houses.load(source.given)
    return [solvability.check_task(task, house) for task in custom_suite.make_tasks(recipe, house)]


def _generated(given: argparse.Namespace, folder: Path) -> list[str]:
    """Files of houses of the generator, 4 to 7 rooms in turn."""
    paths = []
    for seed in range(given.first, given.first + given.generated):
        rooms = 4 + seed % 4
        path = folder / f"{house_soundness.home_name(seed, rooms)}.json"
        jsonio.write(path, jsonio.pretty(house_soundness.generate_valid_home(seed, rooms).document))
        paths.append(str(path))
    return paths


def _count(what: str, verdicts: list[TaskVerdict]) -> None:
    bad = [verdict for verdict in verdicts if verdict.faults]
    inside = [
        verdict for verdict in bad if any("inside" in f.reason or "in one another" in f.reason for f in verdict.faults)
    ]
    share = f"{len(verdicts) - len(bad)} of {len(verdicts)} sound"
    print(f"{what}: {share}; {len(inside)} start with one object inside another")
    for field, many in Counter(verdict.faults[0].field for verdict in bad).most_common():
        print(f"    {many} by {field}, such as {next(v.faults[0].reason for v in bad if v.faults[0].field == field)}")
    sys.stdout.flush()


def _play(suite: Path, given: argparse.Namespace, out: Path) -> None:
    words = ["--suite", str(suite), "--agent", given.agent, "--jobs", str(given.jobs), "--out", str(out)]
    command = [sys.executable, "-m", "hthor", "eval", *words, "--no-control", "--json", "--quiet"]
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    if ended.returncode not in (0, 3):
        raise SystemExit(ended.stderr)
    counts = json.loads(ended.stdout)["runs"][0]["result"]["counts"]
    print(f"played by {given.agent}: {counts['trials']} trials, {counts['faults']} with a fault")


if __name__ == "__main__":
    main()
