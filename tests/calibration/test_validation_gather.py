"""From the products of a calibration to its evidence: nothing is lost, and emulators are scored on unseen trials."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import msgspec
import numpy as np
import pytest
import validation_fakes as fakes

from hthor.calibration import evidence, targets
from hthor.calibration.diagnostics.coverage import Coverage
from hthor.calibration.evidence import (
    FIGURES,
    AbcShift,
    HeldOutCondition,
    HeldOutFigure,
    ParameterSwing,
    RobotRanking,
)
from hthor.calibration.inference.design_effects import NAMES, EmulatorQuality
from hthor.calibration.pipeline import collect_evidence
from hthor.calibration.targets import CONDITIONS
from hthor.humans.population import parameter_registry
from hthor.humans.population.population import Population

P = len(parameter_registry.free_parameter_names())
STUDIES = 12


def _figure(name: str) -> HeldOutFigure:
    return HeldOutFigure(figure=name, published=0.6, band=evidence.Band(low=0.45, median=0.62, high=0.75))


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
        config=SimpleNamespace(
            suite=SimpleNamespace(name="paper", sha256="ab" * 32),
            targets=targets.load_targets("paper"),
            seed=7,
            sizes=SimpleNamespace(correction=0),
        ),
        simulated={"training": fakes.trials(6), "studies": studies, "predicted": studies},
        studies=studies,
        predicted=studies,
        emulator=SimpleNamespace(rates=lambda _: SimpleNamespace(sr=shares, adoption=shares)),
        effects=SimpleNamespace(figures=lambda: dict.fromkeys(NAMES, 1.5)),
        posterior=SimpleNamespace(effective=321.5),
        predictions={
            source: {name: chance.random(50) for name in FIGURES} for source in ("prior", "posterior", "simulated")
        },
        quality=EmulatorQuality(z_sd=1.02, by_figure=dict.fromkeys(NAMES, 1.1), studies=STUDIES),
        coverage=Coverage(
            names=parameter_registry.free_parameter_names(),
            covered=np.linspace(0.8, 1.0, P),
            overall=0.9,
            means=chance.random((STUDIES, P)),
            ranks=chance.random((STUDIES, P)),
            recovery=np.linspace(-0.1, 0.9, P),
        ),
        abc_shifts=tuple(
            AbcShift(name=one.name, shift=0.1, error=0.1) for one in parameter_registry.PARAMETERS if one.fitted
        ),
        held_out=tuple(
            HeldOutCondition(
                condition=name,
                fitted=tuple(other for other in CONDITIONS if other != name),
                figures=tuple(_figure(figure) for figure in FIGURES if figure.endswith(name)),
                log_score=-5.0,
                log_score_prior=-7.0,
            )
            for name in CONDITIONS
        ),
        ranking=RobotRanking(
            suite="paper", trials=600, draws=50, sr=0.96, twsr=0.95, both=0.94, expected={"both": 0.97}
        ),
        swings=(ParameterSwing(name="a50", better="oracle", worse="frontier", low=0.1, high=0.2, ordered=0.9),),
    )


@pytest.fixture(scope="module")
def population() -> Population:
    points = np.random.default_rng(1).uniform(0.05, 0.95, (40, P))
    return Population.make(
        "paper", parameter_registry.from_quantiles(points), purpose="a test", seed=7, command="a test"
    )


@pytest.fixture(scope="module")
def found(stages: Any, population: Population) -> evidence.Evidence:
    return collect_evidence.collect_evidence(stages, population, quick=False)


def test_all_parts_are_there(found: evidence.Evidence, population: Population) -> None:
    assert [row.figure for row in found.predictive] == list(FIGURES)
    assert [one.name for one in found.parameters] == list(parameter_registry.free_parameter_names())
    assert [part.condition for part in found.held_out] == list(CONDITIONS)
    assert sum(len(part.figures) for part in found.held_out) == 8
    assert found.origin.population_sha256 == population.sha256
    assert found.simulated_studies == STUDIES
    assert msgspec.json.decode(evidence.encode_evidence(found), type=evidence.Evidence) == found


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
    assert [one.name for one in found.rankings[0].swings] == ["a50"]
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
