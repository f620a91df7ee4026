"""``hthor/Assist-v0``: one robot that learns helps one living proxy."""

from collections.abc import Collection, Sequence
from pathlib import Path

from hthor.envs.decision_trial import RewardWeights
from hthor.envs.learning import spaces
from hthor.envs.learning.robot_env import RobotEnv
from hthor.envs.trial_source import TrialSource
from hthor.tasks.suite import Suite
from hthor.types.detector_specs import OWN


class AssistEnv(RobotEnv):
    """One robot helps one person with the tasks of a suite, in the trials that `hthor eval` plays.

    See `RobotEnv` for steps and seeds. Every episode has a new person, who remembers no earlier one.

    The reward is the increase of the share of the goal that is met, which adds up to 1 for a task that is done, and the
    terms of `RewardWeights`. An episode is terminated when the goal is met, and truncated when its time is over. An
    action that the rules refuse, or that is no action at all, costs a tick; ``info["refused"]`` says why.

    Args:
        suite: a suite, its name or its path. houses, kinds: only its tasks in these houses and of these kinds, if any.
        robot: the body: a name, or the path of a file. humans: the people, as a word of `--humans`.
        observation: "state" or "rgbd", see `hthor.envs.learning.spaces.observation_space`.
        detector: as `hthor eval --detector`. privileges: what the robot may know: "object_poses" and "house_map".
        time_cost, approach: weights of the reward, see `RewardWeights`.
        render_mode: "rgb_array" for ``render()``, which draws the house from above.

    Raises:
        HthorError: when one of the names does not exist.
    """

    def __init__(
        self,
        suite: Suite | str | Path = "smoke",
        *,
        houses: Collection[str] = (),
        kinds: Collection[str] = (),
        robot: str = "scout",
        humans: str = "proxy",
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
            kinds=kinds,
            robots=(robot,),
            humans=humans,
            detector=detector,
            camera=spaces.camera_name(observation),
            privileges=privileges,
        )
        super().__init__(source, observation, RewardWeights(time_cost=time_cost, approach=approach), render_mode)
