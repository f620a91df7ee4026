"""A robot's trial as a learner has it: observations as arrays, actions as numbers.

The environments of `hthor.envs.learning` are made of it, and so is an agent that plays what was learned in them:

    class Agent:
        def begin(self, briefing):
            self.view = LearnerView(briefing)

        def act(self, observation):
            self.view.see(observation)
            return self.view.action(my_network(self.view.state(), self.view.mask())) if observation.idle else Action()
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from hthor.agents.skills.learner.actions import Choice, RobotActions, action_names
from hthor.agents.skills.learner.known_things import KnownThings
from hthor.agents.skills.learner.state import RobotState
from hthor.types import Action, Briefing, Observation

DEPTH_M = 10.0
"""[m] The depth that is 255 in the fourth channel of `LearnerView.rgbd`; what is farther is 255 too."""


class LearnerView:
    """What one robot knows in one trial, and what its numbers stand for.

    Args:
        briefing: the robot's. jobs: for how many jobs there is room; by default for those of the task. talks: whether
            it can send messages.

    Attributes:
        names: the names of its actions in the order of their numbers, see `learner.actions.action_names`.
    """

    def __init__(self, briefing: Briefing, jobs: int | None = None, talks: bool = True) -> None:
        count = len(briefing.todo) if jobs is None else jobs
        self.names = action_names(briefing.body, count, talks)
        self.things = KnownThings(briefing)
        self._state = RobotState(briefing, count, self.things)
        self._actions = RobotActions(self.names, briefing.body, briefing.todo[:count], self.things)
        self._seen: Observation | None = None

    @property
    def seen(self) -> Observation:
        """The last observation."""
        assert self._seen is not None, "see() was called before"
        return self._seen

    def see(self, observation: Observation) -> None:
        """Take an observation; call it whenever the robot is asked, also while its body is busy."""
        self._seen = observation
        self.things.see(observation)
        self._state.see(observation)

    def state(self) -> NDArray[np.float32]:
        """(size,) float32 from -1 to 1, see `learner.state.state_fields`; call it in the tick of the observation."""
        return self._state.vector(self.seen)

    def rgbd(self) -> NDArray[np.uint8]:
        """(H, W, 4) uint8 of the robot's camera: colour, and depth in steps of `DEPTH_M` / 255, in the same tick."""
        depth = np.clip(self.seen.depth / DEPTH_M, 0.0, 1.0)
        return np.dstack((self.seen.rgb, np.rint(255.0 * depth).astype(np.uint8)))

    def mask(self) -> NDArray[np.int8]:
        """(number of actions,) int8: 1 for the actions that are legal now."""
        return self._actions.mask(self.seen)

    def choose(self, number: Any) -> Choice:
        """What a number stands for now, or why it stands for nothing."""
        return self._actions.choose(number, self.seen)

    def action(self, number: Any) -> Action:
        """The action of a number now; waiting for a tick if it stands for nothing."""
        return self.choose(number).action
