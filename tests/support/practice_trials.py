"""Runs whose trials take place in the room of the practice, which is built and drawn in no time."""

from __future__ import annotations

import msgspec
import pytest

from hthor.eval.runner.run_job import RunJob
from hthor.live.practice_room import practice_trial
from hthor.trials.sessions import Session
from hthor.types import HUMAN, Goal, TrialSpec


def play_in_practice_room(monkeypatch: pytest.MonkeyPatch, seconds: float, goal: Goal | None = None) -> None:
    """Move all trials of runs there, and give each so much time [s], and another goal than the practice's."""
    whole = RunJob.sessions.fget  # type: ignore[attr-defined]

    def moved(trial: TrialSpec) -> TrialSpec:
        room = practice_trial(trial, (HUMAN,)).task
        return msgspec.structs.replace(
            trial, task=msgspec.structs.replace(room, time_limit=seconds, goal=goal or room.goal)
        )

    def sessions(run: RunJob) -> tuple[Session, ...]:
        return tuple(msgspec.structs.replace(one, trials=tuple(map(moved, one.trials))) for one in whole(run))

    monkeypatch.setattr(RunJob, "sessions", property(sessions))
