"""Actions as arrays: nothing is lost, and an array that does not fit is refused by the name of its field."""

from __future__ import annotations

from typing import Any, get_args

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hthor.envs.action_arrays import MOTIONS, action_spec, decode_action, encode_action
from hthor.errors import HthorError
from hthor.types import Action, Close, Drive, Drop, Motion, Move, Open, Pick, Place, Reply, Rotate, Send, Wait
from hthor.types.signals import Ready, Show, Signal

NUMBER = st.floats(allow_nan=False)
POINT = st.none() | st.tuples(NUMBER, NUMBER, NUMBER)
MESSAGE = st.integers(0, 2**63 - 1)
MOTION = st.one_of(
    st.builds(Move, forward=NUMBER, left=NUMBER),
    st.builds(Rotate, yaw=NUMBER, pitch=NUMBER),
    st.builds(Drive, forward=NUMBER, left=NUMBER, yaw=NUMBER, pitch=NUMBER),
    st.builds(Wait, seconds=NUMBER),
    st.builds(Pick, object=st.text()),
    st.builds(Place, on=st.text(), position=POINT),
    st.builds(Open, thing=st.text()),
    st.builds(Close, thing=st.text()),
    st.just(Drop()),
)
SEND = st.builds(
    Send,
    text=st.text(),
    object=st.text(),
    position=POINT,
    to=st.text(),
    question=st.booleans(),
    answers=st.none() | MESSAGE,
)
SAY = st.none() | SEND | st.builds(Reply, message=MESSAGE, accept=st.booleans())
SIGNAL = st.builds(Show, what=st.sampled_from(("panel", "map")), on=st.booleans()) | st.just(Ready())
ACTION = st.builds(Action, motion=MOTION, say=SAY, signals=st.lists(SIGNAL, max_size=4).map(tuple))


@given(action=ACTION)
def test_arrays_hold_every_action(action: Action) -> None:
    arrays = encode_action(action)
    for name, spec in action_spec().items():
        spec.validate(arrays[name])
    assert decode_action(arrays) == action


def test_every_motion_and_signal_is_covered() -> None:
    assert set(MOTIONS) == set(get_args(Motion))
    assert {Show, Ready} <= set(get_args(Signal))
    assert MOTIONS[0] is Wait  # so that zeros are an action


def test_every_field_of_what_is_said_is_covered() -> None:
    assert set(Send.__struct_fields__) == {"text", "object", "position", "to", "question", "answers"}
    assert set(Reply.__struct_fields__) == {"message", "accept"}
    assert set(Action.__struct_fields__) == {"motion", "say", "signals"}


def test_the_values_that_a_specification_makes_are_a_wait() -> None:
    blank = {name: spec.generate_value() for name, spec in action_spec().items()}
    assert decode_action(blank) == Action(motion=Wait(seconds=0.0))


def test_plain_numbers_and_texts_may_stand_for_arrays() -> None:
    plain = {
        **encode_action(Action()),
        "motion": 1,
        "numbers": [1, 0, 0, 0],
        "say": 1,
        "text": "here",
        "question": True,
    }
    assert decode_action(plain) == Action(motion=Move(forward=1.0), say=Send(text="here", question=True))
    short = {**plain, "numbers": np.array((0.5, 0.0, 0.0, 0.0), np.float32), "motion": np.int32(1)}
    assert decode_action(short).motion == Move(forward=0.5)


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("motion", 9),
        ("motion", -1),
        ("motion", 0.5),
        ("numbers", (1.0, 2.0)),
        ("numbers", "fast"),
        ("position", (1.0, None, 2.0)),
        ("thing", 7),
        ("has_position", 2),
        ("answers", -2),
        ("message", 2**64),
        ("signals", "ready"),
        ("signals", '[{"type":"shout"}]'),
    ],
)
def test_what_does_not_fit_is_refused_by_name(field: str, value: Any) -> None:
    arrays = {**encode_action(Action()), field: value}
    with pytest.raises(HthorError, match=f"field '{field}'"):
        decode_action(arrays)


def test_missing_and_unknown_fields_are_named() -> None:
    arrays: dict[str, Any] = encode_action(Action())
    with pytest.raises(HthorError, match="no field 'speed'"):
        decode_action({**arrays, "speed": 1.0})
    del arrays["to"]
    with pytest.raises(HthorError, match="field 'to' is missing"):
        decode_action(arrays)
    with pytest.raises(HthorError, match="got ndarray"):
        decode_action(np.zeros(3))  # type: ignore[arg-type]
    with pytest.raises(HthorError, match=r"field 'answers'.*-3"):
        encode_action(Action(say=Send(text="", answers=-3)))
