"""Sessions with real guests, umpire and records in a world without an engine, where trials cost next to nothing."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import episode_fakes
import eval_fakes as fakes
import msgspec

from hthor import guest
from hthor.episode import play
from hthor.eval.runner.messages import TrialOutcome
from hthor.trials import Participants
from hthor.trials.sessions import Session
from hthor.types import HUMAN, RobotSeat, Snapshot, TaskSpec

AGENT = """
from hthor.types import Action, Send


class Agent:
    def begin(self, briefing):
        self.acts = 0

    def act(self, observation):
        self.acts += 1
        if self.acts % 7 == 0:
            return Action(say=Send(text=f"act {self.acts} at {observation.tick}", object="apple", position=(1, 2, 3)))
        return Action()
"""
"""Says how often it acted, so that a record tells of every act."""


class Stage(episode_fakes.Stage):
    """All objects of the task come into view at tick ``seen``."""

    def reset(self, task: TaskSpec, seed: int = 0) -> None:
        super().reset(task, seed)
        self.objects = tuple(placed.id for placed in task.objects)

    def snapshot(self) -> Snapshot:
        view = self.objects if self.tick >= self.seen else ()
        return Snapshot(tick=self.tick, poses={}, things=self.things, in_view={HUMAN: view}, holding={HUMAN: ""})


def player(agent: str, level: str) -> Callable[[Session], Iterator[TrialOutcome]]:
    """Plays sessions of some dozen ticks a trial with the agent of this file, held at this level."""

    def mind(_: RobotSeat) -> guest.Guest:
        return guest.Guest(agent, config=guest.GuestConfig(isolation=level))

    def perform(session: Session) -> Iterator[TrialOutcome]:
        with Participants({HUMAN: episode_fakes.Mind()}, session.trials[0].robots, mind) as company:
            for memory, trial in enumerate(session.trials):
                task = msgspec.structs.replace(trial.task, kind="object_goal_navigation")
                stage = Stage(seen=fakes.episode(trial, memory).ticks // 10)
                log = play(msgspec.structs.replace(trial, task=task), stage, company.humans, company.ready_agents())
                for seat in dict.fromkeys(fault.seat for fault in log.faults):
                    company.dismiss(seat)
                yield fakes.outcome(trial, log)

    return perform


def write(folder: Path) -> Path:
    """The agent's file, in a folder of its own."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "counting.py"
    path.write_text(AGENT)
    return path
