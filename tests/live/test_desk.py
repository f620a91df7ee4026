"""The experimenter's desk: what it shows, and what it does to a session."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from live_client import ScriptedPerson
from live_session import LiveSession

from hthor.types import HUMAN

pytest.importorskip("starlette", reason="live sessions need an optional dependency: pip install 'hthor[live]'")


@pytest.fixture
def live(tmp_path: Path) -> Iterator[LiveSession]:
    made = LiveSession(tmp_path, seconds=6.0)
    yield made
    made.close()


def desk_of(live: LiveSession) -> ScriptedPerson:
    return live.person(token=live.server.desk_url.partition("#")[2], steers=False)


def begin(person: ScriptedPerson) -> None:
    person.wait_for("trial")
    person.send({"type": "begin", "trial": 0})
    person.wait_for("began")


def test_the_desk_shows_the_house_the_people_and_what_happens(live: LiveSession) -> None:
    with desk_of(live) as desk, live.person() as person:
        plan = desk.wait_for("plan")
        assert plan["seats"] == [HUMAN, "robot"]
        assert len(plan["rooms"]) > 1
        begin(person)
        person.send({"type": "ping", "sent": 1.0, "frames": 58.6, "round_trip": 0.012})
        desk.wait_for("happened", kind="sent")
        desk.wait_until(lambda: _person(desk)["frames"] == 59)
        assert _person(desk)["round_trip_ms"] == 12
        assert _person(desk)["away_s"] == 0.0
        person.act(say={"type": "reply", "message": 0, "accept": True})
        desk.wait_for("happened", kind="accepted")
        with desk_of(live) as later:
            later.wait_for("happened", kind="accepted")
            assert [one["kind"] for one in later.received if one["type"] == "happened"][:1] == ["sent"]


def _person(desk: ScriptedPerson) -> dict[str, Any]:
    watch = desk.last("watch")
    return watch["people"][0] if watch else {"frames": None}


def test_time_stands_still_while_the_experimenter_pauses_it(live: LiveSession) -> None:
    with desk_of(live) as desk, live.person() as person:
        begin(person)
        desk.wait_for("watch", tick=4)
        desk.send({"type": "pause", "reason": "the phone rings"})
        assert person.wait_for("paused", reason="the phone rings")
        desk.wait_for("watch", paused="the phone rings")
        desk.send({"type": "go_on"})
        person.wait_for("paused", reason="")
        person.wait_for("ended")
        person.send({"type": "rate", "trial": 0, "value": 4})
        log = live.log()
    assert [event.kind for event in log.events if event.kind in ("paused", "resumed")] == ["paused", "resumed"]
    assert log.ticks == 60


def test_a_trial_is_voided_with_a_reason_only(live: LiveSession) -> None:
    with desk_of(live) as desk, live.person() as person:
        begin(person)
        desk.send({"type": "void", "reason": " "})
        assert "write one" in desk.wait_for("refused")["words"]
        desk.send({"type": "pause"})
        desk.wait_for("watch", paused="the experimenter paused the trial")
        desk.send({"type": "void", "reason": "a cable came loose"})
        ended = person.wait_for("ended")
        log = live.log()
    assert ended["voided"] == log.voided == "a cable came loose"
    assert not ended["rate"]
    assert log.ratings == {}


def test_corrections_reach_the_log_or_are_refused(live: LiveSession) -> None:
    command = {"type": "adoption", "trial": "0123", "seat": HUMAN, "adopted": None, "reason": ""}
    with desk_of(live) as desk:
        desk.send(command)
        assert "needs a reason" in desk.wait_for("refused")["words"]
        desk.send({**command, "reason": "pressed the wrong button"})
        live.wait_until(lambda: live.book.corrections == [("0123", HUMAN, None, "pressed the wrong button")])


def test_somebody_at_a_seat_cannot_do_what_the_experimenter_does(live: LiveSession) -> None:
    with live.person() as person:
        begin(person)
        person.send({"type": "void", "reason": "I do not like it"})
        person.send({"type": "pause"})
        person.wait_for("ended")
        person.send({"type": "rate", "trial": 0, "value": 4})
        log = live.log()
    assert not log.voided
    assert not any(event.kind == "paused" for event in log.events)
