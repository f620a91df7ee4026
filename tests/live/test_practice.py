"""The practice before a session: its room, what ticks each step, how it ends, and that nothing of it is kept."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import pytest
from live_client import ScriptedPerson
from live_session import smoke_session
from practice_trials import play_in_practice_room

from hthor.episode import Episode
from hthor.errors import HthorError
from hthor.eval.config.options import EvalOptions
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.runner.progress import Silent
from hthor.houses import load, names
from hthor.live.gltf import house_file
from hthor.live.practice import LOOK_RAD, STEPS, WALK_M, Practice, Progress
from hthor.live.practice_room import APPLE, FILE, FRIDGE, MUG, practice_trial
from hthor.live.run import LiveRun
from hthor.live.seat import LiveSeat
from hthor.live.unfinished import NAME
from hthor.live.wire import PRACTICE
from hthor.tasks.validate import task_faults
from hthor.trials import TrialRunner, form_team
from hthor.types import HUMAN, Action, Close, Drop, Open, Pick, Place, Pose, Reply, Rotate, Show, TrialSpec, Wait
from hthor.types.events import (
    Accepted,
    Closed,
    Declined,
    Displayed,
    Dropped,
    Event,
    Opened,
    Picked,
    Placed,
    Refused,
    Shown,
)
from hthor.world.validation.house_soundness import check_soundness

pytest.importorskip("starlette", reason="live sessions need an optional dependency: pip install 'hthor[live]'")

FASTER = 60.0
ALL = {step.name for step in STEPS}


def trial() -> TrialSpec:
    return practice_trial(smoke_session(form_team(["scout"], ["silent"])).trials[0], (HUMAN,))


# ---- the room


def test_the_room_is_sound_and_no_house_of_the_benchmark():
    room, task = load(FILE), trial().task
    assert [found.rule for found in check_soundness(room)] == ["receptacles-present"], "it is no whole home"
    assert {field for field, _ in task_faults(task, room)} == {"goal"}, "nothing in the room solves it"
    assert room.id not in {*names(), *names("unseen")}


# ---- what ticks a step


def event(kind: type[Event], **fields: Any) -> Event:
    return kind(tick=1, seat=HUMAN, **fields)  # type: ignore[call-arg]


@pytest.mark.parametrize(
    ("events", "ticked"),
    [
        ([event(Picked, object=MUG)], {"pick"}),
        ([event(Opened, thing=FRIDGE)], {"open"}),
        ([event(Opened, thing="counter_top")], set()),
        ([event(Placed, object=APPLE, on=FRIDGE)], {"place"}),
        ([event(Placed, object=APPLE, on="floor")], set()),
        ([event(Closed, thing=FRIDGE)], {"close"}),
        ([event(Closed, thing="counter_top")], set()),
        ([event(Dropped, object=APPLE)], {"drop"}),
        ([event(Shown, message=0, sender="robot"), event(Refused, reason="too far", motion="pick")], set()),
        ([event(Accepted, message=0, sender="robot")], {"confirm"}),
        ([event(Declined, message=0, sender="robot")], {"decline"}),
        ([event(Displayed, what="panel", on=False, message=0)], set()),
        ([event(Displayed, what="panel", on=on, message=0) for on in (False, True)], {"panel"}),
        ([event(Displayed, what="map", on=on, message=0) for on in (False, True)], {"map"}),
        ([event(Displayed, what=what, on=on, message=0) for what, on in (("map", False), ("panel", True))], set()),
    ],
)
def test_an_event_ticks_its_step_and_no_other(events: list[Event], ticked: set[str]):
    progress = Progress()
    for one in events:
        progress.take(one)
    assert progress.done == ticked
    assert {step.name for step in progress.steps if step.done} == ticked


@pytest.mark.parametrize("turn", [1.0, -1.0])
def test_walking_and_looking_are_measured(turn: float):
    progress = Progress()
    for k in range(9):  # to and fro: it is the way that counts, and how far the head comes round
        progress.move(Pose(x=0.24 * (k % 2), y=0.0, yaw=3.0 + 0.5 * turn * (k % 2)))
    assert progress.done == set()
    progress.move(Pose(x=WALK_M / 8, y=0.0, yaw=3.0))
    assert progress.done == {"walk"}
    for part in (0.5, 0.99, 1.01):
        assert "look" not in progress.done
        progress.move(Pose(x=0.0, y=0.0, yaw=math.remainder(3.0 + part * turn * LOOK_RAD, math.tau), head=0.0))
    assert progress.done == {"walk", "look"}


# ---- the practice in its room


def test_everything_can_be_tried_in_the_room():
    spec = trial()
    world = TrialRunner().world(spec)
    practice = Practice({HUMAN: LiveSeat(HUMAN)})
    episode = Episode(spec, world)
    episode.reset()
    episode.attach(practice.watch)
    practice.guide.begin(episode.briefing("robot"))

    def act(action: Action) -> None:
        episode.submit(HUMAN, action)
        while True:
            if "robot" in episode.waiting:
                episode.submit("robot", practice.guide.act(episode.observe("robot")))
            episode.advance()
            if world.idle(HUMAN):
                return

    def go_to(x: float, y: float, facing: tuple[float, float]) -> None:
        """The hands are tried; on the way the body is carried there."""
        world.teleport(HUMAN, Pose(x=x, y=y, yaw=math.atan2(facing[1] - y, facing[0] - x), pitch=-0.4))

    apple = next(one.position for one in spec.task.objects if one.id == APPLE)
    for message, accept in ((0, True), (1, False)):
        while not any(one.kind == "sent" and one.message == message for one in episode.events):  # type: ignore[union-attr]
            act(Action(motion=Wait()))
        act(Action(signals=(Show(what="panel", on=False),)))
        act(Action(signals=(Show(what="panel"),)))
        act(Action(say=Reply(message=message, accept=accept)))
    act(Action(signals=(Show(what="map", on=False),)))
    act(Action(signals=(Show(what="map"),)))
    act(Action(motion=Rotate(yaw=math.pi)))
    for _ in range(40):
        act(Action(motion=Wait()))
    assert [one.to for one in episode.events if one.kind == "sent"] == [HUMAN, HUMAN]  # type: ignore[union-attr]
    go_to(apple[0] - 0.2, 0.9, apple[:2])
    act(Action(motion=Pick(object=APPLE)))
    go_to(0.95, 2.9, (0.95, 3.98))
    for hands in (Open(thing=FRIDGE), Place(on=FRIDGE), Pick(object=APPLE), Close(thing=FRIDGE), Drop()):
        act(Action(motion=hands))
    assert practice.progress[HUMAN].done == ALL
    assert practice.over
    assert not episode.done


# ---- in a session


@pytest.fixture
def no_looks(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(house_file, "_make", lambda *_: b"")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))


@contextmanager
def playing(folder: Path, *, practice: bool = True, **options: Any) -> Iterator[LiveRun]:
    """A run that is played in a thread, without robots."""
    chosen = {"agent": ("none",), "humans": ("live",), "suite": "smoke", "limit": 1, "out": folder, **options}
    run = LiveRun(
        EvalOptions(**chosen),
        page=False,
        practice=practice,
        now=lambda: FASTER * time.perf_counter(),
        sleep=lambda seconds: time.sleep(seconds / FASTER),
    )

    def play() -> None:
        with suppress(HthorError):  # some sessions are ended before their end
            run.play(lambda _: Silent())

    with run:
        thread = threading.Thread(target=play)
        thread.start()
        yield run
        thread.join(60.0)


def announced(person: ScriptedPerson) -> list[int]:
    return [one["trial"] for one in person.received if one["type"] == "trial"]


def person_at(run: LiveRun, seat: str = HUMAN) -> ScriptedPerson:
    """Somebody who stands still."""
    return ScriptedPerson(run.server.address, run.server.tokens[seat], steers=False)


def play_session(run: LiveRun, trials: int) -> list[int]:
    """Skip each practice and stand still in each trial; the numbers of what was announced, to the end of the run."""
    with person_at(run) as person:
        for count in range(1, trials + 1):
            person.wait_until(lambda count=count: len(announced(person)) >= count)  # type: ignore[misc]
            number = announced(person)[-1]
            person.send({"type": "skip" if number == PRACTICE else "begin", "trial": number})
        person.wait_for("over")
        return announced(person)


@pytest.fixture
def short(monkeypatch: pytest.MonkeyPatch) -> None:
    """Trials of two seconds in the room of the practice, so that no other world is built."""
    play_in_practice_room(monkeypatch, 2.0)


def test_every_participant_practises_and_nothing_of_it_is_in_the_run(tmp_path: Path, no_looks: None, short: None):
    with playing(tmp_path / "with", participants=2) as run:
        assert play_session(run, 4) == [PRACTICE, 0, PRACTICE, 0]
    with playing(tmp_path / "without", participants=2, practice=False) as run:
        assert play_session(run, 2) == [0, 0]
    with_, without = (RunFolder(tmp_path / name).attempts() for name in ("with", "without"))
    assert [one.key for one in with_] == [one.key for one in without]
    assert [(one.log.events, one.log.paths) for one in with_] == [(one.log.events, one.log.paths) for one in without]


def test_a_session_that_goes_on_begins_without_a_practice(tmp_path: Path, no_looks: None, short: None):
    with playing(tmp_path / "run", limit=2) as run, person_at(run) as person:
        person.wait_for("trial")
        person.send({"type": "skip", "trial": PRACTICE})
        person.wait_until(lambda: announced(person) == [PRACTICE, 0])
        assert not (tmp_path / "run" / NAME).exists(), "an unfinished practice is not kept"
        person.send({"type": "begin", "trial": 0})
        person.wait_for("began", trial=0)
        run.control.draining = True  # it is finished, and the next one does not begin
    with playing(tmp_path / "run", limit=2) as run:
        assert play_session(run, 1) == [1]


def test_a_practice_waits_for_everybody(tmp_path: Path, no_looks: None):
    with (
        playing(tmp_path / "run", humans=("live,live",), kind="collect", suite=None) as run,
        person_at(run) as one,
        person_at(run, "human2") as other,
    ):
        for person in (one, other):
            person.wait_for("trial", trial=PRACTICE)
        other.send({"type": "begin", "trial": PRACTICE})
        one.send({"type": "skip", "trial": PRACTICE})
        one.wait_for("steps", skipped=True)
        other.wait_until(lambda: other.frames and other.frames[-1].tick > 30)
        other.act(say={"type": "reply", "message": 1, "accept": True})  # 0 is for the other person
        other.wait_until(lambda: "confirm" in ticked(other))
        assert ticked(one) == set()
        assert other.last("ended") is None
        other.send({"type": "skip", "trial": PRACTICE})
        for person in (one, other):
            assert not person.wait_for("ended", trial=PRACTICE)["rate"]
            person.wait_for("trial", trial=0)
        run.control.stop()


def ticked(person: ScriptedPerson) -> set[str]:
    steps = person.last("steps")
    assert steps is not None
    return {one["name"] for one in steps["steps"] if one["done"]}
