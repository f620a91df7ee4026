"""A robot that drives about and says once what it sees of the task: the agent of the README.

hthor eval --agent examples/wanderer.py --humans proxy
"""

from hthor.types import Action, Briefing, Move, Observation, Rotate, Send


class Agent:
    def begin(self, briefing: Briefing) -> None:
        self.wanted = {briefing.target, briefing.destination}

    def act(self, now: Observation) -> Action:
        new = next((one for one in now.detections if one.kind in self.wanted and not one.held_by), None)
        say = Send(text=f"I see the {new.kind}.", object=new.id, position=new.position) if new else None
        self.wanted -= {new.kind} if new else set()  # each thing is said once
        free = now.outcome is None or now.outcome.ok  # else something is in the way
        return Action(motion=Move(forward=0.5) if free else Rotate(yaw=2.0), say=say)
