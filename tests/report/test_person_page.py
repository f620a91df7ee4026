"""A person's own page: their trials and messages, and nothing of anybody else's."""

from __future__ import annotations

import re
from typing import Any

import eval_fakes as fakes
import msgspec
from event_fakes import make_event

from hthor import tasks
from hthor.eval.records.trial_record import TrialRecord, make_record
from hthor.report.person import own_session, person_page
from hthor.report.person.own_session import OwnSession
from hthor.types import HUMAN, HumanSeat

TRIAL = fakes.run_of(10, name="small")[1][0].trials[0]
OTHER = "human2"
AT = (3.0, 2.0, 0.8)
COURSE: list[tuple[str, int, str, dict[str, Any]]] = [
    (
        "robot",
        40,
        "sent",
        {"message": 0, "object": "apple", "position": AT, "text": "The apple is <here>.", "off": 0.1},
    ),
    (HUMAN, 50, "shown", {"message": 0, "sender": "robot"}),
    (OTHER, 52, "shown", {"message": 0, "sender": "robot"}),
    (HUMAN, 80, "accepted", {"message": 0, "sender": "robot"}),
    (OTHER, 85, "declined", {"message": 0, "sender": "robot"}),
    (HUMAN, 150, "picked", {"object": "apple"}),
    (
        "robot",
        200,
        "sent",
        {"message": 1, "object": "sofa", "position": AT, "text": "A secret.", "to": OTHER, "off": 3.0},
    ),
    (OTHER, 210, "shown", {"message": 1, "sender": "robot"}),
    ("robot", 300, "sent", {"message": 2, "object": "mug", "position": AT, "text": "The mug is there.", "off": 3.0}),
    (HUMAN, 310, "shown", {"message": 2, "sender": "robot"}),
    ("robot", 400, "placed", {"object": "mug_1", "on": "sofa_1"}),
]


def record() -> TrialRecord:
    """A trial of two people and a robot."""
    people = tuple(
        HumanSeat(seat=seat, model="live", sha256="", participant=k) for k, seat in enumerate((HUMAN, OTHER))
    )
    spec = msgspec.structs.replace(TRIAL, humans=people)
    way: dict[str, Any] = {HUMAN: (3000, 3000, 0), OTHER: (5000, 4000, 0), "robot": (4000, 4000, 0)}
    log = msgspec.structs.replace(
        fakes.episode(spec),
        events=tuple(make_event(tick, seat, kind, **data) for seat, tick, kind, data in COURSE),
        ticks=600,
        met=True,
        ratings={HUMAN: 5, OTHER: 2},
        paths={seat: [pose] * 301 for seat, pose in way.items()},
        journal=(),
    )
    return make_record(spec, log)


def session(seat: str = HUMAN, participant: int = 0) -> OwnSession:
    house = tasks.load_suite("smoke").houses.load("alder")
    return OwnSession(participant=participant, trials=(own_session.own_trial(record(), house, seat),), voided=1)


def test_a_trial_is_told_from_the_persons_side() -> None:
    (trial,) = session().trials
    first, second = trial.messages
    assert (first.shown_s, first.answer, first.answer_s, first.found_s, first.wrong) == (
        5.0,
        "accepted",
        3.0,
        7.0,
        False,
    )
    assert (second.answer, second.answer_s, second.found_s, second.wrong) == ("", None, None, True)
    assert (trial.met, trial.seconds, trial.rating) == (True, 60.0, 5)
    assert trial.robots == ("After 40 s the robot put the mug on or in the sofa.",)


def test_the_page_says_what_was_done_and_holds_nothing_of_others() -> None:
    page = person_page.render(session(), "<h2>More of you</h2>")
    for words in (
        "You confirmed it after 3 s. 7 s later",
        "without an answer",
        "5 of 7",
        "More of you",
        "1 attempt did",
    ):
        assert words in page
    assert "&lt;here&gt;" in page
    for foreign in ("secret", OTHER, "declined", "2 of 7"):
        assert foreign not in page, foreign
    assert page == person_page.render(session(), "<h2>More of you</h2>")


def test_the_page_asks_nobody_and_runs_nothing() -> None:
    page = person_page.render(session(OTHER, 1))
    assert "secret" in page
    assert "<script" not in page
    assert not re.search(r'(?:src|href)="(?!#|data:)', page)
    assert not re.search(r"url\((?!#)", page)


def test_a_session_without_robots_says_nothing_of_messages() -> None:
    (trial,) = session().trials
    alone = msgspec.structs.replace(trial.record.spec, robots=())
    own = msgspec.structs.replace(
        trial, record=msgspec.structs.replace(trial.record, spec=alone), messages=(), robots=(), rating=None
    )
    page = person_page.render(OwnSession(participant=0, trials=(own,)))
    assert "message" not in page.partition("<footer>")[0].partition("<main>")[2].replace("messages that were shown", "")
    assert "rust" not in page.partition("<main>")[2]
