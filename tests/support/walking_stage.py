"""A world without an engine whose bodies walk, can be copied, and look at their own moment; and agents by chance."""

from __future__ import annotations

import pickle
from typing import Any

import msgspec
from episode_fakes import TASK, Mind, Stage, trial

from hthor import seeds
from hthor.episode import Episode
from hthor.types import HUMAN, Action, Drive, Motion, Move, Observation, Outcome, Pose, Reply, Send, Snapshot, Wait
from hthor.types.events import Blocked, Event

SEATS = (HUMAN, "human2", "robot", "robot2")
TICK_S = 0.1


class Moment:
    """Sensors that show ``tick``: of the moment at which they were made if frozen, else of the world."""

    def __init__(self, stage: WalkingStage, *, frozen: bool) -> None:
        self._stage, self._tick = stage, stage.tick if frozen else None

    def rgb(self) -> int:
        return self._stage.tick if self._tick is None else self._tick


class WalkingStage(Stage):
    """Bodies walk along x; a body in another's place is in its way; the target comes into view at 3 m."""

    def __init__(self, seats: tuple[str, ...] = SEATS) -> None:
        super().__init__(seats)

    def reset(self, task: Any, seed: int = 0) -> None:
        self.tick = 0
        self.x = {seat: 10.0 * number for number, seat in enumerate(self.seats)}
        self.motion: dict[str, tuple[Motion, int] | None] = dict.fromkeys(self.seats)
        self.drives: dict[str, Drive] = {}
        self.last: dict[str, Outcome | None] = dict.fromkeys(self.seats)

    def idle(self, seat: str) -> bool:
        return self.motion[seat] is None

    def start(self, seat: str, motion: Motion) -> None:
        if isinstance(motion, Drive):
            self.drives[seat] = motion
            return
        self.drives.pop(seat, None)
        ticks = max(1, round(motion.seconds / TICK_S)) if isinstance(motion, Wait) else 3
        self.motion[seat] = (motion, ticks)

    def advance(self) -> tuple[Event, ...]:
        self.tick += 1
        events = []
        for seat in self.seats:
            if seat in self.drives and self.motion[seat] is None:
                self.x[seat] += self.drives[seat].forward * TICK_S
            if (now := self.motion[seat]) is None:
                continue
            motion, left = now
            if isinstance(motion, Move):
                self.x[seat] += motion.forward / 3
            self.motion[seat] = (motion, left - 1) if left > 1 else None
            if left == 1:
                self.last[seat] = Outcome(motion="move", ok=True)
                events.append(Blocked(tick=self.tick, seat=seat, by="wall"))
        return tuple(events)

    def outcome(self, seat: str) -> Outcome | None:
        return self.last[seat]

    def pose(self, seat: str) -> Pose:
        return Pose(x=self.x[seat], y=0.0)

    def senses(self, seat: str) -> Any:
        return Moment(self, frozen=False)

    def frozen_senses(self, seat: str) -> Any:
        return Moment(self, frozen=True)

    def snapshot(self) -> Snapshot:
        found = (self.truth()[0].id,) if self.x[HUMAN] > 3.0 else ()
        holding = dict.fromkeys(self.seats, "")
        return Snapshot(tick=self.tick, poses={}, things=self.things, in_view={HUMAN: found}, holding=holding)

    def save_state(self) -> bytes:
        return pickle.dumps((self.tick, self.x, self.motion, self.drives, self.last))

    def load_state(self, state: bytes) -> None:
        self.tick, self.x, self.motion, self.drives, self.last = pickle.loads(state)


class Chancy(Mind):
    """Does what chance says, by seat and tick, so that a copy of it does the same; answers what it is asked."""

    def __init__(self, seat: str, root: int) -> None:
        super().__init__(self.decide)
        self.seat, self.root = seat, root
        self.shown: list[tuple[int, int]] = []

    def decide(self, now: Observation) -> Action:
        self.shown.append((now.tick, now.senses.rgb()))  # type: ignore[arg-type]
        draw = seeds.draw(self.root, self.seat, now.tick)
        motions: list[Motion] = [
            Wait(seconds=0.5),
            Move(forward=0.3),
            Move(forward=-0.3),
            Drive(forward=0.8, yaw=0.3),
            Drive(),
        ]
        motion = motions[int(draw * len(motions))]
        chance = seeds.draw(self.root, "say", self.seat, now.tick)
        person = self.seat.startswith(HUMAN)
        question = next((message for message in now.inbox if message.question), None)
        if person and now.inbox and chance < 0.5:
            return Action(motion=motion, say=Reply(message=now.inbox[-1].id, accept=chance < 0.3))
        if not person and question is not None and chance < 0.5:
            return Action(motion=motion, say=Send(text="there", object="apple", answers=question.id))
        if chance < 0.1:
            to = "robot" if person and chance < 0.05 else ""
            return Action(motion=motion, say=Send(text=f"{self.seat} {now.tick}", question=person, to=to))
        return Action(motion=motion)


def minds(root: int) -> tuple[dict[str, Chancy], dict[str, Chancy]]:
    """People and robots, by seat."""
    both = {seat: Chancy(seat, root) for seat in SEATS}
    people = {seat: mind for seat, mind in both.items() if seat.startswith(HUMAN)}
    return people, {seat: mind for seat, mind in both.items() if seat not in people}


def begun() -> Episode:
    """An episode of twelve seconds at its beginning."""
    spec = msgspec.structs.replace(trial(), task=msgspec.structs.replace(TASK, time_limit=12.0))
    episode = Episode(spec, WalkingStage())  # type: ignore[arg-type]
    episode.reset()
    return episode
