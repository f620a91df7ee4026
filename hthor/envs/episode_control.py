"""One trial that composer's environment drives: the caller acts for the robots, human models for the people."""

from collections.abc import Callable, Collection, Mapping
from typing import Any

import numpy as np
from dm_env import specs

from hthor.envs.action_arrays import action_spec, decode_action
from hthor.envs.seat_readings import seat_readings
from hthor.episode import Episode, EpisodeLog
from hthor.episode.frames import Frames
from hthor.episode.play import record_beliefs
from hthor.errors import HthorError, UnknownName
from hthor.humans.model import HumanModel
from hthor.types import Action, Observation, TrialSpec
from hthor.types.events import Progress
from hthor.world import World
from hthor.world.model.trial_control import Reading

People = Callable[[], Mapping[str, HumanModel]]


class EpisodeControl:
    """A trial that goes on by one tick at every step of composer's environment, exactly as `hthor.episode.play` does.

    Args:
        trial: the trial. world: the world of its house, robots and objects.
        people: called at every reset; returns the human model of each person, by seat.
        observe: names of observables that are enabled besides those that always are, without their seat.

    Attributes:
        episode: the trial as an `Episode`, for briefings and for observations as records.
        asked: the seats that the batch would ask at this tick, because their body is free or their mail has changed.
        reward: the increase of the share of the goal that is met, in the last tick; its sum over an episode is the
            whole increase. The share of a task without partial goals is 1.0 once the goal is met, before that 0.0.
        discount: 0.0 once the goal is met. Time that runs out cuts an episode off and ends no task: then it is 1.0.
    """

    def __init__(self, trial: TrialSpec, world: World, people: People, observe: Collection[str] = ()) -> None:
        robots = tuple(seat.seat for seat in trial.robots)
        if robots != world.robots:
            raise HthorError(
                f"the trial has the robots {', '.join(robots) or 'none'}, the world has "
                f"{', '.join(world.robots) or 'none'}; make the world with the trial's robots"
            )
        self.episode, self._world, self._make_people = Episode(trial, world), world, people
        self._robots, self._people = robots, dict[str, HumanModel]()
        self._observe = frozenset(observe)
        self.asked: tuple[str, ...] = ()
        self.reward, self._share, self._begun = 0.0, 0.0, False
        self._ratings: dict[str, int | None] = {}

    @property
    def done(self) -> bool:
        """Whether the goal is met, the time is over, or the trial was voided."""
        return self.episode.done

    @property
    def discount(self) -> float:
        """See above."""
        return 0.0 if self.episode.met else 1.0

    def reset(self) -> None:
        """Begin the trial, and brief the people."""
        people = dict(self._make_people())
        if tuple(people) != self.episode.people:
            given = ", ".join(people) or "none"
            raise HthorError(f"people must have the seats {', '.join(self.episode.people)}, in this order; got {given}")
        self.episode.reset()
        self._frames = Frames(self.episode, people)
        self._begun, self._people, self._ratings = True, people, {}
        for seat, human in people.items():
            human.begin(self.episode.briefing(seat))
        self.reward, self._share = 0.0, self._share_after(self.episode.events, 0.0)
        self.asked = self.episode.waiting

    def submit(self, action: Mapping[str, Any]) -> None:
        """Take the robots' actions; what a robot says counts at every tick, its motion only if its body is free."""
        if not isinstance(action, Mapping) or set(action) != set(self._robots):
            given = ", ".join(map(str, action)) if isinstance(action, Mapping) else type(action).__name__
            raise HthorError(f"an action is a dict with the keys {', '.join(self._robots)}; got {given or 'none'}")
        actions = {seat: self._decoded(seat, action[seat]) for seat in self._robots}
        for seat, one in actions.items():
            self.episode.submit(seat, one)

    def advance(self) -> None:
        """Let the people act and one tick pass; at the end of the trial, people rate the robots."""
        episode = self.episode
        for seat in self.asked:
            if seat in self._people and seat not in self._frames.seats:
                episode.submit(seat, self._people[seat].act(episode.observe(seat)))
        if not episode.done:
            self._frames.play()
        happened = episode.advance() if not episode.done else ()
        record_beliefs(happened, self._people)
        share = self._share_after(happened, self._share)
        self.reward, self._share = share - self._share, share
        self.asked = episode.waiting
        if episode.done and not episode.voided:
            self._ratings = {seat: human.rate(episode.met, episode.tick) for seat, human in self._people.items()}

    def log(self) -> EpisodeLog:
        """The trial's log up to now; once it is over, the same as that of `hthor.episode.play`."""
        journals = {seat: getattr(human, "journal", ()) for seat, human in self._people.items()}
        return self.episode.log(self._ratings, journals)

    def action_spec(self) -> dict[str, dict[str, specs.Array]]:
        """The arrays of each robot's action, by seat."""
        return {seat: action_spec() for seat in self._robots}

    def readings(self) -> dict[str, Reading]:
        """The robots' observables, named ``SEAT/NAME``, and ``tick``, the number of ticks since the reset."""
        found = {"tick": Reading(specs.Array((), np.int64), lambda: np.array(self.episode.tick, np.int64))}
        for seat in self._robots:
            own = self._of_seat(seat)
            if unknown := sorted(self._observe.difference(own)):
                raise UnknownName("observable", unknown[0], own)
            for name, reading in own.items():
                found[f"{seat}/{name}"] = reading._replace(enabled=reading.enabled or name in self._observe)
        return {name: self._guarded(reading) for name, reading in found.items()}

    def _of_seat(self, seat: str) -> dict[str, Reading]:
        world, task = self._world, self.episode.task
        rows = len(world.house.things) + len(world.house.openings) + len(task.objects) + len(world.seats)

        def observe() -> Observation:
            return self.episode.observe(seat)

        instruction = np.array(task.instruction, object)
        return {
            "instruction": Reading(specs.StringArray(()), lambda: instruction),
            "asked": Reading(specs.Array((), np.bool_), lambda: np.array(seat in self.asked)),
            **seat_readings(observe, world.bodies[seat], world.camera(seat).size, rows),
        }

    def _guarded(self, reading: Reading) -> Reading:
        """The same reading, which before the first reset gives some value of its specification."""
        return reading._replace(read=lambda: reading.read() if self._begun else reading.spec.generate_value())

    def _share_after(self, events: Any, before: float) -> float:
        """The share of the goal that is met after these events."""
        told = [event.value for event in events if isinstance(event, Progress)]
        return 1.0 if self.episode.met else told[-1] if told else before

    def _decoded(self, seat: str, arrays: Any) -> Action:
        try:
            return decode_action(arrays)
        except HthorError as error:
            raise HthorError(f"the action of '{seat}': {error}") from None
