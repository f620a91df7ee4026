"""What a trial was worth beside success: logs made by hand whose values are worked out by hand, and laws."""

from __future__ import annotations

import eval_fakes as fakes
import msgspec
import pytest
from event_fakes import make_event
from hypothesis import given
from hypothesis import strategies as st
from msgspec import UNSET

from hthor.comms import claims
from hthor.episode import EpisodeLog
from hthor.eval.metrics import registry, trial_metrics
from hthor.eval.metrics.definitions import contribution, interference
from hthor.eval.metrics.metric import Trial
from hthor.eval.records.scored_trial import score
from hthor.eval.records.trial_record import make_record
from hthor.eval.results import estimates
from hthor.types import HUMAN, Goal, HouseSpec, HumanSeat, Job, Placement, Pose, Room, Snapshot, Thing, ThingState
from hthor.types.events import JournalEntry, LogEntry, Sent

TRIAL = fakes.run_of(10, name="tall+small")[1][0].trials[0]
ALONE = fakes.run_of(10, absent=True)[1][0].trials[0]
APPLES = tuple(f"apple_{number}" for number in range(3))


def gathering():
    """A trial in which three apples, one of them in the fridge, are to be put on the table."""
    objects = tuple(
        Placement(id=name, kind="apple", position=(1.0, 2.0, 0.9), support="fridge" if name == "apple_2" else "shelf")
        for name in APPLES
    )
    jobs = tuple(Job(target=name, relation="on", destinations=("table",)) for name in APPLES)
    goal = Goal(target=APPLES[0], relation="on", destination="table", jobs=jobs)
    return msgspec.structs.replace(TRIAL, task=msgspec.structs.replace(TRIAL.task, objects=objects, goal=goal))


def log(*events: tuple, ticks: int = 900, met: bool = False, progress: float | None = None, **more) -> EpisodeLog:
    """A log of (tick, seat, kind, data) in which nobody moves unless ``paths`` says so."""
    still = [(0, 0, 0)] * (ticks // 2 + 1)
    known = {"paths": dict.fromkeys((HUMAN, "robot", "robot2"), still), "ratings": {HUMAN: 4}, "faults": (), **more}
    made = tuple(make_event(tick, seat, kind, **data) for tick, seat, kind, data in events)
    return EpisodeLog(events=made, ticks=ticks, met=met, progress=progress, **known)


def picked(tick: int, seat: str, apple: int) -> tuple:
    return (tick, seat, "picked", {"object": APPLES[apple]})


def placed(tick: int, seat: str, apple: int, on: str = "table") -> tuple:
    return (tick, seat, "placed", {"object": APPLES[apple], "on": on})


def share(tick: int, value: float) -> tuple:
    return (tick, HUMAN, "progress", {"value": value})


# ------------------------------------------------------------------------------------------------------ share of work


def test_who_picks_and_places_has_done_it():
    third = 1.0 / 3.0
    made = log(
        picked(10, "robot", 0),
        picked(15, HUMAN, 1),
        placed(20, "robot", 0),
        share(20, third),
        placed(30, HUMAN, 1),
        share(30, 2 * third),
        progress=2 * third,
    )
    assert contribution.shares(gathering(), made) == {HUMAN: 0.5, "robot": 0.5, "robot2": 0.0}


def test_opening_the_fridge_and_handing_over_are_work_too():
    made = log(
        (5, HUMAN, "opened", {"thing": "fridge"}),
        picked(10, HUMAN, 2),
        placed(20, HUMAN, 2, on="shelf"),
        picked(30, "robot", 2),
        placed(40, "robot", 2),
        share(40, 1.0),
        met=True,
        progress=1.0,
    )
    assert contribution.shares(gathering(), made) == {HUMAN: 0.0, "robot": 1.0, "robot2": 0.0}, "it came from the shelf"
    straight = msgspec.structs.replace(made, events=(made.events[0], *made.events[3:]))
    assert contribution.shares(gathering(), straight) == pytest.approx({HUMAN: 1 / 3, "robot": 2 / 3, "robot2": 0.0})


def test_what_is_undone_counts_for_nobody():
    made = log(
        picked(10, "robot", 0),
        placed(20, "robot", 0),
        share(20, 0.4),
        picked(30, HUMAN, 0),
        share(30, 0.1),
        placed(50, HUMAN, 0),
        share(50, 0.4),
        progress=0.4,
    )
    found = contribution.shares(gathering(), made)
    assert found == pytest.approx({HUMAN: 0.75, "robot": 0.25, "robot2": 0.0})


def test_what_several_carry_is_shared_and_what_was_so_from_the_start_is_not():
    bearers = {"object": APPLES[0], "bearers": [HUMAN, "robot2"]}
    made = log(
        share(0, 0.5),
        (30, HUMAN, "lifted", bearers),
        (40, "robot", "opened", {"thing": "door"}),
        share(41, 0.75),
        (60, HUMAN, "lowered", bearers),
        share(61, 1.0),
        progress=1.0,
    )
    assert contribution.shares(gathering(), made) == {HUMAN: 0.5, "robot": 0.0, "robot2": 0.5}


def test_what_is_found_is_found_by_the_person_and_by_who_opened_it():
    assert contribution.shares(TRIAL, log(met=True, ticks=50)) == {HUMAN: 1.0, "robot": 0.0, "robot2": 0.0}
    opened = log((9, "robot", "opened", {"thing": "table"}), (10, "robot2", "opened", {"thing": "door"}), met=True)
    assert TRIAL.task.objects[0].support == "table"
    assert contribution.shares(TRIAL, opened) == {HUMAN: 0.5, "robot": 0.5, "robot2": 0.0}
    assert contribution.shares(TRIAL, log()) is None, "nothing was achieved"


@given(st.data())
def test_shares_are_shares(data):
    seats = st.sampled_from((HUMAN, "robot", "robot2"))
    rows, value = [], 0.0
    for tick in range(1, data.draw(st.integers(1, 12))):
        seat, apple = data.draw(seats), data.draw(st.integers(0, 2))
        rows.append(data.draw(st.sampled_from((picked, placed)))(tick, seat, apple))
        if data.draw(st.booleans()):
            value = data.draw(st.sampled_from((0.0, 0.25, 0.5, 1.0)))
            rows.append(share(tick, value))
    found = contribution.shares(gathering(), log(*rows, progress=value))
    assert (found is None) == (value == 0.0)
    if found:
        assert sum(found.values()) == pytest.approx(1.0)
        assert min(found.values()) >= 0.0


# -------------------------------------------------------------------------------------------------- bodies in the way


def walk(stops: int, ticks: int = 200) -> list[tuple[int, int, int]]:
    """Stands until tick ``stops``, then goes 0.1 m a logged pose."""
    return [(max(0, number - stops // 2) * 100, 0, 0) for number in range(ticks // 2 + 1)]


def test_a_hindrance_lasts_until_one_is_away_from_there():
    paths = {HUMAN: walk(30), "robot": walk(0), "robot2": walk(500)}
    made = log((20, HUMAN, "in_way", {"by": "robot"}), ticks=200, paths=paths)
    assert interference.human_hindered(Trial(TRIAL, made)) == pytest.approx(1.8), "0.4 m away at tick 38"
    assert interference.hindered_by_pair(Trial(TRIAL, made))["human by robot"] == pytest.approx(1.8)
    assert interference.hindered_by_pair(Trial(TRIAL, made))["robot by human"] == 0.0
    assert interference.encounters(Trial(TRIAL, made)) == 1
    endless = log((20, "robot2", "in_way", {"by": HUMAN}), ticks=200, paths=paths)
    assert interference.hindered_by_pair(Trial(TRIAL, endless))["robot2 by human"] == interference.LONGEST_S
    late = log((190, "robot2", "in_way", {"by": HUMAN}), ticks=200, paths=paths)
    assert interference.hindered_by_pair(Trial(TRIAL, late))["robot2 by human"] == pytest.approx(1.0), (
        "not longer than the trial"
    )


def test_two_hindrances_at_once_cost_no_more_time():
    paths = {HUMAN: walk(30), "robot": walk(0), "robot2": walk(0)}
    rows = ((20, HUMAN, "in_way", {"by": "robot"}), (24, HUMAN, "in_way", {"by": "robot2"}))
    made = log(*rows, ticks=200, paths=paths)
    assert interference.human_hindered(Trial(TRIAL, made)) == pytest.approx(1.8)
    assert interference.hindered_by_pair(Trial(TRIAL, made))["human by robot2"] == pytest.approx(1.4)


@given(st.lists(st.integers(0, 199), max_size=8), st.integers(0, 200))
def test_nobody_loses_more_than_the_trial(ticks: list[int], stops: int):
    rows = [(tick, HUMAN, "in_way", {"by": "robot"}) for tick in sorted(ticks)]
    made = log(*rows, ticks=200, paths={HUMAN: walk(stops), "robot": walk(0)})
    assert 0.0 <= interference.human_hindered(Trial(TRIAL, made)) <= 20.0
    assert (interference.human_hindered(Trial(TRIAL, made)) > 0.0) == bool(ticks)


# ------------------------------------------------------------------------------------------------------------ messages


def sent(tick: int, seat: str, number: int, **claim) -> tuple:
    return (tick, seat, "sent", {"message": number, "text": "here", **claim})


def test_every_message_has_one_end():
    made = log(
        sent(1, "robot", 0, off=0.2),
        (2, HUMAN, "shown", {"message": 0}),
        (3, HUMAN, "accepted", {"message": 0}),
        sent(4, "robot2", 1, off=1.01),
        (5, "robot", "covered", {"message": 1, "by": 2}),
        sent(5, "robot", 2, off=None),
        (6, HUMAN, "declined", {"message": 2}),
        sent(7, "robot", 3),
        (8, HUMAN, "shown", {"message": 3}),
    )
    found = trial_metrics.measure(TRIAL, made)
    assert (found.sent, found.accepted, found.declined, found.covered, found.unanswered) == (4, 1, 1, 1, 1)
    assert found.false_claims == 2, "one is too far off, one is about nothing that there is"
    assert found.adoption == 1


@given(st.lists(st.sampled_from(("accepted", "declined", "covered", "shown", "")), max_size=20))
def test_ends_of_messages_add_up(ends: list[str]):
    rows = [sent(number, "robot", number) for number in range(len(ends))]
    rows += [(99, HUMAN, end, {"message": number}) for number, end in enumerate(ends) if end]
    found = trial_metrics.measure(TRIAL, log(*rows))
    assert found.sent == len(ends)
    assert found.sent == found.accepted + found.declined + found.covered + found.unanswered
    assert found.false_claims == 0


APPLE = ThingState(id="apple_2", kind="apple", position=(1.0, 1.0, 0.9), support="table")
TABLE = Thing(id="table", kind="dining_table", asset="t", centre=(3.0, 1.0, 0.4), size=(2.0, 1.0, 0.8), yaw=0.0)
HOME = HouseSpec(
    id="home",
    sha256="",
    rooms=(Room(id="r1", kind="kitchen", name="kitchen", polygon=((0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0))),),
    walls=(),
    openings=(),
    things=(TABLE,),
    height=2.5,
    start=Pose(x=1.0, y=1.0),
)
NOW = Snapshot(tick=5, poses={HUMAN: Pose(x=2.0, y=2.0)}, things={"apple_2": APPLE}, in_view={}, holding={HUMAN: ""})


@pytest.mark.parametrize(
    ("name", "position", "off"),
    [
        ("apple_2", (1.0, 1.0, 0.4), 0.5),
        ("apple", (1.0, 4.0, 0.9), 3.0),
        ("table", (2.1, 1.0, 0.8), 0.0),
        ("dining_table", (0.0, 1.0, 0.8), 2.0),
        ("r1", (1.0, 1.0, 0.0), 0.0),
        ("kitchen", (6.0, 1.0, 0.0), 2.0),
        (HUMAN, (2.0, 3.0, 1.5), 1.0),
        ("unicorn", (0.0, 0.0, 0.0), None),
        ("unicorn", None, None),
        ("apple_2", None, UNSET),
        ("", (1.0, 1.0, 1.0), UNSET),
    ],
)
def test_how_far_a_claim_is_off(name, position, off):
    found = claims.claim_error(name, position, NOW, HOME)
    assert found == off
    sent = Sent(tick=0, seat="robot", message=0, text="", off=found)
    assert claims.is_false(sent) == (off is None or (off is not UNSET and off > 1.0))


# ----------------------------------------------------------------------------------------------------------- all of it


def test_without_a_robot_only_what_concerns_the_person_has_a_value():
    made = log(progress=0.5, idle={HUMAN: 123}, paths={HUMAN: [(0, 0, 0)]})
    found = trial_metrics.measure(ALONE, made)
    assert (found.progress, found.idle_s) == (0.5, 12.3)
    assert (found.sent, found.in_way, found.hindered_s, found.work, found.hindered_by) == (None, None, None, {}, {})
    assert trial_metrics.measure(ALONE, log(paths={HUMAN: []})).progress is None


def test_scores_have_every_seat_and_every_pair():
    trials = fakes.run_of(10, name="tall+small")[1][0].trials
    found = estimates.estimate_metrics([score(make_record(trial, fakes.episode(trial))) for trial in trials])
    assert set(found.work) == {HUMAN, "robot", "robot2"}
    assert len(found.hindered_by) == 6
    assert found.work[HUMAN].n == sum(fakes.episode(trial).met for trial in trials)
    assert found.progress.n == 0
    assert found.idle_s.mean > 0.0


# ---------------------------------------------------------------------------------------------------------- the channel


def test_messages_as_a_channel():
    made = log(
        (100, "robot", "sent", {"message": 0, "off": 3.0}),
        (110, HUMAN, "shown", {"message": 0}),
        (120, HUMAN, "accepted", {"message": 0}),
        (200, "robot2", "sent", {"message": 1, "off": 0.2}),
        (210, HUMAN, "shown", {"message": 1}),
        (300, "robot", "sent", {"message": 2, "off": 0.0}),
        (310, HUMAN, "shown", {"message": 2}),
        (320, HUMAN, "accepted", {"message": 2}),
        (400, "robot", "sent", {"message": 3}),
        ticks=900,
    )
    found = trial_metrics.measure(TRIAL, made)
    assert found.precision == pytest.approx(2 / 3, abs=1e-6), "of three claims one was false"
    assert found.first_useful_s == 30.0, "true, and accepted"
    assert found.interruptions_per_min == 2.0
    silent = trial_metrics.measure(TRIAL, log())
    assert (silent.precision, silent.first_useful_s, silent.interruptions_per_min) == (None, None, 0.0)
    alone = trial_metrics.measure(ALONE, log())
    assert (alone.precision, alone.first_useful_s, alone.interruptions_per_min) == (None, None, None)


def test_what_a_robot_says_of_bodies_is_no_claim_that_counts():
    """A robot that tells where it is itself, all the time, is always right and of no use."""
    made = log(
        (100, "robot", "sent", {"message": 0, "object": "robot", "off": 0.0}),
        (110, HUMAN, "accepted", {"message": 0}),
        (120, "robot", "sent", {"message": 1, "object": HUMAN, "off": 0.0}),
        (200, "robot", "sent", {"message": 2, "object": "apple", "off": 3.0}),
        paths={HUMAN: [], "robot": []},
    )
    found = trial_metrics.measure(TRIAL, made)
    assert found.precision == 0.0, "of one claim none was true"
    assert found.first_useful_s is None
    assert found.false_claims == 1


def test_usefulness_is_of_the_confirmed_what_was_true_and_new():
    def offer(number, useful):
        return make_event(1, HUMAN, "offer", message=number, useful=useful)

    rows = [
        (100, "robot", "sent", {"message": 0, "object": "apple", "off": 3.0}),  # false
        (200, "robot", "sent", {"message": 1, "object": "apple", "off": 0.2}),  # true and new
        (300, "robot", "sent", {"message": 2, "object": "apple", "off": 0.2}),  # true, but known by now
        (400, "robot", "sent", {"message": 3}),  # claims nothing
        (500, "robot", "sent", {"message": 4, "object": "apple", "off": 0.2}),  # true, new, and not accepted
        *((600, HUMAN, "accepted", {"message": number}) for number in range(4)),
    ]
    journal = tuple(offer(number, number != 2) for number in range(5))
    found = trial_metrics.measure(TRIAL, log(*rows, journal=journal))
    assert (found.accepted, found.useful, found.usefulness) == (4, 1, 0.25)
    nothing = trial_metrics.measure(TRIAL, log())
    assert (nothing.useful, nothing.usefulness) == (0, None)
    alone = trial_metrics.measure(ALONE, log())
    assert (alone.useful, alone.usefulness) == (None, None)


# ------------------------------------------------------------------------------------------------------ several people


SECOND = "human2"
TWO = msgspec.structs.replace(
    TRIAL,
    humans=(TRIAL.humans[0], HumanSeat(seat=SECOND, model="proxy", sha256="0", participant=1)),
)
MIRROR = {HUMAN: SECOND, SECOND: HUMAN}


def shared(*events: tuple, journal: tuple[JournalEntry, ...] = (), **more) -> EpisodeLog:
    """A log of two people and two robots."""
    still = [(0, 0, 0)] * 451
    seats = (HUMAN, SECOND, "robot", "robot2")
    known = {"paths": dict.fromkeys(seats, still), "ratings": {HUMAN: 4, SECOND: 7}, "idle": {HUMAN: 40, SECOND: 90}}
    return log(*events, journal=journal, **{**known, **more})


def mirrored(made: EpisodeLog) -> EpisodeLog:
    """The log as it would be if the two people had each other's seats."""

    def event(one: LogEntry) -> LogEntry:
        texts = {name: value for name, value in msgspec.structs.asdict(one).items() if isinstance(value, str)}
        return msgspec.structs.replace(one, **{name: MIRROR.get(value, value) for name, value in texts.items()})

    changed = {
        name: {MIRROR.get(seat, seat): value for seat, value in getattr(made, name).items()}
        for name in ("paths", "ratings", "idle")
    }
    events, journal = (tuple(map(event, some)) for some in (made.events, made.journal))
    return msgspec.structs.replace(made, events=events, journal=journal, **changed)


CONVERSATION = (
    sent(10, "robot", 0, object="apple", off=0.2),  # to both; accepted by one, who knew it, and by the other
    (11, HUMAN, "shown", {"message": 0}),
    (11, SECOND, "shown", {"message": 0}),
    (20, HUMAN, "declined", {"message": 0}),
    (25, SECOND, "accepted", {"message": 0}),
    sent(30, "robot2", 1, to=SECOND, object="apple", off=3.0),  # to one; covered by a question
    (31, SECOND, "shown", {"message": 1}),
    (40, "robot", "covered", {"message": 1, "by": 2, "reader": SECOND}),
    sent(40, "robot", 2, to=SECOND, question=True),
    (41, SECOND, "shown", {"message": 2}),
    (45, SECOND, "answered", {"message": 2, "yes": True}),
    sent(50, HUMAN, 3, question=True),  # a person asks; the robot's answer is no suggestion, but a claim
    sent(55, "robot", 4, to=HUMAN, answers=3, object="apple", off=0.1),
    (56, HUMAN, "shown", {"message": 4}),
    (57, HUMAN, "accepted", {"message": 4}),
    sent(60, "robot2", 5, object="mug", off=0.3),  # to both; nobody answers
    (61, HUMAN, "shown", {"message": 5}),
)
HINDERED = (
    (100, HUMAN, "in_way", {"by": "robot"}),
    (300, HUMAN, "in_way", {"by": SECOND}),
    (300, SECOND, "in_way", {"by": HUMAN}),
    (500, SECOND, "in_way", {"by": "robot2"}),
    (580, SECOND, "in_way", {"by": "robot"}),
)
NEW = (make_event(20, HUMAN, "offer", message=0),)


def test_a_message_to_several_people_counts_once_with_its_best_end():
    found = trial_metrics.measure(TWO, shared(*CONVERSATION, journal=NEW))
    assert (found.sent, found.accepted, found.declined, found.covered, found.unanswered) == (3, 1, 0, 1, 1)
    assert (found.adoption, found.adoption_by) == (0.5, {HUMAN: 0.0, SECOND: 1.0})
    assert (found.false_claims, found.precision) == (1, 0.75)
    assert (found.useful, found.usefulness) == (0, 0.0), "it was new to the one who declined it"
    assert found.first_useful_s == 1.0
    assert found.interruptions_per_min == pytest.approx(5 / 2 / 1.5), "an answer is none, a question is one"


def test_what_people_lose_to_robots_is_the_mean_and_what_to_one_another_is_told_apart():
    found = trial_metrics.measure(TWO, shared(*HINDERED))
    assert found.hindered_s == (5.0 + 5.0 + 5.0) / 2
    assert (found.hindered_by["human by human2"], found.hindered_by["human2 by human"]) == (5.0, 5.0)
    assert (found.hindered_by["human2 by robot2"], found.hindered_by["robot by human2"]) == (5.0, 0.0)
    assert found.in_way == 5
    assert (found.idle_s, found.idle_by) == (6.5, {HUMAN: 4.0, SECOND: 9.0})
    assert (found.trust, found.trust_by) == (5.5, {HUMAN: 4.0, SECOND: 7.0})


def test_a_find_is_credited_to_the_person_who_saw_it():
    made = shared((50, SECOND, "success", {}), met=True, ticks=50)
    assert trial_metrics.measure(TWO, made).work == {HUMAN: 0.0, SECOND: 1.0, "robot": 0.0, "robot2": 0.0}


@pytest.mark.parametrize("events", [CONVERSATION, HINDERED, (*CONVERSATION, *HINDERED)])
def test_the_order_of_seats_makes_no_difference(events: tuple[tuple, ...]):
    made = shared(*events, journal=NEW)
    here, there = (trial_metrics.measure(TWO, one) for one in (made, mirrored(made)))
    for metric in registry.SINGLE:
        assert here[metric.name] == there[metric.name], metric.name
    for metric in registry.BY_SEAT:
        swapped = {
            " by ".join(MIRROR.get(seat, seat) for seat in name.split(" by ")): value
            for name, value in there.by_seat(metric.name).items()
        }
        assert here.by_seat(metric.name) == swapped, metric.name


def test_somebody_who_is_absent_changes_only_what_is_shared_by_all():
    """Absent: stands there all the time, accepts nothing, meets nobody, rates nothing."""
    rows = (
        sent(10, "robot", 0, object="apple", off=0.2),
        (20, HUMAN, "accepted", {"message": 0}),
        sent(30, "robot2", 1, object="apple", off=3.0),
        (32, HUMAN, "declined", {"message": 1}),
        sent(40, "robot", 2),
        (60, HUMAN, "in_way", {"by": "robot"}),
        (70, "robot", "in_way", {"by": HUMAN}),
    )
    alone = trial_metrics.measure(TRIAL, log(*rows, idle={HUMAN: 40}, met=True, journal=NEW))
    beside = trial_metrics.measure(
        TWO, shared(*rows, idle={HUMAN: 40, SECOND: 900}, ratings={HUMAN: 4, SECOND: None}, met=True, journal=NEW)
    )
    shares = {"adoption": 0.5, "idle_s": 47.0, "hindered_s": alone.hindered_s / 2}
    shares |= {"panel_shown_s": (alone.panel_shown_s + 89.0) / 2, "map_shown_s": alone.map_shown_s / 2}
    for metric in registry.SINGLE:
        wanted = shares.get(metric.name, alone[metric.name])
        assert beside[metric.name] == wanted, metric.name
    assert {pair: beside.hindered_by[pair] for pair in alone.hindered_by} == alone.hindered_by
    assert beside.work == {**alone.work, SECOND: 0.0}


def test_one_person_has_no_values_by_person():
    line = msgspec.json.decode(msgspec.json.encode(trial_metrics.measure(TRIAL, log(idle={HUMAN: 9}))))
    assert not {"adoption_by", "idle_by", "trust_by"} & set(line)
    assert (line["adoption"], line["trust"], line["idle_s"]) == (0, 4, 0.9)
    trials = [score(make_record(trial, fakes.episode(trial))) for trial in fakes.run_of(10)[1][0].trials]
    assert "trust_by" not in msgspec.to_builtins(estimates.estimate_metrics(trials))


# ------------------------------------------------------------------------------------------------------------ displays


def test_how_long_panel_and_map_were_shown():
    """The panel from 4 to 6 s, hidden for the last half second of it; the map from 6 s on, without 20 to 50 s."""
    events = [
        (40, "robot", "sent", {"message": 0}),
        (55, HUMAN, "displayed", {"what": "panel", "on": False, "message": 0}),
        (60, HUMAN, "accepted", {"message": 0, "sender": "robot"}),
        (200, HUMAN, "displayed", {"what": "map", "on": False, "message": 0}),
        (500, HUMAN, "displayed", {"what": "map", "on": True, "message": 0}),
    ]
    shown = trial_metrics.measure(TRIAL, log(*events))
    assert (shown["panel_shown_s"], shown["map_shown_s"]) == pytest.approx((1.5, 54.0))
    silent = trial_metrics.measure(TRIAL, log())
    assert (silent["panel_shown_s"], silent["map_shown_s"]) == (0.0, 0.0)
    assert trial_metrics.measure(ALONE, log(paths={HUMAN: [(0, 0, 0)] * 451}))["map_shown_s"] is None
