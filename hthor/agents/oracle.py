"""The oracle robot: knows where everything is. Alone with one task it does what the paper's oracle did."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hthor.agents.skills.knowledge import PAPER_KINDS
from hthor.types import Action, Briefing, Observation

if TYPE_CHECKING:
    from hthor.agents.skills.oracle_policies import SingleTaskOracle


class Agent:
    """Walks the shortest way to the target and speaks only when it is close enough to detect it.

    It cannot detect a target behind a closed door; then it speaks in front of that door. When the person has the target
    in hand, the robot goes to the destination and tells where that is. With an arm it does what it can of the task
    itself, and leaves objects to others who are nearer to them.
    """

    privileges = ("house_map", "ideal_detector", "object_poses")
    robots: tuple[str, ...] = ()

    def begin(self, briefing: Briefing) -> None:
        """Prepare the shortest paths of this house."""
        from hthor.agents.skills.oracle_policies import SingleTaskOracle, TeamOracle

        several = briefing.kind not in PAPER_KINDS or len(briefing.todo) > 1
        self.policy: SingleTaskOracle = TeamOracle(briefing) if several else SingleTaskOracle(briefing)

    def act(self, observation: Observation) -> Action:
        """Do what it can itself, and tell the person about the rest when it is time."""
        return self.policy.act(observation)
