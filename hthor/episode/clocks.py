"""Decision clocks: when the answer of a robot's agent takes effect.

`LockStep` stops the world while an agent decides. `Charged` does so too, but counts the time that the agent took as
time of the trial, so that its action comes later. `Concurrent` asks every agent in a thread of its own while the world
goes on, and its action takes effect when it arrives. Models of people always answer at once: how long people think is
part of the model.
"""

import queue
import threading
import time
from collections.abc import Callable, Sequence
from typing import Any, Protocol

import msgspec
from msgspec import Struct

from hthor import rules
from hthor.types import Action, Briefing, Mind, Observation, Senses, TrialSpec

_TOLERANCE = 1e-9
"""[ticks] Tolerance, so that 0.1 + 0.1 + 0.1 s counts as 3 ticks."""


class Answer(Struct, frozen=True, kw_only=True):
    """The action that an agent decided on when it saw ``observation``; or the ``error`` that it raised."""

    seat: str
    observation: Observation
    action: Action | None = None
    error: Exception | None = None


class DecisionClock(Protocol):
    """Asks agents for actions, and hands out their answers in the tick in which these take effect.

    ``frozen`` says whether observations must still show their moment when the world has gone on.
    """

    frozen: bool

    def begin(self, seat: str, mind: Mind, briefing: Briefing) -> None:
        """Brief an agent, before time begins to count; raises what the agent raises."""

    def ask(self, seat: str, mind: Mind, observation: Observation) -> None:
        """Ask an agent that is not `busy` for an action."""

    def busy(self, seat: str) -> bool:
        """Whether the seat's agent was asked and its answer was not handed out yet."""

    def answers(self, tick: int) -> Sequence[Answer]:
        """The answers that take effect in this tick, in any order; each is handed out once."""

    def close(self) -> None:
        """End the trial's decisions; answers that are still missing are dropped."""


def make_clock(trial: TrialSpec) -> DecisionClock:
    """The decision clock that a trial names."""
    if trial.clock == "charged":
        return Charged()
    return Concurrent() if trial.clock == "concurrent" else LockStep()


def decide(seat: str, mind: Mind, observation: Observation) -> Answer:
    """Ask an agent now; its error, or that it returned something else than an action, is part of the answer."""
    try:
        action: object = mind.act(observation)
        if not isinstance(action, Action):
            raise TypeError(f"act must return an hthor.types.Action, got {type(action).__name__}")
    except Exception as error:
        return Answer(seat=seat, observation=observation, error=error)
    return Answer(seat=seat, observation=observation, action=action)


class LockStep:
    """The world waits for every agent; deciding takes no time of the trial."""

    frozen = False

    def __init__(self) -> None:
        self._answers: list[Answer] = []

    def begin(self, seat: str, mind: Mind, briefing: Briefing) -> None:  # noqa: ARG002  the same for every seat
        """Brief an agent."""
        mind.begin(briefing)

    def ask(self, seat: str, mind: Mind, observation: Observation) -> None:
        """Ask an agent, and wait for its answer."""
        self._answers.append(decide(seat, mind, observation))

    def busy(self, seat: str) -> bool:  # noqa: ARG002  never
        """No agent is ever late."""
        return False

    def answers(self, tick: int) -> Sequence[Answer]:  # noqa: ARG002  all are due
        """All answers to what was asked in this tick."""
        answers, self._answers = self._answers, []
        return answers

    def close(self) -> None:
        """Nothing is left to end."""


class Charged(LockStep):
    """The world waits for every agent, and the time that it took counts: its action comes as many ticks later.

    The time is measured while the agent decides, without the time that its sensors take. It adds up: an agent that
    thinks for a third of a tick each time is one tick late every third time, so that nothing is rounded away.

    Args:
        clock: the time [s], by default of this process's monotonic clock.
    """

    def __init__(self, clock: Callable[[], float] = time.perf_counter) -> None:
        super().__init__()
        self._clock = clock
        self._owed: dict[str, float] = {}
        self._late: dict[str, tuple[int, Answer]] = {}

    def ask(self, seat: str, mind: Mind, observation: Observation) -> None:
        """Ask an agent, and measure how long it takes."""
        senses = TimedSenses(observation.senses, self._clock)
        began = self._clock()
        answer = decide(seat, mind, msgspec.structs.replace(observation, senses=senses))
        spent = self._clock() - began - senses.spent
        self._owed[seat] = self._owed.get(seat, 0.0) + max(0.0, spent)
        due = observation.tick if answer.error is not None else observation.tick + self._ticks_owed(seat)
        self._late[seat] = (due, answer)

    def busy(self, seat: str) -> bool:
        """Whether the seat's last action is still held back."""
        return seat in self._late

    def answers(self, tick: int) -> Sequence[Answer]:
        """The answers whose time is over."""
        due = [answer for until, answer in self._late.values() if until <= tick]
        for answer in due:
            del self._late[answer.seat]
        return due

    def _ticks_owed(self, seat: str) -> int:
        """How many whole ticks late the seat's answer is; what is left of a tick is kept for the next answer."""
        ticks = int(self._owed[seat] / rules.TICK_S + _TOLERANCE)
        self._owed[seat] -= ticks * rules.TICK_S
        return ticks


class TimedSenses:
    """A body's sensors, with the time that reading them took: ``spent`` [s]."""

    def __init__(self, senses: Senses, clock: Callable[[], float]) -> None:
        self._senses, self._clock, self.spent = senses, clock, 0.0

    def __getattr__(self, name: str) -> Callable[..., Any]:
        return self.timed(name)

    def timed(self, name: str) -> Callable[..., Any]:
        """The sensor of this name; reading it adds to the time spent."""
        sensor = getattr(self._senses, name)

        def read(*arguments: Any) -> Any:
            began = self._clock()
            try:
                return sensor(*arguments)
            finally:
                self.spent += self._clock() - began

        return read


class RealTime:
    """Lets a tick of the trial last `rules.TICK_S` of wall-clock time.

    Attributes:
        late: how many ticks ended after their time, because the world or a person's model took longer.
    """

    def __init__(
        self, clock: Callable[[], float] = time.monotonic, sleep: Callable[[float], None] = time.sleep
    ) -> None:
        self._clock, self._sleep = clock, sleep
        self._began: float | None = None
        self.late = 0

    def __call__(self, tick: int) -> None:
        """Wait until the time of this tick is over."""
        now = self._clock()
        if self._began is None:
            self._began = now - tick * rules.TICK_S
        left = self._began + (tick + 1) * rules.TICK_S - now
        if left > 0.0:
            self._sleep(left)
        else:
            self.late += 1
            self._began -= left  # what was lost is not caught up in a rush


class Concurrent:
    """The world goes on while agents decide, each in a thread of its own; an answer takes effect when it arrives.

    Args:
        pace: called with the tick before its answers are handed out; returns when its time is over.
    """

    frozen = True

    def __init__(self, pace: Callable[[int], None] | None = None) -> None:
        self._pace = pace if pace is not None else RealTime()
        self._landed: queue.SimpleQueue[Answer] = queue.SimpleQueue()
        self._workers: dict[str, _Worker] = {}
        self._minds: dict[str, Mind] = {}
        self._asked: set[str] = set()

    def begin(self, seat: str, mind: Mind, briefing: Briefing) -> None:
        """Brief an agent in its thread, and wait until it is ready."""
        self._workers[seat] = worker = _Worker(seat, self._landed)
        self._minds[seat] = mind
        worker.call(lambda: mind.begin(briefing))

    def ask(self, seat: str, mind: Mind, observation: Observation) -> None:
        """Ask an agent in its thread."""
        self._asked.add(seat)
        self._workers[seat].ask(mind, observation)

    def busy(self, seat: str) -> bool:
        """Whether the agent is still deciding."""
        return seat in self._asked

    def answers(self, tick: int) -> Sequence[Answer]:
        """The answers that have come by the end of this tick."""
        self._pace(tick)
        answers = []
        while not self._landed.empty():
            answers.append(self._landed.get())
        self._asked.difference_update(answer.seat for answer in answers)
        return answers

    def settle(self) -> None:
        """Wait until every agent that was asked has decided."""
        for worker in self._workers.values():
            worker.call(lambda: None)

    def close(self) -> None:
        """End the agents' threads. An agent that is still deciding is told to finish if it can be, or waited for."""
        for seat in sorted(self._asked):
            if (finish := getattr(self._minds[seat], "finish", None)) is not None:
                finish()
        for worker in self._workers.values():
            worker.end()
        self._workers.clear()
        self._asked.clear()


class _Worker:
    """The thread in which one seat's agent decides."""

    def __init__(self, seat: str, landed: "queue.SimpleQueue[Answer]") -> None:
        self._seat, self._landed = seat, landed
        self._jobs: queue.SimpleQueue[Callable[[], None] | None] = queue.SimpleQueue()
        self._thread = threading.Thread(target=self._run, name=f"agent of {seat}", daemon=True)
        self._thread.start()

    def ask(self, mind: Mind, observation: Observation) -> None:
        """Let the agent decide; the answer lands in the queue."""
        self._jobs.put(lambda: self._landed.put(decide(self._seat, mind, observation)))

    def call(self, job: Callable[[], None]) -> None:
        """Do something in the thread and wait until it is done; raises what it raises."""
        done: queue.SimpleQueue[Exception | None] = queue.SimpleQueue()

        def run() -> None:
            try:
                job()
            except Exception as error:
                done.put(error)
            else:
                done.put(None)

        self._jobs.put(run)
        if (error := done.get()) is not None:
            raise error

    def end(self) -> None:
        """End the thread, after what it still has to do."""
        self._jobs.put(None)
        self._thread.join()

    def _run(self) -> None:
        while (job := self._jobs.get()) is not None:
            job()
