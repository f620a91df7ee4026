"""Which task each trial of an entry is of, worked out from the suite and the seed; reads no log."""

from __future__ import annotations

from hthor.eval.config import sessions
from hthor.leaderboard.entries.entry import Entry
from hthor.tasks.suite import Suite
from hthor.types import TaskSpec


def tasks(suite: Suite, entry: Entry) -> list[TaskSpec]:
    """The task of each trial, in the order in which an entry holds its trials."""
    hands = sessions.assign_many(suite.tasks, entry.run.seed, range(entry.run.participants))
    return [suite.tasks[number] for hand in hands for number in hand]
