"""A robot that drives about and says once what it sees of the task: the agent of the README.

hthor eval --agent examples/wanderer.py --humans proxy
"""

from hthor.types import Action, Briefing, Move, Observation, Rotate, Send


class Agent:
    def begin(self, briefing: Briefing) -> None:
        self.wanted = {briefing.target, briefing.destination}
        self.told: set[str] = set()

    def act(self, observation: Observation) -> Action:
        return Action(motion=self.explore(observation), say=self.news(observation))

    def explore(self, observation: Observation) -> Move | Rotate:
        if observation.outcome is not None and not observation.outcome.ok:  # something is in the way
            return Rotate(yaw=2.0)
        return Move(forward=0.5)

    def news(self, observation: Observation) -> Send | None:
        for seen in observation.detections:
            if seen.kind in self.wanted - self.told and not seen.held_by:  # say each thing once
                self.told.add(seen.kind)
                return Send(text=f"I see the {seen.kind}.", object=seen.id, position=seen.position)
        return None
