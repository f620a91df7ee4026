"""The oracle robot: knows where everything is. Alone with one task it does what the paper's oracle did."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hthor.agents.skills.conversation.conversation import Conversation
from hthor.agents.skills.knowledge import PAPER_KINDS
from hthor.types import Action, Briefing, Observation

if TYPE_CHECKING:
    from hthor.agents.skills.oracle_policies import SingleTaskOracle


class Agent:
    """Walks the shortest way to the target and speaks only when it is close enough to detect it.

    It cannot detect a target behind a closed door; then it speaks in front of that door. When the person has the target
    in hand, the robot goes to the destination and tells where that is. With an arm it does what it can of the task
    itself, and leaves objects to others who are nearer to them. Asked for a thing, it tells where that is if it has
    been close enough to detect it.
    """

    privileges = ("house_map", "ideal_detector", "object_poses")
    robots: tuple[str, ...] = ()
    asks = False
    """Whether it asks what became of its suggestions."""

    def begin(self, briefing: Briefing) -> None:
        """Prepare the shortest paths of this house."""
        from hthor.agents.skills.oracle_policies import SingleTaskOracle, TeamOracle

        several = briefing.kind not in PAPER_KINDS or len(briefing.todo) > 1
        self.policy: SingleTaskOracle = TeamOracle(briefing) if several else SingleTaskOracle(briefing)
        self.conversation = Conversation(briefing, self.policy.unfinished, self.asks)

    def act(self, observation: Observation) -> Action:
        """Do what it can itself, tell people about the rest when it is time, and answer their questions."""
        heard = self.conversation.hear(observation)
        return self.conversation.speak(heard, self.policy.act(heard))
