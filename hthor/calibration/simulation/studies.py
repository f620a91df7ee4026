"""Whole simulated studies of the published design, each of people from one population.

A study has as many people in each condition as the published one, assigned their tasks as `hthor eval` assigns them,
and loses as many trials, drawn at random.
"""

from pathlib import Path

import numpy as np

from hthor import seeds
from hthor.calibration.simulation import design_points, simulate, trial_identity
from hthor.calibration.simulation.simulate import SessionBatch
from hthor.calibration.simulation.trial_table import Table
from hthor.calibration.targets import CONDITIONS, Design
from hthor.eval.runner.progress import Watcher
from hthor.tasks import Suite


def simulate_studies(
    points: np.ndarray, suite: Suite, seed: int, folder: Path, jobs: int, watch: Watcher, name: str, design: Design
) -> Table:
    """A study at each point; arguments as of `simulate.simulate_sessions`, study number s has people from row s.

    Args:
        design: of the published study.
    """
    points, identity = design_points.round_points(points), trial_identity.trials_identity(suite)
    specs = []
    for study, point in enumerate(points.tolist()):
        own_seed = study_seed(seed, name, study)
        for participant in range(design.people * len(CONDITIONS)):
            condition = participant // design.people
            spec = simulate.make_session_spec(suite, identity, own_seed, participant, point, condition)
            specs.append((study, participant, study, spec))
    batch = SessionBatch(suite=suite, identity=identity, points=points, sessions=tuple(specs))
    outcomes = simulate.run_missing(batch, folder, jobs, watch)
    valid, counted = select_counted(simulate.make_table(batch, outcomes), seed, name, design)
    return simulate.make_table(batch, outcomes, valid=valid, counted=counted)


def study_seed(seed: int, name: str, study: int) -> int:
    """The seed of one study: of its people, their tasks and all its chances."""
    return seeds.derive(seed, "calibration", name, study)


def select_counted(table: Table, seed: int, name: str, design: Design) -> tuple[np.ndarray, np.ndarray]:
    """Which trials count in success and in adoption rates: as many in each group as in the published study."""
    valid, counted = np.zeros(len(table), bool), np.zeros(len(table), bool)
    group = table.study.astype(np.int64) * len(CONDITIONS) + table.condition
    for number in range(len(table.points) * len(CONDITIONS)):
        study, condition = divmod(number, len(CONDITIONS))
        rows, label = np.flatnonzero(group == number), CONDITIONS[condition]
        mixed = rows[seeds.shuffled(len(rows), study_seed(seed, name, study), "kept", label)]
        valid[mixed[: design.valid.get(label, len(rows))]] = True
        counted[mixed[: design.counted.get(label, 0)]] = True
    return valid, counted
