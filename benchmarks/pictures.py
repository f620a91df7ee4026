"""The docs' pictures: ``python -m benchmarks.pictures [NAME...]`` makes them, ``--check`` says which are out of date.

`docs/images/pictures.json` holds, for each picture, the hash of its file and of its origin: the task with its T*, the
house, the benchmark's rules, how trials go (the reference trial of `hthor doctor`) and the code that draws. A picture
is out of date when one of the two is another now. Checking plays nothing and takes a second.

The pictures of a report and of a case are of one evaluation of the suite smoke, of some minutes; they need OpenGL and
Chromium, whose versions and fonts can change their bytes, but not whether they are out of date.
"""

from __future__ import annotations

import argparse
import ast
import functools
import hashlib
import json
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path

import cv2

from hthor import houses, jsonio, rules, tasks
from hthor.eval.config import robot_team, sessions, task_selection
from hthor.eval.records.trial_record import TrialRecord
from hthor.eval.runner import trial_runner
from hthor.report.drawing import lettering, trial_figure
from hthor.types import TaskSpec

ROOT = Path(__file__).resolve().parents[1]
FOLDER = ROOT / "docs" / "images"
MANIFEST = FOLDER / "pictures.json"
_REFERENCE = "hthor/eval/doctor/reference.json"
_DRAWING = ("floor_plan", "lettering", "text_fit", "trial_figure", "trial_legend", "trial_timeline", "trial_trace")
_SHEETS = ("hthor/world/rendering/contact_sheet.py", "hthor/world/rendering/opengl_renderer.py")
BY_HAND = ("robots.png",)
"""Pictures that need a stage and a camera of their own."""
AGENTS, SUITE, CASE = ("none", "frontier", "oracle"), "smoke", "smoke/birch/manipulation-01"
"""Of which runs the pictures of a report and of a case are, and of which task the case is."""
_BROWSER = "chromium"
_PAGE_PX, _PAGE_SCALE, _CASE_PX = (860, 1344), 1.4, 1360
"""Pixels of the page in the browser, how much finer its picture is, and how wide the picture of the case is."""

TRIALS = {
    "replay.png": "smoke/birch/manipulation-01",
    "collect.png": "collect/juniper/02",
    "rearrange.png": "rearrange/elder/01",
    "tidy.png": "tidy/maple/02",
    "carry.png": "carry/rowan/01",
}
"""Trials with the oracle, in the bodies that the kind of task is made for: a task, whose suite is its first word."""


def names() -> list[str]:
    """All pictures that this makes."""
    return [*TRIALS, *_OF_RUNS, *(f"scenes/{name}.jpg" for name in houses.names())]


def origin(name: str) -> str:
    """Hash of all that decides what a picture shows."""
    if name in TRIALS:
        task = _task(TRIALS[name])
        code = [f"hthor/report/drawing/{part}.py" for part in _DRAWING]
        facts = [TRIALS[name], task, houses.load(task.house).sha256, rules.sha256(), _sha256(ROOT / _REFERENCE)]
        return jsonio.sha256([*facts, *(_code_sha256(ROOT / path) for path in code)])
    if name in _OF_RUNS:
        return jsonio.sha256(
            [AGENTS, CASE, tasks.load_suite(SUITE).sha256, rules.sha256(), *map(_code_sha256, _code_of_pages())]
        )
    return jsonio.sha256([houses.load(Path(name).stem).sha256, *(_code_sha256(ROOT / path) for path in _SHEETS)])


def problems(folder: Path = FOLDER) -> list[str]:
    """Which pictures are out of date, missing or unknown, a line each."""
    manifest = folder / MANIFEST.name
    known = json.loads(manifest.read_bytes()) if manifest.is_file() else {}
    found = []
    for name in names():
        path, entry = folder / name, known.get(name, {})
        if not path.is_file():
            found.append(f"{name}: is missing")
        elif entry.get("sha256") != _sha256(path):
            found.append(f"{name}: is not the file that was made last")
        elif entry.get("origin") != origin(name):
            found.append(f"{name}: is out of date: what it shows, or the code that draws it, has changed since")
    there = {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.suffix in (".png", ".jpg")}
    found += [f"{name}: nothing makes it" for name in sorted(there - {*names(), *BY_HAND})]
    return found


def make(wanted: Sequence[str], folder: Path = FOLDER) -> None:
    """Make pictures, and note in the manifest what they were made of."""
    manifest = folder / MANIFEST.name
    known = json.loads(manifest.read_bytes()) if manifest.is_file() else {}
    for name in wanted:
        print(f"{name} ...", file=sys.stderr)
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        _maker(name)(path)
        known[name] = {"origin": origin(name), "sha256": _sha256(path)}
        jsonio.write(manifest, jsonio.pretty({one: known[one] for one in names() if one in known}))


def played(task_id: str) -> TrialRecord:
    """The trial of a task with the oracle, as `hthor eval` plays it with the seed 0."""
    chosen = task_selection.select_tasks(task_id.partition("/")[0], "")
    suite, crew = chosen.suite, robot_team.form_team(chosen.robots, ["oracle"] * len(chosen.robots))
    for one in sessions.make_sessions(suite, agent=crew):
        ids = [trial.task.id for trial in one.trials]
        if task_id in ids:
            until = sessions.Session(number=one.number, trials=one.trials[: ids.index(task_id) + 1])
            return [done.record for done in trial_runner.make_runner()(until)][-1]
    raise ValueError(f"the suite {suite.name} has no task {task_id}")


def _code_of_pages() -> list[Path]:
    """The files that decide how a report and a case look, and the reference of how trials go."""
    pages = sorted((ROOT / "hthor" / "report").rglob("*.py"))
    return [*pages, ROOT / _REFERENCE]


def _maker(name: str) -> Callable[[Path], None]:
    if name in _OF_RUNS:
        return _OF_RUNS[name]
    if name in TRIALS:
        return lambda path: _draw_trial(path, TRIALS[name])
    return _draw_scene


def _draw_trial(path: Path, task_id: str) -> None:
    record = played(task_id)
    made = trial_figure.trial_figure(record.spec, record.log, houses.load(record.spec.task.house))
    lettering.save_figure(made, path, metadata={"Software": None})


@functools.cache
def _runs() -> tuple[Path, ...]:
    """The folders of the runs, which are played once."""
    folder = Path(tempfile.mkdtemp(prefix="hthor-pictures-"))
    robots = [part for agent in AGENTS for part in ("--agent", agent)]
    _hthor("eval", *robots, "--suite", SUITE, "--out", folder)
    return tuple(folder / agent for agent in AGENTS)


def _hthor(*words: str | Path) -> None:
    subprocess.run([sys.executable, "-m", "hthor", *map(str, words)], check=True, stdout=subprocess.DEVNULL)


def _draw_report(path: Path) -> None:
    """The first page of a report, as a browser shows it."""
    if shutil.which(_BROWSER) is None:
        raise SystemExit(f"{path.name} is a picture of a page in a browser, and {_BROWSER} is not installed.")
    with tempfile.TemporaryDirectory() as folder:
        _hthor("report", *_runs(), "--out", folder)
        size = ",".join(map(str, _PAGE_PX))
        options = ["--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", f"--user-data-dir={folder}/own"]
        options += [f"--window-size={size}", f"--force-device-scale-factor={_PAGE_SCALE}", f"--screenshot={path}"]
        subprocess.run([_BROWSER, *options, f"file://{folder}/report.html"], check=True, stderr=subprocess.DEVNULL)


def _draw_case(path: Path) -> None:
    """One task under the three conditions, as `hthor case --nice` draws it."""
    with tempfile.TemporaryDirectory() as folder:
        _hthor("case", *_runs(), CASE, "--nice", "--out", folder)
        (drawn,) = Path(folder).glob("*.png")
        whole = cv2.imread(str(drawn))
    assert whole is not None
    high, wide = whole.shape[:2]
    small = cv2.resize(whole, (_CASE_PX, round(high * _CASE_PX / wide)), interpolation=cv2.INTER_AREA)
    cv2.imwrite(str(path), small, [cv2.IMWRITE_JPEG_QUALITY, 88])


_OF_RUNS: dict[str, Callable[[Path], None]] = {"report.png": _draw_report, "case.jpg": _draw_case}


def _draw_scene(path: Path) -> None:
    from hthor.world.rendering import contact_sheet

    with tempfile.TemporaryDirectory() as folder:
        contact_sheet.main([path.stem, "--out", folder])
        (made,) = Path(folder).iterdir()
        path.write_bytes(made.read_bytes())


def _task(task_id: str) -> TaskSpec:
    return next(task for task in tasks.load_suite(task_id.partition("/")[0]).tasks if task.id == task_id)


def _code_sha256(path: Path) -> str:
    """Hash of a file, of a Python file without its comments and docstrings."""
    if path.suffix != ".py":
        return _sha256(path)
    tree = ast.parse(path.read_bytes())
    for node in ast.walk(tree):
        if isinstance(body := getattr(node, "body", None), list):
            texts = [one for one in body if isinstance(one, ast.Expr) and isinstance(one.value, ast.Constant)]
            node.body = [one for one in body if one not in texts]
    return hashlib.sha256(ast.dump(tree).encode()).hexdigest()


def _sha256(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def main() -> None:
    """Make pictures, or check them."""
    options = argparse.ArgumentParser(prog="python -m benchmarks.pictures", description=__doc__.splitlines()[0])
    options.add_argument(
        "names", nargs="*", metavar="NAME", help=f"one of {', '.join(names())} (default: outdated ones)"
    )
    options.add_argument("--all", action="store_true", help="make all of them anew")
    options.add_argument("--check", action="store_true", help="only say which are out of date; exit code 1 if some are")
    given = options.parse_args()
    found = problems()
    if given.check:
        print("\n".join(found) or f"{len(names())} pictures are up to date")
        sys.exit(bool(found))
    stale = [name for name in names() if any(line.startswith(f"{name}:") for line in found)]
    make(given.names or (names() if given.all else stale))


if __name__ == "__main__":
    main()
