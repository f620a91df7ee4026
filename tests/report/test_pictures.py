"""Pictures of trials name what a reader needs; how they look is for eyes."""

from __future__ import annotations

import shutil
import subprocess
import sys
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace

import cv2
import msgspec
import numpy as np
import pytest
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure
from matplotlib.text import Text

from benchmarks import pictures, readme_film
from hthor import houses, tasks
from hthor.episode import EpisodeLog, Fault
from hthor.errors import HthorError
from hthor.eval.records import trial_record
from hthor.report.drawing import figure_file, floor_plan, lettering, trial_figure, trial_trace, trial_video
from hthor.report.drawing.film import webm_file
from hthor.report.html import matplotlib_svg
from hthor.report.page.figures import trial_map
from hthor.types import AgentRef, HumanSeat, RobotSeat, TrialSpec
from hthor.types.events import Accepted, Believed, Declined, Picked, Placed, Predicted, Sent, Success

TASK = next(task for task in tasks.load_suite("smoke").tasks if task.kind == "mobile_manipulation")


@pytest.fixture(scope="module")
def spec() -> TrialSpec:
    agent = AgentRef(name="helper", source="helper.py", sha256="0")
    return TrialSpec(
        task=TASK,
        robots=(RobotSeat(seat="robot", robot="scout", agent=agent),),
        humans=(HumanSeat(seat="human", model="proxy", sha256="0", participant=0),),
        session=0,
        index=0,
        seed=0,
        suite_sha256="0",
        rules_sha256="0",
        code_sha256="0",
    )


@pytest.fixture(scope="module")
def log() -> EpisodeLog:
    claim = [round(part, 3) for part in TASK.objects[0].position]
    events = [
        Sent(tick=40, seat="robot", message=0, text="Here.", position=claim),
        Declined(tick=60, seat="human", message=0, sender="robot"),
        Sent(tick=80, seat="robot", message=1, text="Here!"),
        Accepted(tick=95, seat="human", message=1, sender="robot"),
        Picked(tick=120, seat="human", object=TASK.goal.target),
        Placed(tick=140, seat="human", object=TASK.goal.target, on="x"),
        Success(tick=141, seat="human"),
    ]
    walk = [(1000 + 20 * step, 2000 + 10 * step, 400) for step in range(71)]
    paths = {"human": walk, "robot": [(x + 500, y, yaw) for x, y, yaw in walk]}
    return EpisodeLog(events=tuple(events), paths=paths, ticks=141, met=True, ratings={"human": 5}, faults=())


def test_a_picture_names_rooms_target_times_and_messages(spec: TrialSpec, log: EpisodeLog) -> None:
    house = houses.load(TASK.house)
    sheet = trial_figure.trial_figure(spec, log, house)
    texts = [text.get_text() for text in sheet.findobj(Text)]
    for room in house.rooms:
        assert room.name in texts
    for words in ("1", "2", "T*", "done", "accepts", "declines", "picks", "places", "1 m"):
        assert words in texts, words
    told = "\n".join(texts)
    for words in (TASK.instruction, "helper", "14.1 s", "person", "scout (helper)", "destination"):
        assert words in told, words


def test_a_t_star_beyond_the_time_limit_is_not_drawn(spec: TrialSpec, log: EpisodeLog, tmp_path: Path) -> None:
    """Its words would stand a page away and squeeze the picture."""
    short = msgspec.structs.replace(spec, task=msgspec.structs.replace(TASK, time_limit=15.0, t_star=300.0))
    sheet = trial_figure.trial_figure(short, log, houses.load(TASK.house))
    assert "T*" not in [text.get_text() for text in sheet.findobj(Text)]
    sheet.savefig(tmp_path / "trial.png", dpi=40)


def test_knowledge_of_beliefs_has_a_row_where_a_robot_predicted_them(spec: TrialSpec, log: EpisodeLog) -> None:
    house, places = houses.load(TASK.house), {"bed": 1.0}
    said = Predicted(tick=20, seat="robot", person="human", object="apple", places=places)
    true = Believed(tick=20, seat="human", object="apple", places=places, next="search")
    predicting = msgspec.structs.replace(log, events=(said, *log.events), journal=(true,))
    for one, drawn in ((log, False), (predicting, True)):
        sheet = trial_figure.trial_figure(spec, one, house)
        assert ("beliefs known" in [text.get_text() for text in sheet.findobj(Text)]) == drawn


FILMED_TICKS = 61
"""How much of the trial is filmed."""


@pytest.fixture(scope="module")
def film(spec: TrialSpec, log: EpisodeLog, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("film") / "film.webm"
    first = tuple(event for event in log.events if event.tick <= FILMED_TICKS)
    short = msgspec.structs.replace(
        log,
        events=first,
        ticks=FILMED_TICKS,
        paths={seat: way[: FILMED_TICKS // 2 + 1] for seat, way in log.paths.items()},
    )
    trial_video.write_video(path, spec, short, houses.load(TASK.house))
    return path


def test_a_film_lasts_as_long_as_the_trial(film: Path) -> None:
    opened = cv2.VideoCapture(str(film))
    seconds = opened.get(cv2.CAP_PROP_FRAME_COUNT) / opened.get(cv2.CAP_PROP_FPS)
    assert seconds == pytest.approx(FILMED_TICKS / 10.0 / trial_video.SPEED + webm_file.HOLD_S, abs=0.1)


HOSTILE = r"$\frac{1}{$ <b>x</b> & a_b^2 $x$ 😀 \u202e"


@pytest.fixture
def failed(log: EpisodeLog) -> EpisodeLog:
    """The robot's agent failed after 3.3 s; before, it sent a message at every tick that no formula is."""
    sent = [Sent(tick=n, seat="robot", message=n, text=HOSTILE, position=(1.0, 2.0, 0.5)) for n in range(30)]
    fault = Fault(seat="robot", kind="raised", tick=33, detail=HOSTILE)
    return msgspec.structs.replace(log, events=(*sent, *log.events[-4:]), faults=(fault,))


def test_words_of_agents_are_no_formulas(spec: TrialSpec, failed: EpisodeLog, tmp_path: Path) -> None:
    house = houses.load(TASK.house)
    lettering.save_figure(trial_figure.trial_figure(spec, failed, house), tmp_path / "x.png")
    one = trial_record.make_record(spec, failed)
    svg = matplotlib_svg.to_svg(trial_map.figure(one, house, None), "map", HOSTILE)
    assert svg.startswith("<svg")
    short = msgspec.structs.replace(failed, paths={seat: way[:3] for seat, way in failed.paths.items()})
    trial_video.write_video(tmp_path / "x.webm", spec, short, house)


@pytest.mark.nightly
@pytest.mark.parametrize("suffix", [".svg", ".pdf"])
def test_words_of_agents_are_no_formulas_in_any_format(
    spec: TrialSpec, failed: EpisodeLog, tmp_path: Path, suffix: str
) -> None:
    sheet = trial_figure.trial_figure(spec, failed, houses.load(TASK.house))
    lettering.save_figure(sheet, tmp_path / f"x{suffix}")


def test_no_picture_is_made_without_plain_words(root: Path) -> None:
    """Whoever makes a figure of trials makes it where words stand as they are."""
    for path in (root / "hthor" / "eval").rglob("*.py"):
        text = path.read_text()
        if "Figure(" in text.replace("-> Figure:", ""):
            assert "lettering.plain()" in text or path.name == "ink.py", path
        assert ".savefig(" not in text or path.name in ("lettering.py", "ink.py"), path


def test_a_robot_that_failed_is_a_cross_and_its_way_ends_there(spec: TrialSpec, failed: EpisodeLog) -> None:
    sheet = trial_figure.trial_figure(spec, failed, houses.load(TASK.house))
    told = "\n".join(text.get_text() for text in sheet.findobj(Text))
    assert told.count("raised at 3.3 s") == 2, "on the plan and along the clock"
    assert "the agent failed at 3.3 s (raised)" in told
    shade = to_rgba(trial_trace.seat_colour("robot"))[:3]
    ways = [line for line in sheet.axes[0].lines if to_rgba(line.get_color())[:3] == shade]
    last = trial_trace.position_at(failed, "robot", 33)[0]
    assert max(float(line.get_xdata()[-1]) for line in ways) <= last + 1e-9
    assert trial_trace.position_at(failed, "robot", 141)[0] > last + 1.0, "the body has gone on, in the log"


def test_messages_that_would_hide_one_another_share_a_badge(spec: TrialSpec, failed: EpisodeLog) -> None:
    sheet = trial_figure.trial_figure(spec, failed, houses.load(TASK.house))
    sheet.canvas.draw()
    for ax in sheet.axes[:2]:
        boxes = [text.get_bbox_patch().get_window_extent() for text in ax.texts if text.get_bbox_patch() is not None]
        assert boxes
        for number, box in enumerate(boxes):
            assert not any(box.overlaps(other) for other in boxes[number + 1 :])


@pytest.mark.parametrize(
    ("numbers", "words"),
    [([3], "3"), ([1, 2], "1, 2"), ([1, 2, 3], "1–3"), ([1, 2, 3, 7], "1–3, 7"), ([1, 3, 5, 9], "1 … 9")],
)
def test_numbers_are_written_as_ranges(numbers: list[int], words: str) -> None:
    assert trial_trace.number_ranges(numbers) == words


def test_a_badge_at_the_edge_takes_no_room_from_the_plan(spec: TrialSpec, log: EpisodeLog) -> None:
    house = houses.load(TASK.house)
    far = {seat: [(-300, y, yaw) for _, y, yaw in way] for seat, way in log.paths.items()}
    wide = [trial_figure.trial_figure(spec, one, house) for one in (log, msgspec.structs.replace(log, paths=far))]
    for sheet in wide:
        sheet.canvas.draw()
    first, second = (sheet.axes[0].get_position().width for sheet in wide)
    assert first == pytest.approx(second)


def test_a_rug_is_a_covering_of_the_floor_below_everything(spec: TrialSpec, log: EpisodeLog) -> None:
    house = houses.load(TASK.house)
    rugs = [thing for thing in house.things if floor_plan.is_flat(thing)]
    assert rugs
    assert {thing.kind for thing in rugs} == {"rug"}
    sheet = trial_figure.trial_figure(spec, log, house)
    hatched = [patch for patch in sheet.axes[0].patches if patch.get_hatch()]
    assert len(hatched) == len(rugs)
    solid = [patch for patch in sheet.axes[0].patches if to_rgba(patch.get_facecolor()) == to_rgba("#d9d4cb")]
    assert max(patch.get_zorder() for patch in hatched) < min(patch.get_zorder() for patch in solid)
    assert "rug, flat" in [text.get_text() for text in sheet.findobj(Text)]


def test_the_same_trial_gives_the_same_film(spec: TrialSpec, log: EpisodeLog, tmp_path: Path) -> None:
    short = msgspec.structs.replace(log, paths={seat: way[:4] for seat, way in log.paths.items()})
    for name in ("one", "two"):
        trial_video.write_video(tmp_path / f"{name}.webm", spec, short, houses.load(TASK.house))
    one, two = ((tmp_path / f"{name}.webm").read_bytes() for name in ("one", "two"))
    assert one == two
    assert b"V_VP8" in one[:1000], "what browsers play"


@pytest.mark.parametrize("robots", [1, 7])
@pytest.mark.parametrize("scene", [TASK.house, "willow"])
def test_a_films_words_lie_apart_from_the_plan(spec: TrialSpec, failed: EpisodeLog, scene: str, robots: int) -> None:
    """Title, plan, clock, message and legend stand below one another, however many lines each of them has."""
    seats = [f"robot{number or ''}" for number in range(robots)]
    team = tuple(msgspec.structs.replace(spec.robots[0], seat=seat, robot=f"a body {seat} of {LONG}") for seat in seats)
    task = msgspec.structs.replace(TASK, instruction=f"{TASK.instruction} {LONG}", goal=spec.task.goal)
    many = msgspec.structs.replace(spec, robots=team, task=task)
    said = Sent(tick=19, seat="robot", message=99, text=LONG * 2)
    log = msgspec.structs.replace(failed, events=(*failed.events, said))
    stage = trial_video._Stage(many, log, houses.load(scene))
    frame = stage.draw(log, 10)
    changed = np.argwhere((frame != stage.empty).any(axis=2))
    words = changed[changed[:, 0] > stage.clock_y - 15]
    assert words[:, 0].max() > stage.message_y - 12, "the message is written"
    assert words[:, 1].max() < 958, "its end is no cut letter but an ellipsis"
    first, last = stage.clock_y - 13, stage.message_y + 6
    assert words[:, 0].max() < last
    assert (stage.empty[first:last] == 255).all(), "neither the plan with its scale nor the legend is written over"
    rows = (stage.empty < 250).any(axis=(1, 2))
    assert not rows[:6].any(), "the title is whole"
    assert not rows[-3:].any(), "and the legend"
    assert stage.empty.shape == (800, 960, 3)


LONG = "with a name that goes on and on until nobody can read it any more "


@pytest.mark.skipif(shutil.which("chromium") is None, reason="Chromium is not installed")
def test_a_browser_plays_a_film(film: Path, tmp_path: Path) -> None:
    shutil.copy(film, tmp_path / "film.webm")
    (tmp_path / "page.html").write_text(PAGE)
    options = ["--headless", "--no-sandbox", "--disable-gpu", "--virtual-time-budget=20000"]
    options += [f"--user-data-dir={tmp_path / 'browser'}", "--dump-dom", f"file://{tmp_path / 'page.html'}"]
    done = subprocess.run(["chromium", *options], capture_output=True, text=True, timeout=900, check=True)
    assert "shows 1212 x 800" in done.stdout, "the plan, and the person's display beside it"


PAGE = """<video id="film" muted src="film.webm"></video><p id="told">nothing</p><script>
const film = document.getElementById("film"), told = document.getElementById("told");
film.onerror = () => { told.textContent = "error " + film.error.code; };
film.onloadeddata = () => { told.textContent = "shows " + film.videoWidth + " x " + film.videoHeight; };
</script>"""


def pixels(made: Figure) -> np.ndarray:
    """(H, W, 3) uint8 of a figure's PNG file."""
    return cv2.imdecode(np.frombuffer(figure_file.encode(made, "png"), np.uint8), cv2.IMREAD_COLOR)[:, :, ::-1]


def test_a_house_is_shown_with_its_rooms_and_a_scale() -> None:
    house = houses.load(TASK.house)
    bare = np.full((300, 320, 3), 128, np.uint8)
    named, plain = (
        pixels(floor_plan.labelled_figure(bare, house, (0.0, 0.0, 10.7, 10.0), named=named)) for named in (True, False)
    )
    assert named.shape == plain.shape == (334, 320, 3)
    assert (plain[:300] == bare).all()
    assert (named[:300] != bare).any()
    scale = np.argwhere((plain[317] < 100).all(axis=1))[:, 0]
    assert 25 <= sum(scale < 45) <= 36, "a metre is some thirty pixels"


def test_pictures_of_the_docs_are_known_and_tell_when_they_are_old(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert set(pictures.problems(tmp_path)) == {f"{name}: is missing" for name in pictures.names()}
    monkeypatch.setattr(pictures, "names", lambda: ["replay.png"])
    monkeypatch.setattr(pictures, "_maker", lambda name: lambda path: path.write_bytes(b"drawn"))
    pictures.make(["replay.png"], tmp_path)
    assert pictures.problems(tmp_path) == []
    (tmp_path / "replay.png").write_bytes(b"drawn by hand")
    assert "is not the file that was made last" in pictures.problems(tmp_path)[0]
    (tmp_path / "replay.png").write_bytes(b"drawn")
    monkeypatch.setattr(pictures.rules, "sha256", lambda: "other rules")
    assert "is out of date" in pictures.problems(tmp_path)[0]
    (tmp_path / "other.png").write_bytes(b"")
    assert pictures.problems(tmp_path)[-1] == "other.png: nothing makes it"


def test_a_film_shows_the_whole_trial_and_slows_down_for_messages() -> None:
    sent = Sent(tick=100, seat="robot", message=0, text="Here.", object=None, position=None)
    taken = Picked(tick=300, seat="human", object="tomato")
    done = Placed(tick=400, seat="human", object="tomato", on="fridge")
    record = SimpleNamespace(ticks=400, log=SimpleNamespace(events=(sent, taken, done)))
    ticks = readme_film.shown_ticks(record)  # type: ignore[arg-type]
    assert len(ticks) * readme_film.FRAME_S == readme_film.LENGTH_S
    assert (ticks[0], ticks[-1]) == (0, 400)
    steps = [after - tick for tick, after in pairwise(ticks)]
    assert min(steps) >= 0
    reading = [step for tick, step in zip(ticks, steps, strict=False) if 100 <= tick < 113]
    before = [step for tick, step in zip(ticks, steps, strict=False) if tick < 90]
    assert max(reading) < min(before), "time runs slower while a message is read"


def test_a_film_is_out_of_date_when_the_code_that_draws_it_changes(monkeypatch: pytest.MonkeyPatch) -> None:
    before = pictures.origin("trial.webp")
    hashed: list[Path] = []

    def changed(path: Path) -> str:
        hashed.append(path)
        return f"another {path.name}"

    monkeypatch.setattr(pictures, "_code_sha256", changed)
    assert pictures.origin("trial.webp") != before
    drawing = {"readme_film.py", "record_trial.py", "watch.js", "house.js", "still_light.py"}
    assert drawing <= {path.name for path in hashed}


def test_a_picture_that_shows_something_else_is_named_for_eyes() -> None:
    """Noise of another OpenGL is no change; a thing that was moved is one."""
    draw = np.random.default_rng(1)
    before = cv2.GaussianBlur(draw.integers(0, 255, (120, 160, 3)).astype(np.uint8), (0, 0), 4.0)
    before = cv2.normalize(before, None, 0, 255, cv2.NORM_MINMAX)
    noisy = np.clip(before.astype(int) + draw.integers(-1, 2, before.shape), 0, 255).astype(np.uint8)
    other = before.copy()
    other[40:80, 60:110] = 0
    assert pictures.likeness(before, before) == "similarity to the picture before 1.000"
    assert not pictures.likeness(before, noisy).endswith("look at it")
    assert pictures.likeness(before, other).endswith("look at it")
    assert "another size, 80 x 120 instead of 160 x 120" in pictures.likeness(before, before[:, :80])


def test_files_of_figures_have_no_date_and_know_their_formats(tmp_path: Path) -> None:
    """Two processes, at two times, write the same bytes; words in a PDF are text, and pictures are the only pixels."""
    made = Figure(figsize=(2, 2))
    made.add_subplot().imshow(np.arange(64).reshape(8, 8))
    made.suptitle("words")
    for suffix in figure_file.SUFFIXES:
        figure_file.write_figure(made, tmp_path / f"figure{suffix}")
    svg, pdf = ((tmp_path / f"figure{suffix}").read_bytes() for suffix in (".svg", ".pdf"))
    assert svg.count(b"<image ") == 1
    assert b"<dc:date>" not in svg
    assert b"/CreationDate" not in pdf
    assert b"/Subtype /Image" in pdf
    assert b"/FontFile2" in pdf, "TrueType, which journals accept"
    for name in ("figure.jpg", "figure", "figure.svgz"):
        with pytest.raises(HthorError, match=r"must end in \.png, \.svg or \.pdf"):
            figure_file.write_figure(made, tmp_path / name)


def test_two_processes_write_the_same_drawing() -> None:
    """Names in an SVG and prefixes of fonts are no chance."""
    script = (
        "import hashlib, sys\nfrom hthor import houses\nimport numpy as np\n"
        "from hthor.report.drawing import figure_file, floor_plan\n"
        "bare = np.zeros((300, 320, 3), np.uint8)\n"
        "made = floor_plan.labelled_figure(bare, houses.load('elder'), (0.0, 0.0, 10.7, 10.0))\n"
        "print([hashlib.sha256(figure_file.encode(made, form)).hexdigest() for form in ('png', 'svg', 'pdf')])"
    )
    told = [subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True) for _ in "ab"]
    assert told[0].stdout == told[1].stdout != ""
