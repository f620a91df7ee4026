"""The oracle robot of the paper: knows where everything is and walks there."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hthor.agents.skills.message_timing import ASIDE_M
from hthor.agents.skills.subgoals import PAPER_KINDS, todo
from hthor.agents.skills.task_allocation import able
from hthor.types import HUMAN, Action, Briefing, Job, Motion, Observation, Send, Wait

if TYPE_CHECKING:
    from hthor.agents.skills.routes import Routes
    from hthor.navigation.path_follower import Follower
    from hthor.navigation.yielding import Courtesy

_PATIENCE_S = 25.0
"""How long an object that is another robot's share is not spoken of."""
_LATER_S = 15.0
"""How long an object is left alone that was put down and still is not where it belongs."""


class Agent:
    """Walks the shortest way to the target and speaks only when it is close enough to detect it.

    Behind a closed door it cannot detect, and says so from in front of the door. When the person has the target in
    hand it goes on to the destination, and tells where that is. With an arm it does what it can of the task itself,
    and leaves to the others what they are nearer to.
    """

    privileges = ("house_map", "ideal_detector", "object_poses")
    robots: tuple[str, ...] = ()

    def begin(self, briefing: Briefing) -> None:
        """Prepare the shortest ways of this house."""
        from hthor.agents.skills.carrying import Hauler
        from hthor.agents.skills.manipulation import Worker
        from hthor.agents.skills.messenger import Teller
        from hthor.agents.skills.routes import Routes
        from hthor.agents.skills.subgoals import Knowledge
        from hthor.agents.skills.task_allocation import Crew
        from hthor.agents.skills.yielding import Passing
        from hthor.navigation.path_follower import Follower
        from hthor.navigation.yielding import Courtesy

        assert briefing.house is not None, "the oracle needs the privilege house_map"
        self.briefing, self.jobs = briefing, todo(briefing)
        self.routes: Routes = Routes(briefing.house, briefing.body)
        self.courtesy: Courtesy = Courtesy(briefing.body, self.routes.fits)
        self.passing = Passing(briefing, self.routes)
        self.knowledge = Knowledge(briefing.house.things, briefing.house.rooms)
        self.crew = Crew(briefing, self.routes.apart)
        self.worker = Worker(briefing.body, self.routes, self.passing, briefing.tick_s)
        self.follower: Follower = Follower(step=0.5)
        many = briefing.kind not in PAPER_KINDS or len(self.jobs) > 1
        self.teller = Teller(briefing, self.routes, self.follower, self.knowledge, self.passing if many else None)
        self.many = many
        self.hauler = Hauler(briefing, self.routes, self.worker, self.crew)
        self.mine: Job | None = None
        self.done: Job | None = None
        self.is_aside = False
        self._owned: dict[str, int] = {}
        self._patience = round(_PATIENCE_S / briefing.tick_s)

    def act(self, observation: Observation) -> Action:
        """Do what one can, tell when it is time."""
        self.knowledge.states = {thing.id: thing for thing in observation.truth}
        if self.many:
            self.crew.see(observation, self.knowledge)
            self.teller.hear(observation)
        if observation.idle:
            self.mine = self._own(observation)
        told = self._told(observation) if self.mine is None else None
        if not self.many and self.mine is None and told is None:
            return Action(motion=Wait(seconds=1.0))
        say = self._say(observation, told)
        if not observation.idle:
            return Action(say=say)
        motion = self._motion(observation, told)
        self.passing.note(observation, motion)
        return Action(motion=motion, say=say)

    def _say(self, observation: Observation, told: Job | None) -> Send | None:
        done, self.done = self.done, None
        if done is not None and self._open() and self._is_only_robot():
            return self.teller.report(observation, done)
        if told is not None:
            return self.teller.say(observation, told)
        if self.mine is not None and self.mine.hands > 1:
            if not self.hauler.is_close(observation, self.knowledge, self.mine):
                return None
            lifted = bool(self.knowledge.states[self.mine.target].held_by)
            return None if lifted else self.teller.ask_for_help(observation, self.mine)
        seen = self.teller.in_view(observation, [job for job in self._open() if job is not self.mine])
        best = next((job for job in self._for_person() if job in seen), None) if seen else None
        return None if best is None else self.teller.mention(observation, best)

    def _motion(self, observation: Observation, told: Job | None) -> Motion:
        mine = self.mine
        if mine is not None and mine.hands > 1 and self.hauler.is_close(observation, self.knowledge, mine):
            return self.hauler.motion(observation, self.knowledge, mine)
        yielding = self.passing.refuge(observation) if self.many else None
        if yielding is None:
            yielding = self.courtesy.motion(observation, observation.tick * self.briefing.tick_s)
        if yielding is None and self.many:
            yielding = self.passing.motion(observation)
        if yielding is not None:
            return yielding
        if mine is None and self.many:
            yielding = self.passing.give_way(observation, self.crew.now)
            if yielding is not None:
                return yielding
        if mine is None:
            return self._rest(observation) if told is None else self.teller.motion(observation, told)
        self.is_aside = False
        if mine.hands > 1:
            return self.hauler.motion(observation, self.knowledge, mine)
        return self.worker.motion(observation, self.knowledge, mine) or Wait(seconds=0.3)

    # ----------------------------------------------------------------------------------------------- which job is whose

    def _open(self) -> list[Job]:
        """The jobs that are not done and that nobody has in hand."""
        states = self.knowledge.states
        return [
            job
            for job in self.jobs
            if job.target in states and not states[job.target].held_by and not self.knowledge.is_done(job)
        ]

    def _own(self, observation: Observation) -> Job | None:
        """The job that this robot does itself now."""
        if "pick" not in self.briefing.body.capabilities:
            return None
        holding = next((job for job in self.jobs if job.target == observation.holding), None)
        if holding is not None:
            return holding
        self._look_back(observation)
        mine = [job for job in self._open() if self._can(observation, job)]
        if self.mine in mine:
            return self.mine
        self.worker.drop()
        return self._choice(mine)

    def _choice(self, jobs: list[Job]) -> Job | None:
        """The one that is this robot's share; or one that is nobody's but the person's, who is not there yet."""
        left_to = self.crew.reserved(self._open(), self.knowledge)
        jobs = [job for job in jobs if job.target != left_to] or jobs
        share = self.crew.share(jobs, self.knowledge)
        me = self.briefing.seat
        if me in share:
            return share[me]
        others = [job for seat, job in share.items() if seat not in (me, HUMAN)]
        left = [job for job in jobs if job not in others and not self.crew.leaves_to_person(job, self.knowledge)]
        return min(left, key=lambda job: self.crew.cost(me, job, self.knowledge), default=None)

    def _can(self, observation: Observation, job: Job) -> bool:
        state = self.knowledge.states[job.target]
        shut = self.knowledge.is_shut(state.support)
        if job.hands > 1 and len(state.bearers) >= job.hands:
            return False
        if job.relation == "find" or not able(self.briefing.body, state.kind, job, shut):
            return False
        return self.worker.can_try(job.target, observation.tick)

    def _look_back(self, observation: Observation) -> None:
        """What was put down and still is not where it belongs can wait."""
        job, outcome = self.mine, observation.outcome
        if job is None or outcome is None or outcome.motion != "place" or not outcome.ok:
            return
        if self.knowledge.is_done(job):
            self.done = job
        else:
            self.worker.leave(job.target, observation.tick + round(_LATER_S / self.briefing.tick_s))

    # ---------------------------------------------------------------------------------------------- what to tell of

    def _told(self, observation: Observation) -> Job | None:
        """The job to tell the person of now."""
        if not self.many:
            job = self.jobs[0]
            return job if job.target in self.knowledge.states else None
        held = [job for job in self.jobs if self._held_by_person(job)]
        if held:
            self.teller.take(held[0])
            return held[0]
        current = next((job for job in self._open() if job.target == self.teller.target), None)
        if current is not None and self.teller.waits(observation, current):
            return current
        due = [job for job in self._for_person() if self.teller.is_due(observation, job)]
        chosen = due[0] if due else current
        if chosen is not None:
            self.teller.take(chosen)
        return chosen

    def _for_person(self) -> list[Job]:
        """The open jobs, those first that the person had best do, without those that another robot is about to do."""
        jobs = [job for job in self._open() if job is not self.mine]
        if any(state.held_by == HUMAN for state in self.knowledge.states.values()):
            return []
        kept = self.crew.reserved(self._open(), self.knowledge)
        theirs = [job for job in jobs if job.target == kept and not self.teller.is_exhausted(job)]
        if theirs:
            return theirs
        owners = {job.target: seat for seat, job in self.crew.share(jobs, self.knowledge).items()}
        jobs = [job for job in jobs if not self._is_in_hand(job, owners.get(job.target, HUMAN))]
        return sorted(jobs, key=lambda job: owners.get(job.target) != HUMAN)

    def _is_in_hand(self, job: Job, owner: str) -> bool:
        """Whether it is the share of another robot, and it is not high time that somebody else heard of it."""
        if owner in (HUMAN, self.briefing.seat):
            self._owned.pop(job.target, None)
            return False
        return self.crew.tick < self._owned.setdefault(job.target, self.crew.tick) + self._patience

    def _is_only_robot(self) -> bool:
        """Whether no other robot may just have sent the person a message, which a new one would cover."""
        return all(seat in (HUMAN, self.briefing.seat) for seat in self.crew.seats)

    def _held_by_person(self, job: Job) -> bool:
        state = self.knowledge.states.get(job.target)
        return state is not None and state.held_by == HUMAN and bool(job.destinations)

    def _rest(self, observation: Observation) -> Motion:
        """There is nothing to do or to tell: go where one is in nobody's way."""
        here = (observation.pose.x, observation.pose.y)
        if not self.is_aside:
            self.is_aside = True
            self.follower.take(self.routes.retreat(here, here, ASIDE_M))
        return self.follower.next(observation.pose) or Wait(seconds=0.5)
