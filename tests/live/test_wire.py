"""The binary frames of a live session."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hthor.live import wire
from hthor.live.wire import FrameHead, Hand, Malformed, Steering
from hthor.types import Drive

_NUMBERS = st.floats(-30.0, 30.0, width=32)


_PLACES = st.tuples(_NUMBERS, _NUMBERS, _NUMBERS)


@given(
    number=st.integers(0, 2**32 - 1),
    values=st.tuples(_NUMBERS, _NUMBERS, _NUMBERS, _NUMBERS),
    hand=st.none() | st.builds(Hand, _PLACES, _PLACES),
)
def test_steering_arrives_as_it_was_sent(
    number: int, values: tuple[float, float, float, float], hand: Hand | None
) -> None:
    forward, left, yaw, pitch = values
    sent = Steering(number, Drive(forward=forward, left=left, yaw=yaw, pitch=pitch), hand)
    assert wire.decode_steering(wire.encode_steering(sent)) == sent


@given(data=st.binary(max_size=50))
def test_what_is_no_steering_is_refused(data: bytes) -> None:
    try:
        steering = wire.decode_steering(data)
    except Malformed:
        return
    assert math.isfinite(steering.drive.forward)


@given(
    head=st.builds(FrameHead, st.integers(0, 10**6), st.integers(0, 5), st.integers(0, 10**6), *[_NUMBERS] * 5),
    rows=st.dictionaries(st.integers(0, 2**16 - 1), st.lists(_NUMBERS, min_size=3, max_size=3), max_size=8),
)
def test_a_frame_arrives_to_the_millimetre(head: FrameHead, rows: dict[int, list[float]]) -> None:
    poses = np.array([[*place, 1.0, 0.0, 0.0, 0.0] for place in rows.values()]).reshape(-1, 7)
    rounded = wire.round_poses(poses)
    data = wire.encode_frame(head, {number: rounded[k].tobytes() for k, number in enumerate(rows)})
    again, places = wire.decode_frame(data)
    assert again == head
    for number, place in rows.items():
        assert np.array(places[number][:3]) / 1000.0 == pytest.approx(place, abs=6e-4)
        assert places[number][3:] == (32767, 0, 0, 0)


def test_what_lies_far_away_stays_out_of_the_house() -> None:
    assert wire.round_poses(np.array([[0.0, 0.0, -200.0, 1.0, 0.0, 0.0, 0.0]]))[0, 2] == -32767
