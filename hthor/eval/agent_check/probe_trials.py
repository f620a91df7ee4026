"""Runs short real trials with one submitted agent and records what it did, saw and spent."""

import math
import time
from collections.abc import Sequence

import msgspec
from msgspec import Struct

from hthor import activity, rules, tasks
from hthor.episode import EpisodeLog, Fault
from hthor.episode.clocks import TimedSenses as Timed
from hthor.eval.records import scored_trial, trial_record
from hthor.guest import Guest
from hthor.guest.process_tools import resource_usage
from hthor.trials import Participants, Session, TrialRunner, make_session, robot_team
from hthor.trials.participants import RecordedAgent
from hthor.trials.robot_team import AgentInfo
from hthor.types import Action, Briefing, Detection, Observation, Send, TrialSpec, Wait
from hthor.types.cameras import OWN
from hthor.types.events import Accepted, Declined, Sent

_TASKS = ("smoke/alder/manipulation-01", "smoke/elder/manipulation-02")
_LIMIT_S = 30.0
_LOOK_EVERY = 16
_SPOT_M = 0.25
"""A robot that stays within this distance [m] is on one spot, turning or not."""


class ProbeResult(Struct, frozen=True, kw_only=True):
    """The result of one trial.

    Attributes:
        line: the record as a line of a run's log.
        asked: how often the agent was asked to act. actions: its actions, each with the tick of the request.
        thought_s: the duration [s] of each ``act``, without its pictures and scans; ``begin_s`` that of ``begin``.
        memory_mb: the largest memory use that was measured; 0 for an agent that runs elsewhere.
        lasted_s: the duration of the trial [s] in simulated time.
        motions, refused: how many motions the agent chose, and how many of them failed.
        spot_s: the longest time [s] that the robot stayed on one spot before the person accepted a message.
        sent, covered, repeated: how many messages the agent sent, how many of them its next message covered, and how
            many repeated the message before although the person had not declined it.
        claims, unseen: how many messages were about an object, and how many of them about an undetected object.
        output: the end of what the agent printed.
    """

    line: bytes
    faults: tuple[Fault, ...]
    asked: int
    actions: tuple[tuple[int, Action], ...]
    thought_s: tuple[float, ...]
    begin_s: float
    memory_mb: float
    lasted_s: float
    motions: int
    refused: int
    spot_s: float
    sent: int
    covered: int
    repeated: int
    claims: int
    unseen: int
    output: str


class ProbeTrials:
    """Two short trials, A and B, for one agent, which can be played repeatedly.

    Args:
        character: the agent, from a file.
        robot: the agent's body. camera: its camera, as `hthor.types.cameras.canonical_name` spells it.
    """

    def __init__(self, character: AgentInfo, robot: str, camera: str = OWN) -> None:
        self._runner = TrialRunner()
        crew = robot_team.form_team([robot], [character], camera=camera)
        known = {task.id: task for task in tasks.load_suite("smoke").tasks}
        short = [msgspec.structs.replace(known[name], time_limit=_LIMIT_S) for name in _TASKS]
        self.a, self.b = make_session(short, agent=crew).trials

    def play(self, guest: Guest, trials: Sequence[TrialSpec]) -> list[ProbeResult]:
        """Play trials one after the other with the same guest, each with a person who does not remember the others."""
        found = []
        for number, trial in enumerate(trials, 1):
            activity.say(f"playing short trial {number} of {len(trials)}")
            found.append(self._play(guest, trial))
        return found

    def _play(self, guest: Guest, trial: TrialSpec) -> ProbeResult:
        noted, seat = _Noted(guest), trial.robots[0].seat
        humans = self._runner.enter(Session(number=trial.session, trials=(trial,))).humans
        log = self._runner.run(Participants(humans, trial.robots, lambda _: noted), trial).log
        done = [(look.tick, action) for look, action in noted.looks if action is not None]
        says = [(action.say, seen) for (_, action), seen in zip(done, noted.seen, strict=False)]
        about = [(say.object, seen) for say, seen in says if isinstance(say, Send) and say.object]
        ended = [look.outcome for look, _ in noted.looks if look.idle and look.outcome is not None]
        kept = scored_trial.score(trial_record.make_record(trial, log))
        return ProbeResult(
            line=trial_record.encode(kept),
            faults=log.faults,
            asked=len(noted.looks),
            actions=tuple(done),
            thought_s=tuple(noted.thought_s),
            begin_s=noted.begin_s,
            memory_mb=noted.memory_mb,
            lasted_s=log.ticks * rules.TICK_S,
            motions=sum(not isinstance(action.motion, Wait) for _, action in done),
            refused=sum(not outcome.ok for outcome in ended),
            spot_s=longest_on_one_spot_s(log, seat),
            sent=int(kept.metrics["sent"] or 0),
            covered=int(kept.metrics["covered"] or 0),
            repeated=count_repeated_messages(log, seat),
            claims=len(about),
            unseen=0 if noted.looked else sum(name not in seen for name, seen in about),
            output=noted.output,
        )


class _Senses(Timed):
    """Records what an agent has detected, and whether it looked at pictures, in which it may have seen more."""

    ids: tuple[str, ...] = ()
    looked = False

    def detections(self) -> tuple[Detection, ...]:
        found: tuple[Detection, ...] = self.timed("detections")()
        self.ids = tuple(one.id for one in found)
        return found

    def rgb(self) -> object:
        self.looked = True
        return self.timed("rgb")()


class _Noted(RecordedAgent):
    """A guest whose time and memory are measured."""

    def __init__(self, guest: Guest) -> None:
        super().__init__(guest, last=None)
        self.thought_s: list[float] = []
        self.seen: list[frozenset[str]] = []
        self.begin_s = self.memory_mb = 0.0
        self.looked = False
        self._known: frozenset[str] = frozenset()

    def begin(self, briefing: Briefing) -> None:
        began = time.perf_counter()
        try:
            super().begin(briefing)
        finally:
            self.begin_s = time.perf_counter() - began

    def act(self, observation: Observation) -> Action:
        senses = _Senses(observation.senses, time.perf_counter)
        began = time.perf_counter()
        action = super().act(msgspec.structs.replace(observation, senses=senses))
        self.thought_s.append(time.perf_counter() - began - senses.spent)
        self._known |= frozenset(senses.ids)
        self.seen.append(self._known)
        self.looked = self.looked or senses.looked
        if len(self.seen) % _LOOK_EVERY == 1 and (pid := self.mind.pid):
            self.memory_mb = max(self.memory_mb, resource_usage.resident_mb(pid))
        return action


def longest_on_one_spot_s(log: EpisodeLog, seat: str) -> float:
    """The longest time [s] that a seat stayed on one spot, up to the first accepted message of any robot.

    After that it may wait for a good reason: the person knows where to go.
    """
    until = min((event.tick for event in log.events if isinstance(event, Accepted)), default=log.ticks)
    step = rules.LOG_EVERY_TICKS
    points = [(x / 1000.0, y / 1000.0) for x, y, _ in log.paths[seat][: until // step + 1]]
    longest = start = 0
    for number, point in enumerate(points):
        if math.dist(point, points[start]) > _SPOT_M:
            start = number
        longest = max(longest, number - start)
    return longest * step * rules.TICK_S


def count_repeated_messages(log: EpisodeLog, seat: str) -> int:
    """How many messages of a seat repeat its message before, although the person had not declined that message."""
    count, last = 0, None
    for event in log.events:
        if isinstance(event, Sent) and event.seat == seat:
            said = event.text, event.object
            count += said == last
            last = said
        elif isinstance(event, Declined):
            last = None
    return count
