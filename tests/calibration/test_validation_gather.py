"""From the products of a calibration to its evidence: nothing is lost, and emulators are scored on unseen trials."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import msgspec
import numpy as np
import pytest
import validation_fakes as fakes

from hthor.calibration import targets
from hthor.calibration.diagnostics.abc_check import Check
from hthor.calibration.diagnostics.coverage import Coverage
from hthor.calibration.diagnostics.held_out import HeldOut
from hthor.calibration.diagnostics.ranking_robustness import Gap, Ranking, Swing
from hthor.calibration.inference.design_effects import NAMES, Quality
from hthor.calibration.inference.predictive import Row
from hthor.calibration.pipeline import collect_evidence, evidence
from hthor.calibration.pipeline.evidence import FIGURES
from hthor.calibration.simulation.trial_table import CONDITIONS
from hthor.humans.population import parameter_registry
from hthor.humans.population.population import Population

P = len(parameter_registry.free_parameter_names())
STUDIES = 12


def _row(name: str) -> Row:
    return Row(
        name=name,
        observed=0.6,
        median=0.62,
        low=0.4,
        high=0.8,
        low80=0.45,
        high80=0.75,
        percentile=0.4,
        inside=True,
        inside80=True,
        close=True,
    )


def _studies() -> tuple[Any, np.ndarray]:
    """Twelve studies whose chances of success differ, and those chances (12, 3)."""
    chance = np.random.default_rng(3)
    shares = chance.uniform(0.1, 0.9, (STUDIES, 3))
    parts = []
    for number in range(STUDIES):
        rates = dict(zip(CONDITIONS, shares[number], strict=True))
        one = fakes.trials(6, number, rates, {**rates, "none": 0.0})
        full = np.full(len(one), number)
        parts.append(msgspec.structs.replace(one, study=full, point=full))
    joined = {name: np.concatenate([getattr(part, name) for part in parts]) for name in parts[0].__struct_fields__[2:]}
    return type(parts[0])(
        names=parameter_registry.free_parameter_names(), points=chance.random((STUDIES, P)), **joined
    ), shares


@pytest.fixture(scope="module")
def stages() -> Any:
    chance = np.random.default_rng(5)
    studies, shares = _studies()
    return SimpleNamespace(
        brief=SimpleNamespace(
            suite=SimpleNamespace(name="paper", sha256="ab" * 32),
            targets=targets.load("paper"),
            seed=7,
            sizes=SimpleNamespace(correction=0),
        ),
        training=fakes.trials(6),
        studies=studies,
        predicted=studies,
        emulator=SimpleNamespace(rates=lambda _: SimpleNamespace(sr=shares, adoption=shares)),
        effects=SimpleNamespace(figures=lambda: dict.fromkeys(NAMES, 1.5)),
        posterior=SimpleNamespace(effective=321.5),
        foretold={
            source: {name: chance.random(50) for name in FIGURES} for source in ("prior", "posterior", "simulated")
        },
        quality=Quality(z_sd=1.02, by_figure=dict.fromkeys(NAMES, 1.1), bias={}, r2={}, studies=STUDIES),
        coverage=Coverage(
            names=parameter_registry.free_parameter_names(),
            covered=np.linspace(0.8, 1.0, P),
            overall=0.9,
            fitted=0.9,
            means=chance.random((STUDIES, P)),
            ranks=chance.random((STUDIES, P)),
            recovery=np.linspace(-0.1, 0.9, P),
            contraction=np.zeros(P),
            effective=(10.0, 20.0),
        ),
        check=Check(
            names=parameter_registry.free_parameter_names(),
            shift=np.arange(P) / P,
            error=np.full(P, 0.1),
            worst=0.9,
            passed=False,
            studies=STUDIES,
        ),
        held_out=tuple(
            HeldOut(
                condition=name,
                fitted=tuple(other for other in CONDITIONS if other != name),
                figures=tuple(_row(figure) for figure in FIGURES if figure.endswith(name)),
                log_score=-5.0,
                log_score_prior=-7.0,
                parts={},
                rivals={},
            )
            for name in CONDITIONS
        ),
        ranking=Ranking(
            trials=600,
            draws=50,
            pairs=(
                Gap(
                    metric="sr",
                    better="oracle",
                    worse="frontier",
                    gaps=np.ones(2),
                    noise=np.ones(2),
                    chances=np.array([0.9, 1.0]),
                ),
            ),
            holds={"sr": 0.99, "twsr": 0.98, "both": 0.97},
            measured={"sr": 0.96, "twsr": 0.95, "both": 0.94},
            sure={"sr": 1.0, "twsr": 1.0, "both": 1.0},
        ),
        swings=(Swing(name="a50", metric="sr", better="oracle", worse="frontier", low=0.1, high=0.2, ordered=0.9),),
    )


@pytest.fixture(scope="module")
def population() -> Population:
    points = np.random.default_rng(1).uniform(0.05, 0.95, (40, P))
    return Population.make(
        "paper", parameter_registry.from_quantiles(points), purpose="a test", seed=7, command="a test"
    )


@pytest.fixture(scope="module")
def found(stages: Any, population: Population) -> evidence.Evidence:
    return collect_evidence.evidence(stages, population, quick=False)


def test_all_parts_are_there(found: evidence.Evidence, population: Population) -> None:
    assert [row.figure for row in found.predictive] == list(FIGURES)
    assert [one.name for one in found.parameters] == list(parameter_registry.free_parameter_names())
    assert [part.condition for part in found.held_out] == list(CONDITIONS)
    assert sum(len(part.figures) for part in found.held_out) == 8
    assert found.origin.population_sha256 == population.sha256
    assert found.simulated_studies == STUDIES
    assert msgspec.json.decode(evidence.encode(found), type=evidence.Evidence) == found


def test_intervals_held_out_are_of_80_percent(found: evidence.Evidence) -> None:
    first = found.held_out[0].figures[0]
    assert (first.band.low, first.band.high) == (0.45, 0.75)
    assert first.inside


def test_only_fitted_parameters_are_cross_checked_and_ranked(found: evidence.Evidence) -> None:
    fitted = [one.name for one in parameter_registry.PARAMETERS if one.fitted]
    assert [one.name for one in found.abc] == fitted
    assert [one.name for one in found.parameters if one.ranks] == fitted
    assert all(sum(one.ranks) == STUDIES for one in found.parameters if one.ranks)


def test_an_order_is_judged_as_it_would_be_measured(found: evidence.Evidence) -> None:
    assert (found.rankings[0].sr, found.rankings[0].twsr, found.rankings[0].both) == (0.96, 0.95, 0.94)
    assert found.rankings[0].expected["both"] == 0.97


def test_an_emulator_that_is_right_beats_saying_the_mean(found: evidence.Evidence) -> None:
    whole = [one for one in found.emulated if one.score is not None]
    assert [one.outcome for one in whole] == ["success"] * 3 + ["adoption"] * 2
    for one in whole:
        assert one.score > one.baseline + 0.02  # type: ignore[operator]
        assert len(one.bins) >= 4
        for said, came, trials in one.bins:
            assert abs(said - came) < 4.0 * (said * (1.0 - said) / trials) ** 0.5


def test_log_scores_of_chances() -> None:
    said, came = np.array([0.5, 0.5, 0.8]), np.array([True, False, True])
    assert collect_evidence.log_score(said, came) == pytest.approx((2.0 * np.log(0.5) + np.log(0.8)) / 3.0)


def test_without_enough_studies_there_is_no_cross_check(stages: Any, population: Population) -> None:
    few = SimpleNamespace(**{**vars(stages), "check": None})
    assert collect_evidence.evidence(few, population, quick=True).abc == ()
