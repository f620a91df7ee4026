"""Trials through a seat's eyes: captions beside the view, nothing stretched, room for what a headset shows."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from matplotlib.text import Text

from hthor import houses, tasks
from hthor.episode import EpisodeLog
from hthor.errors import UnknownName
from hthor.eval.records import trial_record
from hthor.report.drawing import figure_file
from hthor.report.drawing.film import captions
from hthor.report.first_person import film, seat_views, strip
from hthor.report.first_person.seat_views import SeatViews
from hthor.report.page.camera_frames import CameraFrames
from hthor.types import AgentRef, HumanSeat, RobotSeat, TrialSpec
from hthor.types.events import Accepted, Picked, Sent, Success

TASK = next(task for task in tasks.load_suite("smoke").tasks if task.kind == "mobile_manipulation")
LONG = "I saw what you are looking for on the counter of the kitchen, next to the fridge, behind all of the bowls. " * 2


class Grey:
    """Views that are grey everywhere, of the shape of a wide camera."""

    def draw(self, tick: int, seat: str) -> Any:
        return np.full((48, 120 if seat == "robot" else 48, 3), 100 + tick, np.uint8)


class Panel:
    """Something that a headset shows in a corner of the view."""

    def draw(self, picture: Any, tick: int) -> None:
        picture[:10, :10] = (255, 0, 0) if tick >= 40 else (0, 0, 255)


@pytest.fixture(scope="module")
def record() -> trial_record.TrialRecord:
    agent = AgentRef(name="helper", source="helper.py", sha256="0")
    spec = TrialSpec(
        task=TASK,
        robots=tuple(RobotSeat(seat=seat, robot="scout", agent=agent) for seat in ("robot", "robot2")),
        humans=(HumanSeat(seat="human", model="proxy", sha256="0", participant=0),),
        session=0,
        index=0,
        seed=0,
        suite_sha256="0",
        rules_sha256="0",
        code_sha256="0",
    )
    events = (
        Sent(tick=40, seat="robot2", message=0, text=LONG),
        Accepted(tick=60, seat="human", message=0, sender="robot2"),
        Picked(tick=100, seat="human", object=TASK.goal.target),
        Success(tick=141, seat="human"),
    )
    paths = {seat: [(1000 + 20 * step, 2000, 400) for step in range(71)] for seat in ("human", "robot", "robot2")}
    log = EpisodeLog(events=events, paths=paths, ticks=141, met=True, ratings={"human": 5}, faults=())
    return trial_record.make_record(spec, log)


def views(record: trial_record.TrialRecord, seat: str = "human", *overlays: Any) -> SeatViews:
    return SeatViews(record=record, seat=seat, frames=Grey(), overlays=overlays)  # type: ignore[arg-type]


def test_captions_stand_beside_the_view_and_frames_have_one_even_size(record: trial_record.TrialRecord) -> None:
    quiet, loud = (film.draw_frame(views(record), tick) for tick in (38, 42))
    assert quiet.shape == loud.shape
    assert all(side % 2 == 0 for side in quiet.shape[:2])
    for frame, tick in ((quiet, 38), (loud, 42)):
        assert (np.all(frame == 100 + tick, axis=2)).sum() == 48 * 48, (
            "every pixel of the view is there, and only there"
        )
    rows = np.argwhere((quiet != loud).any(axis=(1, 2)))[:, 0]
    view = np.argwhere((quiet == 138).all(axis=2))[:, 0]
    assert rows.max() > view.max() + 2 * 26, "what is said is below"
    assert (loud[-4:] == 255).all(), "and whole"
    assert (loud[:, -4:] == 255).all()


def test_a_headset_s_panel_is_drawn_over_the_view_alone(record: trial_record.TrialRecord) -> None:
    bare, shown = (film.draw_frame(views(record, "human", *more), 42) for more in ((), (Panel(),)))
    changed = np.argwhere((bare != shown).any(axis=2))
    assert len(changed) == 100
    assert (shown[tuple(changed[0])] == (0, 0, 255)).all(), "videos have blue first"


def test_a_seat_hears_what_is_for_it(record: trial_record.TrialRecord) -> None:
    log = record.log
    assert captions.newest_message(log, 42) == log.events[0]
    assert captions.newest_message(log, 42, "human") == captions.newest_message(log, 42, "robot2") == log.events[0]
    assert captions.newest_message(log, 42, "robot") is None, "robots' messages are for people"
    assert captions.newest_message(log, 39) is captions.newest_message(log, 91) is None


def test_a_film_shows_every_logged_pose_and_the_end(record: trial_record.TrialRecord, tmp_path: Path) -> None:
    ticks = film.film_ticks(record)
    assert ticks[:3] == [0, 2, 4]
    assert ticks[-2:] == [140, 141]
    for name in ("a", "b"):
        film.write_film(tmp_path / f"{name}.webm", views(record, "robot"))
    assert (tmp_path / "a.webm").read_bytes() == (tmp_path / "b.webm").read_bytes()
    video = cv2.VideoCapture(str(tmp_path / "a.webm"))
    assert video.get(cv2.CAP_PROP_FRAME_COUNT) >= len(ticks)


@pytest.mark.parametrize(
    "suffix",
    [pytest.param(one, marks=pytest.mark.nightly) if one == ".pdf" else one for one in figure_file.SUFFIXES],
)
def test_a_strip_tells_what_happened_and_was_said(
    record: trial_record.TrialRecord, tmp_path: Path, suffix: str
) -> None:
    moments = strip.strip_moments(record, houses.load(TASK.house), "human")
    assert len(moments) == strip.MANY
    made = strip.strip_figure(views(record), moments)
    texts = [text.get_text() for text in made.findobj(Text)]
    for words in ("0.0 s: start", "4.0 s: robot2, message 1", "6.0 s: person accepts", "10.0 s: person picks"):
        assert words in texts
    assert any(text.startswith("robot2: “I saw") for text in texts)
    assert any(text.endswith("…") for text in texts), "long words end in an ellipsis, not in the next view"
    assert "seen by person" in texts[0] + texts[-1] + "\n".join(texts)
    drawn = []
    for name in ("a", "b"):
        figure_file.write_figure(strip.strip_figure(views(record), moments), tmp_path / f"{name}{suffix}")
        drawn.append((tmp_path / f"{name}{suffix}").read_bytes())
    assert drawn[0] == drawn[1]


@pytest.mark.parametrize("seat", ["human", "robot"])
def test_views_of_a_strip_are_not_stretched(record: trial_record.TrialRecord, seat: str) -> None:
    made = strip.strip_figure(views(record, seat), strip.strip_moments(record, houses.load(TASK.house), seat))
    for ax in made.axes:
        box = ax.get_window_extent()
        assert box.width / box.height == pytest.approx(2.5 if seat == "robot" else 1.0, rel=1e-6)


def test_only_seats_of_the_trial_see(record: trial_record.TrialRecord) -> None:
    with pytest.raises(UnknownName, match=r"unknown seat 'human2'\. Did you mean 'human'\? Valid: human, robot"):
        seat_views.check_seat(record, "human2")


class Cameras:
    """A world whose seats have cameras of other shapes."""

    seats, tick = ("human", "robot"), 0

    def camera(self, seat: str) -> Any:
        return type("Camera", (), {"size": (128, 128) if seat == "human" else (160, 104)})

    def frame(self, seat: str, size: tuple[int, int], profile: str) -> Any:
        return lambda: np.zeros((size[1], size[0], 3), np.uint8)

    def reset(self, task: Any, seed: int = 0) -> None: ...


def test_views_have_the_shape_of_the_seats_own_cameras() -> None:
    world = CameraFrames(Cameras(), [0], "fast", ("robot", "human"), 480)
    world.reset(TASK)
    shapes = {seat: picture.shape[:2] for seat, picture in world.views()[0].items()}
    assert shapes == {"human": (480, 480), "robot": (480, 738)}
