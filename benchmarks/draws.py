"""What it is worth to draw people's chances by event: `python -m benchmarks.draws FOLDER`.

Plays robots with the proxy at the first tasks of a suite, in three ways. Keyed: as hthor does it, each chance of a
person drawn by what it is for. Other: the same people at the same tasks, with other chances in the trial. Sequential:
one stream of random numbers a trial, the same for all robots, drawn in the order in which the person needs them.

Then it prints for each two robots how many times fewer trials a comparison takes: the variance of a trial's
difference in the one design over that in the other, with intervals from drawing the people anew.
"""

from __future__ import annotations

import argparse
import contextlib
import itertools
import random
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from unittest import mock

import msgspec
import numpy as np

from hthor import jsonio, seeds
from hthor.agents import frontier, oracle
from hthor.episode import play
from hthor.eval.metrics import trial_metrics
from hthor.humans.communication import message_reading
from hthor.humans.core import trial_context
from hthor.humans.population.participant import Participant
from hthor.tasks.suites import library
from hthor.trials import TrialRunner, sessions
from hthor.types import Action, Mind, Observation

LATE_TICKS = 50
METRICS = ("sr", "twsr", "time_s")
WAYS = ("keyed", "other", "sequential")
BOOTSTRAP = 1000
PAIRS = {
    "unpaired > keyed": ("unpaired", "keyed"),
    "unpaired > other": ("unpaired", "other"),
    "other > keyed": ("other", "keyed"),
    "sequential > keyed": ("sequential", "keyed"),
}


class Late(frontier.Agent):
    """The frontier robot, which stands still for the first five seconds: a robot that differs little."""

    def act(self, observation: Observation) -> Action:
        """Wait, then go on as usual."""
        return Action() if observation.tick < LATE_TICKS else super().act(observation)


AGENTS: dict[str, tuple[str, type[Mind] | None]] = {
    "none": ("none", None),
    "frontier": ("frontier", frontier.Agent),
    "late": ("frontier", Late),
    "oracle": ("oracle", oracle.Agent),
}
"""Minds, and whose privileges they have."""


def played(agent: str, way: str, suite: str, people: int) -> dict[str, list[float]]:
    """Each metric of each trial, and who did it."""
    found: dict[str, list[float]] = {name: [] for name in ("person", *METRICS)}
    (name, make), stage = AGENTS[agent], TrialRunner()
    hands = sessions.make_sessions(library.load_suite(suite), agent=name)[:people]
    with drawing(way):
        for hand in hands:
            human, minds = stage.enter(hand).human, {} if make is None else {"robot": make()}
            for trial in hand.trials:
                log = play(trial, stage.world(trial), {"human": human}, minds)
                measured = trial_metrics.measure(trial, log)
                found["person"].append(trial.session)
                for metric in METRICS:
                    found[metric].append(getattr(measured, metric))
    return found


@contextlib.contextmanager
def drawing(way: str) -> Iterator[None]:
    """People draw their chances in this way."""
    streams: dict[int, random.Random] = {}
    drawn: dict[tuple[object, ...], float] = {}

    def stream(root: int) -> random.Random:
        return streams.setdefault(root, random.Random(root))

    def once(root: int, names: tuple[object, ...], make: Callable[[random.Random], float]) -> float:
        """What was drawn when it was first needed; people ask for some of their chances again and again."""
        if (root, *names) not in drawn:
            drawn[root, *names] = make(stream(root))
        return drawn[root, *names]

    def draw(root: int, *names: object) -> float:
        return once(root, names, lambda chance: min(max(chance.random(), 1e-12), 1.0 - 1e-12))

    def normal(root: int, *names: object) -> float:
        return once(root, ("normal", *names), lambda chance: chance.gauss(0.0, 1.0))

    with contextlib.ExitStack() as held:
        if way == "other":
            other = lambda self, index: seeds.derive(self.root, "another trial", index)  # noqa: E731
            held.enter_context(mock.patch.object(Participant, "trial", other))
        if way == "sequential":
            chances = SimpleNamespace(draw=draw, normal=normal)
            held.enter_context(mock.patch.object(trial_context, "seeds", chances))
            held.enter_context(mock.patch.object(message_reading, "seeds", chances))
        yield


def variances(one: dict[str, np.ndarray], other: dict[str, np.ndarray]) -> dict[str, float]:
    """Of one trial's difference, by design; ``one`` and ``other`` have the values by way."""
    mixed = [(one["keyed"] - other["other"]).var(), (one["other"] - other["keyed"]).var()]
    return {
        "unpaired": one["keyed"].var() + other["keyed"].var(),
        "other": float(np.mean(mixed)),
        "sequential": (one["sequential"] - other["sequential"]).var(),
        "keyed": (one["keyed"] - other["keyed"]).var(),
    }


def main() -> None:
    """Play what is missing, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, help="where the values are kept; a second call only prints")
    parser.add_argument("--suite", default="standard")
    parser.add_argument("--people", type=int, default=60, help="the first so many, ten tasks each")
    parser.add_argument("--only", default="", metavar="AGENT/WAY", help="play this and print nothing")
    wanted = parser.parse_args()
    values = {}
    for agent, way in itertools.product(AGENTS, WAYS):
        if wanted.only in ("", f"{agent}/{way}"):
            file = wanted.folder / f"{wanted.suite}-{wanted.people}-{agent}-{way}.json"
            if not file.is_file():
                jsonio.write(file, jsonio.pretty(played(agent, way, wanted.suite, wanted.people)))
            values[agent, way] = {name: np.array(held) for name, held in msgspec.json.decode(file.read_bytes()).items()}
    if not wanted.only:
        put(values)


def put(values: dict[tuple[str, str], dict[str, np.ndarray]]) -> None:
    """Print the table."""
    print(f"{'robots':16} metric  difference " + " ".join(f"{name:>21}" for name in PAIRS))
    for first, second in itertools.combinations(AGENTS, 2):
        people = values[first, "keyed"]["person"].astype(int)
        chance, members = np.random.default_rng(5), [np.flatnonzero(people == who) for who in range(people.max() + 1)]
        drawn = [
            np.concatenate([members[who] for who in chance.integers(0, len(members), len(members))])
            for _ in range(BOOTSTRAP)
        ]
        for metric in METRICS:
            one, other = ({way: values[agent, way][metric] for way in WAYS} for agent in (first, second))
            here = variances(one, other)
            again = [
                variances(*({way: row[picked] for way, row in some.items()} for some in (one, other)))
                for picked in drawn
            ]
            cells = []
            for above, below in PAIRS.values():
                ratios = [some[above] / max(some[below], 1e-12) for some in again]
                low, high = np.quantile(ratios, [0.025, 0.975])
                cells.append(f"{here[above] / max(here[below], 1e-12):6.2f} ({low:5.2f} to {high:5.2f})")
            gap = float((other["keyed"] - one["keyed"]).mean())
            print(f"{first + ' ' + second:16} {metric:6} {gap:+9.3f}   " + " ".join(cells))


if __name__ == "__main__":
    main()
