"""Whole simulated studies of the published design, each of people from one population.

A study has as many people in each condition as the published one, dealt their tasks as `hthor eval` deals them, and
loses as many trials: which ones is drawn by name.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from hthor import seeds
from hthor.calibration.simulation import design_points, simulate, trial_identity
from hthor.calibration.simulation.simulate import Plan
from hthor.calibration.simulation.trial_table import CONDITIONS, Table
from hthor.calibration.targets import Design
from hthor.eval.runner.progress import Watcher
from hthor.tasks import Suite


def at(
    where: np.ndarray, suite: Suite, seed: int, folder: Path, jobs: int, watch: Watcher, name: str, design: Design
) -> Table:
    """A study at each point.

    Args:
        where: (S, P) points of the prior's unit cube; study number s is of people from row s.
        folder: where played sessions are kept; a later call plays only what is missing.
        name: of these studies; its people and chances are its own.
        design: of the published study.

    Raises:
        RunError: when the folder holds sessions of another world or person.
        Interrupted: on Ctrl-C or SIGTERM.
    """
    spots, known = design_points.tidy(where), trial_identity.trials_identity(suite)
    dealt = []
    for study, point in enumerate(spots.tolist()):
        own = root(seed, name, study)
        for person in range(design.people * len(CONDITIONS)):
            sitting = simulate.place(suite, known, own, person, point, person // design.people)
            dealt.append((study, person, study, sitting))
    plan = Plan(suite=suite, identity=known, points=spots, sittings=tuple(dealt))
    sats = simulate.perform(plan, folder, jobs, watch)
    whole = simulate.tabulate(plan, sats)
    valid, counted = kept(whole, seed, name, design)
    return simulate.tabulate(plan, sats, valid=valid, counted=counted)


def root(seed: int, name: str, study: int) -> int:
    """The seed of one study: of its people, their tasks and what befalls them."""
    return seeds.derive(seed, "calibration", name, study)


def kept(whole: Table, seed: int, name: str, design: Design) -> tuple[np.ndarray, np.ndarray]:
    """Which trials count in success and in adoption rates: as many in each group as in the published study."""
    valid, counted = np.zeros(len(whole), bool), np.zeros(len(whole), bool)
    group = whole.study.astype(np.int64) * len(CONDITIONS) + whole.condition
    for number in range(len(whole.points) * len(CONDITIONS)):
        study, condition = divmod(number, len(CONDITIONS))
        rows, called = np.flatnonzero(group == number), CONDITIONS[condition]
        mixed = rows[seeds.shuffled(len(rows), root(seed, name, study), "kept", called)]
        valid[mixed[: design.valid.get(called, len(rows))]] = True
        counted[mixed[: design.counted.get(called, 0)]] = True
    return valid, counted
