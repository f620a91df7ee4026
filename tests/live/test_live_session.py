"""A live session: a person at a page, here a scripted one, takes part in trials through the server."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from live_client import fetch
from live_session import LiveSession
from websockets.exceptions import InvalidStatus

from hthor.episode import EpisodeLog, play
from hthor.humans.core.recorded_inputs import RecordedInputs
from hthor.live.gltf.house_file import HouseFile
from hthor.live.loop import ABSENT_S
from hthor.trials import TrialRunner
from hthor.types import HUMAN, Controls
from hthor.types.events import Accepted, Acted, Inputs, Note

pytest.importorskip("starlette", reason="live sessions need an optional dependency: pip install 'hthor[live]'")


@pytest.fixture
def live(tmp_path: Path) -> Iterator[LiveSession]:
    made = LiveSession(tmp_path)
    yield made
    made.close()


def test_a_person_walks_answers_and_rates(live: LiveSession) -> None:
    with live.person() as person:
        ahead = person.wait_for("trial")
        assert ahead["instruction"]
        person.drive(forward=0.5, yaw=1.0)
        person.send({"type": "begin", "trial": 0})
        person.wait_for("began")
        panel = person.wait_for("panel", message=0)
        person.act(say={"type": "reply", "message": 0, "accept": True})
        person.wait_for("acknowledged", act=1)
        ended = person.wait_for("ended")
        assert ended["rate"]
        person.send({"type": "rate", "trial": 0, "value": 6})
        log = live.log()
    assert panel["text"] == "It is over there."
    assert panel["picture"]
    assert person.pictures[0][:2] == b"\xff\xd8"
    assert person.last("panel")["message"] is None
    assert person.last("map")["map"]["bodies"]
    assert log.ratings == {HUMAN: 6}
    kinds = {type(entry) for entry in log.journal}
    assert {Inputs, Acted, Note} <= kinds
    (accepted,) = [event for event in log.events if isinstance(event, Accepted)]
    assert accepted.message == 0
    (note,) = [entry for entry in log.journal if isinstance(entry, Note)]
    assert note.topic == "real time"


def test_a_live_trial_is_repeated_from_its_log(live: LiveSession) -> None:
    with live.person() as person:
        person.wait_for("trial")
        person.send({"type": "begin", "trial": 0})
        for k in range(30):
            person.drive(forward=0.6, left=0.02 * k, yaw=0.2 * k, pitch=-0.01 * k)
            person.changed.acquire()
            person.changed.wait(0.1)
            person.changed.release()
        person.wait_for("panel", message=0)
        person.act(say={"type": "reply", "message": 0, "accept": False})
        person.wait_for("ended")
        person.send({"type": "rate", "trial": 0, "value": 2})
        log = live.log()
    spec = live.session.trials[0]
    world = TrialRunner().world(spec)
    again = play(spec, world, {HUMAN: Again(HUMAN, log)}, {"robot": Again("robot", log)})
    assert again.events == log.events
    assert again.paths == log.paths


def test_a_trial_waits_for_a_page_that_is_gone_and_goes_on_when_it_is_back(tmp_path: Path) -> None:
    live = LiveSession(tmp_path, seconds=8.0)
    try:
        with live.person() as person:
            person.wait_for("trial")
            person.send({"type": "begin", "trial": 0})
            person.wait_for("panel", message=0)
            number = person.act(say={"type": "reply", "message": 0, "accept": True})
            person.wait_for("acknowledged", act=number)
        assert live.seat.absent_s() > 0.0
        live.wait_until(lambda: live.seat.absent_s() > ABSENT_S + 0.5)
        with live.person() as person:
            welcome = person.wait_for("welcome")
            assert welcome["acts"] == 1, "the page goes on counting"
            assert person.wait_for("trial")["trial"] == 0
            person.send({"type": "act", "number": 1, "say": {"type": "reply", "message": 0, "accept": False}})
            person.wait_for("acknowledged", act=1)
            person.wait_for("ended")
            person.send({"type": "rate", "trial": 0, "value": 7})
            log = live.log()
    finally:
        live.close()
    kinds = [event.kind for event in log.events]
    assert kinds.count("paused") == kinds.count("resumed") == 1
    assert kinds.count("accepted") == 1
    assert "declined" not in kinds
    assert log.ratings == {HUMAN: 7}
    assert log.ticks == 80


def test_what_is_no_message_has_no_effect(live: LiveSession, caplog: pytest.LogCaptureFixture) -> None:
    with live.person() as person:
        person.wait_for("trial")
        person.send({"type": "begin", "trial": 0})
        person.wait_for("began")
        junk = [
            "",
            "{",
            "[]",
            "null",
            "{}",
            "7",
            '{"type": "join", "token": "x"}',
            '{"type": "rate", "trial": 0, "value": 9}',
        ]
        junk += ['{"type": "act"}', '{"type": "act", "number": 1, "motion": {"type": "drive"}}', "x" * 1000]
        for one in junk:
            person.socket.send(one)
        for data in (b"", b"\x01", b"\x02" * 21, b"\x01" + b"\xff" * 20, b"\x00" * 500):
            person.socket.send(data)
        person.wait_for("ended")
        person.send({"type": "rate", "trial": 0, "value": 4})
        log = live.log()
    assert len([one for one in caplog.records if one.name == "hthor.live"]) == len(junk) + 5
    assert not any(isinstance(entry, Acted) and entry.seat == HUMAN for entry in log.journal)
    assert log.ratings == {HUMAN: 4}


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"token": "guess"}, "belongs to no seat"),
        ({"token": "Schlüssel"}, "belongs to no seat"),
        ({"version": "hthor.live.0"}, "this server speaks hthor.live.2, the page hthor.live.0"),
    ],
)
def test_who_does_not_belong_here_is_told_so(live: LiveSession, changes: dict[str, str], words: str) -> None:
    with live.person(**changes) as person:
        assert words in person.wait_for("problem")["words"]


@pytest.mark.parametrize("origin", ["http://evil.example", "http://127.0.0.1:1", "null"])
def test_pages_of_other_sites_are_refused(live: LiveSession, origin: str) -> None:
    with pytest.raises(InvalidStatus, match="403"), live.person(origin=origin):
        pass


def test_the_files_of_the_last_houses_are_served(live: LiveSession) -> None:
    paths = [live.server.publish(HouseFile(f"house{number}", b"glTF")) for number in range(6)]
    assert [fetch(live.server.address, path)[0] for path in paths] == [404, 404, 200, 200, 200, 200]
    live.server.publish(HouseFile("house2", b"glTF"))
    live.server.publish(HouseFile("house6", b"glTF"))
    assert [fetch(live.server.address, path)[0] for path in paths] == [404, 404, 200, 404, 200, 200]


class Again:
    """Repeats the inputs of one seat."""

    def __init__(self, seat: str, log: EpisodeLog) -> None:
        self.inputs = RecordedInputs(seat, log.events, log.journal, log.ticks)

    def begin(self, briefing: Any) -> None:
        """Nothing to prepare."""

    def frame(self, controls: Controls) -> None:
        self.inputs.frame(controls)

    def rate(self, met: bool, tick: int) -> int | None:
        return 2
