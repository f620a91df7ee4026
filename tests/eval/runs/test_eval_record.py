"""Keys and lines: the same trial gives the same bytes, and no damage goes unseen."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import eval_fakes as fakes
import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hthor import activity, jsonio
from hthor.errors import RunError
from hthor.eval.records import trial_log, trial_record
from hthor.log_format import SCHEMA
from hthor.types.events import Note, Sent


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


@given(st.floats(-1e6, 1e6), st.text(max_size=20))
def test_floats_in_events_are_rounded_once(value: float, text: str):
    trial = _trial()
    whole = fakes.episode(trial)
    log = msgspec.structs.replace(
        whole,
        ticks=20,  # as short as a record may be, which a hundred cases are quicker with
        paths={seat: path[:10] for seat, path in whole.paths.items()},
        events=(Sent(tick=1, seat="robot", message=0, text="", position=(value, 0.0, -0.0)),),
        journal=(Note(tick=1, seat="human", topic=text, values={"value": value, "text": text, "is": True}),),
    )
    line = trial_record.encode(trial_record.make_record(trial, log))
    back = trial_record.decode(line)
    assert back.events[0].position[0] == pytest.approx(value, abs=1e-4)
    assert back.journal[0].values == {"value": pytest.approx(value, abs=1e-4), "text": text, "is": True}
    assert trial_record.encode(trial_record.make_record(trial, back.log)) == line


def _with_events(*more: dict[str, object], schema: str = SCHEMA) -> bytes:
    """A line with the right checksum and key that has these events too."""
    whole = msgspec.json.decode(_LINE) | {"schema": schema}
    del whole["check"]
    whole["events"] += more
    return trial_record.sealed(msgspec.json.encode(whole))


@pytest.mark.parametrize(
    ("kind", "data", "field"),
    [
        ("sent", {"message": 0, "text": "here", "off": [1.0]}, "off"),
        ("sent", {"message": [], "text": "here"}, "message"),
        ("sent", {"text": "here"}, "message"),
        ("sent", {"message": 0, "text": "here", "position": [1.0, 2.0, "up"]}, "position[2]"),
        ("accepted", {"sender": "robot"}, "message"),
        ("progress", {"value": "half"}, "value"),
        ("placed", {"object": "mug", "on": {}}, "on"),
    ],
)
def test_every_field_of_an_event_has_its_type(kind: str, data: dict[str, object], field: str):
    event = {"tick": 1, "seat": "robot", "kind": kind, **data}
    strange = {"tick": 1, "seat": "robot", "kind": "waved"}
    number = len(trial_record.decode(_LINE).events)
    for line in (_with_events(event), _with_events(strange, event)):
        with pytest.raises(trial_record.Damaged) as caught:
            trial_record.decode(line)
        assert caught.value.field == f"events[{number}].{field}"
        number += 1


def test_events_of_a_later_version_are_left_out_and_counted():
    whole, skipped = trial_record.decode(_LINE), Counter()
    waved = {"tick": 1, "seat": "robot", "kind": "waved", "hands": 2}
    line = _with_events(waved, {"kind": "bowed", "tick": 2, "seat": "human"}, waved, schema="hthor.trial/2.7")
    back = trial_record.decode(line, skipped)
    assert skipped == {"waved": 2, "bowed": 1}
    assert back == msgspec.structs.replace(whole, schema="hthor.trial/2.7")


def test_a_field_that_a_later_version_has_added_is_left_out():
    line = msgspec.json.decode(_LINE)
    del line["check"]
    line["spec"]["weather"] = "fine"
    line["key"] = jsonio.sha256(line["spec"])[:16]
    back = trial_record.decode(trial_record.sealed(msgspec.json.encode(line)))
    assert back.spec == trial_record.decode(_LINE).spec
    assert back.key == line["key"]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda line: line.update(schema="hthor.trial/3.0"), "schema is 'hthor.trial/3.0', this version reads"),
        (lambda line: line.pop("schema"), "was written by an older version of hthor; 'hthor migrate"),
    ],
)
def test_a_log_of_another_major_version_is_refused_in_one_sentence(change, words: str, tmp_path: Path):
    line = msgspec.json.decode(_LINE)
    change(line)
    (tmp_path / "trials.jsonl").write_bytes(msgspec.json.encode(line) + b"\n")
    with pytest.raises(RunError) as caught:
        list(trial_log.read(tmp_path / "trials.jsonl"))
    assert words in str(caught.value)
    assert str(caught.value).count(". ") <= 1


def test_a_log_says_once_which_events_were_left_out(tmp_path: Path):
    line = _with_events({"tick": 1, "seat": "robot", "kind": "waved"})
    (tmp_path / "trials.jsonl").write_bytes(line * 3)
    with pytest.warns(UserWarning, match=r"has 3 events of kinds that .* \(3 waved\); they were left out") as told:
        assert len(list(trial_log.read(tmp_path / "trials.jsonl"))) == 3
    assert len(told) == 1
    heard = []
    with activity.read_by(heard.append):
        for _ in range(2):
            assert [one for one, _ in trial_log.read(tmp_path / "trials.jsonl")] == [line] * 3, "the bytes stay"
    assert len(heard) == 1
