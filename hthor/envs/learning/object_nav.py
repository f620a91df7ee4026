"""``hthor/ObjectNav-v0``: a robot that learns looks for a kind of object by itself."""

import math
from collections.abc import Collection, Sequence
from pathlib import Path

from hthor.envs.decision_trial import Decided, DecisionTrial, RewardWeights
from hthor.envs.learning import spaces
from hthor.envs.learning.robot_env import ROBOT, RobotEnv
from hthor.envs.trial_source import TrialSource
from hthor.tasks.suite import Suite
from hthor.types.detector_specs import OWN

MISTAKEN_M = 1.0
"""[m] A detector with errors is mistaken when it reports an object farther from where it is than this; our choice."""
NAVIGATION = "object_goal_navigation"
"""The task kind whose tasks the robot does."""


class ObjectNavEnv(RobotEnv):
    """A robot looks for an object of the kind that a task of object goal navigation names, with nobody's help.

    See `RobotEnv` for steps and seeds. The person of the task stands where it begins and does nothing. The robot has
    succeeded when its detector rightly reports an object of that kind as a decision ends; no action has to say so.
    Tasks whose object is behind a closed door are left out for a robot that cannot open it.

    The reward is 1 for success, and the terms of `RewardWeights`. An episode is terminated by success, and truncated
    when its time is over. Arguments are as in `hthor.envs.learning.assist.AssistEnv`.

    Raises:
        HthorError: when one of the names does not exist.
    """

    def __init__(
        self,
        suite: Suite | str | Path = "navigation",
        *,
        houses: Collection[str] = (),
        robot: str = "scout",
        observation: str = "state",
        detector: str = OWN,
        privileges: Sequence[str] = ("ideal_detector",),
        time_cost: float = 0.0,
        approach: float = 0.0,
        render_mode: str | None = None,
    ) -> None:
        source = TrialSource(
            suite,
            houses=houses,
            kinds=(NAVIGATION,),
            robots=(robot,),
            humans=None,
            detector=detector,
            camera=spaces.camera_name(observation),
            privileges=privileges,
        )
        if "open" not in source.bodies[ROBOT].capabilities:
            source.leave_out_hidden()
        weights = RewardWeights(time_cost=time_cost, approach=approach)
        super().__init__(source, observation, weights, render_mode, talks=False)

    def _succeeded(self, played: DecisionTrial) -> bool:
        task, things = played.episode.task, played.views[ROBOT].things
        kind = next(placed.kind for placed in task.objects if placed.id == task.goal.target)
        found = [things.last[id] for id in things.view if things.last[id].kind == kind]
        true = played.episode.world.snapshot().things if found else {}
        return any(math.dist(one.position, true[one.id].position) < MISTAKEN_M for one in found if one.id in true)

    def _goal(self, decided: Decided, success: bool) -> float:  # noqa: ARG002
        return float(success)
