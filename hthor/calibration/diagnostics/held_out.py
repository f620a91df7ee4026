"""How well two conditions predict the third, compared with the prior and with simple models."""

from collections.abc import Mapping

import numpy as np

from hthor.calibration.emulator.emulator import Emulator, Rates
from hthor.calibration.evidence import HeldOutCondition
from hthor.calibration.inference import likelihood, posterior, predictive
from hthor.calibration.inference.design_effects import DesignEffects
from hthor.calibration.inference.posterior import PriorSample
from hthor.calibration.inference.summary_statistics import StudyResults
from hthor.calibration.targets import CONDITIONS

_BAND80 = (0.1, 0.5, 0.9)


def predict_held_out(
    emulator: Emulator,
    study: StudyResults,
    effects: DesignEffects,
    prior: PriorSample,
    seed: int = 0,
    rivals: Mapping[str, Rates] | None = None,
) -> tuple[HeldOutCondition, ...]:
    """Leave out each condition in turn, and predict it: SR, TWSR and, with a robot, adoption.

    Args:
        study: the published one (S = 1).
        prior: see `posterior.sample_prior`.
        rivals: rates (N = 1) of models without parameters, by name.
    """
    found = []
    for condition in CONDITIONS:
        others, only = study.without(condition), study.only(condition)
        fitted = posterior.sample_posterior(emulator, others, effects, seed, prior=prior)
        rates = emulator.rates(fitted.points)
        figures = predictive.draw_studies(rates, study, effects, seed).figures()
        found.append(
            HeldOutCondition(
                condition=condition,
                fitted=tuple(name for name in CONDITIONS if name != condition),
                figures=predictive.compare_figures(figures, only, _BAND80),
                log_score=_score(rates, only, effects),
                log_score_prior=_score(prior.rates, only, effects),
                rivals={name: _score(rival, only, effects) for name, rival in sorted((rivals or {}).items())},
            )
        )
    return tuple(found)


def _score(rates: Rates, study: StudyResults, effects: DesignEffects) -> float:
    """Log of the mean probability [nats] over equally likely rates."""
    log = likelihood.log_likelihood(rates, study, effects)
    top = float(log.max())
    return top + float(np.log(np.mean(np.exp(log - top))))
