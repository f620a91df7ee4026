"""The stages of a calibration on published numbers, each computed once and stored.

Each product is stored with the hash of its inputs, and made again when the hash has changed.
"""

import pickle
from collections.abc import Callable
from contextlib import AbstractContextManager
from functools import cached_property, partial
from pathlib import Path
from typing import Protocol, TypeVar

import numpy as np

from hthor import jsonio
from hthor.calibration.diagnostics import coverage, ranking_robustness
from hthor.calibration.diagnostics.coverage import Coverage
from hthor.calibration.emulator import emulator
from hthor.calibration.emulator.emulator import Emulator
from hthor.calibration.emulator.mlp import single_thread
from hthor.calibration.evidence import AbcShift, HeldOutCondition, ParameterSwing, RobotRanking
from hthor.calibration.inference import design_effects, likelihood, posterior, summary_statistics
from hthor.calibration.inference.design_effects import DesignEffects, EmulatorQuality
from hthor.calibration.inference.posterior import Posterior
from hthor.calibration.inference.summary_statistics import StudyResults
from hthor.calibration.pipeline.config import CalibrationConfig
from hthor.calibration.simulation import design_points, session_store, simulate, trial_table
from hthor.calibration.simulation.trial_table import Table
from hthor.eval.runner.progress import Watcher
from hthor.humans.population import parameter_registry

_T = TypeVar("_T")
_KEY_LENGTH = 64
FITTED = tuple(one.name for one in parameter_registry.PARAMETERS if one.fitted)
"""Parameters that the published numbers are expected to change."""


class ArtifactCache:
    """Products of one calibration, in a folder; only files that this program wrote are read.

    ``key`` is the hash of all inputs of the products, 64 hexadecimal digits.
    """

    def __init__(self, folder: Path, key: str) -> None:
        self._folder, self._key = folder, key

    def get(self, name: str, make: Callable[[], _T]) -> _T:
        """The product of this name: the stored one if it was made from the same inputs, else a new one."""
        path = self._folder / f"{name}.pkl"
        if path.exists():
            data = path.read_bytes()
            if data[:_KEY_LENGTH] == self._key.encode():
                stored: _T = pickle.loads(data[_KEY_LENGTH:])
                return stored
        product = make()
        jsonio.write(path, self._key.encode() + pickle.dumps(product, protocol=5))
        return product


class ProgressReporter(Protocol):
    """Reports the progress of a calibration."""

    def watch(self, stage: str) -> AbstractContextManager[Watcher]:
        """Report a stage that simulates, trial by trial, for as long as the context lasts."""

    def work(self, stage: str) -> AbstractContextManager[None]:
        """Report a stage that only computes, for as long as the context lasts."""


class CalibrationStages:
    """The products of a calibration, one per property, computed with all products that they need, and stored."""

    def __init__(self, config: CalibrationConfig, progress: ProgressReporter) -> None:
        self.config, self._progress = config, progress
        self.t_star = trial_table.suite_t_star(config.suite)
        inputs = (
            session_store.trials_identity(config.suite),
            config.targets,
            config.seed,
            config.sizes,
            self.t_star.tolist(),
            session_store.statistics_sha256(),
        )
        self._cache = ArtifactCache(config.folder / "products", jsonio.sha256(inputs))

    # ------------------------------------------------------------------------------------------------------- simulated

    @cached_property
    def training(self) -> Table:
        """Sessions spread over the prior."""
        return self._sessions("training", self._prior_points(self.config.sizes.sessions, "training"))

    @cached_property
    def studies(self) -> Table:
        """Whole studies spread over the prior."""
        return self._studies("studies", self._prior_points(self.config.sizes.studies, "studies"))

    @cached_property
    def correction(self) -> Table:
        """Sessions near the first posterior."""
        count, seed = self.config.sizes.correction, self.config.seed
        return self._sessions("correction", posterior.propose_points(self.first_posterior, count, seed))

    @cached_property
    def predicted(self) -> Table:
        """Whole studies of people of the posterior."""
        draws, count = self.posterior.points, self.config.sizes.posterior_studies
        evenly = np.arange(count) * len(draws) // count
        return self._studies("predicted", draws[evenly])

    @property
    def simulated(self) -> dict[str, Table]:
        """All simulated tables, by name."""
        more = {"correction": self.correction} if self.config.sizes.correction else {}
        return {"training": self.training, "studies": self.studies, "predicted": self.predicted, **more}

    def _prior_points(self, count: int, name: str) -> np.ndarray:
        return design_points.sobol_points(count, len(parameter_registry.free_parameter_names()), self.config.seed, name)

    def _sessions(self, name: str, points: np.ndarray) -> Table:
        config = self.config
        with self._progress.watch(name) as watch:
            folder = config.folder / name
            return simulate.simulate_sessions(points, config.suite, config.seed, folder, config.jobs, watch, name)

    def _studies(self, name: str, points: np.ndarray) -> Table:
        config = self.config
        with self._progress.watch(name) as watch:
            folder, design = config.folder / name, config.targets.design
            return simulate.simulate_studies(
                points, config.suite, config.seed, folder, config.jobs, watch, name, design
            )

    # ------------------------------------------------------------------------------------------------------------ fits

    @cached_property
    def first_emulator(self) -> Emulator:
        """The emulator fitted to the training sessions alone."""
        return self._emulator("first-emulator", self.training)

    @cached_property
    def first_posterior(self) -> Posterior:
        """The posterior by the first emulator; it shows where to simulate more sessions."""
        effects = self._effects("first-effects", self.first_emulator)
        return self._posterior("first-posterior", self.first_emulator, effects)

    @cached_property
    def emulator(self) -> Emulator:
        """The emulator fitted to training and correction sessions, if there are correction sessions."""
        if not self.config.sizes.correction:
            return self.first_emulator
        return self._emulator("emulator", trial_table.join_tables([self.training, self.correction]))

    @cached_property
    def effects(self) -> DesignEffects:
        """Design effects: variance of the published figures over that of independent trials."""
        return self._effects("effects", self.emulator)

    @cached_property
    def posterior(self) -> Posterior:
        """The posterior given the published numbers."""
        return self._posterior("posterior", self.emulator, self.effects)

    def _emulator(self, name: str, table: Table) -> Emulator:
        members, seed = self.config.sizes.members, self.config.seed
        return self._cached(name, lambda: emulator.fit_emulator(table, self.t_star, seed=seed, members=members))

    def _effects(self, name: str, fitted: Emulator) -> DesignEffects:
        points, observed = self.studies.points, self.observed
        return self._cached(name, lambda: design_effects.estimate_effects(fitted.rates(points), observed))

    def _posterior(self, name: str, fitted: Emulator, effects: DesignEffects) -> Posterior:
        published, seed, sizes = self.published, self.config.seed, self.config.sizes
        make = partial(posterior.sample_posterior, draws=sizes.draws, proposals=sizes.proposals, seed=seed)
        return self._cached(name, lambda: make(fitted, published, effects))

    # ---------------------------------------------------------------------------------------------------------- checks

    @cached_property
    def published(self) -> StudyResults:
        """The published study."""
        return summary_statistics.published_results(self.config.targets)

    @cached_property
    def observed(self) -> StudyResults:
        """The results that each simulated study would have published."""
        return summary_statistics.study_results(self.studies, self.t_star)[1]

    @cached_property
    def quality(self) -> EmulatorQuality:
        """The emulator's errors on whole studies, in its own standard deviations."""
        fitted, points, observed = self.emulator, self.studies.points, self.observed
        return self._cached("quality", lambda: design_effects.emulator_quality(fitted.rates(points), observed))

    @cached_property
    def coverage(self) -> Coverage:
        """How often the 90 % intervals of simulated studies contain the truth."""
        fitted, points, observed = self.emulator, self.studies.points, self.observed
        seed, size = self.config.seed, self.config.sizes.proposals // 2
        return self._cached(
            "coverage", lambda: coverage.check_coverage(fitted, points, observed, seed=seed, proposals=size)
        )

    @cached_property
    def abc_shifts(self) -> tuple[AbcShift, ...]:
        """Shifts of the fitted parameters by approximate Bayesian computation; empty with too few studies."""
        if self.config.sizes.studies < coverage.FEWEST:
            return ()
        points, means, seed, ours = self.studies.points, self.coverage.means, self.config.seed, self.posterior
        return self._cached("abc", lambda: coverage.compare_posteriors(ours, points, means, FITTED, seed=seed))

    @cached_property
    def held_out(self) -> tuple[HeldOutCondition, ...]:
        """Each condition predicted by the other two."""
        fitted, published, effects = self.emulator, self.published, self.effects
        seed, size = self.config.seed, self.config.sizes.proposals

        def predict() -> tuple[HeldOutCondition, ...]:
            prior = posterior.sample_prior(fitted, seed, size)
            return coverage.predict_held_out(fitted, published, effects, prior, seed=seed)

        return self._cached("held-out", predict)

    @cached_property
    def ranking(self) -> RobotRanking:
        """How posterior draws rank the robots."""
        fitted, points, effects = self.emulator, self.posterior.points, self.effects
        seed, suite = self.config.seed, self.config.suite.name

        def rank() -> RobotRanking:
            return ranking_robustness.rank_robots(fitted.rates(points), effects, seed=seed, suite=suite)

        return self._cached("ranking", rank)

    @cached_property
    def swings(self) -> tuple[ParameterSwing, ...]:
        """How each parameter alone changes the gaps between robots."""
        fitted, ours = self.emulator, self.posterior
        return self._cached("swings", lambda: ranking_robustness.parameter_swings(fitted, ours))

    @cached_property
    def predictions(self) -> dict[str, dict[str, np.ndarray]]:
        """The eight figures of studies: emulated for the prior and the posterior, simulated for the posterior."""
        points = {
            "prior": self._prior_points(self.config.sizes.draws, "prior predictive"),
            "posterior": self.posterior.points,
        }
        emulated = {
            name: likelihood.draw_studies(self.emulator.rates(some), self.published, self.effects, self.config.seed)
            for name, some in points.items()
        }
        simulated = summary_statistics.study_results(self.predicted, self.t_star)[1]
        return {name: results.figures() for name, results in {**emulated, "simulated": simulated}.items()}

    def _cached(self, name: str, make: Callable[[], _T]) -> _T:
        """A product, computed by one thread so that its bytes do not depend on the number of threads."""
        with self._progress.work(name), single_thread():
            return self._cache.get(name, make)
