"""A trial that goes on by one decision at a time: until the body of a robot that learns is free again.

It is the trial of the batch: robots are asked when `hthor.episode.play` would ask them, and people act as there.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any

from msgspec import Struct

from hthor import rules
from hthor.agents.skills.learner import LearnerView
from hthor.agents.skills.learner.known_things import target_id
from hthor.agents.skills.learner.walking_distance import WalkingDistance
from hthor.envs.episode_control import EpisodeControl
from hthor.types import TaskSpec
from hthor.types.events import Event, Refused
from hthor.world import numbers


class RewardWeights(Struct, frozen=True, kw_only=True):
    """The weights of a reward: the goal's own is always 1.

    Attributes:
        time_cost: what the whole time limit costs; a second costs its share of it.
        approach: [1/m] what it is worth to come nearer to the nearest object of the task, by the shortest way, also to
            one that is where it belongs. It adds up to the whole way that was gained, so that going to and fro is worth
            nothing.
    """

    time_cost: float = 0.0
    approach: float = 0.0

    def __post_init__(self) -> None:
        """Raise HthorError for a weight that is no finite number from 0."""
        numbers.number("time_cost", self.time_cost, "units of reward", low=0.0)
        numbers.number("approach", self.approach, "units of reward per metre", low=0.0)

    def terms(self, goal: float, decided: "Decided", seat: str, task: TaskSpec) -> dict[str, float]:
        """The terms of a robot's reward, which is their sum.

        Args:
            goal: what the decision was worth for the goal.
        """
        return {
            "goal": goal,
            "time": -self.time_cost * decided.seconds / task.longest,
            "approach": self.approach * decided.nearer[seat],
        }


class Decided(Struct, frozen=True, kw_only=True):
    """What a decision came to.

    Attributes:
        goal: the increase of the share of the goal that is met. seconds: how long it took.
        refused: by seat, why a rule or the numbering of actions refused the action; empty if none did.
        nearer: [m] by seat, by how much the way to the nearest object became shorter; 0 unless it was asked for.
    """

    goal: float
    seconds: float
    refused: Mapping[str, str]
    nearer: Mapping[str, float]


class DecisionTrial:
    """One trial in which numbers decide for the robots.

    Args:
        control: the trial with its people. jobs: for how many jobs the robots' views have room.
        talks: whether robots can send messages. measures_ways: whether `Decided.nearer` is computed.

    Attributes:
        views: what each robot knows, by seat.
    """

    def __init__(self, control: EpisodeControl, jobs: int, *, talks: bool = True, measures_ways: bool = False) -> None:
        self.control, self.episode = control, control.episode
        self._jobs, self._talks, self._measures_ways = jobs, talks, measures_ways
        self.views: dict[str, LearnerView] = {}

    @property
    def free(self) -> tuple[str, ...]:
        """The robots whose bodies are free, so that their next action counts; none at the end."""
        return () if self.control.done else tuple(seat for seat in self.views if self.episode.world.idle(seat))

    def begin(self) -> None:
        """Begin the trial and show the robots where they are."""
        self.control.reset()
        seats = [seat for seat in self.episode.seats if seat not in self.episode.people]
        self.views = {seat: LearnerView(self.episode.briefing(seat), self._jobs, self._talks) for seat in seats}
        bodies = self.episode.world.bodies
        house = self.episode.world.house
        self._walks = {seat: WalkingDistance(house, bodies[seat]) for seat in seats} if self._measures_ways else {}
        self._look(seats)
        self._ways = {seat: self._way(seat) for seat in seats}

    def decide(self, numbers: Mapping[str, Any]) -> Decided:
        """Let the robots that are free act, and go on until a robot is free again or the trial is over."""
        episode, began, goal = self.episode, self.episode.tick, 0.0
        refused = dict.fromkeys(self.views, "")
        for seat in self.free:
            choice = self.views[seat].choose(numbers.get(seat, 0))
            refused[seat] = choice.refused
            episode.submit(seat, choice.action)
        while True:
            known = len(episode.events)
            self.control.advance()
            goal += self.control.reward
            refused |= _refusals(episode.events[known:], self.views)
            if self.control.done or self.free:
                break
            self._look([seat for seat in self.control.asked if seat in self.views])  # as mail has changed
        self._look(list(self.views))
        ways = {seat: self._way(seat) for seat in self.views}
        nearer = {seat: _gain(self._ways[seat], ways[seat]) for seat in self.views}
        self._ways = ways
        return Decided(goal=goal, seconds=(episode.tick - began) * rules.TICK_S, refused=refused, nearer=nearer)

    def metres(self, seat: str) -> float:
        """[m] The true way from a robot to the nearest object of the task; infinite if it is not measured."""
        return self._ways[seat]

    def _look(self, seats: Sequence[str]) -> None:
        for seat in seats:
            self.views[seat].see(self.episode.observe(seat))

    def _way(self, seat: str) -> float:
        walk, world = self._walks.get(seat), self.episode.world
        if walk is None:
            return math.inf
        pose, snapshot = world.pose(seat), world.snapshot()
        ids = [target_id(job) for job in self.episode.task.goal.todo]
        goals = [snapshot.things[id].position[:2] for id in ids if id in snapshot.things]
        return min((walk.metres((pose.x, pose.y), goal) for goal in goals), default=math.inf)


def _refusals(events: Sequence[Event], seats: Mapping[str, object]) -> dict[str, str]:
    return {event.seat: event.reason for event in events if isinstance(event, Refused) and event.seat in seats}


def _gain(before: float, after: float) -> float:
    return before - after if math.isfinite(before) and math.isfinite(after) else 0.0
