"""What the recorder writes: run lengths that unfold to what happened, attempts with the end that they came to."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import pytest
from event_fakes import fields
from hypothesis import given
from hypothesis import strategies as st

from hthor import rules, tasks
from hthor.calibration.from_logs import trial_features
from hthor.calibration.from_logs.features import locomotion
from hthor.eval.records import trial_record
from hthor.eval.records.trial_record import TrialRecord
from hthor.eval.runner import session_runner
from hthor.humans.core.behaviour_log import BehaviourRecorder
from hthor.tasks.suite import make_suite
from hthor.trials.sessions import Session, make_sessions
from hthor.types import HUMAN, Move, Rotate, Wait
from hthor.types.events import Attempt, Event, JournalEntry, Picked
from hthor.world.model.bodies.avatar import HUMAN as BODY

STEP_M = BODY.speed * rules.TICK_S


def recorder() -> BehaviourRecorder:
    return BehaviourRecorder(HUMAN, BODY, rules.TICK_S)


def entries(made: BehaviourRecorder, *own: JournalEntry, events: tuple[Event, ...] = ()) -> dict[str, Any]:
    return {event.kind: event for event in made.journal(own, events)}


@given(st.lists(st.floats(0.0, 1.0), min_size=1, max_size=60))
def test_stick_unfolds_to_what_was_pushed(shares: list[float]) -> None:
    made = recorder()
    for tick, share in enumerate(shares):
        made.motion(tick, Move(forward=share * STEP_M))
    runs = entries(made)["stick"].runs
    at, value = runs[::2], runs[1::2]
    assert list(at) == sorted(at)
    assert all(a != b for a, b in pairwise(value)), "a run that does not change is one run"
    held = [max((t, v) for t, v in zip(at, value, strict=True) if t <= tick)[1] for tick in range(len(shares))]
    assert held == pytest.approx([1000 * share for share in shares], abs=0.51)


def test_a_long_move_is_the_stick_pushed_all_the_way_and_other_motions_are_none() -> None:
    made = recorder()
    made.motion(3, Move(forward=0.3, left=-0.4))
    made.motion(8, Rotate(yaw=1.0))
    made.motion(9, Move(forward=math.nan))
    made.motion(12, Wait(seconds=1.0))
    assert fields(entries(made)["stick"]) == {"full": BODY.speed, "runs": (0, 0, 3, 1000, 8, 0)}


def test_pitch_is_written_when_it_changes() -> None:
    made = recorder()
    for tick, pitch in ((0, 0.0), (2, -0.2504), (4, -0.25), (6, 0.1)):
        made.head(tick, pitch)
    assert entries(made)["head"].pitch == (0, 0, 2, -250, 6, 100)


def attempt(tick: int, what: str = "pick", **data: Any) -> Attempt:
    return Attempt(tick=tick, seat=HUMAN, what=what, **data)


def test_an_attempt_that_worked_while_nobody_wrote_it_down_gets_its_end() -> None:
    picked = Picked(tick=31, seat=HUMAN, object="mug")
    theirs = Picked(tick=20, seat="robot", object="mug")
    *_, one = recorder().journal([attempt(10)], [theirs, picked])
    assert fields(one) == {"what": "pick", "seconds": 2.1, "ok": True}


def test_an_attempt_that_was_given_up_does_not_get_the_end_of_a_later_one() -> None:
    picked = Picked(tick=60, seat=HUMAN, object="mug")
    *_, first, second = recorder().journal([attempt(10), attempt(40)], [picked])
    assert fields(first) == {"what": "pick"}
    assert second.ok is True


def test_what_was_written_down_stands() -> None:
    written = attempt(10, seconds=1.5, ok=False, why="missed")
    *_, one = recorder().journal([written], [Picked(tick=11, seat=HUMAN, object="mug")])
    assert one == written


@pytest.fixture(scope="module")
def played() -> list[TrialRecord]:
    """A few trials of one person with the oracle, in one house."""
    smoke = tasks.load_suite("smoke")
    few = make_suite("few", 1, tuple(task for task in smoke.tasks if task.house == "elder"))
    whole = make_sessions(few, agent="oracle", seed=3)[0]
    return [done.record for done in session_runner.make_runner()(Session(number=whole.number, trials=whole.trials[:4]))]


def test_nobody_goes_farther_than_the_stick_says(played: list[TrialRecord]) -> None:
    went = 0.0
    for one in played:
        stick = locomotion.stick_deflection(one)
        assert stick is not None
        assert len(stick) == one.ticks
        path = one.paths[HUMAN]
        for k, ((ax, ay, _), (bx, by, _)) in enumerate(pairwise(path)):
            pushed = stick[k * rules.LOG_EVERY_TICKS : (k + 1) * rules.LOG_EVERY_TICKS].sum() / 1000.0
            assert math.hypot(bx - ax, by - ay) / 1000.0 <= pushed * STEP_M + 0.003
            went += math.hypot(bx - ax, by - ay) / 1000.0
    assert went > 5.0, "nobody walked, so this test showed nothing"


def test_every_deed_of_the_hands_was_an_attempt(played: list[TrialRecord]) -> None:
    done = {"picked", "placed", "opened"}
    deeds_done = [e for one in played for e in one.events if e.seat == HUMAN and e.kind in done]
    worked = [a for one in played for a in trial_features.manipulation_attempts(one) if not a.missed and not a.cut]
    assert deeds_done
    assert len(worked) >= len(deeds_done)
    assert all(a.seconds >= rules.HANDLING_S for a in worked)


def test_a_trial_stays_small(played: list[TrialRecord]) -> None:
    """A journal is a few kB, beside paths and events that are more."""
    import msgspec

    for one in played:
        assert len(msgspec.json.encode(one.journal)) < 16_000
        assert trial_record.decode(trial_record.encode(one)) == one
