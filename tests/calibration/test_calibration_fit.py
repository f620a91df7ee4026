"""The statistics of a calibration, on people whose rates are known exactly."""

from __future__ import annotations

import pickle
import sys

import calibration_toy as toy
import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from law_cases import cases
from scipy import stats

from hthor.calibration import targets
from hthor.calibration.diagnostics import acceptance, coverage, ranking_robustness
from hthor.calibration.emulator import emulator, mlp
from hthor.calibration.inference import design_effects, likelihood, posterior, summary_statistics
from hthor.calibration.inference.design_effects import DesignEffects
from hthor.calibration.simulation import trial_table
from hthor.errors import MissingExtra

PLAIN = DesignEffects(sr=np.ones(3), ratio=np.ones(3), adoption=np.ones(3), spread=1.0, correlation=np.eye(3))
PAPER = summary_statistics.published_results(targets.load_targets("paper"))
LIVE = tuple(toy.NAMES[k] for k in (toy.V, toy.LAM, toy.A0, toy.HAND))


@pytest.fixture(scope="module")
def learnt() -> emulator.Emulator:
    return emulator.fit_emulator(toy.sessions(toy.points(800, 1), 1), toy.LEAST, seed=0, members=2)


@pytest.fixture(scope="module")
def studied() -> tuple[np.ndarray, summary_statistics.StudyResults]:
    return summary_statistics.study_results(toy.studies(toy.points(300, 2), 2), toy.LEAST)


@pytest.fixture(scope="module")
def bank() -> posterior.PriorSample:
    return posterior.sample_prior(toy.Exact(), seed=0, proposals=1 << 14)


@pytest.fixture(scope="module")
def true_effects(studied) -> DesignEffects:
    return design_effects.estimate_effects(toy.exact(studied[0]), studied[1])


@pytest.fixture(scope="module")
def fitted(bank, true_effects) -> posterior.Posterior:
    return posterior.sample_posterior(toy.Exact(), PAPER, true_effects, prior=bank)


# ------------------------------------------------------------------------------------------------------------ observed


def test_the_published_counts_give_the_published_percentages():
    printed = targets.load_targets("paper").published
    for name, values in PAPER.figures().items():
        assert values[0] == pytest.approx(printed[name] / 100.0, abs=1e-3), name


def test_what_is_left_out_is_absent():
    whole = targets.load_targets("paper")
    told = {
        name: {k: v for k, v in getattr(whole, name).items() if k != "oracle"} for name in ("sr", "adoption", "ratio")
    }
    less = summary_statistics.published_results(msgspec.structs.replace(whole, **told))
    assert less.trials[0, 2] == less.asked[0, 2] == 0.0
    assert np.isnan(less.ratio[0, 2])
    again = PAPER.without("oracle")
    for name in less.__struct_fields__:
        np.testing.assert_array_equal(getattr(less, name), getattr(again, name))


def test_simulated_studies_are_counted_as_published_ones():
    made = toy.studies(toy.points(3, 4), 4)
    where, found = summary_statistics.study_results(made, toy.LEAST)
    np.testing.assert_array_equal(where, made.points)
    np.testing.assert_array_equal(found.trials, np.tile([58, 59, 58], (3, 1)))
    np.testing.assert_array_equal(found.asked, np.tile([0, 50, 50], (3, 1)))
    rows = (made.study == 1) & (made.condition == 2) & made.valid
    assert found.successes[1, 2] == made.met[rows].sum()
    worth = trial_table.twsr(made.take(rows), toy.LEAST)
    assert found.figures()["twsr oracle"][1] == pytest.approx(worth.mean())


def test_training_sessions_are_no_studies():
    both = trial_table.join_tables([toy.sessions(toy.points(6, 5), 5), toy.studies(toy.points(2, 6), 6)])
    where, found = summary_statistics.study_results(both, toy.LEAST)
    assert len(found) == 2
    np.testing.assert_array_equal(where, both.points[-2:])


# ------------------------------------------------------------------------------------------------- questions, networks


def test_rates_are_integrals_of_chances():
    made = toy.sessions(np.tile(toy.points(1, 7), (3000, 1)), 7)
    rows = made.condition == 2
    answers = emulator.success_outcomes(made.take(rows), toy.LEAST).mean(axis=0, keepdims=True)
    sr, ratio, spread = emulator.success_rates(answers)
    truth = toy.exact(made.points[:1])
    worth = trial_table.twsr(made.take(rows), toy.LEAST)
    assert sr[0] == made.met[rows].mean()
    assert ratio[0] == pytest.approx(worth[worth > 0.0].mean(), abs=0.01)
    assert spread[0] == pytest.approx(truth.ratio_sd[0, 2], abs=0.02)


@given(seed=st.integers(0, 1000))
@settings(max_examples=cases(25))
def test_any_answers_give_possible_rates(seed):
    chance = np.random.Generator(np.random.Philox(seed))
    answers = chance.random((4, emulator.SUCCESS_QUESTIONS + len(emulator.TIME_LEVELS_S)))
    _, ratio, spread = emulator.success_rates(answers)
    assert (ratio >= 0.0).all()
    assert (ratio <= 1.0).all()
    assert (spread > 0.0).all()
    assert (spread <= 0.51).all()


def test_a_network_finds_a_known_law():
    chance = np.random.Generator(np.random.Philox(3))
    told = chance.uniform(-1.0, 1.0, (6000, 5))
    truth = 1.0 / (1.0 + np.exp(-2.0 * told[:, 0] - 2.0 * told[:, 1] * told[:, 2]))
    came = np.stack([chance.random(6000) < truth, chance.random(6000) < 0.3], axis=1)
    said = mlp.fit_network(told, came, seed=1)(told)
    again = mlp.fit_network(told, came, seed=1)
    assert np.sqrt(np.mean((said[:, 0] - truth) ** 2)) < 0.09
    assert np.sqrt(np.mean((said[:, 1] - 0.3) ** 2)) < 0.06
    np.testing.assert_array_equal(again(told), said)
    np.testing.assert_allclose(again(told, 1), said[:, :1], rtol=1e-5)


# ------------------------------------------------------------------------------------------------------------ emulator


def test_the_emulator_is_near_the_truth(learnt):
    where = toy.points(200, 9)
    said, truth = learnt.rates(where), toy.exact(where)
    for name, most in (("sr", 0.08), ("ratio", 0.04), ("adoption", 0.1)):
        error = getattr(said, name) - getattr(truth, name)
        assert np.sqrt((error**2).mean(axis=0)).max() < most, name
        assert np.abs(error.mean(axis=0)).max() < 0.05, name
    assert (said.adoption[:, 0] == 0.0).all()
    assert np.abs(said.ratio_sd - truth.ratio_sd).max() < 0.08


def test_what_does_nothing_changes_little(learnt):
    where = toy.points(200, 10)
    moved = {}
    for name in ("v_pace", "tau_mem"):
        ends = [where.copy(), where.copy()]
        for end, value in zip(ends, (0.1, 0.9), strict=True):
            end[:, toy.NAMES.index(name)] = value
        moved[name] = np.abs(learnt.rates(ends[1]).sr - learnt.rates(ends[0]).sr).mean()
    assert moved["tau_mem"] < 0.05 < 0.3 < moved["v_pace"]


def test_same_seed_same_emulator():
    made = toy.sessions(toy.points(24, 11), 11)
    first, again, other = (emulator.fit_emulator(made, toy.LEAST, seed=seed, members=2) for seed in (0, 0, 1))
    assert pickle.dumps(first) == pickle.dumps(again) != pickle.dumps(other)


def test_a_committee_needs_points():
    with pytest.raises(ValueError, match="a point for each"):
        emulator.fit_emulator(toy.sessions(toy.points(3, 1), 1), toy.LEAST, members=4)


def test_without_the_extra_one_sentence_names_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "sklearn.neural_network", None)
    with pytest.raises(MissingExtra, match=r"hthor\[calibration\]"):
        mlp.fit_network(np.zeros((4, 2)), np.zeros((4, 2)), seed=0)


# ------------------------------------------------------------------------------------------------------ design effects


def test_people_cluster_trials_and_the_errors_say_so(studied):
    where, found = studied
    quality = design_effects.emulator_quality(toy.exact(where), found)
    assert 0.9 < quality.z_sd < 1.1
    assert all(0.85 < value < 1.15 for value in quality.by_figure.values())
    known = design_effects.estimate_effects(toy.exact(where), found)
    assert known.adoption[1:].min() > 1.3  # ten trials of one person: 1 + 9 * correlation
    assert np.abs(known.ratio - 1.0).max() < 0.3  # nothing is alike in the ratios of one person


def test_known_noise_is_found_again(studied):
    where, found = studied
    chance = np.random.Generator(np.random.Philox(12))
    wrong = {}
    truth = toy.exact(where)
    for name in ("sr", "ratio", "adoption"):
        wrong[name] = getattr(truth, name) + chance.normal(0.0, 0.1, truth.sr.shape)
        wrong[f"{name}_se"] = np.full(truth.sr.shape, 0.05)
    rates = msgspec.structs.replace(truth, **wrong)
    assert design_effects.estimate_effects(rates, found).spread == pytest.approx(2.0, abs=0.3)
    assert 0.9 < design_effects.emulator_quality(rates, found).z_sd < 1.1


def test_a_learnt_emulator_knows_how_far_it_is_off(learnt, studied):
    assert 0.9 < design_effects.emulator_quality(learnt.rates(studied[0]), studied[1]).z_sd < 1.1


def test_too_few_studies_are_refused(studied):
    few = summary_statistics.study_results(toy.studies(toy.points(9, 3), 3), toy.LEAST)
    with pytest.raises(ValueError, match="at least 10"):
        design_effects.estimate_effects(toy.exact(few[0]), few[1])


# ---------------------------------------------------------------------------------------------------------- likelihood


@given(st.floats(0.01, 0.99), st.floats(1.0, 4.0), st.integers(2, 60))
@settings(max_examples=cases(40))
def test_counts_have_a_distribution(share, phi, trials):
    hits = np.arange(trials + 1.0)
    chance = np.exp([likelihood.log_beta_binomial(k, trials, np.array([share]), np.array([phi]))[0] for k in hits])
    rho = min(max((phi - 1.0) / (trials - 1.0), 1e-4), 0.95)
    assert chance.sum() == pytest.approx(1.0)
    assert chance @ hits == pytest.approx(share * trials, rel=1e-6)
    spread = share * (1.0 - share) * trials * (1.0 + (trials - 1.0) * rho)
    assert chance @ hits**2 - (chance @ hits) ** 2 == pytest.approx(spread, rel=1e-5)


def test_the_likelihood_is_that_of_its_parts():
    rates = toy.exact(toy.points(5, 13))
    effects = DesignEffects(
        sr=np.array([1.5, 1.6, 1.7]),
        adoption=np.array([1.0, 1.9, 1.8]),
        ratio=np.array([1.2, 1.0, 1.1]),
        spread=1.0,
        correlation=np.array([[1.0, 0.4, 0.3], [0.4, 1.0, 0.2], [0.3, 0.2, 1.0]]),
    )
    found = likelihood.log_likelihood(rates, PAPER, effects)
    for row in range(5):
        total = 0.0
        for hits, trials, share, phi in (
            *zip(PAPER.successes[0], PAPER.trials[0], rates.sr[row], effects.sr, strict=True),
            *zip(PAPER.adopted[0, 1:], PAPER.asked[0, 1:], rates.adoption[row, 1:], effects.adoption[1:], strict=True),
        ):
            a, b = likelihood.beta_shape(share, trials, phi)
            total += stats.betabinom.logpmf(hits, trials, a, b)
        sd = np.sqrt(effects.ratio / PAPER.successes[0]) * rates.ratio_sd[row]
        total += stats.multivariate_normal.logpdf(
            PAPER.ratio[0], rates.ratio[row], effects.correlation * np.outer(sd, sd)
        )
        assert found[row] == pytest.approx(total)


def test_what_was_not_observed_says_nothing():
    rates = toy.exact(toy.points(50, 14))
    parts = sum(likelihood.log_likelihood(rates, PAPER.only(name), PLAIN) for name in targets.CONDITIONS)
    np.testing.assert_allclose(likelihood.log_likelihood(rates, PAPER, PLAIN), parts)
    nothing = PAPER.only("none").without("none")
    np.testing.assert_array_equal(likelihood.log_likelihood(rates, nothing, PLAIN), 0.0)


# ----------------------------------------------------------------------------------------------------------- posterior


def test_the_posterior_informs_what_the_study_tells_of(fitted):
    found = fitted
    known = dict(zip(found.names, found.contraction, strict=True))
    assert min(known["v_pace"], known["a0"]) > 0.4
    assert max(abs(value) for name, value in known.items() if name not in LIVE) < 0.1
    assert found.points.shape == (posterior.DRAWS, len(toy.NAMES))
    assert found.effective > 1000
    assert (found.points > 0.0).all()
    assert (found.points < 1.0).all()
    middle = np.abs(found.points.mean(axis=0) - found.mean) / found.sd
    assert middle.max() < 0.12  # draws are of the weighed points


def test_a_second_round_leaves_the_posterior_as_it_is(bank, true_effects, monkeypatch):
    monkeypatch.setattr(posterior, "ENOUGH", 0.0)
    once = posterior.sample_posterior(toy.Exact(), PAPER, true_effects, prior=bank)
    monkeypatch.setattr(posterior, "ENOUGH", 1e9)
    twice = posterior.sample_posterior(toy.Exact(), PAPER, true_effects, prior=bank)
    assert twice.proposals == 2 * once.proposals
    assert twice.effective > 2.0 * once.effective
    live = [toy.NAMES.index(name) for name in LIVE]
    assert np.abs((twice.mean - once.mean) / once.sd)[live].max() < 0.15
    assert np.abs(np.log(twice.sd / once.sd))[live].max() < 0.1
    assert twice.evidence == pytest.approx(once.evidence, abs=0.15)


def test_weights_are_the_likelihood_of_a_grid():
    """One parameter matters: the posterior is known by integration."""
    study, effects = PAPER.only("oracle"), PLAIN
    grid = np.full((4000, len(toy.NAMES)), 0.5)
    grid[:, toy.A0] = (np.arange(4000) + 0.5) / 4000
    rates = toy.exact(grid)
    held = posterior.PriorSample(points=grid, rates=rates, density=np.zeros(4000))
    weight, evidence = posterior.importance_weights(held, study, effects)
    chance = np.exp(likelihood.log_likelihood(rates, study, effects))
    np.testing.assert_allclose(weight, chance / chance.sum(), rtol=1e-9)
    assert evidence == pytest.approx(np.log(chance.mean()))
    # the same points at twice the density in one half count half as much
    doubled = msgspec.structs.replace(held, density=np.where(grid[:, toy.A0] < 0.5, np.log(2.0), 0.0))
    uneven, _ = posterior.importance_weights(doubled, study, effects)
    half = grid[:, toy.A0] < 0.5
    assert uneven[half].sum() / uneven[~half].sum() == pytest.approx(0.5 * weight[half].sum() / weight[~half].sum())


@given(st.lists(st.floats(0.0, 1.0), min_size=1, max_size=30), st.floats(0.0, 0.999))
@settings(max_examples=cases(60))
def test_resampling_is_fair_to_within_one(raw, start):
    weight = np.array(raw) + 1e-3
    weight = weight / weight.sum()
    counts = np.bincount(posterior.systematic_resample(weight, 100, start), minlength=len(weight))
    assert counts.sum() == 100
    assert np.abs(counts - 100 * weight).max() < 1.0 + 1e-6


def test_proposals_reach_beyond_the_posterior(fitted):
    found = fitted
    fresh = posterior.propose_points(found, 500, seed=3)
    assert fresh.shape == (500, len(toy.NAMES))
    assert fresh.min() > 0.0
    assert fresh.max() < 1.0
    assert 1.02 < fresh[:, toy.V].std() / found.sd[toy.V] < 1.6
    np.testing.assert_array_equal(fresh, posterior.propose_points(found, 500, seed=3))


# ------------------------------------------------------------------------------------------------------ does it hold?


def test_intervals_hold_what_they_promise(studied):
    where, found = studied
    rows = np.arange(200)
    some = summary_statistics.StudyResults(**{name: getattr(found, name)[rows] for name in found.__struct_fields__})
    right = coverage.check_coverage(toy.Exact(), where[rows], some, proposals=1 << 12)
    assert 0.86 < right.overall < 0.94
    assert 0.84 < right.covered[[toy.NAMES.index(name) for name in LIVE]].mean() < 0.95
    assert right.recovery[toy.V] > 0.8 > 0.2 > abs(right.recovery[toy.NAMES.index("tau_mem")])
    assert sum(right.histogram(toy.V)) == 200
    assert max(right.histogram(toy.V)) < 40


def test_overconfidence_is_seen(studied, monkeypatch):
    where, found = studied
    rows = np.arange(60)
    some = summary_statistics.StudyResults(**{name: getattr(found, name)[rows] for name in found.__struct_fields__})
    tiny = DesignEffects(
        sr=np.full(3, 0.05), ratio=np.full(3, 0.05), adoption=np.full(3, 0.05), spread=0.0, correlation=np.eye(3)
    )
    monkeypatch.setattr(design_effects, "cross_validated_effects", lambda rates, studies: [(np.arange(60), tiny)])
    monkeypatch.setattr(likelihood, "_LEAST_RHO", 1e-6)
    wrong = coverage.check_coverage(toy.Exact(), where[rows], some, proposals=1 << 12)
    assert wrong.covered[toy.V] < 0.8


def test_abc_agrees_and_sees_a_shift(studied, fitted):
    where, found = studied
    means = coverage.check_coverage(toy.Exact(), where, found, proposals=1 << 11).means
    shifts = coverage.compare_posteriors(fitted, where, means, LIVE)
    assert {one.name for one in shifts} == set(LIVE)
    assert max(abs(one.shift) for one in shifts) < acceptance.FULL.shift
    assert next(one.error for one in shifts if one.name == toy.NAMES[toy.V]) < 0.3
    off = msgspec.structs.replace(fitted, points=np.clip(fitted.points + 1.2 * fitted.sd, 0.0, 1.0))
    shifts = coverage.compare_posteriors(off, where, means, LIVE)
    assert max(abs(one.shift) for one in shifts) > acceptance.FULL.shift
    with pytest.raises(ValueError, match="at least 40"):
        coverage.compare_posteriors(fitted, where[:30], means[:30], LIVE)


def test_two_conditions_foretell_the_third(true_effects):
    where = np.full((1, len(toy.NAMES)), 0.5)
    where[0, toy.V] = 0.8
    truth = toy.exact(where)
    study = summary_statistics.StudyResults(
        successes=np.round(truth.sr * [58, 59, 58]),
        trials=np.array([[58.0, 59.0, 58.0]]),
        adopted=np.round(truth.adoption * [0, 50, 50]),
        asked=np.array([[0.0, 50.0, 50.0]]),
        ratio=truth.ratio,
    )
    prior = posterior.sample_prior(toy.Exact(), seed=1, proposals=1 << 12)
    bad = msgspec.structs.replace(truth, sr=np.full((1, 3), 0.05), adoption=np.full((1, 3), 0.01))
    found = coverage.predict_held_out(toy.Exact(), study, true_effects, prior)
    assert [one.condition for one in found] == list(targets.CONDITIONS)
    for one in found:
        assert one.log_score > one.log_score_prior
        assert one.condition not in one.fitted
        assert all(row.inside for row in one.figures)
        worst, best = (coverage._score(rates, study.only(one.condition), true_effects) for rates in (bad, truth))
        assert worst < one.log_score < best + 0.5
    assert [row.figure for row in found[0].figures] == ["sr none", "twsr none"]


# ------------------------------------------------------------------------------------------------- what to expect of it


def test_foretold_studies_are_as_noisy_as_real_ones(studied, true_effects):
    where = np.tile(toy.points(1, 20), (300, 1))
    _, real = summary_statistics.study_results(toy.studies(where, 21), toy.LEAST)
    drawn = likelihood.draw_studies(toy.exact(np.repeat(where, 5, axis=0)), PAPER, true_effects, seed=2).figures()
    for name, values in real.figures().items():
        assert drawn[name].mean() == pytest.approx(values.mean(), abs=0.02), name
        assert 0.75 < drawn[name].std() / values.std() < 1.35, name


def test_the_table_of_figures(true_effects):
    figures = {name: np.linspace(0.0, 1.0, 1001) for name in summary_statistics.FIGURES}
    wide = likelihood.compare_figures(figures, PAPER, (0.05, 0.5, 0.95))
    narrow = likelihood.compare_figures(figures, PAPER, (0.1, 0.5, 0.9))
    assert [row.figure for row in wide] == list(summary_statistics.FIGURES)
    assert (wide[2].band.median, wide[2].band.low, narrow[2].band.high) == pytest.approx((0.5, 0.05, 0.9))
    assert wide[2].inside
    assert not narrow[2].inside
    assert not wide[2].close


def test_an_order_that_is_clear_is_kept(fitted, true_effects):
    found = msgspec.structs.replace(fitted, points=fitted.points[::5])
    rates = toy.exact(found.points)
    clear = ranking_robustness.rank_robots(rates, true_effects)
    assert clear.expected["sr"] == 1.0
    assert clear.sr > 0.9
    few = ranking_robustness.rank_robots(rates, true_effects, trials=20)
    assert few.sr < clear.sr
    turned = msgspec.structs.replace(rates, sr=rates.sr[:, ::-1])
    assert ranking_robustness.rank_robots(turned, true_effects).expected["sr"] == 0.0


def test_chances_of_an_order_are_those_of_its_noise():
    rates = toy.exact(np.tile(toy.points(1, 22), (2, 1)))
    near = msgspec.structs.replace(rates, sr=np.tile([0.5, 0.53, 0.99], (2, 1)))
    found = ranking_robustness.rank_robots(near, PLAIN)
    assert found.sr == pytest.approx(found.pairs["sr frontier>none"], abs=0.05)
    assert found.both <= min(found.sr, found.twsr)
    assert found.both > found.sr * found.twsr  # they rise and fall together


def test_noise_of_a_gap_is_that_of_independent_groups():
    rates = toy.exact(np.tile(toy.points(1, 22), (2, 1)))
    found = ranking_robustness.rank_robots(rates, PLAIN, trials=600).pairs["sr oracle>frontier"]
    p, q = rates.sr[0, 2], rates.sr[0, 1]
    noise = np.sqrt((p * (1 - p) + q * (1 - q)) / 600)
    assert found == pytest.approx(stats.norm.cdf((p - q) / noise))


def test_only_what_matters_swings_a_gap(fitted):
    found = msgspec.structs.replace(fitted, points=fitted.points[::10])
    swings = {(one.name, one.better): one for one in ranking_robustness.parameter_swings(toy.Exact(), found)}
    assert len(swings) == 2 * len(toy.NAMES)
    still = swings["tau_mem", "oracle"]
    assert still.low == pytest.approx(still.high)
    assert abs(swings["v_pace", "oracle"].high - swings["v_pace", "oracle"].low) > 0.05
