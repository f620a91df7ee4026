"""The oracle robot: knows where everything is. Alone with one task it does what the paper's oracle did."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hthor.agents.skills.conversation.conversation import Conversation
from hthor.agents.skills.knowledge import PAPER_KINDS
from hthor.types import Action, Briefing, Observation

if TYPE_CHECKING:
    from hthor.agents.skills.oracle_policies import SingleTaskOracle
    from hthor.agents.skills.touring.tour import Tour
    from hthor.agents.skills.walking.oracle_walk import OracleWalk


class Agent:
    """Walks the shortest way to the target and speaks only when it is close enough to detect it.

    It cannot detect a target behind a closed door; then it speaks in front of that door. When the person has the target
    in hand, the robot goes to the destination and tells where that is. With an arm it does what it can of the task
    itself, and leaves objects to others who are nearer to them. Asked for a thing, it tells where that is if it has
    been close enough to detect it.

    If the task begins with a tour, the robot explores the house, and its own record of what it saw is all that it later
    knows about where things belong.
    """

    privileges = ("house_map", "ideal_detector", "object_poses")
    robots: tuple[str, ...] = ()
    asks = False
    """Whether it asks what became of its suggestions."""

    def begin(self, briefing: Briefing) -> None:
        """Prepare the shortest paths of this house, or a tour of it."""
        self.tour: Tour | None = _tour(briefing) if briefing.phases else None
        if self.tour is None:
            self._begin_task(briefing)
        else:
            self.conversation = Conversation(briefing, self.tour.unfinished, self.asks)

    def _begin_task(self, briefing: Briefing) -> None:
        from hthor.agents.skills.oracle_policies import SingleTaskOracle, TeamOracle

        if briefing.relation == "go":
            from hthor.agents.skills.walking.oracle_walk import OracleWalk

            self.policy: SingleTaskOracle | OracleWalk = OracleWalk(briefing)
            self.conversation = Conversation(briefing, self.policy.unfinished, self.asks)
            return
        several = briefing.kind not in PAPER_KINDS or len(briefing.todo) > 1
        self.policy = TeamOracle(briefing) if several else SingleTaskOracle(briefing)
        self.conversation = Conversation(briefing, self.policy.unfinished, self.asks)

    def act(self, observation: Observation) -> Action:
        """Do what it can itself, tell people about the rest when it is time, and answer their questions."""
        if self.tour is not None and not observation.phase:
            self._begin_task(self.tour.briefing_after())
            self.tour = None
        heard = self.conversation.hear(observation)
        action = self.policy.act(heard) if self.tour is None else self.tour.act(heard)
        return self.conversation.speak(heard, action)


def _tour(briefing: Briefing) -> Tour:
    from hthor.agents.skills.touring.tour import Tour

    return Tour(briefing)
