"""Records of an evaluation as a table of trials, so that evaluations and calibrations are measured alike."""

from collections.abc import Sequence

import numpy as np

from hthor.calibration.simulation import trial_table
from hthor.calibration.simulation.session_simulation import OUTCOMES, outcome_row
from hthor.calibration.simulation.trial_table import Table
from hthor.calibration.targets import CONDITIONS
from hthor.eval.records.trial_record import TrialRecord
from hthor.tasks import Suite


def records_table(runs: dict[str, Sequence[TrialRecord]], suite: Suite) -> Table:
    """The trials of one human model in every condition.

    Args:
        runs: records by condition.
    """
    numbers = {task.id: number for number, task in enumerate(suite.tasks)}
    rows = [_row(condition, numbers, record) for condition in CONDITIONS for record in runs.get(condition, ())]
    columns = {name: [row[name] for row in rows] for name in trial_table.COLUMNS}
    return trial_table.build_table(("none",), np.zeros((1, 1)), columns)


def _row(condition: str, numbers: dict[str, int], record: TrialRecord) -> dict[str, int]:
    spec, number = record.spec, CONDITIONS.index(condition)
    outcomes = dict(zip(OUTCOMES, outcome_row(numbers[spec.task.id], spec, record.log), strict=True))
    return {
        **outcomes,
        "study": -1,
        "session": number * 100_000 + spec.participant,
        "point": 0,
        "condition": number,
        "participant": spec.participant,
        "index": spec.index,
        "trust": outcomes["trust"] if spec.robots else 0,
        "valid": 1,
        "counted": int(bool(spec.robots)),
    }
