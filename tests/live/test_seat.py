"""A person's seat without a server: what their page sent, and what the trial makes of it."""

from __future__ import annotations

from collections.abc import Mapping

from hypothesis import given
from hypothesis import strategies as st

from hthor.live import wire
from hthor.live.seat import HANGS_S, STALE_S, LiveSeat
from hthor.live.wire import Act, FrameHead, Steering, ToPage
from hthor.types import HUMAN, Action, Drive, Drop, Observation, Pose

BODY = wire.Body(seat=HUMAN, name="person", radius=0.2, height=1.7, eye=1.6, reach=0.8, speed=1.0, turn_rate=2.0)
AHEAD = wire.TrialAhead(trial=0, trials=1, house="elm", instruction="?", time_limit=9.0, bodies=(BODY,))


class Clock:
    def __init__(self) -> None:
        self.time = 0.0

    def __call__(self) -> float:
        return self.time


class Person:
    """The controls of a step, and what was done with them."""

    def __init__(self) -> None:
        self.tick, self.step = 0, 1
        self.steered: list[Drive] = []
        self.submitted: list[Action] = []

    def observe(self) -> Observation:
        raise AssertionError("a person looks in the first step only")

    def submit(self, action: Action) -> None:
        self.submitted.append(action)

    def steer(self, drive: Drive) -> None:
        self.steered.append(drive)


class Screen:
    """A page that keeps what it is sent."""

    def __init__(self) -> None:
        self.messages: list[ToPage] = []
        self.places: dict[int, bytes] = {}
        self.heads: list[FrameHead] = []

    def send(self, message: ToPage) -> None:
        self.messages.append(message)

    def send_picture(self, message: int, jpeg: bytes) -> None:
        raise AssertionError("no message has a picture")

    def show(self, head: FrameHead, moved: Mapping[int, bytes]) -> None:
        self.heads.append(head)
        self.places.update(moved)


def test_somebody_whose_page_is_silent_stands_still_and_looks_where_they_looked() -> None:
    clock, person = Clock(), Person()
    seat = LiveSeat(HUMAN, clock)
    seat.steer(Steering(1, Drive(forward=0.7, yaw=1.0, pitch=-0.2)))
    clock.time = STALE_S - 0.01
    seat.frame(person)
    assert person.steered[-1].forward == 0.7
    clock.time = STALE_S + 0.01
    seat.frame(person)
    assert person.steered[-1] == Drive(yaw=1.0, pitch=-0.2)
    seat.steer(Steering(2, Drive(forward=0.5)))
    seat.frame(person)
    assert person.steered[-1] == Drive(forward=0.5)


@given(sent=st.lists(st.integers(1, 6), max_size=30))
def test_every_act_is_carried_out_once_and_in_order_however_often_it_is_sent(sent: list[int]) -> None:
    seat, person, screen = LiveSeat(HUMAN, Clock()), Person(), Screen()
    seat.join(screen)
    expected = 0
    for number in sent:
        seat.act(Act(number=number, motion=Drop()))
        expected += number == expected + 1
        last = screen.messages[-1]
        assert isinstance(last, wire.Acknowledged)
        assert last.act == expected
    seat.frame(person)
    assert len(person.submitted) == expected


def test_nobody_is_ready_for_a_trial_that_is_repeated_because_they_were_for_the_first_attempt() -> None:
    seat, screen = LiveSeat(HUMAN, Clock()), Screen()
    seat.join(screen)
    for value in (3, 6):
        seat.open(AHEAD)
        assert not seat.is_ready
        seat.begin_trial(1)
        assert not seat.is_ready, "for another trial"
        seat.begin_trial(0)
        assert seat.is_ready
        seat.rate(0, value)
        seat.rate(0, 1)
        assert seat.ask_rating() == value


def test_a_page_that_joins_later_gets_what_the_screen_shows_and_where_everything_is() -> None:
    seat = LiveSeat(HUMAN, Clock())
    seat.open(AHEAD)
    seat.start(0)
    seat.show_frame(0, 1, Pose(x=1.0, y=2.0), {3: b"a", 4: b"b"})
    seat.show_frame(0, 2, Pose(x=1.5, y=2.0), {4: b"c"})
    screen = Screen()
    assert seat.join(screen) is None
    assert [type(message) for message in screen.messages] == [wire.Welcome, wire.TrialAhead, wire.Began]
    assert screen.places == {3: b"a", 4: b"c"}
    assert screen.heads[-1].x == 1.5
    other = Screen()
    assert seat.join(other) is screen
    seat.leave(screen)
    assert seat.absent_s() == 0.0, "a page that was replaced leaves nothing"


def test_somebody_whose_headset_is_off_is_absent_until_it_is_on_again_or_another_page_is_there() -> None:
    clock = Clock()
    seat, first, second = LiveSeat(HUMAN, clock), Screen(), Screen()
    seat.join(first)
    clock.time = 1.0
    for clock.time in (1.0, 2.0):
        seat.ping(wire.Ping(sent=0.0, off=True))
    clock.time = 4.0
    assert (seat.absent_s(), seat.absence) == (3.0, "the headset of human is off")
    seat.ping(wire.Ping(sent=0.0))
    assert seat.absent_s() == 0.0
    seat.ping(wire.Ping(sent=0.0, off=True))
    seat.join(second)
    assert seat.absent_s() == 0.0
    seat.ping(wire.Ping(sent=0.0, off=True))
    seat.leave(second)
    clock.time = 9.0
    assert (seat.absent_s(), seat.absence) == (5.0, "the page of human is gone")


def test_a_page_that_draws_nothing_in_a_trial_is_absent_until_it_does() -> None:
    clock = Clock()
    seat, page = LiveSeat(HUMAN, clock), Screen()
    seat.open(AHEAD)
    seat.join(page)
    clock.time = 100.0
    assert seat.absent_s() == 0.0, "the trial has not begun"
    seat.start(0)
    clock.time += HANGS_S
    assert seat.absent_s() == 0.0, "it may still load something"
    clock.time += 0.5
    assert (seat.absent_s(), seat.absence) == (HANGS_S + 0.5, "the page of human draws no pictures")
    seat.steer(Steering(1, Drive()))
    assert seat.absent_s() == 0.0
    clock.time += 2 * HANGS_S
    seat.join(Screen())
    assert seat.absent_s() == 0.0, "another page has just come"
