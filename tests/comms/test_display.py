"""The display of a person: what opens and closes it, what its map shows, and that a log tells it all."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from law_cases import cases

from hthor.comms import display, map_picture
from hthor.comms.display import PARTS, Displays, DisplayState
from hthor.comms.display_contents import relative_map
from hthor.types import HUMAN, DisplayMap, MapBody, MapPlace, Pose, Show
from hthor.types.events import Accepted, Answered, Covered, Declined, Displayed, Event, Refused, Sent, Shown


def sent(message: int, tick: int = 0, seat: str = "robot", thing: str = "apple", **more: object) -> Sent:
    return Sent(tick=tick, seat=seat, message=message, text="here", object=thing, **more)  # type: ignore[arg-type]


def accepted(message: int, tick: int = 0, seat: str = HUMAN) -> Accepted:
    return Accepted(tick=tick, seat=seat, message=message, sender="robot")


def after(*events: Event, seat: str = HUMAN) -> DisplayState:
    return display.state_at(events, seat, 10**9)


def test_a_message_opens_the_panel_and_the_answer_closes_it() -> None:
    assert after().on == {"panel": False, "map": False}
    state = after(sent(0))
    assert state.message is not None
    assert (state.message.message, state.on) == (0, {"panel": True, "map": False})
    assert after(sent(0), accepted(0)).on == {"panel": False, "map": True}
    declined = Declined(tick=0, seat=HUMAN, message=0, sender="robot")
    assert after(sent(0), declined).on == {"panel": False, "map": False}


def test_a_newer_message_covers_the_panel_though_it_was_hidden() -> None:
    hidden = Displayed(tick=1, seat=HUMAN, what="panel", on=False, message=0)
    covered = Covered(tick=2, seat="robot", message=0, sender="robot", by=1)
    state = after(sent(0), hidden, covered, sent(1))
    assert state.message is not None
    assert (state.message.message, state.on["panel"]) == (1, True)
    assert not after(sent(0), accepted(0), Shown(tick=1, seat=HUMAN, message=0, sender="robot")).on["panel"]


def test_a_question_has_a_panel_and_no_map() -> None:
    answered = Answered(tick=1, seat=HUMAN, message=0, sender="robot", yes=True)
    assert after(sent(0, question=True), answered).on == {"panel": False, "map": False}


def test_only_what_is_for_a_person_is_on_their_display() -> None:
    both = (sent(0, to="human2"), accepted(0, seat="human2"))
    assert after(*both).message is None
    assert after(*both, seat="human2").on["map"]
    assert after(sent(0, seat=HUMAN), sent(1, seat=HUMAN)).message is None, "nobody reads their own words"


def test_the_map_keeps_the_newest_place_of_each_thing() -> None:
    events = [sent(0), accepted(0), sent(1, thing="mug"), accepted(1), sent(2), accepted(2), sent(3, seat="robot2")]
    assert [one.message for one in after(*events).confirmed] == [1, 2]
    assert [one.message for one in after(*events, accepted(3)).confirmed] == [1, 2, 3]


def test_what_is_not_there_cannot_be_shown() -> None:
    for what, words in (("panel", "no message has come yet"), ("map", "no message was confirmed yet")):
        for on in (True, False):
            (event,) = after().show(7, Show(what=what, on=on))  # type: ignore[arg-type]
            assert isinstance(event, Refused)
            assert words in event.reason
    (event,) = Displays((HUMAN,), ()).show(7, "robot", Show(what="map"))
    assert isinstance(event, Refused)
    assert "only people" in event.reason
    for show in (Show(what="radio"), Show(what="map", on=2)):  # type: ignore[arg-type]
        (event,) = after(sent(0), accepted(0)).show(7, show)
        assert isinstance(event, Refused)


def test_showing_what_is_shown_changes_nothing() -> None:
    state = after(sent(0), accepted(0))
    assert state.show(1, Show(what="map")) == ()
    assert state.show(1, Show(what="panel", on=False)) == ()
    assert state.show(1, Show(what="map", on=False)) == (
        Displayed(tick=1, seat=HUMAN, what="map", on=False, message=0),
    )


STEPS = st.lists(st.tuples(st.sampled_from(["send", "yes", "no", *PARTS]), st.integers(0, 3)), max_size=40)


def course(steps: list[tuple[str, int]]) -> list[Event]:
    """Events of a trial in which these things happen, with pauses [ticks] between them, as the display lets them."""
    events: list[Event] = []
    displays, tick, count, open_ = Displays((HUMAN,), events), 0, 0, -1
    for step, pause in steps:
        tick += pause
        if step == "send":
            events.append(sent(count, tick))
            count, open_ = count + 1, count
        elif step in PARTS:
            state = displays.state(HUMAN)
            assert state is not None
            events += displays.show(tick, HUMAN, Show(what=step, on=not state.on[step]))  # type: ignore[index,arg-type]
        elif open_ >= 0:
            kind = Accepted if step == "yes" else Declined
            events.append(kind(tick=tick, seat=HUMAN, message=open_, sender="robot"))
            open_ = -1
    return events


@settings(max_examples=cases(80))
@given(STEPS)
def test_a_log_tells_what_was_shown_at_every_tick(steps: list[tuple[str, int]]) -> None:
    events = course(steps)
    end = max((event.tick for event in events), default=0) + 5
    spans = display.shown_spans(events, HUMAN, end)
    for part in PARTS:
        seen = [display.state_at(events, HUMAN, tick).on[part] for tick in range(end)]
        assert sum(last - first for first, last in spans[part]) == sum(seen)
        assert all(seen[tick] for first, last in spans[part] for tick in range(first, last))
    whole = Displays((HUMAN,), events).state(HUMAN)
    assert whole is not None
    assert whole.on == display.state_at(events, HUMAN, end).on


# ------------------------------------------------------------------------------------------------------------- the map


@given(st.floats(-10, 10), st.floats(-10, 10), st.floats(-7, 7), st.floats(-1, 1), st.floats(0.1, 20), st.floats(-3, 3))
def test_the_map_is_seen_from_the_persons_head(
    x: float, y: float, yaw: float, head: float, far: float, bearing: float
) -> None:
    """A thing at a bearing from the head and a distance is there on the map, wherever the person stands."""
    me, way = Pose(x=x, y=y, yaw=yaw, head=head), yaw + head + bearing
    there = (x + far * math.cos(way), y + far * math.sin(way))
    poses = {HUMAN: me, "robot": Pose(x=there[0], y=there[1])}
    shown = relative_map(me, (sent(0, position=(*there, 0.8)), sent(1, thing="mug")), poses.__getitem__)
    (body,), (place,) = shown.bodies, shown.places
    assert (body.forward, body.left) == pytest.approx((far * math.cos(bearing), far * math.sin(bearing)), abs=2e-3)
    assert (place.forward, place.left, place.message) == (body.forward, body.left, 0)


def middle_of(picture: np.ndarray, shade: tuple[int, int, int]) -> tuple[float, float]:
    """Mean row and column of the pixels of a colour, from the middle of the picture, in shares of its side."""
    rows, columns = np.nonzero((np.abs(picture.astype(int) - shade) < 12).all(axis=2))
    assert len(rows) > 10
    return rows.mean() / len(picture) - 0.5, columns.mean() / len(picture) - 0.5


@settings(max_examples=cases(15))
@given(st.floats(0.8, 25.0), st.floats(-math.pi, math.pi))
def test_the_picture_has_bodies_in_their_direction_and_in_the_right_order_of_distance(far: float, way: float) -> None:
    ahead, left = far * math.cos(way), far * math.sin(way)
    near = MapBody(seat="robot", forward=ahead / 2, left=left / 2)
    shown = DisplayMap(bodies=(near,), places=(MapPlace(message=0, sender="robot", forward=ahead, left=left),))
    picture = map_picture.draw_map(shown, 400, {"robot": (0, 255, 0)}, (255, 0, 255))
    assert picture.shape == (400, 400, 3)
    assert picture.dtype == np.uint8
    row, column = middle_of(picture, (255, 0, 255))
    assert math.hypot(row, column) < 0.03, "the person is in the middle"
    row, column = middle_of(picture, (0, 255, 0))  # its name, below it, has the same colour
    assert column == pytest.approx(-0.4 * left / 2 / next(m for m in (4, 8, 16, 32) if far <= m), abs=0.03)
    assert np.array_equal(picture, map_picture.draw_map(shown, 400, {"robot": (0, 255, 0)}, (255, 0, 255)))


def test_a_map_of_nothing_and_a_place_beyond_every_ring_can_be_drawn() -> None:
    assert map_picture.draw_map(DisplayMap(), 40).shape == (40, 40, 3)
    far = MapPlace(message=0, sender="robot", forward=900.0, left=0.0)
    picture = map_picture.draw_map(DisplayMap(places=(far, far)), 200)
    row, column = middle_of(picture, (122, 59, 143))
    assert -0.46 < row < -0.36, "it stands on the outer ring"
    assert abs(column) < 0.06
