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
from scipy import stats

from hthor.calibration import targets
from hthor.calibration.diagnostics import abc_check, coverage, held_out, ranking_robustness
from hthor.calibration.emulator import emulator, mlp, outcomes, trust_emulator
from hthor.calibration.inference import design_effects, likelihood, posterior, predictive, summary_statistics
from hthor.calibration.inference.design_effects import Effects
from hthor.calibration.simulation import trial_table
from hthor.errors import MissingExtra

PLAIN = Effects(sr=np.ones(3), ratio=np.ones(3), adoption=np.ones(3), spread=1.0, correlation=np.eye(3))
PAPER = summary_statistics.published(targets.load("paper"))
LIVE = tuple(toy.NAMES[k] for k in (toy.V, toy.LAM, toy.A0, toy.HAND))


@pytest.fixture(scope="module")
def learnt() -> emulator.Emulator:
    return emulator.fit(toy.sessions(toy.points(800, 1), 1), toy.LEAST, seed=0, members=2)


@pytest.fixture(scope="module")
def studied() -> tuple[np.ndarray, summary_statistics.Observed]:
    return summary_statistics.studies(toy.studies(toy.points(300, 2), 2), toy.LEAST)


@pytest.fixture(scope="module")
def bank() -> posterior.Bank:
    return posterior.bank(toy.Exact(), seed=0, proposals=1 << 14)


@pytest.fixture(scope="module")
def true_effects(studied) -> Effects:
    return design_effects.effects(toy.exact(studied[0]), studied[1])


@pytest.fixture(scope="module")
def fitted(bank, true_effects) -> posterior.Posterior:
    return posterior.sample(toy.Exact(), PAPER, true_effects, prior=bank)


# ------------------------------------------------------------------------------------------------------------ observed


def test_the_published_counts_give_the_published_percentages():
    printed = targets.load("paper").published
    for name, values in PAPER.figures().items():
        assert values[0] == pytest.approx(printed[name] / 100.0, abs=1e-3), name


def test_what_is_left_out_is_absent():
    less = summary_statistics.published(targets.load("paper").without("oracle"))
    assert less.trials[0, 2] == less.asked[0, 2] == 0.0
    assert np.isnan(less.ratio[0, 2])
    again = PAPER.without("oracle")
    for name in less.__struct_fields__:
        np.testing.assert_array_equal(getattr(less, name), getattr(again, name))


def test_simulated_studies_are_counted_as_published_ones():
    made = toy.studies(toy.points(3, 4), 4)
    where, found = summary_statistics.studies(made, toy.LEAST)
    np.testing.assert_array_equal(where, made.points)
    np.testing.assert_array_equal(found.trials, np.tile([58, 59, 58], (3, 1)))
    np.testing.assert_array_equal(found.asked, np.tile([0, 50, 50], (3, 1)))
    rows = (made.study == 1) & (made.condition == 2) & made.valid
    assert found.successes[1, 2] == made.met[rows].sum()
    worth = trial_table.twsr(made.take(rows), toy.LEAST)
    assert found.figures()["twsr oracle"][1] == pytest.approx(worth.mean())


def test_training_sessions_are_no_studies():
    both = trial_table.join([toy.sessions(toy.points(6, 5), 5), toy.studies(toy.points(2, 6), 6)])
    where, found = summary_statistics.studies(both, toy.LEAST)
    assert len(found) == 2
    np.testing.assert_array_equal(where, both.points[-2:])


# ------------------------------------------------------------------------------------------------- questions, networks


def test_rates_are_integrals_of_chances():
    made = toy.sessions(np.tile(toy.points(1, 7), (3000, 1)), 7)
    rows = made.condition == 2
    answers = outcomes.doing(made.take(rows), toy.LEAST).mean(axis=0, keepdims=True)
    sr, ratio, spread = outcomes.rates(answers)
    truth = toy.exact(made.points[:1])
    worth = trial_table.twsr(made.take(rows), toy.LEAST)
    assert sr[0] == made.met[rows].mean()
    assert ratio[0] == pytest.approx(worth[worth > 0.0].mean(), abs=0.01)
    assert spread[0] == pytest.approx(truth.ratio_sd[0, 2], abs=0.02)


def test_quartiles_are_those_of_the_trials():
    made = toy.sessions(np.tile(toy.points(1, 8), (3000, 1)), 8)
    rows = made.condition == 0
    answers = outcomes.doing(made.take(rows), toy.LEAST).mean(axis=0, keepdims=True)
    found = outcomes.quartiles(answers, (0.1, 0.25, 0.5, 0.99))[0]
    assert found[:3] == pytest.approx(np.quantile(trial_table.seconds(made.take(rows)), (0.1, 0.25, 0.5)), abs=1.5)
    assert found[3] == 90.0


@given(seed=st.integers(0, 1000))
@settings(max_examples=25, deadline=None)
def test_any_answers_give_possible_rates(seed):
    chance = np.random.Generator(np.random.Philox(seed))
    answers = chance.random((4, outcomes.WORTHY + len(outcomes.SECONDS)))
    _, ratio, spread = outcomes.rates(answers)
    assert (ratio >= 0.0).all()
    assert (ratio <= 1.0).all()
    assert (spread > 0.0).all()
    assert (spread <= 0.51).all()
    times = outcomes.quartiles(answers, (0.25, 0.5, 0.75))
    assert (np.diff(times, axis=1) >= 0.0).all()
    assert times.max() <= 90.0
    assert times.min() >= 0.0


def test_a_network_finds_a_known_law():
    chance = np.random.Generator(np.random.Philox(3))
    told = chance.uniform(-1.0, 1.0, (6000, 5))
    truth = 1.0 / (1.0 + np.exp(-2.0 * told[:, 0] - 2.0 * told[:, 1] * told[:, 2]))
    came = np.stack([chance.random(6000) < truth, chance.random(6000) < 0.3], axis=1)
    said = mlp.fit(told, came, seed=1)(told)
    assert np.sqrt(np.mean((said[:, 0] - truth) ** 2)) < 0.09
    assert np.sqrt(np.mean((said[:, 1] - 0.3) ** 2)) < 0.06
    np.testing.assert_array_equal(mlp.fit(told, came, seed=1)(told), said)
    np.testing.assert_allclose(mlp.fit(told, came, seed=1)(told, 1), said[:, :1], rtol=1e-5)


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
    first, again, other = (emulator.fit(made, toy.LEAST, seed=seed, members=2) for seed in (0, 0, 1))
    assert pickle.dumps(first) == pickle.dumps(again) != pickle.dumps(other)
    assert first.trials == 240
    assert first.sessions == 24


def test_a_committee_needs_points():
    with pytest.raises(ValueError, match="a point for each"):
        emulator.fit(toy.sessions(toy.points(3, 1), 1), toy.LEAST, members=4)


def test_without_the_extra_one_sentence_names_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "sklearn.neural_network", None)
    with pytest.raises(MissingExtra, match=r"hthor\[calibration\]"):
        mlp.fit(np.zeros((4, 2)), np.zeros((4, 2)), seed=0)


# ------------------------------------------------------------------------------------------------------ design effects


def test_people_cluster_trials_and_the_errors_say_so(studied):
    where, found = studied
    quality = design_effects.quality(toy.exact(where), found)
    assert 0.9 < quality.z_sd < 1.1
    assert all(0.85 < value < 1.15 for value in quality.by_figure.values())
    assert min(quality.r2["sr none"], quality.r2["ratio none"]) > 0.7
    known = design_effects.effects(toy.exact(where), found)
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
    assert design_effects.effects(rates, found).spread == pytest.approx(2.0, abs=0.3)
    assert 0.9 < design_effects.quality(rates, found).z_sd < 1.1


def test_a_learnt_emulator_knows_how_far_it_is_off(learnt, studied):
    assert 0.9 < design_effects.quality(learnt.rates(studied[0]), studied[1]).z_sd < 1.1


def test_too_few_studies_are_refused(studied):
    few = summary_statistics.studies(toy.studies(toy.points(9, 3), 3), toy.LEAST)
    with pytest.raises(ValueError, match="at least 10"):
        design_effects.effects(toy.exact(few[0]), few[1])


# ---------------------------------------------------------------------------------------------------------- likelihood


@given(st.floats(0.01, 0.99), st.floats(1.0, 4.0), st.integers(2, 60))
@settings(max_examples=40, deadline=None)
def test_counts_have_a_distribution(share, phi, trials):
    hits = np.arange(trials + 1.0)
    chance = np.exp([likelihood.count(k, trials, np.array([share]), np.array([phi]))[0] for k in hits])
    rho = min(max((phi - 1.0) / (trials - 1.0), 1e-4), 0.95)
    assert chance.sum() == pytest.approx(1.0)
    assert chance @ hits == pytest.approx(share * trials, rel=1e-6)
    spread = share * (1.0 - share) * trials * (1.0 + (trials - 1.0) * rho)
    assert chance @ hits**2 - (chance @ hits) ** 2 == pytest.approx(spread, rel=1e-5)


def test_the_likelihood_is_that_of_its_parts():
    rates = toy.exact(toy.points(5, 13))
    effects = Effects(
        sr=np.array([1.5, 1.6, 1.7]),
        adoption=np.array([1.0, 1.9, 1.8]),
        ratio=np.array([1.2, 1.0, 1.1]),
        spread=1.0,
        correlation=np.array([[1.0, 0.4, 0.3], [0.4, 1.0, 0.2], [0.3, 0.2, 1.0]]),
    )
    found = likelihood.log(rates, PAPER, effects)
    for row in range(5):
        total = 0.0
        for hits, trials, share, phi in (
            *zip(PAPER.successes[0], PAPER.trials[0], rates.sr[row], effects.sr, strict=True),
            *zip(PAPER.adopted[0, 1:], PAPER.asked[0, 1:], rates.adoption[row, 1:], effects.adoption[1:], strict=True),
        ):
            a, b = likelihood.shape(share, trials, phi)
            total += stats.betabinom.logpmf(hits, trials, a, b)
        sd = np.sqrt(effects.ratio / PAPER.successes[0]) * rates.ratio_sd[row]
        total += stats.multivariate_normal.logpdf(
            PAPER.ratio[0], rates.ratio[row], effects.correlation * np.outer(sd, sd)
        )
        assert found[row] == pytest.approx(total)


def test_what_was_not_observed_says_nothing():
    rates = toy.exact(toy.points(50, 14))
    parts = sum(likelihood.log(rates, PAPER.only(name), PLAIN) for name in trial_table.CONDITIONS)
    np.testing.assert_allclose(likelihood.log(rates, PAPER, PLAIN), parts)
    nothing = PAPER.only("none").without("none")
    np.testing.assert_array_equal(likelihood.log(rates, nothing, PLAIN), 0.0)


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
    np.testing.assert_allclose(np.diag(found.correlation), 1.0)


def test_a_second_round_leaves_the_posterior_as_it_is(bank, true_effects, monkeypatch):
    monkeypatch.setattr(posterior, "ENOUGH", 0.0)
    once = posterior.sample(toy.Exact(), PAPER, true_effects, prior=bank)
    monkeypatch.setattr(posterior, "ENOUGH", 1e9)
    twice = posterior.sample(toy.Exact(), PAPER, true_effects, prior=bank)
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
    held = posterior.Bank(points=grid, rates=rates, density=np.zeros(4000))
    weight, evidence = posterior.weights(held, study, effects)
    chance = np.exp(likelihood.log(rates, study, effects))
    np.testing.assert_allclose(weight, chance / chance.sum(), rtol=1e-9)
    assert evidence == pytest.approx(np.log(chance.mean()))
    # the same points at twice the density in one half count half as much
    doubled = msgspec.structs.replace(held, density=np.where(grid[:, toy.A0] < 0.5, np.log(2.0), 0.0))
    uneven, _ = posterior.weights(doubled, study, effects)
    half = grid[:, toy.A0] < 0.5
    assert uneven[half].sum() / uneven[~half].sum() == pytest.approx(0.5 * weight[half].sum() / weight[~half].sum())


@given(st.lists(st.floats(0.0, 1.0), min_size=1, max_size=30), st.floats(0.0, 0.999))
@settings(max_examples=60, deadline=None)
def test_resampling_is_fair_to_within_one(raw, start):
    weight = np.array(raw) + 1e-3
    weight = weight / weight.sum()
    counts = np.bincount(posterior.resampled(weight, 100, start), minlength=len(weight))
    assert counts.sum() == 100
    assert np.abs(counts - 100 * weight).max() < 1.0 + 1e-6


def test_proposals_reach_beyond_the_posterior(fitted):
    found = fitted
    fresh = posterior.propose(found, 500, seed=3)
    assert fresh.shape == (500, len(toy.NAMES))
    assert fresh.min() > 0.0
    assert fresh.max() < 1.0
    assert 1.02 < fresh[:, toy.V].std() / found.sd[toy.V] < 1.6
    np.testing.assert_array_equal(fresh, posterior.propose(found, 500, seed=3))


# ------------------------------------------------------------------------------------------------------ does it hold?


def test_intervals_hold_what_they_promise(studied):
    where, found = studied
    rows = np.arange(200)
    some = summary_statistics.Observed(**{name: getattr(found, name)[rows] for name in found.__struct_fields__})
    right = coverage.run(toy.Exact(), where[rows], some, proposals=1 << 12, fitted=LIVE)
    assert 0.86 < right.overall < 0.94
    assert 0.84 < right.fitted < 0.95
    assert right.recovery[toy.V] > 0.8 > 0.2 > abs(right.recovery[toy.NAMES.index("tau_mem")])
    assert sum(right.histogram(toy.V)) == 200
    assert max(right.histogram(toy.V)) < 40


def test_overconfidence_is_seen(studied, monkeypatch):
    where, found = studied
    rows = np.arange(60)
    some = summary_statistics.Observed(**{name: getattr(found, name)[rows] for name in found.__struct_fields__})
    tiny = Effects(
        sr=np.full(3, 0.05), ratio=np.full(3, 0.05), adoption=np.full(3, 0.05), spread=0.0, correlation=np.eye(3)
    )
    monkeypatch.setattr(design_effects, "crossed", lambda rates, studies: [(np.arange(60), tiny)])
    monkeypatch.setattr(likelihood, "_LEAST_RHO", 1e-6)
    wrong = coverage.run(toy.Exact(), where[rows], some, proposals=1 << 12, fitted=(toy.NAMES[toy.V],))
    assert wrong.fitted < 0.8


def test_abc_agrees_and_sees_a_shift(studied, fitted):
    where, found = studied
    means = coverage.run(toy.Exact(), where, found, proposals=1 << 11).means
    verdict = abc_check.check(fitted, where, means, fitted=LIVE)
    assert verdict.passed
    assert verdict.error[toy.V] < 0.3
    off = msgspec.structs.replace(fitted, points=np.clip(fitted.points + 1.2 * fitted.sd, 0.0, 1.0))
    assert not abc_check.check(off, where, means, fitted=LIVE).passed
    with pytest.raises(ValueError, match="at least 40"):
        abc_check.check(fitted, where[:30], means[:30])


def test_two_conditions_foretell_the_third(true_effects):
    where = np.full((1, len(toy.NAMES)), 0.5)
    where[0, toy.V] = 0.8
    truth = toy.exact(where)
    study = summary_statistics.Observed(
        successes=np.round(truth.sr * [58, 59, 58]),
        trials=np.array([[58.0, 59.0, 58.0]]),
        adopted=np.round(truth.adoption * [0, 50, 50]),
        asked=np.array([[0.0, 50.0, 50.0]]),
        ratio=truth.ratio,
    )
    prior = posterior.bank(toy.Exact(), seed=1, proposals=1 << 12)
    bad = held_out.simple(np.array([0.05] * 3), np.array([0.95] * 3), np.array([0.1] * 3), np.array([0.0] * 3), 300)
    found = held_out.run(toy.Exact(), study, true_effects, prior=prior, rivals={"bad": bad, "true": truth})
    assert [one.condition for one in found] == list(trial_table.CONDITIONS)
    for one in found:
        assert one.gain > 0.0
        assert one.condition not in one.fitted
        assert all(row.inside80 for row in one.figures)
        assert one.rivals["bad"] < one.log_score < one.rivals["true"] + 0.5
    assert [row.name for row in found[0].figures] == ["sr none", "twsr none"]
    assert set(found[0].parts) == {"sr", "ratio"}
    assert set(found[2].parts) == {"sr", "adoption", "ratio"}


# ------------------------------------------------------------------------------------------------- what to expect of it


def test_foretold_studies_are_as_noisy_as_real_ones(studied, true_effects):
    where = np.tile(toy.points(1, 20), (300, 1))
    _, real = summary_statistics.studies(toy.studies(where, 21), toy.LEAST)
    drawn = predictive.draw(toy.exact(np.repeat(where, 5, axis=0)), PAPER, true_effects, seed=2).figures()
    for name, values in real.figures().items():
        assert drawn[name].mean() == pytest.approx(values.mean(), abs=0.02), name
        assert 0.75 < drawn[name].std() / values.std() < 1.35, name


def test_the_table_of_figures(true_effects):
    figures = {name: np.linspace(0.0, 1.0, 1001) for name in summary_statistics.FIGURES}
    rows = predictive.compare(figures, PAPER)
    assert [row.name for row in rows] == list(summary_statistics.FIGURES)
    row = rows[2]
    assert (row.median, row.low, row.high80) == pytest.approx((0.5, 0.05, 0.9))
    assert row.percentile == pytest.approx(53 / 58, abs=1e-3)
    assert row.inside
    assert not row.inside80
    assert not row.close


def test_an_order_that_is_clear_is_kept(fitted, true_effects):
    found = msgspec.structs.replace(fitted, points=fitted.points[::5])
    rates = toy.exact(found.points)
    clear = ranking_robustness.robots(rates, true_effects)
    assert clear.holds["sr"] == 1.0
    assert clear.measured["sr"] > 0.9
    gap = next(one for one in clear.pairs if one.name == "sr oracle>frontier")
    np.testing.assert_allclose(gap.gaps, rates.sr[:, 2] - rates.sr[:, 1])
    few = ranking_robustness.robots(rates, true_effects, trials=20)
    assert few.measured["sr"] < clear.measured["sr"]
    turned = msgspec.structs.replace(rates, sr=rates.sr[:, ::-1])
    assert ranking_robustness.robots(turned, true_effects).holds["sr"] == 0.0
    shared = ranking_robustness.robots(rates, true_effects, correlation={"sr": 0.6, "twsr": 0.6})
    assert shared.pairs[0].noise.mean() < gap.noise.mean()


def test_chances_of_an_order_are_those_of_its_noise():
    rates = toy.exact(np.tile(toy.points(1, 22), (2, 1)))
    near = msgspec.structs.replace(rates, sr=np.tile([0.5, 0.53, 0.99], (2, 1)))
    found = ranking_robustness.robots(near, PLAIN)
    pair = next(gap for gap in found.pairs if gap.name == "sr frontier>none")
    assert found.measured["sr"] == pytest.approx(pair.chances[0], abs=0.05)
    assert found.measured["both"] <= min(found.measured["sr"], found.measured["twsr"])
    assert found.measured["both"] > found.measured["sr"] * found.measured["twsr"]  # they rise and fall together


def test_noise_of_a_gap_is_that_of_independent_groups():
    rates = toy.exact(np.tile(toy.points(1, 22), (2, 1)))
    gap = ranking_robustness.robots(rates, PLAIN, trials=600).pairs[0]
    p, q = rates.sr[0, 2], rates.sr[0, 1]
    assert gap.noise[0] == pytest.approx(np.sqrt((p * (1 - p) + q * (1 - q)) / 600))


def test_only_what_matters_swings_a_gap(fitted):
    found = msgspec.structs.replace(fitted, points=fitted.points[::10])
    swings = {(one.name, one.better): one for one in ranking_robustness.sensitivity(toy.Exact(), found)}
    assert len(swings) == 2 * len(toy.NAMES)
    still = swings["tau_mem", "oracle"]
    assert still.low == pytest.approx(still.high)
    assert abs(swings["v_pace", "oracle"].high - swings["v_pace", "oracle"].low) > 0.05


def test_people_who_meet_two_robots_are_paired():
    where = np.tile(toy.points(1, 23), (900, 1))
    made = toy.sessions(where, 23)
    assert ranking_robustness.paired(made, toy.LEAST) == {"sr": 0.0, "twsr": 0.0}
    first = made.take(made.condition == 1)
    columns = {name: getattr(first, name) for name in trial_table.TRIAL}
    twin = trial_table.build(made.names, made.points, {**columns, "condition": np.full(len(first), 2)})
    both = {name: np.concatenate([columns[name], getattr(twin, name)]) for name in trial_table.TRIAL}
    assert ranking_robustness.paired(trial_table.build(made.names, made.points, both), toy.LEAST)[
        "sr"
    ] == pytest.approx(1.0)


def test_trust_curves():
    made = toy.sessions(toy.points(900, 24), 24)
    curve = trust_emulator.fit(made, members=3)
    where = toy.points(40, 25)
    mean = curve.mean(where).mean(axis=0)
    assert mean[1, 9] - mean[1, 0] == pytest.approx(0.9, abs=0.25)
    assert mean[0] == pytest.approx(np.full(10, 3.5), abs=0.25)
    real = trust_emulator.reports(toy.studies(np.repeat(where, 4, axis=0), 26))
    drawn = curve.group(np.repeat(where, 4, axis=0), seed=1)
    assert 0.75 < drawn[:, 1].std(axis=0).mean() / real[:, 1].std(axis=0).mean() < 1.3
    events = curve.events(where)
    gap = ((real[:, 1] - real[:, 0]) > 0.0).all(axis=1).mean()
    assert events.shape == (40, 2)
    assert events[:, 0].mean() == pytest.approx(gap, abs=0.15)
    assert events[:, 1].mean() > 0.9
