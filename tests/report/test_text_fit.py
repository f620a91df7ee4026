"""Words in pictures and on pages are whole, whatever robots are called: nothing is cut, covered or beyond the edge."""

from __future__ import annotations

import itertools
import re
import shutil
import subprocess
from collections.abc import Iterator
from html import unescape
from pathlib import Path

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.axis import Axis, Tick
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Annotation, Text
from report_fakes import PUBLISHED, run

from hthor import houses
from hthor.episode import EpisodeLog, Fault
from hthor.eval.records.trial_record import TrialRecord
from hthor.report.analysis import build, load_runs
from hthor.report.analysis.document import Findings
from hthor.report.drawing import lettering, render_trial, text_fit, trial_figure, trial_trace
from hthor.report.html import elements, matplotlib_svg
from hthor.report.page import camera_frames, figure_index, key_moments, write_report
from hthor.report.page.figure_index import MapScene
from hthor.report.page.figures import case_study, run_styles, session
from hthor.types import RobotSeat, TrialSpec

LONG = "a_policy_whose_name_has_sixty_characters_as_some_people_like"
WIDE = "WWWWWWWWWWWWWWW MMMMMMMMMMMMMMM-WWWWWWWWWWWWWWWMMMMMMMMMMMMM"
NAMES = ("frontier", "control", LONG, WIDE)


@pytest.fixture(scope="module")
def folders(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    base = tmp_path_factory.mktemp("runs")
    robots = [run(base / str(number), name) for number, name in enumerate(NAMES)]
    return [run(base / "alone", "silent", absent=True), *robots]


@pytest.fixture(scope="module", autouse=True)
def _known_house() -> Iterator[None]:
    plan = houses.load("hazel")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(render_trial, "load_house", lambda *_: plan)
        yield


@pytest.fixture(scope="module")
def found(folders: list[Path]) -> Findings:
    return build.build_findings(load_runs.load_runs(folders), PUBLISHED)


@pytest.fixture(scope="module")
def written(folders: list[Path], tmp_path_factory: pytest.TempPathFactory) -> str:
    """The page of a report on four runs."""
    out = tmp_path_factory.mktemp("report")
    write_report.write_report(folders[:4], out, PUBLISHED)
    return (out / "report.html").read_text()


@pytest.fixture(scope="module")
def long_trial(folders: list[Path]) -> TrialRecord:
    """A trial of the robot with the long name, which fails in the middle of it."""
    one = load_runs.load_runs(folders)[3].records[0]
    robot = one.spec.robots[0]
    seat = RobotSeat(seat=robot.seat, robot=robot.robot, agent=msgspec.structs.replace(robot.agent, name=WIDE))
    return msgspec.structs.replace(one, spec=msgspec.structs.replace(one.spec, robots=(seat,)))


def cut(made: Figure) -> list[str]:
    """Words of a figure that are not wholly on it."""
    FigureCanvasAgg(made)
    with matplotlib_svg.style():
        made.canvas.draw()
    whole = made.bbox.padded(1.0)
    undrawn = {tick.label1 for ax in made.axes for axis in (ax.xaxis, ax.yaxis) for tick in _beyond(axis)}
    texts = [text for text in made.findobj(Text) if text not in undrawn]
    shown = [text for text in texts if text.get_visible() and text.get_text().strip()]
    boxes = [(text, text.get_window_extent()) for text in shown]
    return [
        text.get_text()
        for text, box in boxes
        if box.x0 < whole.x0 or box.y0 < whole.y0 or box.x1 > whole.x1 or box.y1 > whole.y1
    ]


def _beyond(axis: Axis) -> list[Tick]:
    """Ticks that are not drawn, as they lie beyond the axis's ends."""
    low, high = sorted(axis.get_view_interval())
    return [tick for tick in axis.get_major_ticks() if not low <= tick.get_loc() <= high]


def test_every_figure_of_a_report_has_its_words_whole(found: Findings, folders: list[Path]) -> None:
    assert all(len(name) == 60 for name in (LONG, WIDE))
    record = load_runs.load_runs(folders)[1].records[0]
    scenes = [MapScene(record=record, alone=None, house=houses.load("hazel"))] * 2
    drawn = {one.name: one.figure for one in figure_index.draw_figures(found, scenes)}
    assert {"scores", "compared", "time-spent", "trust", "channel", "scenes", "legend"} <= drawn.keys()
    assert {name: cut(made) for name, made in drawn.items()} == {name: [] for name in drawn}


def test_names_of_curves_lie_right_of_all_marks_and_apart(found: Findings) -> None:
    """Each began where its own curve ended, and the marks of the others hid its first letters."""
    made = session.trust_figure(found.trust, found.arms)
    assert cut(made) == []
    (ax,) = made.axes
    named = {run_styles.axis_label(name) for name in NAMES}
    boxes = [text.get_window_extent() for text in ax.texts if text.get_text() in named]
    assert len(boxes) == len(NAMES)
    to_pixels = ax.transData.transform
    last = max(to_pixels((float(np.max(line.get_xdata())), 0.0))[0] for line in ax.lines)
    assert all(box.x0 > last + 4.0 for box in boxes)
    assert not any(one.overlaps(other) for one, other in itertools.combinations(boxes, 2))
    within = ax.get_window_extent().padded(2.0)
    assert all(within.y0 <= box.y0 and box.y1 <= within.y1 for box in boxes)


def test_a_picture_and_a_case_have_their_words_whole(long_trial: TrialRecord) -> None:
    house, spec = houses.load("hazel"), long_trial.spec
    event = msgspec.structs.replace(
        next(one for one in long_trial.log.events if one.kind == "sent"),
        message=0,
        text=WIDE * 4,
        position=None,
    )
    others = [one for one in long_trial.log.events if one.kind != "sent"]
    fault = Fault(seat="robot", kind="raised", tick=33, detail="no")
    log = msgspec.structs.replace(long_trial.log, events=(event, *others), faults=(fault,))
    assert cut(_pictured(spec, log)) == []
    grey = np.full((24, 32, 3), 128, np.uint8)
    held = key_moments.key_moments(long_trial, house)
    views = {moment.tick: dict.fromkeys(long_trial.paths, grey) for moment in held}
    row = case_study.Row(label=WIDE, record=long_trial, moments=held, seen=camera_frames.Seen(views=views))
    assert cut(case_study.case_study_figure([row, row], house)) == []


def _pictured(spec: TrialSpec, log: EpisodeLog) -> Figure:
    with lettering.plain_lettering():
        return trial_figure.trial_figure(spec, log, houses.load("hazel"))


@given(st.text(alphabet="aW_-/ .+:é$\\", max_size=80), st.floats(0.3, 3.0))
def test_lines_are_as_wide_as_they_may_be_and_lose_no_letter(words: str, inches: float) -> None:
    lines = text_fit.wrap(words, inches, 8.0)
    assert "".join(lines).replace(" ", "") == words.replace(" ", "")
    assert all(text_fit.text_width(line, 8.0) <= inches for line in lines)
    line = text_fit.shorten(words, inches, 8.0)
    assert text_fit.text_width(line, 8.0) <= inches
    assert line.endswith("…") or line == " ".join(words.split())


def test_long_names_may_be_broken_on_a_page_and_are_copied_whole() -> None:
    broken = elements.paragraph(f"<{LONG}> helps 12 % of people at smoke/maple/01")
    assert "a_<wbr>policy_<wbr>whose_" in broken
    assert "smoke/maple/01" in broken
    assert unescape(re.sub(r"</?p>|<wbr>", "", broken)).replace("\xa0", " ") == (
        f"<{LONG}> helps 12 % of people at smoke/maple/01"
    )


def test_letters_in_a_figure_have_a_size_and_no_font_of_their_own(written: str) -> None:
    figures = re.findall(r"<svg .*?</svg>", written, re.DOTALL)
    assert len(figures) > 5
    for figure in figures:
        styles = re.findall(r'<text style="([^"]*)"', figure)
        assert styles
        for style in styles:
            parts = [part.strip().partition(":")[0] for part in style.split(";")]
            assert "font-size" in parts, style
            assert all(part and "," not in part and part not in ("font", "font-family") for part in parts), style


@pytest.mark.skipif(shutil.which("chromium") is None, reason="Chromium is not installed")
@pytest.mark.parametrize("width", [1280, pytest.param(700, marks=pytest.mark.nightly)])
def test_four_runs_fit_a_page(written: str, tmp_path: Path, width: int) -> None:
    """At 1280 pixels nothing is wider than the page; at 700 tables that are slide within it, and the page does not."""
    (tmp_path / "page.html").write_text(written.replace("</body>", f"{PROBE}</body>"))
    options = [
        "--headless",
        "--no-sandbox",
        "--disable-gpu",
        "--virtual-time-budget=4000",
        f"--window-size={width},900",
    ]
    options += [f"--user-data-dir={tmp_path / 'browser'}", "--dump-dom", f"file://{tmp_path / 'page.html'}"]
    done = subprocess.run(["chromium", *options], capture_output=True, text=True, timeout=900, check=True)
    told = re.search(r'<pre id="told">(.*?)</pre>', done.stdout, re.DOTALL)
    assert told is not None
    lines = unescape(told.group(1)).splitlines()
    assert lines[0] == "page fits"
    assert [line for line in lines if line.startswith("cut")] == []
    if width == 1280:
        assert [line for line in lines if line.startswith("slides")] == []


PROBE = """<script>addEventListener("load", () => {
document.querySelectorAll("details").forEach(one => { one.open = true; });
const all = document.documentElement, told = [all.scrollWidth <= all.clientWidth ? "page fits" : "page is wider"];
for (const one of document.querySelectorAll("svg")) {
  const box = one.getBoundingClientRect();
  for (const text of one.querySelectorAll("text")) {
    const own = text.getBoundingClientRect();
    if (own.left < box.left - 1 || own.right > box.right + 1) told.push("cut: " + text.textContent);
  }
}
for (const one of document.querySelectorAll("main *")) {
  if (one.closest("svg") || !one.clientWidth || one.scrollWidth <= one.clientWidth + 1) continue;
  if (getComputedStyle(one).overflowX === "visible") continue;
  told.push("slides: " + one.className + " " + one.scrollWidth + " > " + one.clientWidth);
}
const out = document.createElement("pre");
out.id = "told";
out.textContent = told.join("\\n");
document.body.append(out);
});</script>"""


def test_hundreds_of_messages_share_few_badges_that_do_not_touch(long_trial: TrialRecord) -> None:
    """Joining them pair by pair, again from the start after each, took minutes."""
    sent = next(one for one in long_trial.log.events if one.kind == "sent")
    events = [msgspec.structs.replace(sent, tick=n, message=n, text="x", position=(2.0, 2.0, 0.5)) for n in range(900)]
    log = msgspec.structs.replace(long_trial.log, events=tuple(events))
    marked = [(n + 1, event, (0.01 * n, 0.0)) for n, event in enumerate(events)]
    groups = trial_trace.group_messages(log, marked, 0.05, 0.2)
    assert len(groups) < 40
    for one, other in itertools.combinations(groups, 2):
        wide = 0.5 * 0.05 * sum(1.6 + len(group.words) for group in (one, other))
        assert abs(one.place[0] - other.place[0]) >= wide
    made = _pictured(long_trial.spec, log)
    assert cut(made) == []
    arrows = [text for text in made.axes[0].texts if isinstance(text, Annotation) and text.arrow_patch is not None]
    assert 0 < len(arrows) < 20, "of arrows that lie on one another one is drawn"
    made.axes[1].figure.canvas.draw()
    lane = made.axes[1]
    badges = [text.get_bbox_patch().get_window_extent() for text in lane.texts if text.get_bbox_patch() is not None]
    names = [tick.get_window_extent() for tick in lane.get_yticklabels()]
    assert not any(badge.overlaps(name) for badge in badges for name in names)
