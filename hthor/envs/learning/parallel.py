"""A PettingZoo environment of several robots that learn and one living proxy."""

import math
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Any

import gymnasium
from gymnasium.error import ResetNeeded
from gymnasium.utils import seeding
from pettingzoo import ParallelEnv

from hthor.agents.skills.learner.actions import action_names
from hthor.envs.decision_trial import DecisionTrial, RewardWeights
from hthor.envs.learning import spaces
from hthor.envs.learning.information import information
from hthor.envs.learning.remade import Remade
from hthor.envs.learning.study_seeds import StudySeeds
from hthor.envs.trial_source import TrialSource
from hthor.episode import EpisodeLog
from hthor.errors import HthorError
from hthor.tasks.suite import Suite
from hthor.types import TrialSpec
from hthor.types.detector_specs import OWN

ByAgent = dict[str, Any]


class AssistParallelEnv(Remade, ParallelEnv[str, Any, Any]):
    """Several robots help one person with the tasks of a suite; the agents' names are the robots' seats.

    A step lasts until the body of at least one robot is free again. The actions of robots that are busy do nothing:
    their mask leaves them "wait", which lets their motion go on, and ``info["free"]`` is false. All robots get the same
    reward for the goal and for time, and each its own for coming nearer. Episodes end for all robots at once.

    Args:
        robots: the bodies, in the order of the seats "robot", "robot2" ...
        others: as in `hthor.envs.learning.assist.AssistEnv`.

    Attributes:
        actions: the names of each agent's actions, by agent. trial: the present trial.

    Raises:
        HthorError: when one of the names does not exist.
    """

    metadata: dict[str, Any] = {"name": "hthor_assist_v0", "render_modes": []}  # noqa: RUF012 - as PettingZoo declares it

    def __init__(
        self,
        suite: Suite | str | Path = "collect",
        *,
        houses: Collection[str] = (),
        kinds: Collection[str] = (),
        robots: Sequence[str] = ("tender", "puck"),
        humans: str = "proxy",
        observation: str = "state",
        detector: str = OWN,
        privileges: Sequence[str] = ("ideal_detector",),
        time_cost: float = 0.0,
        approach: float = 0.0,
    ) -> None:
        self._source = TrialSource(
            suite,
            houses=houses,
            kinds=kinds,
            robots=robots,
            humans=humans,
            detector=detector,
            camera=spaces.camera_name(observation),
            privileges=privileges,
        )
        bodies, jobs = self._source.bodies, self._source.jobs
        self._sight, self._weights = observation, RewardWeights(time_cost=time_cost, approach=approach)
        self.render_mode: str | None = None
        self.possible_agents: list[str] = list(bodies)
        self.agents: list[str] = []
        self.actions = {seat: action_names(body, jobs) for seat, body in bodies.items()}
        self.observation_spaces = {seat: spaces.observation_space(jobs, observation) for seat in bodies}
        self.action_spaces = {seat: spaces.action_space(body, jobs) for seat, body in bodies.items()}
        self.trial: TrialSpec | None = None
        self._played: DecisionTrial | None = None
        self._seeds, self._random = StudySeeds(), seeding.np_random()[0]

    def observation_space(self, agent: str) -> gymnasium.Space[Any]:
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> gymnasium.Space[Any]:
        return self.action_spaces[agent]

    def reset(self, seed: int | None = None, options: Mapping[str, Any] | None = None) -> tuple[ByAgent, ByAgent]:
        """Begin a trial with a new person; ``options={"task": ID}`` chooses the task. Seeds as in `AssistEnv`."""
        if seed is not None:
            self._random = seeding.np_random(seed)[0]
        self.trial = self._seeds.trial(self._source, self._random, seed, options)
        measures = bool(self._weights.approach)
        self._played = DecisionTrial(self._source.control(self.trial), self._source.jobs, measures_ways=measures)
        self._played.begin()
        self.agents = list(self.possible_agents)
        return self._observations(), {seat: self._info(seat) for seat in self.agents}

    def step(self, actions: Mapping[str, Any]) -> tuple[ByAgent, ByAgent, ByAgent, ByAgent, ByAgent]:
        """Let the robots that are free act, and time pass until one is free again."""
        if not self.agents:
            raise ResetNeeded("the episode is over, or has not begun: call reset()")
        if not isinstance(actions, Mapping):
            raise HthorError(f"actions must be a dict with the number of each agent's action, got {actions!r:.60}")
        played, seats = self._running(), self.agents
        decided = played.decide(actions)
        success, task = played.episode.met, played.episode.task
        truncated = played.control.done and not success
        terms = {seat: self._weights.terms(decided.goal, decided, seat, task) for seat in seats}
        infos = {
            seat: self._info(seat) | {"refused": decided.refused[seat], "reward_terms": terms[seat]} for seat in seats
        }
        rewards = {seat: math.fsum(terms[seat].values()) for seat in seats}
        if success or truncated:
            self.agents = []
        return self._observations(), rewards, dict.fromkeys(seats, success), dict.fromkeys(seats, truncated), infos

    def close(self) -> None:
        """Drop the worlds; a later reset makes new ones."""
        self._source.close()
        self._played, self.agents = None, []

    def log(self) -> EpisodeLog:
        """The trial's log up to now; once it is over, that of `hthor.episode.play` with the same actions."""
        return self._running().control.log()

    def _observations(self) -> ByAgent:
        return {seat: spaces.observe(view, self._sight) for seat, view in self._running().views.items()}

    def _info(self, seat: str) -> dict[str, Any]:
        played = self._running()
        return information(played, self.trial, seat, played.episode.met) | {"free": seat in played.free}

    def _running(self) -> DecisionTrial:
        if self._played is None:
            raise ResetNeeded("call reset() first")
        return self._played
