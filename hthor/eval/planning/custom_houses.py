"""`hthor eval --house my_house.json`: tasks made in houses of the user's own, kept in the cache for the next time."""

import os
import re
from collections.abc import Callable
from pathlib import Path

from hthor import code_identity, houses, installation, jsonio
from hthor.errors import HthorError
from hthor.eval.config import task_selection
from hthor.eval.config.options import EvalOptions
from hthor.eval.task_check import make_suite as proved
from hthor.tasks.generation import custom_suite
from hthor.tasks.generation.custom_suite import Recipe
from hthor.tasks.suites import suite_files
from hthor.tasks.suites.suite_files import HouseSource

TASKS = 10
"""How many tasks a house gets: as many as a person does."""
_FORBIDDEN = re.compile(r"[^A-Za-z0-9_.-]+")


def files(options: EvalOptions) -> list[str]:
    """The house files of the user's own among the houses."""
    return [word for word in options.house if word.endswith(".json")]


def make_suite(options: EvalOptions, tell: Callable[[str], None]) -> Path:
    """The folder of a suite of tasks in the user's own houses, made unless it is there.

    Args:
        tell: called with a sentence before tasks are made, which takes a while.

    Raises:
        HthorError: when the houses do not fit the other options, or have no room for tasks.
    """
    own = files(options)
    if len(own) < len(options.house):
        named = next(word for word in options.house if word not in own)
        raise HthorError(f"--house {named} is a suite's house and {own[0]} is your own; give one sort or the other.")
    if options.suite:
        raise HthorError(f"--house {own[0]} makes tasks of its own; leave out --suite, or name a house of the suite.")
    if options.kind.endswith(".py"):
        raise HthorError("--house with a house of your own takes hthor's kinds of task; make a suite for your kind.")
    found = suite_files.find_sources(own)
    kinds = (task_selection.find_kind(options.kind).name,) if options.kind else ()
    recipe = Recipe(name=_name(found), tasks=TASKS, kinds=kinds, difficulty=options.difficulty or "")
    specs = [houses.load(one.given) for one in found]
    key = jsonio.sha256([custom_suite.VERSION, recipe, specs, code_identity.makers_sha256()])
    folder = installation.cache() / "suites" / f"{recipe.name}-{key[:16]}"
    if not (folder / suite_files.SUITE).is_file():
        tell(f"making {TASKS} tasks in {', '.join(one.given for one in found)}; they are kept for the next time")
        jobs = options.jobs or len(os.sched_getaffinity(0))
        made = dict(proved.make_tasks(recipe, found, jobs=jobs))
        columns = [made[number] for number in range(len(found))]
        suite_files.write_files(folder, suite_files.make_files(recipe.name, custom_suite.VERSION, found, columns))
    return folder


def _name(found: tuple[HouseSource, ...]) -> str:
    """The name of the suite: its house's name, or the number of houses."""
    stem = found[0].file.stem if len(found) == 1 and found[0].file else f"{len(found)}-houses"
    name = _FORBIDDEN.sub("-", stem).strip("-._")[:50] or "house"
    return f"in-{name}"
