"""The umpire: one clock, one mailbox, one goal, one event list."""

from __future__ import annotations

import time
import traceback
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any, Protocol, TypeVar

import msgspec
from msgspec import Struct

from hthor import plugins, rules, seeds
from hthor.comms import claims
from hthor.comms.mailbox import Mailbox
from hthor.humans.core.behaviour_log import BehaviourRecorder
from hthor.humans.model import HumanModel
from hthor.tasks.kind import TaskKind
from hthor.thinking_time import Decision, Thinking
from hthor.types import (
    HUMAN,
    Action,
    BodySpec,
    Briefing,
    Event,
    HouseSpec,
    Mind,
    Motion,
    Observation,
    Outcome,
    Pose,
    Send,
    Senses,
    Snapshot,
    TaskSpec,
    ThingState,
    TrialSpec,
    Wait,
)

_T = TypeVar("_T")
_LOOK_TICKS = round(1.0 / rules.TICK_S)


class TrialWorld(Protocol):
    """What the umpire asks of a world."""

    @property
    def seats(self) -> Sequence[str]: ...
    @property
    def bodies(self) -> Mapping[str, BodySpec]: ...
    @property
    def house(self) -> HouseSpec: ...
    @property
    def tick(self) -> int: ...
    def reset(self, task: TaskSpec, seed: int = 0) -> None: ...
    def idle(self, seat: str) -> bool: ...
    def start(self, seat: str, motion: Motion) -> None: ...
    def outcome(self, seat: str) -> Outcome | None: ...
    def advance(self) -> tuple[Event, ...]: ...
    def pose(self, seat: str) -> Pose: ...
    def holding(self, seat: str) -> str: ...
    def room(self, seat: str) -> str: ...
    def senses(self, seat: str) -> Senses: ...
    def truth(self) -> tuple[ThingState, ...]: ...
    def snapshot(self) -> Snapshot: ...
    def frame(self, seat: str) -> Callable[[], Any]: ...


class Fault(Struct, frozen=True, kw_only=True):
    """A robot's mind failed at ``tick``; the trial went on without it. ``detail`` is its traceback or what it did."""

    seat: str
    kind: str
    tick: int
    detail: str


class EpisodeLog(Struct, frozen=True, kw_only=True):
    """What one trial left behind.

    ``paths`` holds, for each seat and every `rules.LOG_EVERY_TICKS` ticks from tick 0, [x, y, yaw] in whole
    millimetres and milliradians. ``ticks`` is the trial's length; ``trust`` the person's rating, None without a robot.
    ``progress`` is the share of the goal that is met in the end, from 0 to 1, None where the kind of task counts no
    parts; whenever it changes there is an event "progress" with its ``value``. ``idle`` says for how many ticks each
    seat's body carried out no motion, or only waited. ``journal`` is what the person's own recorder holds besides:
    stick, pitch, attempts, glimpses, choices, as `hthor.humans.core.behaviour_log` lists them.
    """

    events: tuple[Event, ...]
    paths: dict[str, list[tuple[int, int, int]]]
    ticks: int
    met: bool
    trust: int | None
    faults: tuple[Fault, ...]
    progress: float | None = None
    idle: dict[str, int] = {}
    journal: tuple[Event, ...] = ()


def run_episode(
    trial: TrialSpec,
    world: TrialWorld,
    human: HumanModel,
    robots: Mapping[str, Mind],
    *,
    clock: Callable[[], float] = time.perf_counter,
) -> EpisodeLog:
    """Run one trial from reset to its end.

    Args:
        trial: what to play; its task decides house, start, goal and time limit.
        world: built for the task's house, with a body for every seat of ``robots``.
        human: the person, who may remember earlier trials of the session.
        robots: a mind for each robot's seat.
        clock: what thinking time is measured by [s] in a trial in real time; in lock-step nobody looks at it.
    """
    return _Episode(trial, world, human, robots, Thinking(clock) if trial.realtime else None).run()


class _Episode:
    def __init__(
        self,
        trial: TrialSpec,
        world: TrialWorld,
        human: HumanModel,
        robots: Mapping[str, Mind],
        thinking: Thinking | None,
    ) -> None:
        self.thinking = thinking
        self.task, self.world, self.human = trial.task, world, human
        self.seed = seeds.derive(trial.seed, "world", trial.participant, trial.index, trial.task.id)
        self.minds: dict[str, Mind] = {HUMAN: human, **robots}
        self.privileges = {robot.seat: robot.agent.privileges for robot in trial.robots}
        self.kind: TaskKind = plugins.load("task kind", self.task.kind)
        self.advances = _Progress(self.kind, self.task)
        self.limit = round(self.task.time_limit / rules.TICK_S)
        self.mailbox = Mailbox(robots=tuple(robots))
        self.events: list[Event] = []
        self.faults: list[Fault] = []
        self.paths: dict[str, list[tuple[int, int, int]]] = {seat: [] for seat in self.minds}
        self.idle = dict.fromkeys(self.minds, 0)
        self.recorder = BehaviourRecorder(world.bodies[HUMAN], rules.TICK_S)
        self.resting: dict[str, int | None] = dict.fromkeys(self.minds, 0)

    def run(self) -> EpisodeLog:
        self.world.reset(self.task, seed=self.seed)
        self._trace()
        self.events.extend(self.advances.look(self.world.snapshot(), self.world.house, news=True))
        for seat, mind in tuple(self.minds.items()):
            self._guarded(seat, partial(mind.begin, self._briefing(seat)))
        met = False
        while not met and self.world.tick < self.limit:
            told = len(self.events)
            self._tick()
            snapshot = self.world.snapshot()
            met = self.kind.met(self.task, snapshot, self.world.house)
            if self.advances.value is not None:
                news = len(self.events) > told
                self.events.extend(self.advances.look(snapshot, self.world.house, met=met, news=news))
        return self._log(met)

    def _log(self, met: bool) -> EpisodeLog:
        ticks = self.world.tick
        for seat in self.resting:
            self._rest(seat, False)
        self.events.append(Event(tick=ticks, seat=HUMAN, kind="success" if met else "timeout"))
        return EpisodeLog(
            events=tuple(self.events),
            paths=self.paths,
            ticks=ticks,
            met=met,
            trust=self.human.rate(met, ticks),
            faults=tuple(self.faults),
            progress=self.advances.value,
            idle=self.idle,
            journal=self.recorder.journal(getattr(self.human, "journal", ()), self.events),
        )

    def _tick(self) -> None:
        """Every seat that is asked sees the same moment; only then do their actions take effect."""
        world, mailbox = self.world, self.mailbox
        wanted = [seat for seat in self.minds if world.idle(seat) or mailbox.changed(seat)]
        asked = {seat: self._observe(seat) for seat in wanted if self.thinking is None or not self.thinking.busy(seat)}
        if HUMAN in asked and asked[HUMAN].inbox:
            self.events.extend(mailbox.shown(world.tick))
        actions = [(seat, self._ask(seat, observation)) for seat, observation in asked.items()]
        for seat, action in actions if self.thinking is None else self._timely(self.thinking, actions):
            if action is None:
                continue
            if action.say is not None:
                self._say(seat, action)
            if world.idle(seat):
                if seat == HUMAN:
                    self.recorder.motion(world.tick, action.motion)
                world.start(seat, action.motion)
                self._rest(seat, isinstance(action.motion, Wait) or world.idle(seat))
        self.events.extend(world.advance())
        self._trace()

    def _timely(
        self, thinking: Thinking, actions: Sequence[tuple[str, Action | None]]
    ) -> Sequence[tuple[str, Action | None]]:
        """In real time: what is decided by now. The rest comes later, and the bodies that wait for it stand still."""
        tick = self.world.tick
        for seat, action in actions:
            late = thinking.late(seat)
            if action is None:
                continue
            free = self.world.idle(seat)
            thinking.hold(Decision(seat=seat, action=action, moves=free), until=tick + late)
            if late:
                self.events.append(Event(tick=tick, seat=seat, kind="thought", data={"ticks": late}))
                if free:
                    self._rest(seat, True)
        due = thinking.due(tick, self.minds)
        for one in due:
            if not one.moves and one.action.say is not None:  # who was asked while busy was asked for words alone
                self._say(one.seat, one.action)
        return [(one.seat, one.action) for one in due if one.moves]

    def _ask(self, seat: str, observation: Observation) -> Action | None:
        """A robot's failure ends its part in the trial, not the trial; a human model's failure is ours to see."""
        mind = self.minds[seat]
        if seat == HUMAN:
            return _checked(mind.act(observation))
        act = mind.act if self.thinking is None else partial(self.thinking.ask, seat, mind)
        return self._guarded(seat, lambda: _checked(act(observation)))

    def _observe(self, seat: str) -> Observation:
        world, tick = self.world, self.world.tick
        return Observation(
            tick=tick,
            pose=world.pose(seat),
            idle=world.idle(seat),
            senses=world.senses(seat),
            room=world.room(seat),
            holding=world.holding(seat),
            outcome=world.outcome(seat),
            inbox=self.mailbox.inbox(seat),
            receipt=self.mailbox.receipt(seat),
            truth=world.truth() if "object_poses" in self.privileges.get(seat, ()) else (),
        )

    def _say(self, seat: str, action: Action) -> None:
        tick, say = self.world.tick, action.say
        if isinstance(say, Send):
            events = self.mailbox.send(tick, seat, say, self.world.frame(seat))
            self.events.extend(self._judged(event, say) for event in events)
        elif say is not None:
            self.events.extend(self.mailbox.reply(tick, seat, say))

    def _judged(self, event: Event, send: Send) -> Event:
        """The same event; what was sent, with how far it is from the truth."""
        if event.kind != "sent":
            return event
        claim = claims.claim_error(send, event.data["position"], self.world.snapshot(), self.world.house)
        return msgspec.structs.replace(event, data={**event.data, **claim})

    def _rest(self, seat: str, resting: bool) -> None:
        """From now on the seat's body carries out a motion, or none but waiting."""
        tick, since = self.world.tick, self.resting[seat]
        if since is not None and not resting:
            self.idle[seat] += tick - since
        self.resting[seat] = None if not resting else tick if since is None else since

    def _briefing(self, seat: str) -> Briefing:
        goal, granted = self.task.goal, self.privileges.get(seat, ())
        return Briefing(
            seat=seat,
            instruction=self.task.instruction,
            target=goal.target,
            destination=goal.destination,
            relation=goal.relation,
            body=self.world.bodies[seat],
            tick_s=rules.TICK_S,
            time_limit=self.task.time_limit,
            teammates=tuple(other for other in self.minds if other != seat),
            privileges=granted,
            house=self.world.house if "house_map" in granted else None,
            kind=self.task.kind,
            jobs=goal.todo,
            crew=dict(self.world.bodies),
        )

    def _guarded(self, seat: str, call: Callable[[], _T]) -> _T | None:
        """A robot's failure ends its part in the trial, not the trial; a human model's failure is ours to see."""
        if seat == HUMAN:
            return call()
        try:
            return call()
        except Exception as error:
            self._retire(seat, error)
            return None

    def _retire(self, seat: str, error: Exception) -> None:
        """Take a failed mind out of the trial: its body stays where it is, and what it did wrong is on record."""
        tick, kind = self.world.tick, str(getattr(error, "kind", type(error).__name__))
        detail = str(getattr(error, "detail", "")) or "".join(traceback.format_exception(error, limit=-4))
        self.faults.append(Fault(seat=seat, kind=kind, tick=tick, detail=detail))
        self.events.append(Event(tick=tick, seat=seat, kind="fault", data={"kind": kind}))
        self._rest(seat, True)
        del self.minds[seat]

    def _trace(self) -> None:
        if self.world.tick % rules.LOG_EVERY_TICKS:
            return
        for seat, path in self.paths.items():
            pose = self.world.pose(seat)
            path.append((round(pose.x * 1000), round(pose.y * 1000), round(pose.yaw * 1000)))
            if seat == HUMAN:
                self.recorder.head(self.world.tick, pose.pitch)


class _Progress:
    """How much of the goal is met, by the kinds of task that count parts; the others cost nothing."""

    def __init__(self, kind: TaskKind, task: TaskSpec) -> None:
        counts = type(kind).progress is not TaskKind.progress
        self.value: float | None = 0.0 if counts else None
        self._kind, self._task, self._last = kind, task, round(task.time_limit / rules.TICK_S)
        self._things: Mapping[str, ThingState] | None = None

    def look(self, snapshot: Snapshot, house: HouseSpec, *, met: bool = False, news: bool) -> tuple[Event, ...]:
        """The event "progress" when it changed.

        It is worked out when a thing has changed by a deed or by itself, once a second, and at the end. While the only
        news is that something is carried along, it can wait.
        """
        stirred = snapshot.things is not self._things and (news or not any(snapshot.holding.values()))
        due = met or stirred or snapshot.tick % _LOOK_TICKS == 0 or snapshot.tick == self._last
        if self.value is None or not due:
            return ()
        self._things = snapshot.things
        share = 1.0 if met else round(min(1.0, max(0.0, float(self._kind.progress(self._task, snapshot, house)))), 4)
        if share == self.value:
            return ()
        self.value = share
        return (Event(tick=snapshot.tick, seat=HUMAN, kind="progress", data={"value": share}),)


def _checked(action: object) -> Action:
    if not isinstance(action, Action):
        raise TypeError(f"act must return an hthor.types.Action, got {type(action).__name__}")
    return action
