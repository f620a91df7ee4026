"""People who are not simulated but drawn by a formula, as fast as statistics need them."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from hthor import seeds
from hthor.calibration.simulation import design_points, simulate, trial_table
from hthor.calibration.simulation.trial_table import Table
from hthor.calibration.targets import CONDITIONS
from hthor.humans.population import parameter_registry
from hthor.trials.sessions import assign_tasks

NAMES = parameter_registry.free_parameter_names()
V, LAM, A0 = (NAMES.index(name) for name in ("v_pace", "lam0", "a0"))


def trials(where: np.ndarray, condition: np.ndarray, task: np.ndarray, chance: np.random.Generator) -> dict:
    """Outcomes of trials at points (N, P)."""
    logit = 3.0 * where[:, V] + 1.5 * where[:, LAM] - 2.6 + np.array([0.6, 1.0, 2.4])[condition]
    met = chance.random(len(where)) < 1.0 / (1.0 + np.exp(-logit - 0.8 * np.sin(task)))
    ticks = np.where(met, np.clip(chance.normal(650 - 350 * where[:, V], 120), 60, 899).astype(int), 900)
    told = chance.random(len(where)) < np.array([0.0, 0.7, 0.98])[condition]
    adopted = told & (chance.random(len(where)) < 1.0 / (1.0 + np.exp(-3.0 * where[:, A0] - 0.2)))
    sent = np.where(told, chance.integers(20, 400, len(where)), -1)
    return {
        "met": met,
        "ticks": ticks,
        "sent": sent,
        "shown": np.where(told, sent + 1, -1),
        "accepted": np.where(adopted, sent + 40, -1),
        "declined": np.where(told & ~adopted, sent + 40, -1),
        "picked": np.where(met, ticks - 50, -1),
        "messages": told.astype(int),
        "adopted": adopted,
        "trust": np.where(condition > 0, chance.integers(2, 7, len(where)), 0),
    }


def sessions(where, suite, seed, folder, jobs, watch, name) -> Table:
    """In place of `simulate.simulate_sessions`."""
    spots = design_points.round_points(where)
    rows = np.repeat(np.arange(len(spots)), 10)
    return _table(spots, suite, seed, name, np.full(len(rows), -1), rows, rows, (rows + rows // 3) % 3, rows)


def whole(where, suite, seed, folder, jobs, watch, name, design) -> Table:
    """In place of `simulate.simulate_studies`."""
    spots = design_points.round_points(where)
    people = design.people * len(CONDITIONS)
    study = np.repeat(np.arange(len(spots)), people * 10)
    person = np.tile(np.repeat(np.arange(people), 10), len(spots))
    made = _table(spots, suite, seed, name, study, person, study, person // design.people, person)
    valid, counted = simulate.select_counted(made, seed, name, design)
    columns = {column: getattr(made, column) for column in trial_table.COLUMNS}
    return trial_table.build_table(NAMES, spots, {**columns, "valid": valid, "counted": counted})


def _table(spots, suite, seed, name, study, number, point, condition, person) -> Table:
    chance = np.random.Generator(np.random.Philox(seeds.derive(seed, "fake", name)))
    dealt = {one: assign_tasks(suite.tasks, seed, one) for one in np.unique(person).tolist()}
    index = np.tile(np.arange(10), len(point) // 10)
    task = np.array([dealt[one][place] for one, place in zip(person.tolist(), index.tolist(), strict=True)])
    columns = {
        "study": study,
        "session": number,
        "point": point,
        "condition": condition,
        "participant": person,
        "index": index,
        "task": task,
        "valid": np.ones(len(point), bool),
        "counted": condition > 0,
        **trials(spots[point], condition, task, chance),
    }
    return trial_table.build_table(NAMES, spots, columns)


def nowhere(folder: Path) -> Path:
    """A folder that is not there yet."""
    return folder / "calibration"
