"""What a robot does that knows where everything is, while there is one thing to find or to bring.

With an arm it does the job itself; else it goes where the target is and tells the person.
"""

from collections.abc import Sequence

from hthor.agents.skills.carrying import Carrier
from hthor.agents.skills.knowledge import Knowledge
from hthor.agents.skills.manipulation import Manipulator
from hthor.agents.skills.messenger import Messenger
from hthor.agents.skills.routes import HouseRoutes
from hthor.agents.skills.task_allocation import TaskAllocation, can_do
from hthor.agents.skills.yielding import Yielding
from hthor.navigation.path_follower import Courtesy, Follower
from hthor.types import HUMAN, Action, Briefing, Job, Motion, Observation, Send, Wait

_LATER_S = 15.0
"""How long an object is left alone that was put down and still is not where it belongs."""


class SingleTaskOracle:
    """One robot's policy for one trial.

    Attributes:
        mine: the job that this robot does itself now. done: the one it has just finished.
    """

    several = False
    """Whether there may be several jobs or robots."""

    def __init__(self, briefing: Briefing) -> None:
        assert briefing.house is not None, "the oracle needs the privilege house_map"
        self.briefing, self.jobs = briefing, briefing.todo
        self.routes = HouseRoutes(briefing.house, briefing.body)
        self.courtesy = Courtesy(briefing.body, self.routes.fits)
        self.yielding = Yielding(briefing, self.routes)
        self.knowledge = Knowledge(briefing.house.things, briefing.house.rooms)
        self.allocation = TaskAllocation(briefing, self.routes.apart)
        self.manipulator = Manipulator(briefing.body, self.routes, self.yielding, briefing.tick_s)
        self.follower = Follower(step=0.5)
        others = self.yielding if self.several else None
        self.messenger = Messenger(briefing, self.routes, self.follower, self.knowledge, others)
        self.carrier = Carrier(briefing, self.routes, self.manipulator, self.allocation)
        self.mine: Job | None = None
        self.done: Job | None = None

    def act(self, observation: Observation) -> Action:
        """The next motion and message; as `hthor.types.Mind.act`."""
        self.knowledge.states = {thing.id: thing for thing in observation.truth}
        self._update(observation)
        if observation.idle:
            self.mine = self._choose_own(observation)
        topic = self._choose_topic(observation) if self.mine is None else None
        if self._has_nothing_to_do(topic):
            return Action(motion=Wait(seconds=1.0))
        say = self._say(observation, topic)
        if not observation.idle:
            return Action(say=say)
        motion = self._motion(observation, topic)
        self.yielding.note(observation, motion)
        return Action(motion=motion, say=say)

    # ---------------------------------------------------------------------------- what differs with several jobs

    def _update(self, observation: Observation) -> None:
        """Take in what is new, besides where everything is."""

    def _choose_topic(self, observation: Observation) -> Job | None:  # noqa: ARG002
        """The job to tell the person about now."""
        job = self.jobs[0]
        return job if job.target in self.knowledge.states else None

    def _has_nothing_to_do(self, topic: Job | None) -> bool:
        return self.mine is None and topic is None

    def _say(self, observation: Observation, topic: Job | None) -> Send | None:
        if topic is not None:
            return self.messenger.say(observation, topic)
        if self.mine is None or self.mine.hands < 2:
            return None
        if not self.carrier.is_close(observation, self.knowledge, self.mine):
            return None
        lifted = bool(self.knowledge.states[self.mine.target].held_by)
        return None if lifted else self.messenger.ask_for_help(observation, self.mine)

    def _step_aside(self, observation: Observation) -> Motion | None:
        """A motion out of somebody's way, None to carry on."""
        return self.courtesy.motion(observation, observation.tick * self.briefing.tick_s)

    def _motion_without_job(self, observation: Observation, topic: Job | None) -> Motion:
        assert topic is not None
        return self.messenger.motion(observation, topic)

    # ------------------------------------------------------------------------------------------------ its own job

    def _motion(self, observation: Observation, topic: Job | None) -> Motion:
        mine = self.mine
        if mine is not None and mine.hands > 1 and self.carrier.is_close(observation, self.knowledge, mine):
            return self.carrier.motion(observation, self.knowledge, mine)
        aside = self._step_aside(observation)
        if aside is not None:
            return aside
        if mine is None:
            return self._motion_without_job(observation, topic)
        if mine.hands > 1:
            return self.carrier.motion(observation, self.knowledge, mine)
        return self.manipulator.motion(observation, self.knowledge, mine) or Wait(seconds=0.3)

    def _open_jobs(self) -> list[Job]:
        """The jobs that are not done and whose objects nobody has in hand."""
        states = self.knowledge.states
        return [
            job
            for job in self.jobs
            if job.target in states and not states[job.target].held_by and not self.knowledge.is_done(job)
        ]

    def _choose_own(self, observation: Observation) -> Job | None:
        """The job that this robot does itself now."""
        if "pick" not in self.briefing.body.capabilities:
            return None
        holding = next((job for job in self.jobs if job.target == observation.holding), None)
        if holding is not None:
            return holding
        self._check_last_placement(observation)
        mine = [job for job in self._open_jobs() if self._can_do(observation, job)]
        if self.mine in mine:
            return self.mine
        self.manipulator.drop()
        return self._choose_among(mine)

    def _choose_among(self, jobs: Sequence[Job]) -> Job | None:
        """This robot's share; or else the nearest job that is nobody's but a person's who is not there yet."""
        allocation, knowledge, me = self.allocation, self.knowledge, self.briefing.seat
        reserved = allocation.reserved(self._open_jobs(), knowledge)
        jobs = [job for job in jobs if job.target != reserved] or jobs
        share = allocation.share(jobs, knowledge)
        if me in share:
            return share[me]
        others = [job for seat, job in share.items() if seat not in (me, HUMAN)]
        left = [job for job in jobs if job not in others and not allocation.leaves_to_person(job, knowledge)]
        return min(left, key=lambda job: allocation.cost(me, job, knowledge), default=None)

    def _can_do(self, observation: Observation, job: Job) -> bool:
        state = self.knowledge.states[job.target]
        shut = self.knowledge.is_shut(state.support)
        if job.hands > 1 and len(state.bearers) >= job.hands:
            return False
        if job.relation == "find" or not can_do(self.briefing.body, state.kind, job, shut):
            return False
        return self.manipulator.can_try(job.target, observation.tick)

    def _check_last_placement(self, observation: Observation) -> None:
        """Leave alone for a while what was put down and still is not where it belongs."""
        job, outcome = self.mine, observation.outcome
        if job is None or outcome is None or outcome.motion != "place" or not outcome.ok:
            return
        if self.knowledge.is_done(job):
            self.done = job
        else:
            self.manipulator.leave(job.target, observation.tick + round(_LATER_S / self.briefing.tick_s))
