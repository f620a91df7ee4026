"""A trial that is driven from outside, one tick at a time: by `hthor.episode.play`, a live session or a learner.

    episode = Episode(trial, world)
    episode.reset()
    while not episode.done:
        for seat in episode.waiting:
            episode.submit(seat, decide(episode.observe(seat)))
        episode.advance()
    log = episode.log()

All seats that observe in one tick observe the same moment, and the order of calls within a tick makes no difference:
actions take effect together as the tick begins, in `advance` or with the first `substep`.
"""

from collections.abc import Callable, Mapping, Sequence

import msgspec
from msgspec import UNSET

from hthor import seeds
from hthor.comms.mailbox import Mailbox
from hthor.episode.episode_state import EpisodeState
from hthor.episode.goal_judge import GoalJudge
from hthor.episode.participants import Participants
from hthor.episode.phases import PhaseClock
from hthor.episode.recording.episode_log import EpisodeLog
from hthor.episode.recording.log_writer import LogWriter, end_event
from hthor.episode.recording.set_points import rounded
from hthor.episode.seat_inputs import make_briefing, make_observation
from hthor.episode.signals import SignalReceiver
from hthor.episode.speech import say
from hthor.episode.trial_world import TrialWorld
from hthor.errors import HthorError
from hthor.types import HUMAN, SUBTICKS, Action, Briefing, Drive, Motion, Observation, TrialSpec, is_person
from hthor.types.events import Acted, Event, JournalEntry, Paused, Resumed, Thought
from hthor.types.specs import LOCKSTEP

Observer = Callable[["Episode", Sequence[Event]], None]
"""Called after `Episode.reset` and after every tick, with the events since its last call; it must change nothing."""


class Episode:
    """One trial, from `reset` until it is `done`.

    Args:
        trial: its task names the house, the starts, the goal and the time limit.
        world: the simulation of the task's house, with a body for every seat.
        seats: the seats that take part, by default all of the world, people first.

    Attributes:
        seats: as above. events: everything that has happened so far, in order. faults: failures of agents so far.
        voided: why the trial does not count; empty if it does.
    """

    def __init__(self, trial: TrialSpec, world: TrialWorld, seats: Sequence[str] | None = None) -> None:
        self.trial, self.task, self.world = trial, trial.task, world
        self.seats = tuple(world.seats if seats is None else seats)
        self.people = tuple(seat for seat in self.seats if is_person(seat))
        self._seed = seeds.derive(trial.seed, "world", trial.session, trial.index, trial.task.id)
        self._privileges = {robot.seat: robot.agent.privileges for robot in trial.robots}
        self._observers: list[Observer] = []

    def reset(self) -> None:
        """Begin the trial at tick 0, whatever has happened before."""
        self.voided, self.paused = "", False
        self._mailbox = Mailbox([seat for seat in self.seats if seat not in self.people], self.people)
        robots = [robot.seat for robot in self.trial.robots] if (self.trial.clock or LOCKSTEP) != LOCKSTEP else ()
        self._writer = LogWriter({seat: self.world.bodies[seat] for seat in self.seats}, robots)
        self._goal = GoalJudge(self.task)
        self._phases = PhaseClock(self.task, self._goal, self._writer.rest)
        self.world.reset(self._phases.arrangement, seed=self._seed)
        self.events, self.faults = self._writer.events, self._writer.faults
        self._signals = SignalReceiver(self.people, self.events, self._phases)
        self._participants = Participants(self.seats)
        self._steps = 0  # of this tick, that bodies that drive have made
        self._reported = 0  # events that `advance` has returned
        self._observed: dict[str, Observation] = {}
        self._writer.trace(self.world)
        self.events.extend(self._phases.begin(self.world))
        self._report()

    @property
    def tick(self) -> int:
        """Ticks since `reset`."""
        return self.world.tick

    @property
    def step(self) -> int:
        """How many steps of this tick the bodies that drive have made."""
        return self._steps

    @property
    def met(self) -> bool:
        """Whether the goal is met."""
        return self._goal.met

    @property
    def progress(self) -> float | None:
        """The share of the goal that is met, from 0 to 1; None for task kinds without partial goals."""
        return self._goal.progress

    @property
    def done(self) -> bool:
        """Whether the goal is met, the time is over, or the trial was voided."""
        return self._goal.met or bool(self.voided) or self.world.tick >= self._phases.end

    @property
    def waiting(self) -> tuple[str, ...]:
        """The seats that are to be asked now: their body is free for a new motion, or their mail has changed."""
        idle, changed = self.world.idle, self._mailbox.changed
        return tuple([seat for seat in self._participants.active if idle(seat) or changed(seat)])

    def briefing(self, seat: str) -> Briefing:
        """What the seat's agent or human model is told before the trial."""
        return make_briefing(self.task, self.world, self.seats, seat, self._privileges.get(seat, ()))

    def observe(self, seat: str, *, frozen: bool = False) -> Observation:
        """What the seat observes at this tick; the same record until the next `advance`.

        Args:
            frozen: whether its sensors must still show this moment when the world has gone on, as a reader in another
                thread needs; otherwise they may be read until the next `advance`.
        """
        known = self._observed.get(seat)
        if known is not None:
            return known
        if self._steps:
            raise HthorError("observe before the first step of a tick, so that all seats observe the same moment")
        privileges, phase = self._privileges.get(seat, ()), self._phases.name
        display = self._signals.displays.state(seat)
        observation = make_observation(self.world, self._mailbox, display, seat, privileges, phase, frozen=frozen)
        self._observed[seat] = observation
        return observation

    def submit(self, seat: str, action: Action, observation: Observation | None = None) -> None:
        """Let a seat act as the next tick begins: with words and signals, and with its motion if the body is free.

        That is this tick before its first `substep`, and the one after it from then on. A second action for the same
        tick replaces the first; if it says nothing, what the first says is kept, and so are its signals.

        Args:
            observation: what the seat saw when it decided, if that was in an earlier tick; a motion counts only if the
                body was free then.

        Raises:
            TypeError: when ``action`` is not an `Action`.
            HthorError: when there is no such seat.
        """
        if not isinstance(action, Action):
            raise TypeError(f"submit needs an hthor.types.Action, got {type(action).__name__}")
        self._check_seat(seat)
        if self._writer.records(seat):
            self._record(seat, action, observation)
        self._participants.submit(seat, action, observation)

    def steer(self, seat: str, drive: Drive) -> None:
        """Let a seat drive like this from its next step on, as a live person does between two ticks."""
        self._check_seat(seat)
        self._start(seat, drive)

    def substep(self) -> None:
        """Move the bodies that drive by one of the tick's `hthor.types.SUBTICKS` steps; `advance` makes those left.

        With the first step the tick begins and all actions take effect. It makes no difference who makes the steps.
        """
        self._check_running()
        if not self._steps:
            self._begin_tick()
        self.world.substep()
        self._steps += 1

    def retire(self, seat: str, error: Exception) -> None:
        """Take a failed agent out of the trial: its body stays where it is from now on, and its fault is logged."""
        self._participants.retire(self.tick, seat, error)

    def advance(self) -> tuple[Event, ...]:
        """Let one tick pass, and return its events. Raises HthorError when the trial is over or paused.

        Messages that were observed count as shown, and failed agents leave. Then every seat in order says what it has
        to say and begins its motion. Then the world moves on, the next phase may begin, and the goal is judged.
        """
        self._check_running()
        world, events = self.world, self.events
        if not self._steps:
            self._begin_tick()
        events.extend(world.advance())
        self._observed.clear()
        self._steps = 0
        events.extend(self._phases.advance(world, self._participants.active))
        self._writer.trace(world)
        events.extend(self._goal.judge(world.snapshot(), world.house, has_events=len(events) > self._reported))
        return self._report()

    # ------------------------------------------------------------------------------------- pausing, ending, watching

    def pause(self, reason: str = "") -> None:
        """Stop the trial's time until `resume`; the log has when and why, and nothing else changes."""
        if not self.paused:
            self.paused = True
            self.events.append(Paused(tick=self.tick, seat=HUMAN, reason=reason))

    def resume(self) -> None:
        """Let time pass again."""
        if self.paused:
            self.paused = False
            self.events.append(Resumed(tick=self.tick, seat=HUMAN))

    def void(self, reason: str) -> None:
        """End the trial and mark it as one that does not count, such as one in which a cable came loose."""
        if not reason:
            raise HthorError("a trial is voided for a reason; say which")
        self.voided = self.voided or reason

    def attach(self, observer: Observer) -> None:
        """Let an observer watch the trial from now on."""
        self._observers.append(observer)

    def save_state(self) -> EpisodeState:
        """A copy of the trial in its present state, without the agents and human models, which have their own."""
        return EpisodeState(
            world=self.world.save_state(),
            mailbox=self._mailbox.save_state(),
            log=self._writer.save_state(),
            goal=self._goal.save_state(self.world.snapshot()),
            phases=self._phases.save_state(),
            voided=self.voided,
            paused=self.paused,
            participants=self._participants.save_state(),
            observed={seat: msgspec.structs.replace(one, senses=None) for seat, one in self._observed.items()},
            steps=self._steps,
            reported=self._reported,
        )

    def load_state(self, state: EpisodeState) -> None:
        """Continue from a copy of this trial; with the same actions it has the same future, byte for byte.

        Raises:
            HthorError: when the world's state is that of another world.
        """
        self.reset()
        self.world.load_state(state.world)
        self._mailbox.load_state(state.mailbox)
        self._writer.load_state(state.log)
        self._signals.displays.reset()
        self.voided, self.paused = state.voided, state.paused
        self._phases.load_state(state.phases)
        self._goal.load_state(state.goal, self.world.snapshot())
        self._participants.load_state(state.participants)
        self._steps, self._reported = state.steps, state.reported
        self._observed = {
            seat: msgspec.structs.replace(one, senses=self.world.senses(seat)) for seat, one in state.observed.items()
        }

    def log(
        self,
        ratings: Mapping[str, int | None] | None = None,
        journals: Mapping[str, Sequence[JournalEntry]] | None = None,
    ) -> EpisodeLog:
        """The trial's log up to now.

        Args:
            ratings: each person's rating of trust in the robots after the trial, by seat.
            journals: each human model's own entries for the journal, by seat.
        """
        winner = self._goal.winner(self.world.snapshot(), self.people) if self.met else ""
        end = end_event(self.tick, winner, self.voided) if self.done else None
        return self._writer.log(self.tick, end, self._goal.progress, ratings or {}, journals or {})

    def _record(self, seat: str, action: Action, observation: Observation | None) -> None:
        """Let the journal have what a seat does."""
        begun = self._steps > 0
        acted = Acted(
            tick=self.tick + begun,
            seat=seat,
            motion=action.motion,
            say=action.say,
            signals=action.signals,
            early=max(0, SUBTICKS - self._steps) if begun else 0,
            seen=UNSET if observation is None else observation.tick,
        )
        self._writer.note_action(acted)

    def _report(self) -> tuple[Event, ...]:
        """The events since the last report; observers see them."""
        events, first = self.events, self._reported
        happened = tuple(events[first:]) if len(events) > first else ()
        self._reported = len(events)
        for observer in self._observers:
            observer(self, happened)
        return happened

    def _begin_tick(self) -> None:
        """Let everything that was seen and submitted take effect."""
        tick = self.tick
        for seat in self.seats:
            if (observation := self._observed.get(seat)) is not None and observation.inbox:
                self.events.extend(self._mailbox.shown(tick, seat))
        if self._participants.failed:
            self._dismiss_failed(tick)
        self._act(tick)

    def _dismiss_failed(self, tick: int) -> None:
        faults, events = self._participants.dismiss_failed(tick)
        self.faults.extend(faults)
        self.events.extend(events)
        for fault in faults:
            self._writer.rest.note(tick, fault.seat, resting=True)

    def _act(self, tick: int) -> None:
        """Let every seat that has acted say what it says and begin its motion."""
        idle, actions = self.world.idle, self._participants.actions
        for seat in self._participants.active:
            given, free = actions.get(seat), idle(seat)
            if given is None:
                if free:
                    self._writer.rest.note_unasked(tick, seat)
                continue
            action, seen = given
            if seen is not None and seen.tick < tick:
                self.events.append(Thought(tick=tick, seat=seat, ticks=tick - seen.tick))
            if action.say is not None:
                self.events.extend(say(self.world, self._mailbox, seat, action.say))
            for signal in action.signals:
                self.events.extend(self._signals.receive(tick, seat, signal))
            if (free and (seen is None or seen.idle)) or isinstance(action.motion, Drive):
                self._start(seat, action.motion)
            elif free:
                self._writer.rest.note_unasked(tick, seat)
        self._participants.actions = {}

    def _start(self, seat: str, motion: Motion) -> None:
        motion, world = rounded(motion) if isinstance(motion, Drive) else motion, self.world
        world.start(seat, motion)
        self._writer.note_motion(world.tick, self._steps, seat, motion, started=not world.idle(seat))

    def _check_seat(self, seat: str) -> None:
        if seat not in self.seats:
            raise HthorError(f"'{seat}' is no seat of this trial; its seats are {', '.join(self.seats)}")

    def _check_running(self) -> None:
        if self.paused or self.done:
            raise HthorError(f"this trial is {'paused' if self.paused else 'over'}, so no time passes in it")
