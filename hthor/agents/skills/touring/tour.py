"""A robot's tour of the house before a task: it looks at all furniture, and records where the task's objects are.

The robot has only its senses for this. With a map of the house it goes from piece to piece; without one it also
explores. It opens furniture if it can. It is ready when it has seen all objects, or all that it can get to.
"""

import msgspec

from hthor.agents.skills.explorer import Explorer, ObservedRoutes
from hthor.agents.skills.knowledge import ObservedKnowledge
from hthor.agents.skills.manipulation import Manipulator
from hthor.agents.skills.right_of_way.passing import Passing
from hthor.agents.skills.right_of_way.yielding import Yielding
from hthor.agents.skills.routes import HouseRoutes
from hthor.agents.skills.touring.inspection import Inspection
from hthor.agents.skills.touring.tour_record import TourRecord
from hthor.navigation.path_follower import Follower
from hthor.types import Action, Briefing, Job, Motion, Observation, Ready, Thing, Wait

_PATIENCE_S = 30.0
"""[s] Time for one piece of furniture, the way to it included. Our choice: twice the longest way within a house."""
_LATER_S = 60.0
"""[s] Time after which the robot tries again to open a piece that it has left. Our choice."""


class Tour:
    """One robot's policy in the phases before a task.

    Attributes:
        record: where objects were in the first phase. seen: what it knows about furniture.
        explorer: its map, if it was not given one.
    """

    def __init__(self, briefing: Briefing) -> None:
        self.briefing, self._phase, self._over = briefing, briefing.phases[0].name, False
        self.record = TourRecord(job.target for job in briefing.todo)
        self.seen = ObservedKnowledge()
        self.explorer = Explorer(briefing.body)
        self.explorer.edges_only = True
        house = briefing.house
        self._routes = ObservedRoutes(self.explorer) if house is None else HouseRoutes(house, briefing.body)
        if house is not None:
            self.seen.things.update({thing.id: thing for thing in house.things})
        self.yielding = Yielding(briefing, self._routes)
        self.passing = Passing(briefing, self._routes, self.yielding)
        self.manipulator = Manipulator(briefing.body, self._routes, self.yielding, briefing.tick_s)
        self.inspection = Inspection(briefing.body, self._routes, self.seen)
        self._follower: Follower = self.inspection.follower
        self._opening: Thing | None = None
        self._piece: Thing | None = None
        self._since = 0

    def act(self, observation: Observation) -> Action:
        """The next motion, and the signal `Ready` in the end; as `hthor.types.Mind.act`."""
        if observation.phase != self._phase:
            self._begin_again(observation.phase)
        if self.briefing.house is None:
            self.explorer.see(observation)
        self.seen.note(observation)
        self.inspection.see(observation)
        if self._phase == self.briefing.phases[0].name:
            self.record.note(observation)
        self._over = self._over or self.record.complete
        signals = (Ready(),) if self._over else ()
        if not observation.idle:
            return Action(signals=signals)
        motion = self._motion(observation)
        self.yielding.note(observation, motion)
        return Action(motion=motion, signals=(Ready(),) if self._over else ())

    def unfinished(self) -> list[str]:
        """The objects that it has not seen."""
        return [target for target in self.record.targets if target not in self.record.seen]

    def briefing_after(self) -> Briefing:
        """The briefing for the task itself: with what the robot has recorded in place of what it was not told.

        Jobs of objects that it has not seen are left out. But if that is the first job, which is known to be undone,
        the robot can still find the object for others.
        """
        jobs: list[Job] = []
        for number, job in enumerate(self.briefing.todo):
            known = job if job.relation != "back" else self.record.job(job.target, self.seen.things)
            if known is None and number == 0:
                known = Job(target=job.target, relation="find")
            if known is not None:
                jobs.append(known)
        return msgspec.structs.replace(self.briefing, jobs=tuple(jobs), phases=())

    def _begin_again(self, phase: str) -> None:
        self._phase, self._over = phase, False
        self.explorer.begin_again()
        self.explorer.edges_only = True
        self.seen.begin_again()
        self.inspection = Inspection(self.briefing.body, self._routes, self.seen)

    def _motion(self, observation: Observation) -> Motion:
        """Make way, else open, else look at furniture, else explore."""
        aside = self.passing.motion(observation, self._follower, is_free=self._over)
        if aside is None:
            aside = self.yielding.motion(observation)
        self._give_up_late(observation.tick)
        if aside is not None or self._over:
            return aside or Wait(seconds=0.5)
        motion, self._follower = self._open(observation), self.manipulator.follower
        if motion is not None:
            self.inspection.drop()
        else:
            motion, self._follower = self.inspection.motion(observation), self.inspection.follower
        if motion is not None:
            self.explorer.drop()
            return motion
        self._over = self.briefing.house is not None or self.explorer.rounds > 0
        self._follower = self.explorer.follower
        return Wait(seconds=0.5) if self._over else self.explorer.motion(observation)

    def _give_up_late(self, tick: int) -> None:
        """Leave a piece that takes too long, for example because somebody stands before it."""
        piece = self._opening or self.inspection.piece
        if piece is not self._piece:
            self._piece, self._since = piece, tick
        elif piece is not None and tick - self._since > _PATIENCE_S / self.briefing.tick_s:
            self.inspection.give_up(piece)
            self.manipulator.leave(piece.id, tick + round(_LATER_S / self.briefing.tick_s))
            self._opening = None

    def _open(self, observation: Observation) -> Motion | None:
        """Open the furniture that hides its inside and is nearer than any that is left to look at, if the robot can."""
        if "open" not in self.briefing.body.capabilities:
            return None
        shut = [thing for thing in self.seen.shut() if self.manipulator.can_try(thing.id, observation.tick)]
        if self._opening not in shut:
            nearest = self.inspection.nearest(observation, [*shut, *self.inspection.left()])
            self._opening = nearest if nearest in shut else None
        return None if self._opening is None else self.manipulator.open(observation, self._opening)
