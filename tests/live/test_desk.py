"""The experimenter's desk: what it shows, and what it does to a session."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from live_client import ScriptedPerson
from live_session import LiveSession

from hthor.types import HUMAN
from hthor.types.events import Displayed, Note

pytest.importorskip("starlette", reason="live sessions need an optional dependency: pip install 'hthor[live]'")


ROW = b"\0" * 14


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
        desk.wait_for_event("sent")
        desk.wait_until(lambda: _person(desk)["frames"] == 59)
        assert _person(desk)["round_trip_ms"] == 12
        assert _person(desk)["away_s"] == 0.0
        person.act(say={"type": "reply", "message": 0, "accept": True})
        desk.wait_for_event("accepted")
        with desk_of(live) as later:
            later.wait_for_event("accepted")
            later.wait_for("watch")
            assert later.event_kinds[:1] == ["sent"]
            (ways,) = [one["ways"] for one in later.received if one["type"] == "ways"]
            first = next(one for one in desk.received if one["type"] == "watch")["people"]
            assert [ways[one["seat"]][0] for one in first] == [[one["x"], one["y"]] for one in first]


def _person(desk: ScriptedPerson) -> dict[str, Any]:
    watch = desk.last("watch")
    return watch["people"][0] if watch else {"frames": None}


def test_a_page_that_joins_late_gets_a_long_trial_whole(live: LiveSession) -> None:
    with desk_of(live) as desk, live.person() as person:
        begin(person)
        desk.wait_for("watch")
        shown = Displayed(tick=1, seat=HUMAN, what="map", on=True, message=0)
        live.desk._note(None, [shown] * 700)  # type: ignore[arg-type]
        with desk_of(live) as later:
            later.wait_for("played")
            assert later.event_kinds.count("displayed") == 700
            later.wait_for("watch")


def test_a_trial_waits_for_the_experimenter(tmp_path: Path) -> None:
    live = LiveSession(tmp_path, seconds=1.0, experimenter_starts=True)
    try:
        with desk_of(live) as desk:
            assert desk.wait_for("plan")["starts"]
            desk.wait_for("gathering", missing=[HUMAN], ready=[])
            desk.send({"type": "start"})
            assert "human: not ready yet" in desk.wait_for("refused")["words"]
            with live.person() as person:
                person.wait_for("trial")
                person.send({"type": "begin", "trial": 0})
                desk.wait_for("gathering", missing=[], ready=[HUMAN])
                desk.wait_until(lambda: _person(desk).get("away_s") == 0.0)
                assert person.last("began") is None
                with desk_of(live) as later:
                    later.wait_for("gathering", missing=[], ready=[HUMAN])
                desk.send({"type": "start"})
                person.wait_for("began")
                person.wait_for("ended")
                person.send({"type": "rate", "trial": 0, "value": 4})
                assert live.log().ticks == 10
            desk.wait_for("trial_over", voided="")
            desk.send({"type": "void", "reason": "too late"})
            desk.wait_for("refused", words="no trial is going on; one that is over is voided in the list of trials.")
            desk.received.clear()
            desk.send({"type": "start"})
            assert "no trial waits" in desk.wait_for("refused")["words"]
    finally:
        live.close()


def test_a_page_that_looks_gets_where_everything_is_and_no_other_page_does(live: LiveSession) -> None:
    with desk_of(live) as desk, desk_of(live) as other, live.person() as person:
        begin(person)
        live.desk.show_frame(0, 0, {3: ROW, 4: ROW})
        desk.send({"type": "look", "on": True})
        desk.wait_until(lambda: desk.places.keys() >= {3, 4})
        live.desk.show_frame(1, 0, {5: ROW})
        desk.wait_until(lambda: 5 in desk.places)
        desk.send({"type": "look", "on": False})
        desk.send({"type": "void", "reason": ""})
        desk.wait_for("refused")  # so the page looks no longer
        live.desk.show_frame(2, 0, {6: ROW})
        desk.send({"type": "look", "on": True})
        desk.wait_until(lambda: 6 in desk.places)
        other.wait_for("watch", tick=4)
    assert other.frames == []


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


def test_a_trial_that_is_over_is_voided_and_repeated_with_a_reason_only(live: LiveSession) -> None:
    with desk_of(live) as desk:
        desk.send({"type": "repeat", "trial": "0123", "reason": ""})
        assert "needs a reason" in desk.wait_for("refused")["words"]
        desk.send({"type": "repeat", "trial": "0123", "reason": "a cable came loose"})
        live.wait_until(lambda: live.book.repeated == [("0123", "a cable came loose")])


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


def test_the_experimenter_asks_for_vr_and_sees_who_is_in_it(live: LiveSession) -> None:
    with desk_of(live) as desk:
        desk.wait_for("headset_asked", on=False)
        with live.person() as person:
            begin(person)
            desk.wait_until(lambda: _person(desk).get("vr") is False)
            desk.send({"type": "ask_for_headset", "on": True})
            for page in (person, desk):
                page.wait_for("headset_asked", on=True)
        with desk_of(live) as later, live.person() as again:
            for page in (later, again):
                page.wait_for("headset_asked", on=True)
            again.send({"type": "ping", "sent": 1.0, "vr": True})
            desk.wait_until(lambda: _person(desk).get("vr") is True)
            again.wait_for("ended")
            again.send({"type": "rate", "trial": 0, "value": 4})
            log = live.log()
    (share,) = [one.values["share"] for one in log.journal if isinstance(one, Note) and one.topic == "in VR"]
    assert 0.0 < float(share) < 1.0
