"""One person is measured from a session: every estimator finds what a fake log was made of, or says why it cannot."""

from __future__ import annotations

import math
from typing import Any

import eval_fakes as fakes
import msgspec
import numpy as np
import pytest
from event_fakes import make_event
from hypothesis import given, settings
from hypothesis import strategies as st
from law_cases import cases

from hthor import seeds, tasks
from hthor.agents import unreliable
from hthor.calibration.from_logs import trial_features
from hthor.calibration.from_logs.models import trust_model
from hthor.calibration.from_logs.trial_features import Sessions, Trial, TrialFeatures
from hthor.calibration.person import (
    hands,
    messages,
    population_comparison,
    profile,
    protocol,
    row_words,
    trust,
    walking,
    words,
)
from hthor.calibration.person.measure import Measure, middle, share, typical, unknown, weighted
from hthor.calibration.person.messages import Answer
from hthor.calibration.person.walking import Practice
from hthor.errors import HthorError
from hthor.eval.config.options import EvalOptions
from hthor.eval.records.trial_record import make_record
from hthor.humans.population import parameter_registry, population_file, resolve
from hthor.types import HUMAN
from hthor.types.events import Head, Inputs, JournalEntry, Stick

SESSION = fakes.run_of(10, name="small")[1][0].trials
POPULATION = population_file.load_population(resolve.default_population())
NO_PRACTICE = Practice(0.0, 0.0)
AT = (3.0, 0.0, 0.8)


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.Generator(np.random.Philox(key=seeds.derive(0, "person")))


def trial(
    index: int = 0,
    *events: tuple[int, str, dict[str, Any]],
    stick: tuple[int, ...] = (0, 0),
    yaw: list[float] | None = None,
    ticks: int = 600,
    rating: int | None = 4,
    journal: tuple[JournalEntry, ...] = (),
) -> Trial:
    """A trial of a person at a page, with a stick, in ticks and thousandths of 1 m/s, and the gaze every 0.2 s."""
    turned = yaw or [0.0] * (ticks // 2 + 1)
    gone = [0.0]
    for k in range(1, len(turned)):
        pushed = [value for at, value in zip(stick[::2], stick[1::2], strict=True) if at <= 2 * k][-1]
        gone.append(gone[-1] + pushed * 0.2 / 1000.0)
    path = [(round(1000 * x), 0, round(1000 * angle)) for x, angle in zip(gone, turned, strict=True)]
    log = msgspec.structs.replace(
        fakes.episode(SESSION[index]),
        events=tuple(
            make_event(tick, "robot" if kind == "sent" else HUMAN, kind, **data) for tick, kind, data in events
        ),
        ticks=ticks,
        ratings={HUMAN: rating},
        paths={HUMAN: path, "robot": [(0, 0, 0)] * len(path)},
        journal=(
            Stick(tick=0, seat=HUMAN, full=1.0, runs=stick),
            Head(tick=0, seat=HUMAN, fastest=2.5, pitch=()),
            *(journal or (Inputs(tick=0, seat=HUMAN, runs=(0, 0, 0, 0, 0, 0)),)),
        ),
    )
    return Trial(record=make_record(SESSION[index], log), person=0, session=0)


def features(*trials: Trial) -> tuple[TrialFeatures, ...]:
    return trial_features.extract_features(Sessions(trials=trials, people=1, sessions=1))


def by_name(measures: list[Measure]) -> dict[str, Measure]:
    return {one.name: one for one in measures}


def holds(one: Measure, truth: float) -> bool:
    return one.value is not None and one.low <= truth <= one.high


# ---------------------------------------------------------------------------------------------------- plain intervals


@given(st.lists(st.floats(0.05, 50.0), min_size=5, max_size=40), st.floats(0.0, 0.1))
@settings(max_examples=cases(40), deadline=None)
def test_intervals_hold_their_own_middle_and_grow_with_the_common_error(values: list[float], error: float) -> None:
    for estimate in (typical, middle):
        value, low, high = estimate(values)
        assert min(values) * (1 - 1e-9) <= value <= max(values) * (1 + 1e-9)
        assert low <= value * (1 + 1e-9)
        assert value <= high * (1 + 1e-9)
        _, wider_low, wider_high = estimate(values, error=error)
        assert wider_low <= low * (1 + 1e-9)
        assert wider_high >= high * (1 - 1e-9)


@given(st.integers(1, 60).flatmap(lambda n: st.tuples(st.integers(0, n), st.just(n))))
@settings(max_examples=cases(40), deadline=None)
def test_a_share_is_inside_its_interval_which_ends_where_shares_end(pair: tuple[int, int]) -> None:
    hits, count = pair
    value, low, high = share(hits, count)
    assert 0.0 <= low <= value <= high <= 1.0
    assert (low == 0.0) == (hits == 0)
    assert (high == 1.0) == (hits == count)


def test_a_typical_value_is_found_in_nine_of_ten_samples(rng: np.random.Generator) -> None:
    found = [typical(np.exp(rng.normal(0.3, 0.4, 8)).tolist()) for _ in range(400)]
    assert 0.86 < np.mean([low <= math.exp(0.3) <= high for _, low, high in found]) < 0.94


def test_weighted_values_follow_their_weights() -> None:
    grid = np.linspace(-4.0, 4.0, 801)
    value, low, high = weighted(grid, -0.5 * ((grid - 1.0) / 0.5) ** 2)
    assert (value, low, high) == pytest.approx((1.0, 1.0 - 1.645 * 0.5, 1.0 + 1.645 * 0.5), abs=0.01)


# ---------------------------------------------------------------------------------------------------------- walking


@pytest.mark.parametrize("pace", [0.31, 0.6, 0.9])
def test_a_pace_is_that_of_the_stick_under_way(pace: float) -> None:
    stick = (0, 0, 30, round(1000 * pace), 400, 0)
    found = by_name(walking.walking(features(*(trial(k, stick=stick) for k in range(4))), NO_PRACTICE))
    assert holds(found["v_pace"], pace)
    assert found["v_pace"].value == pytest.approx(pace, rel=1e-3)
    assert holds(found["t_on"], 3.0)
    assert found["k_map"].value is None


def test_a_pace_is_brought_back_to_the_first_trial() -> None:
    practice = Practice(0.2, 0.05)
    paces = [0.5 * practice.factor(k) for k in range(5)]
    trials = [trial(k, stick=(0, 0, 30, round(1000 * pace), 400, 0)) for k, pace in enumerate(paces)]
    one = by_name(walking.walking(features(*trials), practice))["v_pace"]
    assert one.value == pytest.approx(0.5, rel=2e-3)
    assert one.high / one.low > 1.1, "how much a person gains is not known"


@pytest.mark.parametrize("pace", [0.986, 1.0])
def test_somebody_at_full_stick_may_be_faster_or_just_as_fast(pace: float) -> None:
    stick = (0, 0, 30, round(1000 * pace), 400, 0)
    one = by_name(walking.walking(features(*(trial(k, stick=stick) for k in range(4))), NO_PRACTICE))["v_pace"]
    assert (one.bound, one.value, one.high) == ("at least", one.low, math.inf)
    assert 0.94 < one.low < pace, "the least pace that would look like this"


@given(st.floats(0.75, 1.3), st.floats(0.0, 0.4))
@settings(max_examples=cases(25), deadline=None)
def test_a_person_at_full_stick_by_practice_may_have_begun_slower(own: float, learn: float) -> None:
    """However much they gain themselves, as long as it is within what the population's spread allows."""
    trials = []
    for k in range(9):
        pace = min(1.0, own * Practice(learn, 0.0).factor(k))
        trials.append(trial(k, stick=(0, 0, 30, round(1000 * pace), 400, 0)))
    one = by_name(walking.walking(features(*trials), Practice(0.2, 0.12)))["v_pace"]
    assert holds(one, own)


def test_somebody_who_turns_as_fast_as_the_body_may_be_faster_or_just_as_fast() -> None:
    found = []
    for rate in (2.47, 2.5):
        yaw = [0.0] * 20 + [0.2 * rate * k for k in range(12)]
        yaw += [yaw[-1]] * (301 - len(yaw))
        one = by_name(walking.walking(features(*(trial(k, yaw=yaw) for k in range(4))), NO_PRACTICE))["omega"]
        assert one.bound == "at least"
        assert 2.35 < one.low < rate
        found.append(one.low)
    assert found[0] == found[1], "the two look alike"


@pytest.mark.parametrize("rate", [0.8, 1.7])
def test_turns_tell_the_speed_of_turning(rate: float) -> None:
    yaw = [0.0] * 20 + [0.2 * rate * k for k in range(12)]
    yaw += [yaw[-1]] * (301 - len(yaw))
    one = by_name(walking.walking(features(*(trial(k, yaw=yaw) for k in range(4))), NO_PRACTICE))["omega"]
    assert holds(one, rate)
    assert one.value == pytest.approx(rate, rel=0.02)


def test_the_look_round_is_the_angle_turned_before_the_first_step() -> None:
    yaw = [min(0.3 * k, 3.0) for k in range(301)]
    trials = [trial(k, yaw=yaw, stick=(0, 0, 100, 500, 300, 0)) for k in range(3)]
    assert walking.look_round(trials).value == pytest.approx(3.0, abs=0.01)


@given(st.lists(st.integers(1, 30), min_size=1, max_size=6))
@settings(max_examples=cases(25), deadline=None)
def test_starts_are_timed_by_sixtieths_of_a_second(rises: list[int]) -> None:
    """Each start has a slow step first, and full speed so many steps later."""
    runs, step = [], 0
    for rise in rises:
        for at, speed in ((step + 60, 1000), (step + 60 + rise, 9000), (step + 160, 0)):
            runs += [at // 6, at % 6, speed, 0, 0, 0]
        step += 200
    found = walking.rises_of(Inputs(tick=0, seat=HUMAN, runs=tuple(runs)))
    assert found == pytest.approx([rise / 60.0 for rise in rises])


# ------------------------------------------------------------------------------------------------------------ hands


@given(st.lists(st.integers(10, 80), min_size=4, max_size=9))
@settings(max_examples=cases(25), deadline=None)
def test_hands_are_timed_from_the_last_step(times: list[int]) -> None:
    trials, stick, tick = [], [0, 0], 10
    events: list[tuple[int, str, dict[str, Any]]] = []
    for number, each in enumerate(times):
        stick += [tick, 500, tick + 20, 0]
        what = ("picked", {"object": "apple"}) if number % 2 == 0 else ("placed", {"object": "apple", "on": "table"})
        events.append((tick + 20 + each, *what))
        tick += 20 + each + 1
    trials = [trial(0, *events, stick=tuple(stick), ticks=max(600, tick + tick % 2))]
    one = by_name(hands.hands(features(*trials), NO_PRACTICE))
    expected = typical([each / 10.0 - 0.4 for each in times])
    assert one["t_manip"].value == pytest.approx(expected[0], rel=0.05)
    assert one["t_manip"].n == len(times)
    assert "no misses" in one["p_fail"].unknown


def test_time_with_a_message_is_no_time_of_the_hands() -> None:
    sent: list[tuple[int, str, dict[str, Any]]] = [
        (90, "sent", {"message": 0, "object": "apple", "position": AT}),
        (95, "shown", {"message": 0}),
    ]
    got = (110, "picked", {"object": "apple"})
    stick = (0, 0, 10, 500, 60, 0)
    assert len(features(trial(0, got, stick=stick))[0].attempts) == 1
    assert features(trial(0, *sent, got, stick=stick))[0].attempts == ()


# ---------------------------------------------------------------------------------------------------------- messages


def told(rng: np.random.Generator, notice: float, read: float) -> list[Trial]:
    """Four trials with messages of six and of twenty words, noticed and read as the model has it."""
    trials = []
    for index in range(4):
        events: list[tuple[int, str, dict[str, Any]]] = []
        for number in range(5):
            count = 20 if number % 2 else 6
            takes = notice * math.exp(0.4 * rng.normal()) + read * count / 12.0 * math.exp(0.4 * rng.normal())
            at = 20 + 250 * number
            text = " ".join(["word"] * count)
            events += [
                (
                    at,
                    "sent",
                    {"message": number, "object": "apple", "position": (4.0 * number, 0.0, 0.8), "text": text},
                ),
                (at, "shown", {"message": number}),
                (at + max(1, round(10 * takes)), "accepted", {"message": number}),
            ]
        trials.append(trial(index, *events, ticks=1400))
    return trials


def test_answers_to_short_and_long_messages_tell_the_time_to_read(rng: np.random.Generator) -> None:
    found = []
    for _ in range(12):
        notice, read = math.exp(rng.uniform(0.0, 0.8)), math.exp(rng.uniform(0.7, 1.5))
        measured = by_name(messages.reading(features(*told(rng, notice, read))))
        found.append((holds(measured["reading"], notice + read), holds(measured["t_read"], read)))
        assert measured["reading"].value == pytest.approx(notice + read, rel=0.35)
    assert sum(total for total, _ in found) >= 8
    assert sum(own for _, own in found) >= 8


def test_willingness_is_found_and_bounded_by_those_who_confirm_everything(rng: np.random.Generator) -> None:
    hits = 0
    for a0 in (-2.0, -1.0, 0.0, 1.0, 2.0):
        mean = POPULATION.parameters(POPULATION.pick(1, round(a0)))
        logit = a0 + mean.a_gain * math.log1p(12.0)
        answers = [
            Answer(
                accepted=bool(rng.random() < 1 / (1 + math.exp(-logit))),
                true=k % 2 == 0,
                trust=0.5,
                load=0.0,
                again=0.0,
            )
            for k in range(40)
        ]
        one = by_name(messages.acceptance(answers, POPULATION))["a0"]
        hits += one.bound != "" or holds(one, a0)
    assert hits >= 4
    every = [Answer(accepted=True, true=True, trust=0.5, load=0.0, again=0.0)] * 10
    one = by_name(messages.acceptance(every, POPULATION))["a0"]
    assert one.bound == "at least"
    assert one.high == math.inf
    none = [msgspec.structs.replace(each, accepted=False) for each in every]
    refused = by_name(messages.acceptance(none, POPULATION))["a0"]
    assert refused.bound == "at most"
    assert refused.value is not None
    assert one.value is not None
    assert refused.value < one.value


def test_answers_know_right_from_wrong_what_was_in_hand_and_the_last_rating() -> None:
    def offered(number: int, tick: int, off: float, answer: str) -> list[tuple[int, str, dict[str, Any]]]:
        return [
            (tick, "sent", {"message": number, "object": "apple", "position": AT, "off": off}),
            (tick + 1, "shown", {"message": number}),
            (tick + 30, answer, {"message": number}),
        ]

    first = trial(0, *offered(0, 50, 0.1, "declined"), *offered(1, 150, 4.0, "accepted"), rating=7)
    second = trial(1, (40, "picked", {"object": "apple"}), *offered(0, 50, 0.0, "accepted"))
    found = messages.answers_of([first, second])
    assert [(one.accepted, one.true, one.trust, one.load, one.again) for one in found] == [
        (False, True, None, 0.0, 0.0),
        (True, False, None, 0.0, 1.0),
        (True, True, 1.0, 1.0, 0.0),
    ]
    shares = by_name(messages.shares(found))
    assert (shares["confirmed_right"].value, shares["confirmed_wrong"].value) == (0.5, 1.0)


def test_a_person_at_a_page_is_misled_by_a_wrong_place_that_they_come_to() -> None:
    def followed(off: float, metres: float) -> trust_model.Experience:
        sent = {"message": 0, "object": "apple", "position": (metres, 0.0, 0.8), "off": off}
        events: list[tuple[int, str, dict[str, Any]]] = [
            (20, "sent", sent),
            (21, "shown", {"message": 0}),
            (40, "accepted", {"message": 0}),
        ]
        return features(trial(0, *events, stick=(0, 0, 50, 500, 150, 0)))[0].experience

    assert followed(4.0, 5.0).misled == 1
    assert followed(4.0, 50.0).misled == 0
    right = followed(0.1, 5.0)
    assert right.misled == 0
    assert right.helped == pytest.approx(4.0)


# ------------------------------------------------------------------------------------------------------------- trust


def test_ratings_tell_trust_at_first(rng: np.random.Generator) -> None:
    hits = 0
    for number in range(12):
        own = POPULATION.draw_traits(3, number)
        plain = features(*(trial(k) for k in range(8)))
        lived = [
            trust_model.Experience(
                offered=True, helped=float(rng.choice([10.0, math.nan])), misled=0, met=True, rating=1
            )
            for _ in plain
        ]
        data = trust_model.make_trust_data([lived], np.zeros(1, dtype=int))
        values = {name: math.log(getattr(own, name)) for name in ("n0", "w_s", "w_f", "tau_s")}
        _, after = trust_model.mean_trust(data, {**values, "mu0": math.log(own.mu0 / (1 - own.mu0))}, np.zeros(1))
        ratings = np.clip(np.rint(1 + 6 * after[0] + 0.7 * rng.normal(size=8)), 1, 7).astype(int)
        rated = [
            msgspec.structs.replace(one, experience=msgspec.structs.replace(each, rating=int(value)))
            for one, each, value in zip(plain, lived, ratings, strict=True)
        ]
        found = by_name(trust.trust(rated, POPULATION))
        hits += holds(found["mu0"], own.mu0)
        assert (found["first_rating"].value, found["last_rating"].value) == (ratings[0], ratings[-1])
    assert hits >= 9


# ------------------------------------------------------------------------------------------------------------ profile


def test_every_parameter_is_measured_or_has_a_reason() -> None:
    assert set(words.PARAMETERS) == {*parameter_registry.free_parameter_names(), "reading"}
    house = tasks.load_suite("smoke").houses.load("alder")
    parameters, others = profile.measure_person([trial(0, rating=None)], POPULATION, lambda _: house)
    assert {one.name for one in parameters} == set(words.PARAMETERS)
    assert all(one.value is None and one.unknown for one in parameters), "somebody who stood still tells nothing"
    assert {one.name for one in others} == set(words.OTHERS)


def test_people_are_compared_by_rank_and_by_spread() -> None:
    people = {"v_pace": np.linspace(0.2, 1.2, 1001), "omega": np.full(10, 2.0)}
    made = [
        Measure(name="v_pace", unit="m/s", value=0.9, low=0.8, high=1.0, n=5),
        Measure(name="omega", unit="rad/s", value=1.0, low=0.9, high=1.1, n=5),
        unknown("lam0", "1/s", "it takes more"),
    ]
    pace, turning, noticing = population_comparison.compare(made, words.PARAMETERS, people)
    assert [pace.below, pace.z] == [pytest.approx(70.0, abs=0.1), pytest.approx(0.69, abs=0.01)]
    assert row_words.place_words(pace) == "more than 70 of 100 people"
    assert row_words.z_words(pace) == "+0.7"
    assert row_words.value_words(pace.measure) == "0.90 m/s (0.80 … 1.00)"
    assert (turning.below, turning.z) == (None, None), "nobody differs"
    assert (noticing.people, row_words.value_words(noticing.measure)) == (None, "–")
    bound = msgspec.structs.replace(pace.measure, bound="at least", high=math.inf)
    assert row_words.value_words(bound) == "at least 0.90 m/s"


# ----------------------------------------------------------------------------------------------------------- protocol


def test_the_session_is_prescribed() -> None:
    plain = EvalOptions(humans=("live",))
    made = protocol.prescribed(plain)
    assert (made.suite, made.agent) == ("calibration", ("unreliable",))
    for change in ({"suite": "paper"}, {"agent": ("oracle",)}, {"limit": 2}, {"humans": ("live,live",)}):
        with pytest.raises(HthorError, match="--calibrate"):
            protocol.prescribed(msgspec.structs.replace(plain, **change))


def test_each_task_of_the_session_has_its_part_in_three_houses() -> None:
    kinds = [task.kind for task in tasks.load_suite("calibration").tasks]
    assert {kind: kinds.count(kind) for kind in set(kinds)} == {
        "visual_language_navigation": 3,
        "object_goal_navigation": 3,
        "mobile_manipulation": 3,
    }
    told = [
        truth
        for task in tasks.load_suite("calibration").tasks
        if task.kind != "visual_language_navigation"
        for truth in unreliable.truths(f"{task.house} {task.instruction}")
    ]
    assert 0.35 < np.mean(told) < 0.65


@given(st.text(max_size=12))
@settings(max_examples=cases(40), deadline=None)
def test_never_more_than_two_messages_in_a_row_are_alike(key: str) -> None:
    found = unreliable.truths(key)
    assert len(found) == unreliable.MOST
    assert all(len(set(found[k : k + 3])) == 2 for k in range(len(found) - 2))
