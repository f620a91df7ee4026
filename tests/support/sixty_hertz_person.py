"""A person who acts 60 times a second: walks about with a swaying head, and answers messages between two ticks."""

import math

from hthor.types import SUBTICKS, Action, Drive, Reply


class Model:
    def __init__(self, participant, state=None):
        self.participant, self.trials = participant, state["trials"] if state else 0

    def begin(self, briefing):
        self.seen = None
        self.answered = set()

    def frame(self, controls):
        frame = controls.tick * SUBTICKS + controls.step
        yaw = 0.8 * frame / 60.0 + 0.2 * math.sin(frame / 7.0)
        drive = Drive(forward=0.5 + 0.3 * math.sin(frame / 40.0), yaw=yaw, pitch=0.2 * math.sin(frame / 11.0))
        controls.steer(drive)
        if controls.step == 0 and controls.tick % 5 == 0:
            self.seen = controls.observe()
        elif controls.step == 4 and self.seen is not None:
            for message in self.seen.inbox:
                if message.id not in self.answered and controls.tick > message.tick + 8:
                    self.answered.add(message.id)
                    reply = Reply(message=message.id, accept=len(self.answered) % 2 == 0)
                    controls.submit(Action(motion=drive, say=reply), self.seen)

    def act(self, observation):
        raise AssertionError("a person who acts in every frame is not asked")

    def rate(self, met, tick):
        self.trials += 1
        return 4

    def state(self):
        return {"trials": self.trials}
