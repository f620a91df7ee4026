"""The frontier robot, which also says what it thinks that the person has in mind.

    hthor eval --agent examples/mind_reader.py --suite smoke

Nobody hears its predictions: they are logged, and `belief_match` and `activity_match` compare them with what the
simulated person had in mind. Its theory of mind is simple. Until it has reached the person with a message, the person
searches, and expects the target where common knowledge expects it, at all furniture of such a kind that the robot has
seen. Once the person has confirmed, they expect the target where the robot has said that it is, and follow the message.
"""

from collections import Counter

import msgspec

from hthor.agents.frontier import Agent as Frontier
from hthor.catalog import TARGETS, priors
from hthor.types import Action, Briefing, Observation, Predict

EVERY_TICKS = 20
SURE = 0.9
"""How sure it is that a person who confirmed a message believes it."""


class Agent(Frontier):
    """Predicts the person's belief about the target, and their activity, every two seconds."""

    def begin(self, briefing: Briefing) -> None:
        """Start without furniture."""
        super().begin(briefing)
        self.furniture: dict[str, str] = {}
        self.due = 0
        weights = priors.weights(briefing.target) if briefing.target in TARGETS else {}
        self.expected = {kind: share for (relation, kind), share in weights.items() if relation != "near"}

    def act(self, observation: Observation) -> Action:
        """Do as the frontier robot does, and say now and then what the person has in mind."""
        action = super().act(observation)
        self.furniture |= {seen.id: seen.kind for seen in observation.detections if seen.family == "furniture"}
        if observation.tick < self.due:
            return action
        self.due = observation.tick + EVERY_TICKS
        receipt = observation.receipt
        told = self.target is not None and receipt is not None and receipt.status == "accepted"
        predict = Predict(
            object=self.briefing.target,
            places={self.target.support: SURE} if told and self.target.support else self.common_knowledge(),
            next={"follow": 0.6, f"fetch {self.briefing.target}": 0.3, "search": 0.1} if told else {"search": 1.0},
        )
        return msgspec.structs.replace(action, signals=(*action.signals, predict))

    def common_knowledge(self) -> dict[str, float]:
        """Each kind's share of the scene priors, divided among the furniture of this kind that it has seen."""
        many = Counter(self.furniture.values())
        return {id: self.expected[kind] / many[kind] for id, kind in self.furniture.items() if kind in self.expected}
