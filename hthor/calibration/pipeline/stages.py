"""The stages of a calibration on published numbers, each made once and kept."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Protocol, TypeVar

import numpy as np
from msgspec import Struct

from hthor import jsonio
from hthor.calibration.emulator.single_thread import alone
from hthor.calibration.pipeline.artifact_cache import ArtifactCache
from hthor.calibration.simulation import design_points, simulate, studies, trial_identity, trial_table
from hthor.calibration.simulation.budget import Sizes
from hthor.calibration.simulation.trial_table import Table
from hthor.calibration.targets import Targets
from hthor.eval.runner.progress import Watcher
from hthor.humans.population import parameter_registry
from hthor.tasks import Suite

if TYPE_CHECKING:
    from hthor.calibration.diagnostics.abc_check import Check
    from hthor.calibration.diagnostics.coverage import Coverage
    from hthor.calibration.diagnostics.held_out import HeldOut
    from hthor.calibration.diagnostics.ranking_robustness import Ranking, Swing
    from hthor.calibration.emulator.emulator import Emulator
    from hthor.calibration.inference.design_effects import Effects, Quality
    from hthor.calibration.inference.posterior import Posterior
    from hthor.calibration.inference.summary_statistics import Observed

_T = TypeVar("_T")

FITTED = tuple(one.name for one in parameter_registry.PARAMETERS if one.fitted)
"""Parameters that the published numbers are expected to move."""


class Teller(Protocol):
    """Who is told how a calibration goes."""

    def watch(self, stage: str) -> AbstractContextManager[Watcher]:
        """Somebody who follows a stage that simulates."""

    def work(self, stage: str) -> AbstractContextManager[None]:
        """A stage that only computes begins, and ends with the context."""


class Brief(Struct, frozen=True, kw_only=True):
    """What is to be calibrated, on what, with which chances; ``folder`` keeps everything, ``jobs`` are processes."""

    suite: Suite
    targets: Targets
    seed: int
    sizes: Sizes
    folder: Path
    jobs: int


class Stages:
    """The stages, in order of need: to ask for one makes those that it needs. Each is kept in the folder."""

    def __init__(self, brief: Brief, teller: Teller) -> None:
        self.brief, self._teller = brief, teller
        self.t_star = trial_table.t_star(brief.suite)
        self.known = trial_identity.trials_identity(brief.suite)
        what = (
            self.known,
            brief.targets,
            brief.seed,
            brief.sizes,
            self.t_star.tolist(),
            trial_identity.statistics_sha256(),
        )
        self._shelf = ArtifactCache(brief.folder / "products", jsonio.sha256(what))

    # ------------------------------------------------------------------------------------------------------- simulated

    @cached_property
    def training(self) -> Table:
        """Sessions all over the prior."""
        size = self.brief.sizes.sessions
        where = design_points.spread(size, len(parameter_registry.free_parameter_names()), self.brief.seed, "training")
        return self._sessions("training", where)

    @cached_property
    def studies(self) -> Table:
        """Whole studies all over the prior."""
        size = self.brief.sizes.studies
        where = design_points.spread(size, len(parameter_registry.free_parameter_names()), self.brief.seed, "studies")
        return self._studies("studies", where)

    @cached_property
    def correction(self) -> Table:
        """Sessions near the first posterior."""
        from hthor.calibration.inference import posterior

        where = posterior.propose(self.first_posterior, self.brief.sizes.correction, self.brief.seed)
        return self._sessions("correction", where)

    @cached_property
    def predicted(self) -> Table:
        """Whole studies of people of the posterior."""
        draws, count = self.posterior.points, self.brief.sizes.posterior_studies
        evenly = np.arange(count) * len(draws) // count  # draws that lie together come from the same round of weighing
        return self._studies("predicted", draws[evenly])

    def _sessions(self, name: str, where: np.ndarray) -> Table:
        brief = self.brief
        with self._teller.watch(name) as watch:
            return simulate.at(where, brief.suite, brief.seed, brief.folder / name, brief.jobs, watch, name)

    def _studies(self, name: str, where: np.ndarray) -> Table:
        brief = self.brief
        with self._teller.watch(name) as watch:
            folder, design = brief.folder / name, brief.targets.design
            return studies.at(where, brief.suite, brief.seed, folder, brief.jobs, watch, name, design)

    # ------------------------------------------------------------------------------------------------------------ fits

    @cached_property
    def first_emulator(self) -> Emulator:
        """Fitted to the training alone."""
        return self._emulator("first-emulator", self.training)

    @cached_property
    def first_posterior(self) -> Posterior:
        """By the first emulator: shows where to look closer."""
        effects = self._effects("first-effects", self.first_emulator)
        return self._posterior("first-posterior", self.first_emulator, effects)

    @cached_property
    def emulator(self) -> Emulator:
        """Fitted to the training and the correction, where there is one."""
        if not self.brief.sizes.correction:
            return self.first_emulator
        return self._emulator("emulator", trial_table.join([self.training, self.correction]))

    @cached_property
    def effects(self) -> Effects:
        """Design effects: variance of the published figures over that of independent trials."""
        return self._effects("effects", self.emulator)

    @cached_property
    def posterior(self) -> Posterior:
        """Of the published numbers."""
        return self._posterior("posterior", self.emulator, self.effects)

    def _emulator(self, name: str, trials: Table) -> Emulator:
        from hthor.calibration.emulator import emulator

        sizes, seed = self.brief.sizes, self.brief.seed
        return self._made(name, lambda: emulator.fit(trials, self.t_star, seed=seed, members=sizes.members))

    def _effects(self, name: str, fitted: Emulator) -> Effects:
        from hthor.calibration.inference import design_effects

        where, seen = self.studies.points, self.observed
        return self._made(name, lambda: design_effects.effects(fitted.rates(where), seen))

    def _posterior(self, name: str, fitted: Emulator, effects: Effects) -> Posterior:
        from hthor.calibration.inference import posterior

        sizes, seed = self.brief.sizes, self.brief.seed
        return self._made(
            name,
            lambda: posterior.sample(
                fitted, self.published, effects, seed=seed, draws=sizes.draws, proposals=sizes.proposals
            ),
        )

    # ---------------------------------------------------------------------------------------------------------- checks

    @cached_property
    def published(self) -> Observed:
        """The study that was published."""
        from hthor.calibration.inference import summary_statistics

        return summary_statistics.published(self.brief.targets)

    @cached_property
    def observed(self) -> Observed:
        """What each simulated study would have published."""
        return self._published_of(self.studies)

    @cached_property
    def quality(self) -> Quality:
        """How far the emulator is off whole studies, in its own standard deviations."""
        from hthor.calibration.inference import design_effects

        fitted, where, seen = self.emulator, self.studies.points, self.observed
        return self._made("quality", lambda: design_effects.quality(fitted.rates(where), seen))

    @cached_property
    def coverage(self) -> Coverage:
        """How often simulated studies' 90 % intervals hold the truth."""
        from hthor.calibration.diagnostics import coverage

        fitted, where, seen = self.emulator, self.studies.points, self.observed
        seed, size = self.brief.seed, self.brief.sizes.proposals // 2
        return self._made(
            "coverage", lambda: coverage.run(fitted, where, seen, seed=seed, proposals=size, fitted=FITTED)
        )

    @cached_property
    def check(self) -> Check | None:
        """The same posterior by approximate Bayesian computation; None with too few studies for it."""
        from hthor.calibration.diagnostics import abc_check

        if self.brief.sizes.studies < abc_check.FEWEST:
            return None
        where, means, seed = self.studies.points, self.coverage.means, self.brief.seed
        found = self.posterior
        return self._made("abc", lambda: abc_check.check(found, where, means, seed=seed, fitted=FITTED))

    @cached_property
    def held_out(self) -> tuple[HeldOut, ...]:
        """Each condition foretold by the other two."""
        from hthor.calibration.diagnostics import held_out
        from hthor.calibration.inference import posterior

        fitted, aim, effects = self.emulator, self.published, self.effects
        seed, size = self.brief.seed, self.brief.sizes.proposals
        return self._made(
            "held-out",
            lambda: held_out.run(fitted, aim, effects, seed=seed, prior=posterior.bank(fitted, seed, size)),
        )

    @cached_property
    def ranking(self) -> Ranking:
        """How posterior draws rank the robots."""
        from hthor.calibration.diagnostics import ranking_robustness

        fitted, where, effects, seed = self.emulator, self.posterior.points, self.effects, self.brief.seed
        return self._made("ranking", lambda: ranking_robustness.robots(fitted.rates(where), effects, seed=seed))

    @cached_property
    def swings(self) -> tuple[Swing, ...]:
        """What each parameter alone does to the gaps between robots."""
        from hthor.calibration.diagnostics import ranking_robustness

        fitted, found = self.emulator, self.posterior
        return self._made("swings", lambda: ranking_robustness.sensitivity(fitted, found))

    @cached_property
    def foretold(self) -> dict[str, dict[str, np.ndarray]]:
        """The eight figures of studies: emulated ones of the prior and the posterior, simulated ones of the latter."""
        from hthor.calibration.inference import predictive

        seed, sizes = self.brief.seed, self.brief.sizes
        where = {
            "prior": design_points.spread(
                sizes.draws, len(parameter_registry.free_parameter_names()), seed, "prior predictive"
            ),
            "posterior": self.posterior.points,
        }
        emulated = {
            name: predictive.draw(self.emulator.rates(some), self.published, self.effects, seed).figures()
            for name, some in where.items()
        }
        return {**emulated, "simulated": self._published_of(self.predicted).figures()}

    def _published_of(self, trials: Table) -> Observed:
        from hthor.calibration.inference import summary_statistics

        _, found = summary_statistics.studies(trials, self.t_star)
        return found

    def _made(self, name: str, make: Callable[[], _T]) -> _T:
        """A product, worked out by one thread so that its bytes do not hang on their number."""
        with self._teller.work(name), alone():
            return self._shelf.kept(name, make)
