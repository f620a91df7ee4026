"""Standing around, repeating oneself and saying too much are seen in what a trial left behind."""

from __future__ import annotations

import msgspec
import pytest

from hthor.episode import EpisodeLog
from hthor.eval.agent_check import criteria
from hthor.eval.agent_check.probe_trials import ProbeResult, count_repeated_messages, longest_on_one_spot_s
from hthor.types import HUMAN
from hthor.types.events import Accepted, Declined, Event, Sent

NOTES = ProbeResult(
    line=b"", faults=(), asked=300, actions=(), thought_s=(0.0004,) * 300, begin_s=0.0, memory_mb=0.0, lasted_s=30.0,
    motions=100, refused=0, spot_s=2.0, sent=1, covered=0, repeated=0, claims=1, unseen=0, output="",
)  # fmt: skip


def log(path: list[tuple[int, int, int]], *events: Event) -> EpisodeLog:
    return EpisodeLog(events=events, paths={"robot": path}, ticks=300, met=False, ratings={"human": None}, faults=())


def sent(text: str, tick: int = 0) -> Event:
    return Sent(tick=tick, seat="robot", message=tick, text=text, object="mug")


def answered(kind: type[Accepted | Declined], tick: int) -> Event:
    return kind(tick=tick, seat=HUMAN, message=0, sender="robot")


def test_turning_is_standing_and_driving_is_not():
    turning = [(1000, 2000, 100 * step) for step in range(150)]
    driving = [(100 * step, 2000, 0) for step in range(150)]
    assert longest_on_one_spot_s(log(turning), "robot") == pytest.approx(29.8)
    assert longest_on_one_spot_s(log(driving), "robot") < 1.0
    assert longest_on_one_spot_s(log(driving[:50] + [driving[50]] * 100), "robot") == pytest.approx(19.8, abs=0.5)


def test_after_an_accepted_message_it_may_wait():
    path = [(100 * step, 2000, 0) for step in range(50)] + [(5000, 2000, 0)] * 100
    assert longest_on_one_spot_s(log(path, answered(Accepted, 100)), "robot") < 1.0


def test_the_same_again_is_a_repetition_unless_it_was_declined():
    assert count_repeated_messages(log([], sent("a"), sent("a", 1), sent("a", 2), sent("b", 3)), "robot") == 2
    assert count_repeated_messages(log([], sent("a"), answered(Declined, 5), sent("a", 100)), "robot") == 0


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({}, ""),
        ({"sent": 7}, ""),
        ({"sent": 8, "covered": 7}, "it sent 8 messages in 30 s: 7 covered by the next one"),
        (
            {"sent": 39, "covered": 38, "repeated": 38},
            "39 messages in 30 s: 38 covered by the next one, 38 the same as",
        ),
        ({"sent": 0}, "it never sent a message"),
        ({"spot_s": 16.0}, "it stood on one spot for 16 of 30 s"),
        ({"motions": 0, "spot_s": 30.0}, "it never moved"),
    ],
)
def test_warnings_name_what_was_counted(changes: dict[str, object], told: str):
    found = criteria.warnings((msgspec.structs.replace(NOTES, **changes),), _Character())
    assert [one.status for one in found] == ["warning"] * bool(told)
    assert all(told in one.told and one.advice for one in found)


def test_the_share_of_thinking_is_of_the_trials_time():
    """300 steps of 0.4 ms in 30 s, however long it took to play them."""
    assert criteria.figures(NOTES)["share"] == pytest.approx(0.004)
    assert "0.4 % of the trial's 30 s" in criteria.check_speed(NOTES).told
    assert criteria.check_speed(msgspec.structs.replace(NOTES, thought_s=(0.2,) * 300)).status == "warning"


def test_slow_loading_and_a_slow_begin_are_warned_of():
    assert [criteria.check_loading(seconds, _Character()).status for seconds in (4.9, 5.1)] == ["ok", "warning"]
    slow = msgspec.structs.replace(NOTES, begin_s=1.1)
    assert [criteria.check_trial(one, "agent.py")[0].status for one in (NOTES, slow)] == ["ok", "warning"]


class _Character:
    """As much of a submitted agent as warnings look at."""

    class ref:  # noqa: N801
        privileges: tuple[str, ...] = ()
