"""Keys and lines: the same trial gives the same bytes, and no damage goes unseen."""

from __future__ import annotations

import eval_fakes as fakes
import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hthor.eval.records import trial_record
from hthor.types import Event


def _trial(index: int = 0, seed: int = 0):
    return fakes.run_of(30, seed=seed)[1][0].trials[index]


def _line() -> bytes:
    trial = _trial()
    return trial_record.encode(trial_record.make_record(trial, fakes.episode(trial)))


def test_the_key_is_fixed_by_the_trial_alone():
    copy = msgspec.json.decode(msgspec.json.encode(_trial()), type=type(_trial()))
    assert trial_record.key(copy) == trial_record.key(_trial())
    assert len(trial_record.key(_trial())) == 16


@pytest.mark.parametrize("field", ["seed", "session", "index", "humans", "code_sha256", "rules_sha256"])
def test_everything_that_decides_a_trial_is_in_its_key(field: str):
    trial = _trial()
    value = getattr(trial, field)
    other = msgspec.structs.replace(trial, **{field: value + 1 if isinstance(value, int) else "0" * 64})
    assert trial_record.key(other) != trial_record.key(trial)


def test_keys_are_all_different():
    keys = [trial_record.key(trial) for dealt in fakes.run_of(60)[1] for trial in dealt.trials]
    assert len(set(keys)) == 60


def test_a_line_comes_back_as_it_was():
    line = _line()
    back = trial_record.decode(line)
    assert trial_record.encode(back) == line
    assert trial_record.make_record(back.spec, back.log) == back


def test_a_line_holds_no_newline_but_its_last():
    assert _line().count(b"\n") == 1


@given(st.integers(0, 3000), st.integers(0, 255))
def test_a_changed_byte_is_seen(place: int, value: int):
    line = bytearray(_LINE)
    place %= len(line) - 1
    if line[place] == value or value == 10:
        return
    line[place] = value
    with pytest.raises(trial_record.Damaged):
        trial_record.decode(bytes(line))


_LINE = _line()


def test_damage_names_the_field():
    with pytest.raises(trial_record.Damaged) as caught:
        trial_record.decode(_LINE.replace(b'"ticks":', b'"ticks":"x",\n"y":').replace(b"\n", b"", 1))
    assert caught.value.field == "ticks"


@pytest.mark.slow
@given(st.floats(-1e6, 1e6), st.text(max_size=20))
def test_floats_in_events_are_rounded_once(value: float, text: str):
    trial = _trial()
    log = msgspec.structs.replace(
        fakes.episode(trial),
        events=(Event(tick=1, seat="robot", kind="sent", data={"message": 0, "text": "", "p": (value, text)}),),
    )
    line = trial_record.encode(trial_record.make_record(trial, log))
    back = trial_record.decode(line)
    assert back.events[0].data["p"][0] == pytest.approx(value, abs=1e-4)
    assert trial_record.encode(trial_record.make_record(trial, back.log)) == line


@pytest.mark.parametrize(
    ("kind", "data", "field"),
    [
        ("sent", {"message": 0, "text": "here", "off": [1.0]}, "off"),
        ("sent", {"message": [], "text": "here"}, "message"),
        ("sent", {"text": "here"}, "message"),
        ("accepted", {}, "message"),
        ("progress", {"value": "half"}, "value"),
        ("placed", {"on": {}}, "on"),
    ],
)
def test_what_is_scored_of_an_event_has_its_type(kind: str, data: dict[str, object], field: str):
    """Such a line has the right checksum and key, and its record could not be scored or drawn."""
    whole = trial_record.decode(_LINE)
    bad = msgspec.structs.replace(whole, events=(*whole.events, Event(tick=1, seat="robot", kind=kind, data=data)))
    with pytest.raises(trial_record.Damaged) as caught:
        trial_record.decode(trial_record.encode(bad))
    assert caught.value.field == f"events[{len(whole.events)}].data.{field}"
