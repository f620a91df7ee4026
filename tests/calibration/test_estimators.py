"""Estimators find what synthetic people were made of, say so when they cannot, and a population takes it up."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path

import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from law_cases import cases

from benchmarks import recovery
from hthor import seeds, tasks
from hthor.calibration.from_logs import estimate, estimate_all, run, trial_features
from hthor.calibration.from_logs.features.messages import Offer, Reading
from hthor.calibration.from_logs.models import mixed_effects, priors, search_models, timing_models, trust_model
from hthor.calibration.from_logs.models.mixed_effects import Fit, Term
from hthor.calibration.from_logs.models.priors import to_scale
from hthor.calibration.from_logs.models.search_models import Choice, Exposure
from hthor.calibration.from_logs.models.trust_model import Experience
from hthor.calibration.from_logs.update_population import update_draws
from hthor.errors import RunError
from hthor.eval.records import trial_record
from hthor.eval.records.trial_record import TrialRecord
from hthor.humans.communication.trust import Experience as Lived
from hthor.humans.communication.trust import Trust, initial_trust
from hthor.humans.population import population_file
from hthor.humans.population.parameters import Parameters
from hthor.tasks.suite import make_suite
from hthor.trials import TrialRunner

BELIEFS = priors.prior_beliefs()
PEOPLE = 12
RNG = "estimators"


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.Generator(np.random.Philox(key=seeds.derive(0, RNG)))


def near(fit: Fit, name: str, truth: float, widths: float = 3.0) -> bool:
    """Whether the truth lies within so many standard errors, and the error says something."""
    return abs(fit.value[name] - truth) <= widths * fit.se[name] and fit.se[name] < 0.9 * BELIEFS[name].sd


def test_a_random_effect_is_told_from_noise(rng: np.random.Generator) -> None:
    """Against the exact answer: with equal numbers of normal data, the spread has a closed form."""
    person = np.repeat(np.arange(30), 8)
    own, noise = rng.normal(0.0, 0.5, 30), rng.normal(0.0, 0.3, 240)
    y = 1.0 + own[person] + noise

    def likelihood(values: dict[str, float], effects: np.ndarray) -> np.ndarray:
        return -0.5 * ((y - values["m"] - effects) / 0.3) ** 2

    wide = [Term(name="m", start=0.0, sd=100.0)]
    found = mixed_effects.fit_mixed_model(likelihood, wide, person, Term(name="spread", start=-1.0, sd=100.0))
    means = np.bincount(person, y) / 8.0
    exact = math.sqrt(means.var() - 0.3**2 / 8.0)  # where the likelihood of the thirty means is largest
    assert found.value["m"] == pytest.approx(means.mean(), abs=1e-3)
    assert math.exp(found.value["spread"]) == pytest.approx(exact, rel=0.02)
    assert found.se["m"] == pytest.approx(math.sqrt(means.var() / 30.0), rel=0.03)
    assert np.corrcoef(found.effects, own)[0, 1] > 0.9


def test_a_median_is_found_with_practice_and_with_what_the_device_cuts_off(rng: np.random.Generator) -> None:
    person = np.repeat(np.arange(PEOPLE), 10)
    index = np.tile(np.arange(10), PEOPLE)
    own = rng.normal(0.0, 0.15, PEOPLE)[person]
    pace = 0.8 * np.exp(own) * (1.0 + 0.3 * (1.0 - np.exp(-index / 3.0))) * np.exp(rng.normal(0.0, 0.03, len(person)))
    rows = [(min(y, 1.0), p, i, int(y >= 1.0)) for y, p, i in zip(pace, person, index, strict=True)]
    assert sum(cut for *_, cut in rows) > 30
    data, terms = timing_models.make_sample(rows), (BELIEFS["v_pace"].term(), BELIEFS["learn"].term())
    found = timing_models.fit_log_normal(data, terms[0], 0.5, noise=0.03, practice=1, learn=terms[1])
    assert near(found, "v_pace", math.log(0.8))
    assert near(found, "learn", 0.3)
    assert math.exp(found.value["spread"]) == pytest.approx(0.15, rel=0.5)


def some_choices(rng: np.random.Generator, beta: float, kappa: float, w: float, count: int) -> Iterator[Choice]:
    dwell, manip = BELIEFS["t_dwell"].middle, BELIEFS["t_manip"].middle
    for _ in range(count):
        n = int(rng.integers(3, 10))
        knowledge, uniform = rng.dirichlet(np.full(n, 0.5)), np.full(n, 1.0 / n)
        metres, exposure, closed = rng.uniform(0.5, 9.0, n), rng.exponential(0.5, n), rng.random(n) < 0.3
        door = np.arange(n) == 0
        closed, exposure = closed & ~door, np.where(door, 0.0, exposure)
        seconds = np.where(door, metres / 0.6 + 2.0, metres / 0.6 + dwell + 1.0 + manip * closed)
        worth = (w * knowledge + (1.0 - w) * uniform) * np.exp(-exposure) / seconds**kappa
        share = worth**beta / (worth**beta).sum()
        table = np.stack([knowledge, uniform, metres, exposure, closed, door], axis=1)
        yield Choice(options=table.tolist(), chosen=int(rng.choice(n, p=share)), pace=0.6)


def test_choices_tell_rationality_and_the_weight_of_time(rng: np.random.Generator) -> None:
    made = list(some_choices(rng, beta=2.0, kappa=0.8, w=0.7, count=600))
    found = search_models.fit_choices(made, np.arange(600) % PEOPLE, BELIEFS)
    assert near(found, "beta", math.log(2.0))
    assert near(found, "kappa", 0.8)
    assert near(found, "w_prior", float(to_scale(0.7, "logit")))


def test_exposures_tell_the_rate_of_noticing(rng: np.random.Generator) -> None:
    traits, found, person = Parameters(lam0=1.2, a50=0.04), [], []
    own = rng.normal(0.0, 0.25, PEOPLE)
    for k in range(500):
        rows, noticed = [], False
        angle, beside = float(np.exp(rng.uniform(np.log(0.01), np.log(0.2)))), int(rng.integers(0, 4))
        while len(rows) < 20 and not noticed:
            ecc = abs(float(rng.normal(0.0, 0.5)))
            rows.append([0.3, angle, ecc, 0.9, beside, 0])
            rate = traits.lam0 * math.exp(own[k % PEOPLE]) * 0.9 / (1.0 + (traits.a50 / angle) ** 2)
            rate *= math.exp(-0.5 * (ecc / traits.ecc_sd) ** 2 - traits.clutter * beside)
            noticed = float(rng.random()) < 1.0 - math.exp(-rate * 0.3)
        found.append(Exposure(rows=rows, noticed=noticed))
        person.append(k % PEOPLE)
    fit = search_models.fit_detection(found, np.array(person), BELIEFS)
    assert near(fit, "lam0", math.log(1.2))
    assert near(fit, "a50", 0.04)


def test_reading_time_is_found_though_some_never_answer(rng: np.random.Generator) -> None:
    person, read = np.repeat(np.arange(PEOPLE), 12), []
    own = rng.normal(0.0, 0.25, PEOPLE)
    for who in person:
        words, known = int(rng.integers(5, 18)), bool(rng.random() < 0.3)
        length = max(4, words) / 12 * (0.5 if known else 1.0)
        notice, reads = 1.4 * math.exp(rng.normal(0.0, 0.4)), 3.5 * length * math.exp(own[who] + rng.normal(0.0, 0.4))
        left = bool(rng.random() < 0.15)
        read.append(Reading(seconds=40.0 if left else notice + reads, answered=not left, words=words, known=known))
    fit = timing_models.fit_reading(read, person, BELIEFS)
    total = math.exp(fit.value["t_notice"]) + math.exp(fit.value["t_read"])
    assert total == pytest.approx(1.4 + 3.5, rel=0.1)


def test_answers_tell_willingness_and_what_sways_it(rng: np.random.Generator) -> None:
    person, trust = np.repeat(np.arange(PEOPLE), 20), rng.uniform(0.2, 0.9, 20 * PEOPLE)
    own, offers = rng.normal(0.0, 0.5, PEOPLE), []
    for who, level in zip(person, trust, strict=True):
        gain, load, again = float(rng.exponential(10.0)), float(rng.random() < 0.3), float(rng.integers(0, 3))
        logit = 0.5 + own[who] + 4.0 * (level - 0.5) + 0.5 * math.log1p(gain) - 1.5 * load - 0.5 * again
        said = bool(rng.random() < 1.0 / (1.0 + math.exp(-logit)))
        offers.append(Offer(gain=gain, load=load, again=again, accepted=said))
    fit = trust_model.fit_acceptance(offers, trust, person, BELIEFS)
    for name, truth in (("a0", 0.5), ("a_trust", 4.0), ("a_gain", 0.5), ("a_load", 1.5), ("a_again", 0.5)):
        assert abs(fit.value[name] - truth) < 3.0 * fit.se[name], name
    assert near(fit, "a0", 0.5)


def a_session(rng: np.random.Generator, traits: Parameters) -> list[Experience]:
    """Ten trials as `hthor.humans.communication.trust` has them, with their ratings."""
    trust, seen = initial_trust(traits), []
    for _ in range(10):
        offered, met = bool(rng.random() < 0.8), bool(rng.random() < 0.7)
        helped = float(rng.uniform(5.0, 60.0)) if offered and rng.random() < 0.7 else None
        misled = int(offered and helped is None and rng.random() < 0.3)
        for _ in range(misled):
            trust = trust.after(0.0, traits)
        lived = Lived(offered=offered, helped=helped, misled=bool(misled))
        trust = trust.after(lived.signal(met, traits), traits)
        rating = trust.report(float(rng.normal()), traits)
        when = math.nan if helped is None else helped
        seen.append(Experience(offered=offered, helped=when, misled=misled, met=met, rating=rating))
    return seen


def test_ratings_tell_first_trust_and_what_moves_it(rng: np.random.Generator) -> None:
    people = []
    for _ in range(24):
        mu0 = 1.0 / (1.0 + math.exp(-(0.8 + 0.4 * float(rng.normal()))))
        people.append(a_session(rng, Parameters(mu0=mu0, n0=6.0, w_s=2.5, w_f=0.8)))
    fit = trust_model.fit_trust(trust_model.make_trust_data(people, np.arange(24)), BELIEFS)
    assert near(fit, "mu0", 0.8)
    assert near(fit, "w_s", math.log(2.5))
    assert near(fit, "w_f", math.log(0.8))
    assert abs(fit.value["n0"] - math.log(6.0)) < 3.0 * fit.se["n0"]


def test_trust_is_followed_as_the_person_has_it(rng: np.random.Generator) -> None:
    """The estimator's recursion is that of the model itself, to the last digit."""
    traits = Parameters(mu0=0.4, n0=3.0, w_s=1.1, w_f=2.2, tau_s=31.0)
    session = a_session(rng, traits)
    values = {
        "mu0": float(to_scale(0.4, "logit")),
        **{k: math.log(getattr(traits, k)) for k in ("n0", "w_s", "w_f", "tau_s")},
    }
    before, after = trust_model.mean_trust(trust_model.make_trust_data([session], np.array([0])), values, np.zeros(1))
    trust: Trust = initial_trust(traits)
    for k, one in enumerate(session):
        assert before[0, k] == pytest.approx(trust.mean)
        for _ in range(one.misled):
            trust = trust.after(0.0, traits)
        helped = None if math.isnan(one.helped) else one.helped
        trust = trust.after(
            Lived(offered=one.offered, helped=helped, misled=bool(one.misled)).signal(one.met, traits), traits
        )
        assert after[0, k] == pytest.approx(trust.mean)


def test_too_few_data_are_said_to_be_too_few() -> None:
    belief = BELIEFS["t_manip"]
    few, some, many = (estimate.make_estimate(belief, belief.mean, 0.1, n, "") for n in (5, 12, 40))
    assert not few.used
    assert "too few data: 5 attempts, 30 are wanted" in few.words
    assert some.used
    assert some.words == "few data: 12 of 30 attempts"
    assert (many.used, many.words) == (True, "estimated")
    assert estimate.make_estimate(belief, belief.mean, belief.sd, 40, "").words == "little learnt"


@settings(max_examples=cases(50))
@given(st.sampled_from(sorted(BELIEFS.keys() & estimate.NEEDS.keys())), st.floats(-3.0, 3.0), st.floats(0.01, 1.0))
def test_an_estimate_lies_within_its_prior_and_its_interval(name: str, z: float, share: float) -> None:
    belief = BELIEFS[name]
    found = estimate.make_estimate(belief, belief.mean + z * belief.sd, share * belief.sd, 1000, "")
    assert belief.low <= found.low <= found.value <= found.high <= belief.high


# ------------------------------------------------------------------------------------------------ a population's update


def correlated(rng: np.random.Generator) -> np.ndarray:
    """Draws of (t_manip, tau_mem) that go together, each by its prior otherwise."""
    a = rng.normal(0.0, 1.0, 1000)
    b = 0.8 * a + 0.6 * rng.normal(0.0, 1.0, 1000)
    return np.exp(np.stack([1.1 + 0.5 * a, 4.7 + 0.8 * b], axis=1))


def test_what_was_measured_is_replaced_and_the_rest_follows(rng: np.random.Generator) -> None:
    draws = correlated(rng)
    names, weights = ("t_manip", "tau_mem"), np.full(1000, 1e-3)
    held = priors.population_beliefs(names, draws, weights)
    found = estimate.make_estimate(held["t_manip"], 1.1 + 0.5, 0.05, 100, "")
    new = update_draws(names, draws, weights, held, [found], seed=1)
    logs = np.log(new.draws)
    assert new.direct == ("t_manip",)
    assert logs[:, 0].mean() == pytest.approx(1.6, abs=0.02)
    assert logs[:, 0].std() == pytest.approx(0.05, rel=0.15)
    assert logs[:, 1].mean() > 4.7 + 0.4, "what goes with slow hands must go with them"
    assert new.effective >= 100.0
    again = update_draws(names, draws, weights, held, [found], seed=1)
    assert np.array_equal(again.draws, new.draws)
    assert not np.array_equal(update_draws(names, draws, weights, held, [found], seed=2).draws, new.draws)


def test_too_few_data_leave_a_population_as_it_was(rng: np.random.Generator) -> None:
    draws, weights = correlated(rng), np.full(1000, 1e-3)
    held = priors.population_beliefs(("t_manip", "tau_mem"), draws, weights)
    found = estimate.make_estimate(held["t_manip"], 2.5, 0.05, 3, "")
    new = update_draws(("t_manip", "tau_mem"), draws, weights, held, [found], seed=1)
    assert new.direct == ()
    assert np.array_equal(np.sort(new.draws, axis=0), np.sort(draws, axis=0))


# ---------------------------------------------------------------------------------------------- real logs, real proxies


@pytest.fixture(scope="module")
def played() -> tuple[Parameters, list[TrialRecord]]:
    """Six people of one population, some with robots, four trials each in one house."""
    smoke = tasks.load_suite("smoke")
    few = make_suite("few", 1, tuple(task for task in smoke.tasks if task.house == "elder")[:4])
    population = Parameters(v_pace=0.45, omega=1.2, t_manip=1.6, t_read=4.2, sigma=0.1, a0=3.0)
    return population, recovery.simulate_logs(population, few, TrialRunner(), seed=5, people=6)


def test_real_logs_tell_what_people_were_made_of(played: tuple[Parameters, list[TrialRecord]]) -> None:
    population, records = played
    sessions = trial_features.sessions_of(records)
    found = {one.name: one for one in estimate_all.estimate_parameters(sessions, BELIEFS)}
    for name, off in (("v_pace", 0.1), ("omega", 0.1), ("t_manip", 0.35)):
        assert found[name].value == pytest.approx(getattr(population, name), rel=off), name
    assert found[estimate_all.READING].value == pytest.approx(population.t_notice + population.t_read, rel=0.35)
    assert found["t_on"].value == pytest.approx(population.t_on, abs=0.15)
    assert trial_features.sessions_of(reversed(records)) == sessions, "the order of the records must not matter"


def test_logs_are_read_from_folders_and_files_each_trial_once(
    played: tuple[Parameters, list[TrialRecord]], tmp_path: Path
) -> None:
    _, records = played
    (tmp_path / "run").mkdir()
    lines = [trial_record.encode(one) for one in records]
    (tmp_path / "run" / "trials.jsonl").write_bytes(b"".join(lines))
    (tmp_path / "some.jsonl").write_bytes(b"".join(lines[:3]))
    whole = trial_features.read_sessions([tmp_path / "run"])
    assert (whole.people, whole.sessions, len(whole.trials)) == (6, 6, len(records))
    assert trial_features.read_sessions([tmp_path / "some.jsonl", tmp_path / "run"]) == whole


@pytest.mark.parametrize(
    ("damage", "words"),
    [
        (lambda lines: b"".join(lines)[:-40], "line 3 is cut off"),
        (lambda lines: lines[0] + b'{"pose": [1, 2]}\n', "line 2 is not a trial that 'hthor eval' logged: schema: "),
        (lambda lines: lines[0].replace(b'"ticks":', b'"tacks":', 1), "ticks"),
        (lambda lines: lines[0] + lines[1].replace(b'"index":1', b'"index":7', 1), "line 2 is not a trial"),
        (lambda lines: b"\x00\xff\n", "line 1 is not a trial"),
    ],
)
def test_foreign_and_broken_logs_are_refused(
    played: tuple[Parameters, list[TrialRecord]], tmp_path: Path, damage: object, words: str
) -> None:
    lines = [trial_record.encode(one) for one in played[1][:3]]
    path = tmp_path / "trials.jsonl"
    path.write_bytes(damage(lines))  # type: ignore[operator]
    with pytest.raises(RunError) as caught:
        trial_features.read_sessions([tmp_path])
    assert words in str(caught.value)
    assert str(path) in str(caught.value)


def test_a_log_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(RunError, match=r"a folder without trials\.jsonl"):
        trial_features.read_sessions([tmp_path])
    with pytest.raises(RunError, match="is not there"):
        trial_features.read_sessions([tmp_path / "nowhere.jsonl"])


def test_recovery_counts_what_was_found_and_what_was_covered() -> None:
    made = [
        recovery.Dataset(truth={"v_pace": float(k)}, found={"v_pace": k + 0.1 * (-1) ** k}, errors={"v_pace": error})
        for k, error in enumerate((0.1, 0.1, 0.01, 0.1))
    ]
    (row,) = recovery.summarize_recovery(made)
    assert (row.name, row.datasets, row.bar, row.passed) == ("v_pace", 4, 0.8, True)
    assert row.r == pytest.approx(np.corrcoef([0, 1, 2, 3], [0.1, 0.9, 2.1, 2.9])[0, 1])
    assert row.covered == 0.75
    scrambled = [
        recovery.Dataset(truth=a.truth, found=b.found, errors=a.errors) for a, b in zip(made, made[::-1], strict=True)
    ]
    assert not recovery.summarize_recovery(scrambled)[0].passed


def test_logs_become_a_population_the_same_every_time(
    played: tuple[Parameters, list[TrialRecord]], tmp_path: Path
) -> None:
    log = tmp_path / "trials.jsonl"
    log.write_bytes(b"".join(trial_record.encode(one) for one in played[1]))
    told: list[str] = []
    found, made = run.estimate_from_logs([log], "literature", tmp_path / "a" / "mine", told.append)
    log.write_bytes(b"".join(trial_record.encode(one) for one in reversed(played[1])))
    run.estimate_from_logs([log], "literature", tmp_path / "b" / "mine", told.append)
    for name in ("population.json", "population.npz", "estimates.json"):
        one, other = ((tmp_path / folder / "mine" / name).read_bytes() for folder in ("a", "b"))
        assert one == other, name
    loaded = population_file.load_population(tmp_path / "a" / "mine" / "population.npz")
    assert loaded.sha256 == made.sha256
    rows = {row.name: row for row in found.rows}
    assert rows["v_pace"].after == pytest.approx(played[0].v_pace, rel=0.1)
    assert rows["tau_mem"].estimate is None
    assert rows["tau_mem"].after == pytest.approx(rows["tau_mem"].before), "in these priors nothing tells of memory"
    assert (found.people, found.trials) == (6, len(played[1]))
    assert "24 trials of 6 people" in found.notes[0]
    assert told.count("walking") == 2


def test_a_log_without_a_journal_is_refused(played: tuple[Parameters, list[TrialRecord]], tmp_path: Path) -> None:
    bare = [msgspec.structs.replace(one, journal=()) for one in played[1]]
    (tmp_path / "trials.jsonl").write_bytes(b"".join(trial_record.encode(one) for one in bare))
    with pytest.raises(RunError, match="has no record of the person's motions"):
        run.estimate_from_logs([tmp_path], "literature", tmp_path / "out", lambda _: None)
