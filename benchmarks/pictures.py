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
from typing import Any

import cv2
import numpy as np

from benchmarks import page_certificate, page_headset, page_looks, page_trial, readme_film
from hthor import houses, jsonio, rules, tasks
from hthor.eval.config import task_selection
from hthor.eval.records.trial_record import TrialRecord
from hthor.eval.runner import session_runner
from hthor.report.drawing import figure_file, trial_figure
from hthor.report.drawing.person_display import panel_picture
from hthor.trials import robot_team, sessions
from hthor.types import TaskSpec
from hthor.types.events import Sent
from hthor.world import World

ROOT = Path(__file__).resolve().parents[1]
FOLDER = ROOT / "docs" / "images"
MANIFEST = FOLDER / "pictures.json"
_REFERENCE = "hthor/eval/doctor/reference.json"
_DRAWING = (
    "figure_file",
    "floor_plan",
    "lettering",
    "text_fit",
    "trial_figure",
    "trial_legend",
    "trial_timeline",
    "trial_trace",
    "person_display/timeline_bars",
)
_DISPLAY = ("hthor/report/drawing/person_display/panel_picture.py", "hthor/comms/map_picture.py")
_DISPLAY_TASK, _DISPLAY_PX = "smoke/birch/manipulation-01", (320, 240)
"""Of which task the picture of a display is, and the size of each of its parts [pixels]."""
_SHEETS = ("hthor/world/rendering/contact_sheet.py", "hthor/world/rendering/opengl_renderer.py")
LOOK_BELOW = 0.98
"""Pictures that are less similar than this to those that they replace are named for a person to look at."""
_OVERVIEWS = tuple(f"hthor/world/rendering/{part}.py" for part in ("ray_renderer", "shading", "viewpoint"))
_SUFFIXES = (".png", ".jpg", ".webp")
BY_HAND = ("robots.png", "loose_things.jpg", "live_own_page.jpg")
"""Pictures that need a stage and a camera of their own, or a session of ten minutes."""
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
LEARNED = {"savn_success.png": "smoke/rowan/manipulation-03", "savn_failure.png": "smoke/juniper/manipulation-01"}
"""Trials with the robot savn; `_LEARNED_OF` are the files that decide what it does."""
_LEARNED_OF = [
    "hthor/agents/savn.py",
    *(
        f"hthor/agents/skills/{part}.py"
        for part in ("detector_noise", "network_search", "savn_network", "semantic_cells")
    ),
    *(f"hthor/agents/checkpoints/savn/{part}" for part in ("config.json", "model.safetensors")),
]
TASKS = {"vln_task.png": "vln/juniper/01"}
"""Tasks as `hthor tasks draw` draws them."""


EYES = "paper"
"""Of which suite's first trial the strip through a person's eyes is."""
OF_TASKS = {
    "angles.jpg": ("rearrange/elder/01", "--angles"),
    "pipeline.jpg": ("paper/alder/manipulation-01", "--pipeline"),
}
"""Figures of tasks in three dimensions: a task, and the option of `hthor tasks draw`."""
FILMS = {"trial.webp": "paper/juniper/manipulation-03"}
"""Trials with the oracle as the README's film shows one."""
LOOKS = "live_looks.jpg"
_OF_PAGES: dict[str, Callable[[Path], None]] = {
    LOOKS: page_looks.write,
    page_trial.TRIAL: page_trial.write,
    page_trial.EXPERIMENTER: page_trial.write,
    page_headset.HEADSET: page_headset.write,
    page_certificate.CERTIFICATE: page_certificate.write,
}
"""Pictures of the page of `hthor live` and of what a browser shows before it, each with the function that writes it."""
LADDER, _LADDER_OF = "savn_ladder.png", "hthor/agents/checkpoints/savn/eval.json"
"""How well robots find things, by the evaluation of the network that ships."""
_LADDER_CODE = (
    "benchmarks/navigation_ladder.py",
    "hthor/report/html/matplotlib_svg.py",
    "hthor/report/page/figures/run_styles.py",
)


def names() -> list[str]:
    """All pictures that this makes."""
    return [
        *TRIALS,
        *LEARNED,
        *OF_TASKS,
        *TASKS,
        *FILMS,
        "eyes.jpg",
        *_OF_RUNS,
        "display.png",
        *_OF_PAGES,
        LADDER,
        *(f"scenes/{name}.jpg" for name in houses.names()),
    ]


def origin(name: str) -> str:
    """Hash of all that decides what a picture shows."""
    if name in TRIALS or name in LEARNED:
        task_id = (TRIALS | LEARNED)[name]
        task = _task(task_id)
        code = [f"hthor/report/drawing/{part}.py" for part in _DRAWING] + (_LEARNED_OF if name in LEARNED else [])
        facts = [task_id, task, houses.load(task.house).sha256, rules.sha256(), _sha256(ROOT / _REFERENCE)]
        return jsonio.sha256([*facts, *(_code_sha256(ROOT / path) for path in code)])
    if name in FILMS:
        task = _task(FILMS[name])
        shown = [FILMS[name], task, houses.load(task.house).sha256, rules.sha256(), _sha256(ROOT / _REFERENCE)]
        return jsonio.sha256([*shown, *map(_code_sha256, _code_of_films())])
    if name in OF_TASKS:
        task = _task(OF_TASKS[name][0])
        code = [*sorted((ROOT / "hthor/report/drawing/overviews").glob("*.py")), *(ROOT / path for path in _OVERVIEWS)]
        facts = [OF_TASKS[name], task, houses.load(task.house).sha256]
        return jsonio.sha256([*facts, *map(_code_sha256, code)])
    if name == "eyes.jpg":
        code = [*sorted((ROOT / "hthor/report/first_person").glob("*.py")), *(ROOT / path for path in _OVERVIEWS)]
        facts = [EYES, tasks.load_suite(EYES).sha256, rules.sha256(), _sha256(ROOT / _REFERENCE)]
        return jsonio.sha256([*facts, *map(_code_sha256, code)])
    if name in TASKS:
        task, code = _task(TASKS[name]), [f"hthor/report/drawing/{part}.py" for part in (*_DRAWING, "task_figure")]
        facts = [task, houses.load(task.house).sha256, rules.sha256()]
        return jsonio.sha256([*facts, *(_code_sha256(ROOT / path) for path in code)])
    if name in _OF_RUNS:
        return jsonio.sha256(
            [AGENTS, CASE, tasks.load_suite(SUITE).sha256, rules.sha256(), *map(_code_sha256, _code_of_pages())]
        )
    if name == page_certificate.CERTIFICATE:
        code = [ROOT / "hthor/live/certificate.py", ROOT / "benchmarks/page_certificate.py"]
        return jsonio.sha256([*map(_code_sha256, code)])
    if name in _OF_PAGES:
        shown = {home for home, _ in page_looks.ROOMS}
        facts = [[houses.load(home).sha256 for home in sorted(shown)], rules.sha256()]
        return jsonio.sha256([*facts, *map(_code_sha256, _code_of_live_pages(name))])
    if name == LADDER:
        return jsonio.sha256([_sha256(ROOT / _LADDER_OF), *(_code_sha256(ROOT / path) for path in _LADDER_CODE)])
    if name == "display.png":
        facts = [_task(_DISPLAY_TASK), rules.sha256(), _sha256(ROOT / _REFERENCE)]
        return jsonio.sha256([*facts, *(_code_sha256(ROOT / path) for path in _DISPLAY)])
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
    there = {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.suffix in _SUFFIXES}
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
        before = cv2.imread(str(path)) if path.is_file() else None
        _maker(name)(path)
        if before is not None:
            print(f"{name}: {likeness(before, cv2.imread(str(path)))}", file=sys.stderr)
        known[name] = {"origin": origin(name), "sha256": _sha256(path)}
        jsonio.write(manifest, jsonio.pretty({one: known[one] for one in names() if one in known}))


def likeness(before: Any, after: Any) -> str:
    """In words how like a picture is to the one that it replaces, (H, W, 3) uint8 each: which ones to look at.

    The number is the structural similarity of Wang et al. (2004), 1 for equal pictures: other bytes of another
    version of OpenGL or of a browser hardly change it, another content does.
    """
    from skimage.metrics import structural_similarity

    if before.shape != after.shape:
        return f"has another size, {after.shape[1]} x {after.shape[0]} instead of {before.shape[1]} x {before.shape[0]}"
    share = structural_similarity(before, after, channel_axis=2)
    return f"similarity to the picture before {share:.3f}{', look at it' if share < LOOK_BELOW else ''}"


def played(task_id: str, agent: str = "oracle") -> TrialRecord:
    """The trial of a task with an agent, as `hthor eval` plays it with the seed 0."""
    return [done.record for done in session_runner.make_runner()(session_until(task_id, agent))][-1]


def session_until(task_id: str, agent: str = "oracle") -> sessions.Session:
    """The session of a task with an agent, up to the trial of this task."""
    chosen = task_selection.select_tasks(task_id.partition("/")[0], "")
    suite, crew = chosen.suite, robot_team.form_team(chosen.robots, [agent] * len(chosen.robots))
    for one in sessions.make_sessions(suite, agent=crew):
        ids = [trial.task.id for trial in one.trials]
        if task_id in ids:
            return sessions.Session(number=one.number, trials=one.trials[: ids.index(task_id) + 1])
    raise ValueError(f"the suite {suite.name} has no task {task_id}")


def _code_of_pages() -> list[Path]:
    """The files that decide how a report and a case look, and the reference of how trials go."""
    pages = sorted((ROOT / "hthor" / "report").rglob("*.py"))
    return [*pages, ROOT / _REFERENCE]


def _code_of_films() -> list[Path]:
    """The files that decide how a film looks: those of the page that shows it, and the light of its house."""
    page = [ROOT / "web" / "src" / f"{part}.js" for part in ("eye", "house", "map")]
    page += sorted((ROOT / "web" / "src" / "watch").iterdir())
    own = [ROOT / "benchmarks" / "readme_film.py", *sorted((ROOT / "hthor" / "watch").glob("*.py"))]
    return [*own, *page, *_code_of_light()]


def _code_of_light() -> list[Path]:
    """The files that decide how pages draw a house."""
    light = sorted((ROOT / "hthor" / "live" / "gltf").glob("*.py"))
    scene = sorted((ROOT / "hthor" / "world" / "rendering" / "scene").glob("*.py"))
    return [*light, *scene, ROOT / "benchmarks" / "page_browser.py"]


def _code_of_live_pages(name: str) -> list[Path]:
    """The files that decide how the page of `hthor live` looks: how it draws, its light, and all else that is on it."""
    code = _code_of_light()
    if name == LOOKS:
        drawing = (ROOT / "web" / "src" / part for part in ("eye.js", "house.js"))
        return [*code, *drawing, ROOT / "benchmarks" / "page_looks.py"]
    own = [ROOT / "benchmarks" / f"{part}.py" for part in ("page_person", "page_trial")]
    if name == page_headset.HEADSET:
        own += [ROOT / "benchmarks" / f"{part}.py" for part in ("page_headset", "page_wearer")]
        own += sorted((ROOT / "web" / "src" / "headset").iterdir())
    return [*code, *sorted((ROOT / "web" / "src").glob("*.*")), *own]


def _maker(name: str) -> Callable[[Path], None]:
    if name in _OF_RUNS:
        return _OF_RUNS[name]
    if name in _OF_PAGES:
        return _OF_PAGES[name]
    if name == "eyes.jpg":
        return _draw_eyes
    if name in TASKS:
        return lambda path: _hthor("tasks", "draw", TASKS[name], "--out", path)
    if name in TRIALS:
        return lambda path: _draw_trial(path, TRIALS[name])
    if name in LEARNED:
        return lambda path: _draw_trial(path, LEARNED[name], "savn")
    if name in FILMS:
        return lambda path: readme_film.write_film(path, session_until(FILMS[name]))
    if name in OF_TASKS:
        return lambda path: _draw_smaller(path, "tasks", "draw", *OF_TASKS[name])
    if name == "display.png":
        return _draw_display
    if name == LADDER:
        return _draw_ladder
    return _draw_scene


def _draw_trial(path: Path, task_id: str, agent: str = "oracle") -> None:
    record = played(task_id, agent)
    made = trial_figure.trial_figure(record.spec, record.log, houses.load(record.spec.task.house))
    figure_file.write_figure(made, path)


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
    _draw_smaller(path, "case", *_runs(), CASE, "--nice")


def _draw_eyes(path: Path) -> None:
    """A trial with the oracle through the person's eyes, as `hthor replay --eyes` draws it."""
    with tempfile.TemporaryDirectory() as folder:
        _hthor("eval", "--agent", "oracle", "--suite", EYES, "--participants", "1", "--limit", "1", "--out", folder)
        _draw_smaller(path, "replay", folder, "0", "--eyes", "human")


def _draw_smaller(path: Path, *words: str | Path) -> None:
    """The picture that a command writes to its option --out, as a JPEG of the width of the docs' pages."""
    with tempfile.TemporaryDirectory() as folder:
        drawn = Path(folder) / "drawn.png"
        _hthor(*words, "--out", drawn)
        whole = cv2.imread(str(drawn))
    assert whole is not None
    high, wide = whole.shape[:2]
    small = cv2.resize(whole, (_CASE_PX, round(high * _CASE_PX / wide)), interpolation=cv2.INTER_AREA)
    cv2.imwrite(str(path), small, [cv2.IMWRITE_JPEG_QUALITY, 88])


_OF_RUNS: dict[str, Callable[[Path], None]] = {
    "report.png": _draw_report,
    "case.jpg": _draw_case,
}


def _draw_display(path: Path) -> None:
    """What a person sees, the panel with a robot's message, and the map after they confirmed it."""
    task = _task(_DISPLAY_TASK)
    world = World(task.house, robots=["scout"])
    world.reset(task)
    target, (wide, high) = task.goal.target, _DISPLAY_PX
    world.robot.go_to(target)
    world.robot.send(f"I found the {target} here.", target, world.position(target))
    message = world.human.display.message
    sent = next(event for event in world.events if isinstance(event, Sent))
    assert message is not None
    assert message.image is not None
    panel = panel_picture.draw_panel(sent, wide, high, message.image())
    world.human.reply(accept=True)
    gap = np.full((high, 12, 3), 255, dtype=np.uint8)
    whole = np.hstack([world.human.rgb(_DISPLAY_PX), gap, panel, gap, world.human.map_view(high)])
    cv2.imwrite(str(path), whole[:, :, ::-1])


def _draw_ladder(path: Path) -> None:
    from benchmarks import navigation_ladder  # needs torch

    navigation_ladder.write(path, ROOT / _LADDER_OF)


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
