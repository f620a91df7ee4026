"""A trial as a loop over ticks: calls agents, passes messages, starts motions, judges the goal, writes the log."""

import time
import traceback
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import TypeVar

import msgspec

from hthor import plugins, rules, seeds
from hthor.comms import claims
from hthor.comms.mailbox import Mailbox
from hthor.episode.episode_log import EpisodeLog, Fault
from hthor.episode.trial_world import TrialWorld
from hthor.humans.core.behaviour_log import BehaviourRecorder
from hthor.humans.model import HumanModel
from hthor.tasks.kind import TaskKind
from hthor.thinking_time import Decision, Thinking
from hthor.types import (
    HUMAN,
    Action,
    Briefing,
    Event,
    HouseSpec,
    Mind,
    Observation,
    Send,
    Snapshot,
    TaskSpec,
    ThingState,
    TrialSpec,
    Wait,
)

_T = TypeVar("_T")
_EVERY_TICKS = round(1.0 / rules.TICK_S)
"""[ticks] Progress is computed at least this often."""


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
        trial: its task names the house, the starts, the goal and the time limit.
        world: the simulation of the task's house, with a body for every seat of ``robots``.
        human: the human model, which may remember earlier trials of the session.
        robots: the agent of each robot, by seat.
        clock: measures thinking time [s] in a real-time trial; not used in lock-step.

    Raises:
        Exception: any exception of the human model or the world; errors of agents become faults in the log.
    """
    return Episode(trial, world, human, robots, Thinking(clock) if trial.realtime else None).run()


class Episode:
    """The state of one trial while it runs; `run_episode` makes one and runs it.

    In every tick, each seat whose body is idle or that has mail is asked for an action; all observe the same moment.
    Then messages are passed on, motions are started, and the world advances by one tick.

    The arguments are as in `run_episode`; ``thinking`` counts agents' thinking as trial time, and is None in lock-step.
    """

    def __init__(
        self,
        trial: TrialSpec,
        world: TrialWorld,
        human: HumanModel,
        robots: Mapping[str, Mind],
        thinking: Thinking | None,
    ) -> None:
        self.task, self.world, self.human, self.thinking = trial.task, world, human, thinking
        self.seed = seeds.derive(trial.seed, "world", trial.session, trial.index, trial.task.id)
        self.agents: dict[str, Mind] = {HUMAN: human, **robots}
        self.privileges = {robot.seat: robot.agent.privileges for robot in trial.robots}
        self.kind: TaskKind = plugins.load("task kind", self.task.kind)
        self.progress = GoalProgress(self.kind, self.task)
        self.limit = round(self.task.time_limit / rules.TICK_S)
        self.mailbox = Mailbox(robots=tuple(robots))
        self.events: list[Event] = []
        self.faults: list[Fault] = []
        self.paths: dict[str, list[tuple[int, int, int]]] = {seat: [] for seat in self.agents}
        self.idle = dict.fromkeys(self.agents, 0)
        self.recorder = BehaviourRecorder(world.bodies[HUMAN], rules.TICK_S)
        self.resting_since: dict[str, int | None] = dict.fromkeys(self.agents, 0)

    def run(self) -> EpisodeLog:
        """Run the trial to its end."""
        self.world.reset(self.task, seed=self.seed)
        self._trace()
        self.events.extend(self.progress.update(self.world.snapshot(), self.world.house, has_events=True))
        for seat, agent in tuple(self.agents.items()):
            self._guarded(seat, partial(agent.begin, self._briefing(seat)))
        met = False
        while not met and self.world.tick < self.limit:
            events = len(self.events)
            self._tick()
            snapshot = self.world.snapshot()
            met = self.kind.met(self.task, snapshot, self.world.house)
            if self.progress.value is not None:
                has_events = len(self.events) > events
                self.events.extend(self.progress.update(snapshot, self.world.house, met=met, has_events=has_events))
        return self._log(met)

    def _log(self, met: bool) -> EpisodeLog:
        ticks = self.world.tick
        for seat in self.resting_since:
            self._rest(seat, False)
        self.events.append(Event(tick=ticks, seat=HUMAN, kind="success" if met else "timeout"))
        return EpisodeLog(
            events=tuple(self.events),
            paths=self.paths,
            ticks=ticks,
            met=met,
            ratings={HUMAN: self.human.rate(met, ticks)},
            faults=tuple(self.faults),
            progress=self.progress.value,
            idle=self.idle,
            journal=self.recorder.journal(getattr(self.human, "journal", ()), self.events),
        )

    def _tick(self) -> None:
        """Play one tick: all seats that must act observe the same moment; only then do their actions take effect."""
        world, mailbox = self.world, self.mailbox
        ready = [seat for seat in self.agents if world.idle(seat) or mailbox.changed(seat)]
        asked = {seat: self._observe(seat) for seat in ready if self.thinking is None or not self.thinking.busy(seat)}
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
        """The actions that are due by now in real time; bodies whose action is not due yet stand still."""
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
        due = thinking.due(tick, self.agents)
        for one in due:
            if not one.moves and one.action.say is not None:  # while it moves, a seat may only speak
                self._say(one.seat, one.action)
        return [(one.seat, one.action) for one in due if one.moves]

    def _ask(self, seat: str, observation: Observation) -> Action | None:
        agent = self.agents[seat]
        if seat == HUMAN:
            return _checked(agent.act(observation))
        act = agent.act if self.thinking is None else partial(self.thinking.ask, seat, agent)
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
            self.events.extend(self._with_claim_error(event, say) for event in events)
        elif say is not None:
            self.events.extend(self.mailbox.reply(tick, seat, say))

    def _with_claim_error(self, event: Event, send: Send) -> Event:
        """The event; for a sent message, with the distance of its claim from the truth added."""
        if event.kind != "sent":
            return event
        claim = claims.claim_error(send, event.data["position"], self.world.snapshot(), self.world.house)
        return msgspec.structs.replace(event, data={**event.data, **claim})

    def _rest(self, seat: str, resting: bool) -> None:
        """Note whether the seat's body rests (does nothing or waits) from now on, and add up its idle time."""
        tick, since = self.world.tick, self.resting_since[seat]
        if since is not None and not resting:
            self.idle[seat] += tick - since
        self.resting_since[seat] = None if not resting else tick if since is None else since

    def _briefing(self, seat: str) -> Briefing:
        goal, privileges = self.task.goal, self.privileges.get(seat, ())
        return Briefing(
            seat=seat,
            instruction=self.task.instruction,
            target=goal.target,
            destination=goal.destination,
            relation=goal.relation,
            body=self.world.bodies[seat],
            tick_s=rules.TICK_S,
            time_limit=self.task.time_limit,
            teammates=tuple(other for other in self.agents if other != seat),
            privileges=privileges,
            house=self.world.house if "house_map" in privileges else None,
            kind=self.task.kind,
            jobs=goal.todo,
            crew=dict(self.world.bodies),
        )

    def _guarded(self, seat: str, call: Callable[[], _T]) -> _T | None:
        """Call an agent or the human model. An agent that fails leaves the trial; a human model's error is raised."""
        if seat == HUMAN:
            return call()
        try:
            return call()
        except Exception as error:
            self._retire(seat, error)
            return None

    def _retire(self, seat: str, error: Exception) -> None:
        """Take a failed agent out of the trial: its body stays where it is, and its fault is logged."""
        tick, kind = self.world.tick, str(getattr(error, "kind", type(error).__name__))
        detail = str(getattr(error, "detail", "")) or "".join(traceback.format_exception(error, limit=-4))
        self.faults.append(Fault(seat=seat, kind=kind, tick=tick, detail=detail))
        self.events.append(Event(tick=tick, seat=seat, kind="fault", data={"kind": kind}))
        self._rest(seat, True)
        del self.agents[seat]

    def _trace(self) -> None:
        if self.world.tick % rules.LOG_EVERY_TICKS:
            return
        for seat, path in self.paths.items():
            pose = self.world.pose(seat)
            path.append((round(pose.x * 1000), round(pose.y * 1000), round(pose.yaw * 1000)))
            if seat == HUMAN:
                self.recorder.head(self.world.tick, pose.pitch)


def _checked(action: object) -> Action:
    if not isinstance(action, Action):
        raise TypeError(f"act must return an hthor.types.Action, got {type(action).__name__}")
    return action


class GoalProgress:
    """The share of the goal that is met: ``value``, from 0 to 1, or None for task kinds without partial goals."""

    def __init__(self, kind: TaskKind, task: TaskSpec) -> None:
        counts = type(kind).progress is not TaskKind.progress
        self.value: float | None = 0.0 if counts else None
        self._kind, self._task, self._last = kind, task, round(task.time_limit / rules.TICK_S)
        self._things: Mapping[str, ThingState] | None = None

    def update(self, snapshot: Snapshot, house: HouseSpec, *, met: bool = False, has_events: bool) -> tuple[Event, ...]:
        """The event "progress" if the share changed.

        It is computed when an object changed, once a second, and at the end; not while an object is only carried.

        Args:
            met: whether the goal is met.
            has_events: whether anything happened in this tick.
        """
        changed = snapshot.things is not self._things and (has_events or not any(snapshot.holding.values()))
        due = met or changed or snapshot.tick % _EVERY_TICKS == 0 or snapshot.tick == self._last
        if self.value is None or not due:
            return ()
        self._things = snapshot.things
        share = 1.0 if met else round(min(1.0, max(0.0, float(self._kind.progress(self._task, snapshot, house)))), 4)
        if share == self.value:
            return ()
        self.value = share
        return (Event(tick=snapshot.tick, seat=HUMAN, kind="progress", data={"value": share}),)
