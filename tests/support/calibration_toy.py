"""People whose rates are known exactly: success, time, adoption and trust by formula, alike in a person and a task."""

from __future__ import annotations

import numpy as np
from msgspec import Struct

from hthor import seeds
from hthor.calibration.emulator.emulator import Rates
from hthor.calibration.simulation import trial_table
from hthor.calibration.simulation.trial_table import Table
from hthor.calibration.targets import CONDITIONS
from hthor.humans.population import parameter_registry

NAMES = parameter_registry.free_parameter_names()
V, LAM, A0, HAND = (NAMES.index(name) for name in ("v_pace", "lam0", "a0", "t_manip"))
TASKS = 30
LEAST = np.full(TASKS, 25.0)
"""T* [s]."""
_TASK = np.random.Generator(np.random.Philox(5)).normal(0.0, 0.7, TASKS)
_PERSON, _WILL, _RATIO = 0.7, 0.9, 0.15
_VALID, _COUNTED = (58, 59, 58), (0, 50, 50)


def chance_of(where: np.ndarray, condition: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Logit of success, mean ratio before it is cut, and logit of adoption, of the mean person at a point."""
    v, lam, a, hand = (where[:, k] for k in (V, LAM, A0, HAND))
    help_ = np.array([0.0, 0.8, 2.4])[condition]
    logit = -1.6 + help_ + 3.0 * v + np.array([1.8, 1.4, 0.6])[condition] * lam - 1.0 * hand
    return logit, 0.45 + 0.4 * v - 0.1 * hand, np.array([-30.0, -1.3, 0.4])[condition] + 2.5 * a + 0.5 * lam


def _tables() -> tuple[np.ndarray, ...]:
    """Rates by logit of the mean person, and ratio and its square by the ratio before it is cut: means over people."""
    normal = np.linspace(-4.0, 4.0, 161)
    mass = np.exp(-0.5 * normal**2) / np.exp(-0.5 * normal**2).sum()
    logit, middle = np.linspace(-30.0, 12.0, 1681), np.linspace(0.2, 1.0, 321)
    able = (1.0 / (1.0 + np.exp(-logit[:, None, None] - _PERSON * normal[:, None] - _TASK))).mean(axis=2) @ mass
    keen = (1.0 / (1.0 + np.exp(-logit[:, None] - _WILL * normal))) @ mass
    ratio = np.clip(middle[:, None] + _RATIO * normal, 0.3, 1.0)
    return logit, able, keen, middle, ratio @ mass, ratio**2 @ mass


_LOGIT, _ABLE, _KEEN, _MIDDLE, _FIRST, _SECOND = _tables()


def exact(where: np.ndarray) -> Rates:
    """The true rates at points (N, P)."""
    columns: dict[str, list[np.ndarray]] = {name: [] for name in Rates.__struct_fields__}
    for place in range(len(CONDITIONS)):
        logit, middle, will = chance_of(where, np.full(len(where), place))
        ratio = np.interp(middle, _MIDDLE, _FIRST)
        columns["sr"].append(np.interp(logit, _LOGIT, _ABLE))
        columns["ratio"].append(ratio)
        columns["ratio_sd"].append(np.sqrt(np.interp(middle, _MIDDLE, _SECOND) - ratio**2))
        columns["adoption"].append(np.interp(will, _LOGIT, _KEEN))
        for name in ("sr_se", "ratio_se", "adoption_se"):
            columns[name].append(np.zeros(len(where)))
    return Rates(**{name: np.stack(parts, axis=1) for name, parts in columns.items()})


class Exact(Struct, frozen=True):
    """In place of an emulator: never wrong."""

    names: tuple[str, ...] = NAMES

    def rates(self, where: np.ndarray) -> Rates:
        return exact(where)


def points(count: int, seed: int) -> np.ndarray:
    chance = np.random.Generator(np.random.Philox(seeds.derive(seed, "points")))
    return chance.uniform(1e-3, 1.0 - 1e-3, (count, len(NAMES)))


def sessions(where: np.ndarray, seed: int) -> Table:
    """One session at each point, conditions in turn."""
    rows = np.arange(len(where))
    return _played(where, np.full(len(rows), -1), rows, rows % 3, seed)


def studies(where: np.ndarray, seed: int) -> Table:
    """A whole study at each point: six people in each condition, who do all tasks twice."""
    rows = np.repeat(np.arange(len(where)), 18)
    return _played(where, rows, rows, np.tile(np.repeat(np.arange(3), 6), len(where)), seed)


def _played(where: np.ndarray, study: np.ndarray, point: np.ndarray, condition: np.ndarray, seed: int) -> Table:
    chance = np.random.Generator(np.random.Philox(seeds.derive(seed, "play")))
    people = len(point)
    rows, index = np.repeat(np.arange(people), 10), np.tile(np.arange(10), people)
    decks = [chance.permutation(TASKS) for _ in range(-(-people // 3))]
    task = np.concatenate(decks)[: people * 10]
    logit, mean, will = chance_of(where[point][rows], condition[rows])
    able, keen = (chance.standard_normal(people)[rows] for _ in range(2))
    met = chance.random(len(rows)) < 1.0 / (1.0 + np.exp(-logit - _PERSON * able - _TASK[task]))
    ratio = np.clip(mean + _RATIO * chance.standard_normal(len(rows)), 0.3, 1.0)
    ticks = np.where(met, np.round(10.0 * np.where(ratio < 1.0, LEAST[task] / ratio, 20.0)), 900).astype(int)
    adopted = chance.random(len(rows)) < 1.0 / (1.0 + np.exp(-will - _WILL * keen))
    rise = np.array([0.0, 0.0, 0.1])[condition[rows]] * index
    trust = np.clip(np.round(3.5 + rise + 0.8 * keen + 0.6 * chance.standard_normal(len(rows))), 1, 7)
    valid, counted = np.ones(len(rows), bool), condition[rows] > 0
    for number in np.unique(study[study >= 0]):
        for place in range(3):
            mine = np.flatnonzero((study[rows] == number) & (condition[rows] == place))
            valid[mine[_VALID[place] :]] = False
            counted[mine[_COUNTED[place] :]] = False
    columns = {
        "study": study[rows],
        "session": rows,
        "point": point[rows],
        "condition": condition[rows],
        "participant": rows,
        "index": index,
        "task": task,
        "met": met,
        "ticks": ticks,
        "sent": np.where(condition[rows] > 0, 50, -1),
        "shown": np.where(condition[rows] > 0, 51, -1),
        "accepted": np.where(adopted, 90, -1),
        "declined": np.where(adopted, -1, 90),
        "picked": np.where(met, ticks // 2, -1),
        "messages": (condition[rows] > 0).astype(int),
        "adopted": adopted,
        "trust": np.where(condition[rows] > 0, trust, 0),
        "valid": valid,
        "counted": counted,
    }
    return trial_table.build_table(NAMES, where, columns)
