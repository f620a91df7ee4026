"""Logs tell how people use panel and map: how much of the way the map was shown, and who walks without it."""

from __future__ import annotations

import eval_fakes as fakes
import msgspec
import pytest
from event_fakes import make_event

from benchmarks import recovery
from hthor import tasks
from hthor.calibration.from_logs import display_habits, estimate_all, trial_features
from hthor.calibration.from_logs.features import display_use
from hthor.calibration.from_logs.models import priors
from hthor.eval.records.trial_record import TrialRecord, make_record
from hthor.humans.population.parameters import Parameters
from hthor.tasks.suite import make_suite
from hthor.trials import TrialRunner
from hthor.types import HUMAN

TRIAL = fakes.run_of(10, name="small")[1][0].trials[0]
AT = (3.0, 0.0, 0.8)


def record(*events: tuple[int, str, dict[str, object]], journal: tuple[object, ...] = ()) -> TrialRecord:
    """A trial of 60 s: message 0 is sent at 4 s and accepted at 6 s; the person walks to it from 10 to 20 s."""
    course = [
        (40, "sent", {"message": 0, "object": "apple", "position": AT}),
        (41, "shown", {"message": 0}),
        (60, "accepted", {"message": 0}),
        *events,
    ]
    walk = [(round(min(max(0.0, (k * 2 - 100) * 0.03), 3.0) * 1000), 0, 0) for k in range(301)]
    log = msgspec.structs.replace(
        fakes.episode(TRIAL),
        events=tuple(
            make_event(tick, "robot" if kind == "sent" else HUMAN, kind, **data) for tick, kind, data in course
        ),
        ticks=600,
        paths={HUMAN: walk, "robot": [(0, 0, 0)] * 301},
        journal=journal,
    )
    return make_record(TRIAL, log)


def _seat(kind: str) -> str:
    return "robot" if kind == "sent" else HUMAN


def shown(tick: int, on: bool) -> tuple[int, str, dict[str, object]]:
    return (tick, "displayed", {"what": "map", "on": on, "message": 0})


def test_a_way_ends_near_the_place_and_the_map_was_shown_for_part_of_it() -> None:
    """Half of the three metres are walked at 15 s, nine seconds after the confirmation."""
    (follow,) = display_use.message_follows(record())
    assert (follow.seconds, follow.shown, follow.shown_again, follow.hidden) == (pytest.approx(9.0), 9.0, 0, False)
    (follow,) = display_use.message_follows(record(shown(65, False), shown(115, True)))
    assert (follow.shown, follow.shown_again, follow.hidden) == (pytest.approx(0.5 + 3.5), 1, True)
    (follow,) = display_use.message_follows(record(shown(100, False)))
    assert (follow.shown, follow.hidden) == (pytest.approx(4.0), False), "it was hidden late"


def test_what_was_seen_first_or_was_nothing_new_is_not_followed() -> None:
    seen = make_event(70, HUMAN, "exposure", object="apple", noticed=True, seconds=1.0, gathered=())
    assert display_use.message_follows(record(journal=(seen,))) == ()
    known = make_event(60, HUMAN, "offer", message=0, useful=False)
    assert display_use.message_follows(record(journal=(known,))) == ()


def test_the_panel_is_shown_until_the_answer_unless_it_is_hidden() -> None:
    assert display_use.panel_times(record()) == (pytest.approx(2.0),)
    hidden = (50, "displayed", {"what": "panel", "on": False, "message": 0})
    made = record()
    events = tuple(sorted((*made.events, make_event(hidden[0], HUMAN, hidden[1], **hidden[2])), key=lambda e: e.tick))
    assert display_use.panel_times(msgspec.structs.replace(made, events=events)) == (pytest.approx(1.0),)


def test_habits_sum_up_all_trials() -> None:
    made = trial_features.extract_features(trial_features.sessions_of([record(shown(65, False), shown(115, True))]))
    found = display_habits.display_habits(made)
    assert (found.answers, found.panel_s, found.follows, found.shown_again) == (1, 2.0, 1, 1.0)
    assert found.map_share == pytest.approx(4.0 / 9.0, abs=1e-4)
    assert "44 % of the time" in found.words
    assert display_habits.display_habits(()).words == "Nobody answered a message."


@pytest.mark.parametrize("share", [*(pytest.param(share, marks=pytest.mark.nightly) for share in (0.0, 0.5)), 1.0])
def test_logs_of_proxies_tell_how_often_they_walk_with_the_map_hidden(share: float) -> None:
    smoke = tasks.load_suite("smoke")
    few = make_suite("few", 1, tuple(task for task in smoke.tasks if task.house == "elder")[:4])
    population = Parameters(a0=6.0, map_hidden=share)
    records = recovery.simulate_logs(population, few, TrialRunner(), seed=7, people=6)
    sessions = trial_features.sessions_of(records)
    follows = [follow for one in trial_features.extract_features(sessions) for follow in one.follows]
    found = {one.name: one for one in estimate_all.estimate_parameters(sessions, priors.prior_beliefs())}
    one = found[estimate_all.HIDDEN]
    assert one.n == len(follows) >= 10
    assert one.value == pytest.approx(share, abs=0.1 if share in (0.0, 1.0) else 0.3)
    assert (sum(follow.hidden for follow in follows) / len(follows) == share) or share == 0.5
    assert (sum(follow.shown_again for follow in follows) > 0) is (share > 0.0)
