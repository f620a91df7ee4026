"""What was on a person's display is drawn as they saw it: in the timeline, below views, beside films."""

from __future__ import annotations

from pathlib import Path

import cv2
import eval_fakes as fakes
import msgspec
import numpy as np
import pytest
from event_fakes import make_event
from matplotlib.figure import Figure

from hthor import houses, tasks
from hthor.episode import EpisodeLog
from hthor.report.drawing import trial_video
from hthor.report.drawing.person_display import panel_picture, timeline_bars
from hthor.report.drawing.person_display.display_pictures import DisplayPictures
from hthor.types import HUMAN
from hthor.types.events import Sent

TRIAL = fakes.run_of(10, name="small")[1][0].trials[0]
TASK = tasks.load_suite("smoke").tasks[0]
SPEC = msgspec.structs.replace(TRIAL, task=TASK)
GREEN = np.full((60, 80, 3), (0, 200, 0), dtype=np.uint8)
EVENTS = (
    (20, "robot", "sent", {"message": 0, "object": "apple", "position": (3.0, 0.0, 0.5)}),
    (40, HUMAN, "accepted", {"message": 0}),
    (60, HUMAN, "displayed", {"what": "map", "on": False, "message": 0}),
    (80, HUMAN, "displayed", {"what": "panel", "on": True, "message": 0}),
)


def log(*events: tuple[int, str, str, dict[str, object]]) -> EpisodeLog:
    made = tuple(make_event(tick, seat, kind, **data) for tick, seat, kind, data in events)
    paths = {HUMAN: [(0, 0, 0)] * 51, "robot": [(1000 + 10 * k, 500, 0) for k in range(51)]}
    return msgspec.structs.replace(fakes.episode(TRIAL), events=made, ticks=100, paths=paths)


def test_panel_and_map_are_drawn_while_they_were_shown() -> None:
    pictures = DisplayPictures(log(*EVENTS), {0: GREEN})
    drawn = [
        (pictures.panel(HUMAN, tick, 240, 160) is not None, pictures.map(HUMAN, tick, 120) is not None)
        for tick in (10, 20, 39, 40, 59, 60, 80)
    ]
    assert drawn == [
        (False, False),
        (True, False),
        (True, False),
        (False, True),
        (False, True),
        (False, False),
        (True, False),
    ]


def test_the_map_of_a_log_follows_its_paths() -> None:
    pictures = DisplayPictures(log(*EVENTS))
    assert (pictures.map(HUMAN, 40, 200) != pictures.map(HUMAN, 58, 200)).any(), "the robot went on"


def test_a_panel_shows_the_picture_of_the_message_and_its_buttons_until_the_answer() -> None:
    pictures = DisplayPictures(log(*EVENTS), {0: GREEN})
    open_, again = pictures.panel(HUMAN, 20, 300, 200), pictures.panel(HUMAN, 80, 300, 200)
    assert open_.shape == again.shape == (200, 300, 3)
    assert ((open_ == (0, 200, 0)).all(axis=2)).sum() > 5000
    foot = slice(175, 195)
    assert (open_[foot] < 128).any(), "A confirm, B decline"
    assert not (again[foot] < 128).any()
    assert not ((DisplayPictures(log(*EVENTS)).panel(HUMAN, 20, 300, 200) == (0, 200, 0)).all(axis=2)).any()


@pytest.mark.parametrize("size", [(400, 130), (160, 60), (240, 240), (120, 300)])
def test_words_of_agents_stay_within_the_panel(size: tuple[int, int]) -> None:
    for text in ("", "$\\frac{1}{$", "W" * 200, "über die Maßen viele Wörter " * 12):
        sent = Sent(tick=0, seat="robot", message=0, text=text)
        for image in (None, GREEN):
            panel = panel_picture.draw_panel(sent, *size, image)
            assert panel.shape == (size[1], size[0], 3)
            assert (panel[:, -3:] == 255).all()


def test_a_strip_and_a_film_have_a_place_for_both() -> None:
    pictures = DisplayPictures(log(*EVENTS), {0: GREEN})
    bare, panel = pictures.strip(HUMAN, 10, 400, 160), pictures.strip(HUMAN, 20, 400, 160)
    assert bare.shape == panel.shape == (160, 400, 3)
    assert (bare[:, :230] != panel[:, :230]).any()
    assert (bare[:, 240:] == panel[:, 240:]).all()
    frame = np.zeros((400, 500, 3), dtype=np.uint8)
    wide = pictures.beside(frame, 45)
    assert wide.shape[0] == 400
    assert wide.shape[1] % 2 == 0, "a film's frames have even sides"
    assert (wide[:, :500] == frame).all()
    assert (wide != pictures.beside(frame, 20)).any()


def test_a_trial_without_messages_is_drawn_as_before() -> None:
    pictures = DisplayPictures(log())
    frame = np.zeros((40, 50, 3), dtype=np.uint8)
    assert pictures.people == ()
    assert pictures.beside(frame, 10) is frame
    assert timeline_bars.legend_entries(log()) == []


def test_the_timeline_has_a_bar_for_each_time() -> None:
    ax = Figure().add_subplot()
    timeline_bars.draw_bars(ax, log(*EVENTS), HUMAN, 0.0)
    timeline_bars.draw_bars(ax, log(*EVENTS), "robot", -1.0)
    bars = sorted(tuple(round(float(x), 1) for x in line.get_xdata()) for line in ax.lines)
    assert bars == [(2.0, 4.0), (4.0, 6.0), (8.0, 10.0)]
    assert [one.get_label() for one in timeline_bars.legend_entries(log(*EVENTS))] == ["panel shown", "map shown"]


def test_a_film_shows_the_display(tmp_path: Path) -> None:
    path = tmp_path / "trial.webm"
    trial_video.write_video(path, SPEC, log(*EVENTS), houses.load(TASK.house))
    film = cv2.VideoCapture(str(path))
    frames = [film.read()[1] for _ in range(51)]
    assert frames[0].shape[1] > 1000
    column = [frame[:, 970:].astype(int) for frame in frames]
    assert np.abs(column[15] - column[2]).max() > 60, "the panel"
    assert np.abs(column[25] - column[2]).max() > 60, "the map"
