"""What the environments with one robot have in common: seeds, decisions, rewards, ends."""

import math
from collections.abc import Mapping
from typing import Any

import gymnasium
import numpy as np
from gymnasium.error import ResetNeeded
from numpy.typing import NDArray

from hthor.agents.skills.learner import LearnerView
from hthor.agents.skills.learner.actions import action_names
from hthor.envs.decision_trial import Decided, DecisionTrial, RewardWeights
from hthor.envs.learning import spaces
from hthor.envs.learning.information import information
from hthor.envs.learning.remade import Remade
from hthor.envs.learning.study_seeds import StudySeeds
from hthor.envs.trial_source import TrialSource
from hthor.episode import EpisodeLog
from hthor.types import TrialSpec

ROBOT = "robot"
PIXELS_PER_METRE = 25.0
"""Scale of the pictures of ``render``."""


class RobotEnv(Remade, gymnasium.Env[Any, Any]):
    """An environment with one robot that learns; subclasses say when it has succeeded.

    A step is one decision: it lasts until the robot's body is free again, from one tick of 0.1 s to about two seconds.
    ``reset(seed=S)`` begins study S: the first episode has its participant 0, every further ``reset()`` the next one.
    ``reset(options={"task": ID})`` chooses the task, else it is drawn.

    Args:
        source: makes the trials. sight: "state" or "rgbd". weights: of the reward. talks: whether it sends messages.

    Attributes:
        actions: the names of the actions in the order of their numbers. trial: the present trial.
    """

    metadata: dict[str, Any] = {"render_modes": ["rgb_array"], "render_fps": 5}  # noqa: RUF012 - as Gymnasium does

    def __init__(
        self, source: TrialSource, sight: str, weights: RewardWeights, render_mode: str | None, *, talks: bool = True
    ) -> None:
        self._source, self._sight, self._weights, self._talks = source, sight, weights, talks
        self.render_mode = render_mode
        body, jobs = source.bodies[ROBOT], source.jobs
        self.actions = action_names(body, jobs, talks)
        self.observation_space = spaces.observation_space(jobs, sight)
        self.action_space = spaces.action_space(body, jobs, talks)
        self.trial: TrialSpec | None = None
        self._played: DecisionTrial | None = None
        self._over = False
        self._seeds = StudySeeds()

    def reset(self, *, seed: int | None = None, options: Mapping[str, Any] | None = None) -> tuple[Any, dict[str, Any]]:
        """Begin a trial with a new person; ``options={"task": ID}`` chooses the task.

        Raises:
            UnknownName: when there is no such task.
        """
        super().reset(seed=seed)
        self.trial = self._seeds.trial(self._source, self.np_random, seed, options)
        self._played = DecisionTrial(
            self._source.control(self.trial),
            self._source.jobs,
            talks=self._talks,
            measures_ways=bool(self._weights.approach),
        )
        self._played.begin()
        self._over = False
        return spaces.observe(self.view, self._sight), self._info()

    def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """Make a decision, and let time pass until the next one.

        Raises:
            ResetNeeded: before the first reset, and after the end of an episode.
        """
        played = self._running()
        if self._over:
            raise ResetNeeded("the episode is over: call reset()")
        decided = played.decide({ROBOT: action})
        success = self._succeeded(played)
        terms = self._weights.terms(self._goal(decided, success), decided, ROBOT, played.episode.task)
        truncated = played.control.done and not success
        self._over = success or truncated
        info = self._info() | {"refused": decided.refused[ROBOT], "reward_terms": terms}
        return spaces.observe(self.view, self._sight), math.fsum(terms.values()), success, truncated, info

    def action_masks(self) -> NDArray[np.bool_]:
        """(number of actions,) bool: the legal actions, where ``MaskablePPO`` of sb3-contrib looks for them."""
        return self.view.mask().astype(bool)

    def render(self) -> Any:
        """The house from above, (H, W, 3) uint8, with +y up; None without a render mode."""
        if self.render_mode is None:
            return None
        world: Any = self._running().episode.world
        return world.top_view(PIXELS_PER_METRE)

    def close(self) -> None:
        """Drop the worlds; a later reset makes new ones."""
        self._source.close()
        self._played = None

    def log(self) -> EpisodeLog:
        """The trial's log up to now; once it is over, that of `hthor.episode.play` with the same actions."""
        return self._running().control.log()

    @property
    def view(self) -> LearnerView:
        """What the robot knows now."""
        return self._running().views[ROBOT]

    def _succeeded(self, played: DecisionTrial) -> bool:
        """Whether the task is done."""
        return played.episode.met

    def _goal(self, decided: Decided, success: bool) -> float:  # noqa: ARG002
        """The part of the reward that is for the goal."""
        return decided.goal

    def _info(self) -> dict[str, Any]:
        played = self._running()
        return information(played, self.trial, ROBOT, self._succeeded(played))

    def _running(self) -> DecisionTrial:
        if self._played is None:
            raise ResetNeeded("call reset() first")
        return self._played
