"""Pictures of trials name what a reader needs; how they look is for eyes."""

from __future__ import annotations

from pathlib import Path

import cv2
import pytest
from matplotlib.text import Text

from hthor import houses, tasks
from hthor.episode import EpisodeLog
from hthor.eval import picture, video
from hthor.types import AgentRef, Event, RobotSeat, TrialSpec

TASK = next(task for task in tasks.suite("smoke").tasks if task.kind == "mobile_manipulation")


@pytest.fixture(scope="module")
def spec() -> TrialSpec:
    agent = AgentRef(name="helper", source="helper.py", sha256="0")
    return TrialSpec(
        task=TASK,
        robots=(RobotSeat(seat="robot", robot="scout", agent=agent),),
        human="proxy",
        human_sha256="0",
        participant=0,
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
        Event(tick=40, seat="robot", kind="sent", data={"message": 0, "text": "Here.", "position": claim}),
        Event(tick=60, seat="human", kind="declined", data={"message": 0}),
        Event(tick=80, seat="robot", kind="sent", data={"message": 1, "text": "Here!", "position": None}),
        Event(tick=95, seat="human", kind="confirmed", data={"message": 1}),
        Event(tick=120, seat="human", kind="picked", data={"object": TASK.goal.target}),
        Event(tick=140, seat="human", kind="placed", data={"object": TASK.goal.target, "on": "x"}),
        Event(tick=141, seat="human", kind="success"),
    ]
    walk = [(1000 + 20 * step, 2000 + 10 * step, 400) for step in range(71)]
    paths = {"human": walk, "robot": [(x + 500, y, yaw) for x, y, yaw in walk]}
    return EpisodeLog(events=tuple(events), paths=paths, ticks=141, met=True, trust=5, faults=())


def test_a_picture_names_rooms_target_times_and_messages(spec: TrialSpec, log: EpisodeLog) -> None:
    house = houses.load(TASK.house)
    sheet = picture.figure(spec, log, house)
    texts = [text.get_text() for text in sheet.findobj(Text)]
    for room in house.rooms:
        assert room.name in texts
    for words in ("1", "2", "T*", "done", "confirms", "declines", "picks", "places", "1 m"):
        assert words in texts, words
    told = "\n".join(texts)
    for words in (TASK.instruction, "helper", "14.1 s", "person", "scout (helper)", "destination"):
        assert words in told, words


def test_a_film_lasts_as_long_as_the_trial(spec: TrialSpec, log: EpisodeLog, tmp_path: Path) -> None:
    path = tmp_path / "film.mp4"
    video.write(path, spec, log, houses.load(TASK.house))
    film = cv2.VideoCapture(str(path))
    seconds = film.get(cv2.CAP_PROP_FRAME_COUNT) / film.get(cv2.CAP_PROP_FPS)
    assert seconds == pytest.approx(14.1 / video.SPEED + video.HOLD_S, abs=0.1)
