"""Records of an evaluation as a table of trials, so that people and calibrations are measured alike; plays nothing."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hthor import rules
from hthor.calibration.simulation import trial_table as tables
from hthor.calibration.simulation.trial_table import CONDITIONS, Table
from hthor.eval.records.trial_record import TrialRecord
from hthor.tasks import Suite
from hthor.types import HUMAN

_FIRST = ("sent", "shown", "confirmed", "declined", "picked")


def table(runs: dict[str, Sequence[TrialRecord]], suite: Suite) -> Table:
    """The trials of one human model in every condition.

    Args:
        runs: records by condition.
    """
    numbers = {task.id: number for number, task in enumerate(suite.tasks)}
    rows = [
        _row(CONDITIONS.index(condition), numbers, record)
        for condition in CONDITIONS
        for record in runs.get(condition, ())
    ]
    columns = {name: [row[name] for row in rows] for name in tables.TRIAL}
    return tables.build(("none",), np.zeros((1, 1)), columns)


def _row(condition: int, numbers: dict[str, int], record: TrialRecord) -> dict[str, int]:
    first = dict.fromkeys(_FIRST, -1)
    messages, target = 0, record.spec.task.goal.target
    for event in record.events:
        messages += event.kind == "sent"
        if event.kind in first and first[event.kind] < 0 and (event.kind != "picked" or _took(event, target)):
            first[event.kind] = event.tick
    return {
        **first,
        "study": -1,
        "session": condition * 100_000 + record.spec.participant,
        "point": 0,
        "condition": condition,
        "participant": record.spec.participant,
        "index": record.spec.index,
        "task": numbers[record.spec.task.id],
        "met": int(record.met),
        "ticks": record.ticks if record.met else round(record.spec.task.time_limit / rules.TICK_S),
        "messages": messages,
        "adopted": int(bool(record.metrics["adoption"])),
        "trust": record.trust or 0 if record.spec.robots else 0,
        "valid": 1,
        "counted": int(bool(record.spec.robots)),
    }


def _took(event: object, target: str) -> bool:
    return getattr(event, "seat", "") == HUMAN and getattr(event, "data", {}).get("object") == target
