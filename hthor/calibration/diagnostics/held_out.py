"""How well two conditions foretell the third, against the prior and simple models."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from msgspec import Struct

from hthor.calibration.emulator.emulator import Emulator, Rates
from hthor.calibration.inference import likelihood, posterior, predictive
from hthor.calibration.inference.design_effects import Effects
from hthor.calibration.inference.posterior import Bank
from hthor.calibration.inference.predictive import Row
from hthor.calibration.inference.summary_statistics import FIGURES, Observed
from hthor.calibration.simulation.trial_table import CONDITIONS

Array = np.ndarray[Any, Any]


class HeldOut(Struct, frozen=True, kw_only=True):
    """A condition that was left out of the fit.

    Attributes:
        fitted: the conditions that were fitted. figures: its SR, TWSR and, with a robot, adoption.
        log_score: log chance [nats] of its counts and ratio, given the others. log_score_prior: before any data.
        parts: gain over the prior by metric ("sr", "adoption", "ratio"), each judged alone.
        rivals: log scores of simple models, by name.
    """

    condition: str
    fitted: tuple[str, ...]
    figures: tuple[Row, ...]
    log_score: float
    log_score_prior: float
    parts: dict[str, float]
    rivals: dict[str, float]

    @property
    def gain(self) -> float:
        """Nats gained over the prior."""
        return self.log_score - self.log_score_prior


def run(
    emulator: Emulator,
    study: Observed,
    effects: Effects,
    seed: int = 0,
    prior: Bank | None = None,
    rivals: Mapping[str, Rates] | None = None,
) -> tuple[HeldOut, ...]:
    """Leave out each condition in turn, and foretell it.

    Args:
        study: the published one (S = 1).
        prior: a bank of the prior, see `posterior.bank`.
        rivals: rates (N = 1) of models without parameters, by name; `simple` makes them of simulated trials.
    """
    held = prior or posterior.bank(emulator, seed)
    return tuple(_one(emulator, study, effects, seed, held, rivals or {}, name) for name in CONDITIONS)


def simple(sr: Array, ratio: Array, ratio_sd: Array, adoption: Array, trials: int) -> Rates:
    """Rates of a model that was simulated, arrays (3,) by condition, each found on so many ``trials``.

    A rate of 0 of 200 trials is not impossible: the uncertainty of the rate is part of its score.
    """
    shares = {
        name: (np.asarray(share, dtype=float) * trials + 0.5) / (trials + 1.0)
        for name, share in (("sr", sr), ("adoption", adoption))
    }
    errors = {f"{name}_se": np.sqrt(share * (1.0 - share) / trials)[None] for name, share in shares.items()}
    spread = np.asarray(ratio_sd, dtype=float)[None]
    return Rates(
        sr=shares["sr"][None],
        adoption=shares["adoption"][None],
        ratio=np.asarray(ratio, dtype=float)[None],
        ratio_sd=spread,
        ratio_se=spread / np.sqrt(np.maximum(trials * shares["sr"][None], 1.0)),
        **errors,
    )


def _one(
    emulator: Emulator,
    study: Observed,
    effects: Effects,
    seed: int,
    prior: Bank,
    rivals: Mapping[str, Rates],
    condition: str,
) -> HeldOut:
    others, only = study.without(condition), study.only(condition)
    fitted = posterior.sample(emulator, others, effects, seed, prior=prior)
    rates = emulator.rates(fitted.points)
    drawn = predictive.draw(rates, study, effects, seed)
    named = {name: values for name, values in drawn.figures().items() if name.endswith(f" {condition}")}
    return HeldOut(
        condition=condition,
        fitted=tuple(name for name in CONDITIONS if name != condition),
        figures=tuple(row for row in predictive.compare({**_nothing(), **named}, only)),
        log_score=_score(rates, only, effects),
        log_score_prior=_score(prior.rates, only, effects),
        parts={
            metric: _score(rates, part, effects) - _score(prior.rates, part, effects)
            for metric, part in _parts(only).items()
        },
        rivals={name: _score(rival, only, effects) for name, rival in sorted(rivals.items())},
    )


def _score(rates: Rates, study: Observed, effects: Effects) -> float:
    """Log of the mean chance over equally likely rates."""
    log = likelihood.log(rates, study, effects)
    top = float(log.max())
    return top + float(np.log(np.mean(np.exp(log - top))))


def _parts(study: Observed) -> dict[str, Observed]:
    nothing, none = np.zeros_like(study.trials), np.full_like(study.ratio, np.nan)
    counts = {"successes": study.successes, "trials": nothing, "adopted": nothing, "asked": nothing, "ratio": none}
    parts = {
        "sr": Observed(**{**counts, "trials": study.trials}),
        "adoption": Observed(**{**counts, "adopted": study.adopted, "asked": study.asked}),
        "ratio": Observed(**{**counts, "ratio": study.ratio}),
    }
    return {name: part for name, part in parts.items() if part.trials.any() or part.asked.any() or name == "ratio"}


def _nothing() -> dict[str, Array]:
    return {name: np.full(1, np.nan) for name in FIGURES}
