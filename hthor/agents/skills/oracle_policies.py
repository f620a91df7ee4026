"""Policies of a robot that knows where everything is: alone with one thing to find or to bring, or in a team.

With an arm the robot does the job itself; without, it goes where the target is and tells the person.
"""

from collections.abc import Sequence

from hthor.agents.skills.audience import Audience
from hthor.agents.skills.joint_carrying.carrier import Carrier
from hthor.agents.skills.knowledge import Knowledge
from hthor.agents.skills.manipulation import Manipulator
from hthor.agents.skills.message_timing import ASIDE_M
from hthor.agents.skills.messenger import Messenger
from hthor.agents.skills.right_of_way.passing import Passing
from hthor.agents.skills.right_of_way.yielding import Yielding
from hthor.agents.skills.routes import HouseRoutes
from hthor.agents.skills.task_allocation import TaskAllocation, can_do
from hthor.navigation.path_follower import Courtesy, Follower
from hthor.types import HUMAN, Action, Briefing, Job, Motion, Observation, Rotate, Send, Wait, is_person

_LATER_S = 15.0
"""How long [s] an object is left alone that was put down but is not where it belongs."""
_LOOK_SHARE, _LOOKS = 0.8, 3
"""A robot that waits turns by this share of its field of view, or a multiple of it, up to the second number."""
_PATIENCE_S = 25.0
"""How long [s] the robot does not speak about an object that is another robot's share."""


class SingleTaskOracle:
    """One robot's policy for one trial; `TeamOracle` overrides the parts that differ with several jobs or robots.

    Attributes:
        mine: the job that this robot does itself now. done: the job that it has just finished.
    """

    several = False
    """Whether there may be several jobs or robots."""

    def __init__(self, briefing: Briefing) -> None:
        assert briefing.house is not None, "the oracle needs the privilege house_map"
        self.briefing, self.jobs = briefing, briefing.todo
        others = tuple(briefing.crew.values()) if self.several else ()
        self.routes = HouseRoutes(briefing.house, briefing.body, others)
        self.courtesy = Courtesy(briefing.body, self.routes.fits)
        self.yielding = Yielding(briefing, self.routes)
        self.knowledge = Knowledge(briefing.house.things, briefing.house.rooms)
        self.allocation = TaskAllocation(briefing, self.routes.apart)
        self.manipulator = Manipulator(briefing.body, self.routes, self.yielding, briefing.tick_s)
        self.follower = Follower(step=0.5)
        yielding = self.yielding if self.several else None
        audience = Audience(self.allocation, briefing.tick_s)
        self.messenger = Messenger(briefing, self.routes, self.follower, self.knowledge, yielding, audience)
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

    def unfinished(self) -> list[str]:
        """The objects of jobs that are not done."""
        return [job.target for job in self.jobs if not self.knowledge.is_done(job)]

    def _update(self, observation: Observation) -> None:
        """Learn from an observation what the robot does not know already."""

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
        asks = self.carrier.needs_helper(observation, self.knowledge, self.mine)
        return self.messenger.ask_for_help(observation, self.mine) if asks else None

    def _step_aside(self, observation: Observation) -> Motion | None:
        """A motion out of somebody's way, None to carry on."""
        return self.courtesy.motion(observation, observation.tick * self.briefing.tick_s)

    def _motion_without_job(self, observation: Observation, topic: Job | None) -> Motion:
        assert topic is not None
        return self.messenger.motion(observation, topic)

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
        """This robot's share; or else the nearest job that no other robot has and that no person is close to."""
        allocation, knowledge, me = self.allocation, self.knowledge, self.briefing.seat
        reserved = allocation.reserved(self._open_jobs(), knowledge)
        jobs = [job for job in jobs if job.target != reserved] or jobs
        share = allocation.share(jobs, knowledge)
        if me in share:
            return share[me]
        others = [job for seat, job in share.items() if seat != me and not is_person(seat)]
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
        """Leave an object alone for a while that was put down but is not where it belongs."""
        job, outcome = self.mine, observation.outcome
        if job is None or outcome is None or outcome.motion != "place" or not outcome.ok:
            return
        if self.knowledge.is_done(job):
            self.done = job
        else:
            self.manipulator.leave(job.target, observation.tick + round(_LATER_S / self.briefing.tick_s))


class TeamOracle(SingleTaskOracle):
    """The policy where there are several jobs or robots: share them out, tell about the rest, and make way.

    Every robot works out the same shares from the same observations.
    """

    several = True

    def __init__(self, briefing: Briefing) -> None:
        super().__init__(briefing)
        self.is_aside = False
        self._turns = 0
        self._shared_since: dict[str, int] = {}  # tick from which an object was another robot's share
        self._patience = round(_PATIENCE_S / briefing.tick_s)
        self.passing = Passing(briefing, self.routes, self.yielding)

    def _update(self, observation: Observation) -> None:
        self.allocation.see(observation, self.knowledge)
        self.messenger.hear(observation)

    def _has_nothing_to_do(self, topic: Job | None) -> bool:  # noqa: ARG002
        return False

    def _say(self, observation: Observation, topic: Job | None) -> Send | None:
        done, self.done = self.done, None
        if done is not None and self._open_jobs() and self._is_only_robot():
            return self.messenger.report(observation, done)
        if topic is not None or (self.mine is not None and self.mine.hands > 1):
            return super()._say(observation, topic)
        seen = self.messenger.in_view(observation, [job for job in self._open_jobs() if job is not self.mine])
        best = next((job for job in self._for_person() if job in seen), None) if seen else None
        return None if best is None else self.messenger.mention(observation, best)

    def _step_aside(self, observation: Observation) -> Motion | None:
        aside = self.passing.motion(observation, self._current_follower(), is_free=self.mine is None)
        if aside is None:
            aside = self.yielding.motion(observation)
        if aside is None and self.mine is None:
            aside = self.yielding.give_way(observation, self.allocation.now)
        if aside is None and self.mine is not None:
            self.is_aside = False
        return aside

    def _current_follower(self) -> Follower:
        """The follower of the path that the robot is on."""
        if self.mine is None:
            return self.follower
        waits = self.mine.hands > 1 and not self.carrier.follower.done
        return self.carrier.follower if waits else self.manipulator.follower

    def _motion_without_job(self, observation: Observation, topic: Job | None) -> Motion:
        """Go where the topic is; without a topic, go where the robot blocks nobody. While it waits, it looks round."""
        if topic is not None:
            motion = super()._motion_without_job(observation, topic)
        else:
            here = (observation.pose.x, observation.pose.y)
            if not self.is_aside:
                self.is_aside = True
                self.follower.take(self.routes.retreat(here, here, ASIDE_M))
            motion = self.follower.next(observation.pose) or Wait(seconds=0.5)
        return self._look_round() if isinstance(motion, Wait) else motion

    def _look_round(self) -> Motion:
        """A turn by most of the field of view, so that the robot sees who wants to pass."""
        self._turns = self._turns % _LOOKS + 1
        return Rotate(yaw=self._turns * _LOOK_SHARE * self.briefing.body.fov[0])

    def _choose_topic(self, observation: Observation) -> Job | None:
        held = self._held_job(observation)
        if held is not None:
            self.messenger.take(held)
            return held
        current = next((job for job in self._open_jobs() if job.target == self.messenger.target), None)
        if current is not None and self.messenger.waits(observation, current):
            return current
        due = [job for job in self._for_person() if self.messenger.is_due(observation, job)]
        chosen = due[0] if due else current
        if chosen is not None:
            self.messenger.take(chosen)
        return chosen

    def _held_job(self, observation: Observation) -> Job | None:
        """The job whose object somebody brings somewhere: one to be told where, or any while nobody has free hands."""
        held = [job for job in self.jobs if self._is_held_by_person(job)]
        if not held:
            return None
        due = next((job for job in held if self.messenger.is_due(observation, job, "destination")), None)
        return held[0] if due is None and self.knowledge.all_hold(self.allocation.people) else due

    def _for_person(self) -> list[Job]:
        """The open jobs except those that another robot is about to do; first those that suit the person best."""
        allocation, knowledge = self.allocation, self.knowledge
        jobs = [job for job in self._open_jobs() if job is not self.mine]
        if knowledge.all_hold(allocation.people):
            return []
        reserved = allocation.reserved(self._open_jobs(), knowledge)
        theirs = [job for job in jobs if job.target == reserved and not self.messenger.is_exhausted(job)]
        if theirs and len(allocation.people) < 2:
            return theirs
        owners = {job.target: seat for seat, job in allocation.share(jobs, knowledge).items()}
        jobs = [job for job in jobs if not self._is_anothers(job, owners.get(job.target, HUMAN))]
        jobs.sort(key=lambda job: not is_person(owners.get(job.target, "")))
        return theirs + [job for job in jobs if job not in theirs]

    def _is_anothers(self, job: Job, owner: str) -> bool:
        """Whether the job is another robot's share, and has not been that for too long."""
        if is_person(owner) or owner == self.briefing.seat:
            self._shared_since.pop(job.target, None)
            return False
        tick = self.allocation.tick
        return tick < self._shared_since.setdefault(job.target, tick) + self._patience

    def _is_only_robot(self) -> bool:
        """Whether no other robot may just have sent a message, which a new one would cover."""
        return all(is_person(seat) or seat == self.briefing.seat for seat in self.allocation.seats)

    def _is_held_by_person(self, job: Job) -> bool:
        state = self.knowledge.states.get(job.target)
        return state is not None and is_person(state.held_by) and bool(job.destinations)
