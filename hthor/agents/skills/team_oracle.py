"""The oracle where there are several jobs or robots: it shares them out, tells about the rest, and makes way."""

from hthor.agents.skills.message_timing import ASIDE_M
from hthor.agents.skills.single_task_oracle import SingleTaskOracle
from hthor.types import HUMAN, Briefing, Job, Motion, Observation, Send, Wait

_PATIENCE_S = 25.0
"""How long an object that is another robot's share is not spoken about."""


class TeamOracle(SingleTaskOracle):
    """One robot's policy for one trial; every robot works out the same shares from the same observations."""

    several = True

    def __init__(self, briefing: Briefing) -> None:
        super().__init__(briefing)
        self.is_aside = False
        self._shared_since: dict[str, int] = {}  # tick from which an object was another robot's share
        self._patience = round(_PATIENCE_S / briefing.tick_s)

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
        aside = self.yielding.refuge(observation)
        if aside is None:
            aside = super()._step_aside(observation)
        if aside is None:
            aside = self.yielding.motion(observation)
        if aside is None and self.mine is None:
            aside = self.yielding.give_way(observation, self.allocation.now)
        if aside is None and self.mine is not None:
            self.is_aside = False
        return aside

    def _motion_without_job(self, observation: Observation, topic: Job | None) -> Motion:
        """Go where the topic is; with nothing to tell either, go where it is in nobody's way."""
        if topic is not None:
            return super()._motion_without_job(observation, topic)
        here = (observation.pose.x, observation.pose.y)
        if not self.is_aside:
            self.is_aside = True
            self.follower.take(self.routes.retreat(here, here, ASIDE_M))
        return self.follower.next(observation.pose) or Wait(seconds=0.5)

    # ------------------------------------------------------------------------------------------ what to tell about

    def _choose_topic(self, observation: Observation) -> Job | None:
        held = [job for job in self.jobs if self._is_held_by_person(job)]
        if held:
            self.messenger.take(held[0])
            return held[0]
        current = next((job for job in self._open_jobs() if job.target == self.messenger.target), None)
        if current is not None and self.messenger.waits(observation, current):
            return current
        due = [job for job in self._for_person() if self.messenger.is_due(observation, job)]
        chosen = due[0] if due else current
        if chosen is not None:
            self.messenger.take(chosen)
        return chosen

    def _for_person(self) -> list[Job]:
        """The open jobs, those first that the person had best do, without those that another robot is about to do."""
        allocation, knowledge = self.allocation, self.knowledge
        jobs = [job for job in self._open_jobs() if job is not self.mine]
        if any(state.held_by == HUMAN for state in knowledge.states.values()):
            return []
        reserved = allocation.reserved(self._open_jobs(), knowledge)
        theirs = [job for job in jobs if job.target == reserved and not self.messenger.is_exhausted(job)]
        if theirs:
            return theirs
        owners = {job.target: seat for seat, job in allocation.share(jobs, knowledge).items()}
        jobs = [job for job in jobs if not self._is_anothers(job, owners.get(job.target, HUMAN))]
        return sorted(jobs, key=lambda job: owners.get(job.target) != HUMAN)

    def _is_anothers(self, job: Job, owner: str) -> bool:
        """Whether it is another robot's share, and has not been so for too long."""
        if owner in (HUMAN, self.briefing.seat):
            self._shared_since.pop(job.target, None)
            return False
        tick = self.allocation.tick
        return tick < self._shared_since.setdefault(job.target, tick) + self._patience

    def _is_only_robot(self) -> bool:
        """Whether no other robot may just have sent the person a message, which a new one would cover."""
        return all(seat in (HUMAN, self.briefing.seat) for seat in self.allocation.seats)

    def _is_held_by_person(self, job: Job) -> bool:
        state = self.knowledge.states.get(job.target)
        return state is not None and state.held_by == HUMAN and bool(job.destinations)
