"""Compares checkpoints with controls on the same episodes, in houses that are new to them and in those of training."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
import torch
from msgspec import Struct
from numpy.typing import NDArray

from hthor import jsonio, seeds
from hthor.train import evaluation
from hthor.train.controls import Robot, robots
from hthor.train.grid_pictures import load_grids
from hthor.train.grid_worlds import BOTH, Episodes, GridWorlds, Zones
from hthor.train.groups import Group, find_encoder
from hthor.train.houses import Split
from hthor.train.resampling import Rating, Sums, add_up, difference, rate
from hthor.train.walkers import Walker
from hthor.train.watcher import Watcher

SCHEMA = "hthor.navigation/1"
NEW: Split = "test"
KNOWN: Split = "train"
"""The splits of houses that are new to a network, and that it was trained in."""


class Setup(Struct, frozen=True, kw_only=True):
    """What a comparison is made in.

    Attributes:
        houses: how many of each split, with one arrangement of objects each. episodes: in each of them.
        zones: whether in single rooms, whole houses or both. jobs: processes that build grids, None for one a
            processor.
    """

    houses: int = 24
    episodes: int = 25
    zones: tuple[Zones, ...] = BOTH
    jobs: int | None = None


class Row(Struct, frozen=True, kw_only=True):
    """How well one robot did.

    Attributes:
        zones, split: where. robot: its name. checkpoints: how many it is the mean of; 1 if it has no network.
        success: share of the episodes. spl: success weighted by path length. success_long, spl_long: of episodes of at
            least five actions. actions: per episode.
    """

    zones: Zones
    split: Split
    robot: str
    checkpoints: int
    success: Rating
    spl: Rating
    success_long: Rating
    spl_long: Rating
    actions: float


class Difference(Struct, frozen=True, kw_only=True):
    """How much better ``robot`` did than ``other`` on the same episodes, in new houses."""

    zones: Zones
    robot: str
    other: str
    success: Rating
    spl: Rating


class Comparison(Struct, frozen=True, kw_only=True):
    """What came out, as in the file that `hthor train eval --out` writes.

    Attributes:
        houses: how many houses of each split had room for their objects. episodes: in each of them.
        lists: a hash of each list of episodes. checkpoints: of each group, the hashes of the weights.
        divergence: [nats] how far adaptation had moved the policy of the first group when it was over, by zones.
    """

    schema: str
    houses: dict[str, int]
    episodes: int
    lists: dict[str, str]
    checkpoints: dict[str, tuple[str, ...]]
    rows: tuple[Row, ...]
    differences: tuple[Difference, ...]
    divergence: dict[str, float]


class Arena(NamedTuple):
    """A list of episodes; ``house`` (E,) is the number of the house that each is in."""

    zones: Zones
    split: Split
    worlds: GridWorlds
    episodes: Episodes
    house: NDArray[np.int64]


def make_arena(worlds: GridWorlds, zones: Zones, split: Split, episodes: int) -> Arena:
    """So many episodes in each house. They depend on nothing but their number, the split, the zones and the house."""
    houses = worlds.house.unique().tolist()
    lists = [
        worlds.draw(
            episodes,
            torch.Generator().manual_seed(seeds.derive(0, "navigation", split, zones, house)),
            house=house,
        )
        for house in houses
    ]
    whole = Episodes(*(torch.cat(column) for column in zip(*lists, strict=True)))
    return Arena(zones, split, worlds, whole, np.repeat(houses, episodes))


def compare(groups: Sequence[Group], setup: Setup, watcher: Watcher) -> Comparison:
    """Let all robots go through the same episodes, on one processor core.

    Args:
        groups: networks. The first ones are also tried in variants, and compared with all others.

    Raises:
        HthorError: when no house has room for its objects, or some networks read labels and others pictures.
    """
    torch.set_num_threads(1)  # more threads wait for each other longer than they compute
    arenas: list[Arena] = []
    houses: dict[str, int] = {}
    encoder = find_encoder(groups)
    for split in (NEW, KNOWN):
        grids = load_grids(
            split,
            setup.houses,
            1,
            encoder=encoder,
            jobs=setup.jobs,
            building=watcher.building,
            drawing=watcher.drawing,
        )
        houses[split] = len(grids)
        arenas += [make_arena(GridWorlds(grids, zones), zones, split, setup.episodes) for zones in setup.zones]
    tried = [list(robots(arena.worlds, arena.episodes, groups, variants=arena.split == NEW)) for arena in arenas]
    total = sum(len(robot.walkers) for some in tried for robot in some)
    done = itertools.count(1)

    def walk(arena: Arena, walker: Walker) -> evaluation.Results:
        found = evaluation.evaluate(walker, arena.worlds, arena.episodes, evaluation.MOST_ACTIONS[arena.zones])
        watcher.walking(next(done), total)
        return found

    rows: list[Row] = []
    differences: list[Difference] = []
    for arena, some in zip(arenas, tried, strict=True):
        outcomes = [_outcome(arena, robot, [walk(arena, make()) for make in robot.walkers]) for robot in some]
        rows += [_row(arena, outcome) for outcome in outcomes]
        if arena.split == NEW:
            differences += _differences(arena, outcomes, groups[0].name)
    return Comparison(
        schema=SCHEMA,
        houses=houses,
        episodes=setup.episodes,
        lists={f"{arena.split} {arena.zones}": _sha256(arena.episodes) for arena in arenas},
        checkpoints={group.name: group.hashes for group in groups},
        rows=tuple(sorted(rows, key=lambda row: setup.zones.index(row.zones))),
        differences=tuple(differences),
        divergence={arena.zones: _divergence(arena, groups[0]) for arena in arenas if arena.split == NEW},
    )


class _Outcome(NamedTuple):
    """What became of a robot: sums of each measure, of all episodes and of the long ones, and the mean of actions."""

    robot: Robot
    success: Sums
    spl: Sums
    success_long: Sums
    spl_long: Sums
    actions: float


def _outcome(arena: Arena, robot: Robot, results: Sequence[evaluation.Results]) -> _Outcome:
    found, spl, actions = (
        torch.stack(column).double().numpy()
        for column in zip(*((one.found, one.spl, one.actions) for one in results), strict=True)
    )
    long = arena.episodes.least.numpy() >= evaluation.LONG
    every = np.ones_like(long)
    return _Outcome(
        robot=robot,
        success=add_up(found, every, arena.house),
        spl=add_up(spl, every, arena.house),
        success_long=add_up(found, long, arena.house),
        spl_long=add_up(spl, long, arena.house),
        actions=float(actions.mean()),
    )


def _row(arena: Arena, outcome: _Outcome) -> Row:
    group = outcome.robot.group
    return Row(
        zones=arena.zones,
        split=arena.split,
        robot=outcome.robot.name,
        checkpoints=len(outcome.robot.walkers),
        success=rate(outcome.success, group),
        spl=rate(outcome.spl, group),
        success_long=rate(outcome.success_long, group),
        spl_long=rate(outcome.spl_long, group),
        actions=round(outcome.actions, 2),
    )


def _differences(arena: Arena, outcomes: Sequence[_Outcome], name: str) -> Iterator[Difference]:
    """How much better the robot of this name did than each other."""
    one = next(outcome for outcome in outcomes if outcome.robot.name == name)
    for other in outcomes:
        if other is not one:
            names = (one.robot.group, other.robot.group)
            yield Difference(
                zones=arena.zones,
                robot=name,
                other=other.robot.name,
                success=difference(one.success, other.success, names),
                spl=difference(one.spl, other.spl, names),
            )


def _divergence(arena: Arena, group: Group) -> float:
    """The mean over a group's networks, 0 if they do not adapt."""
    found = [
        evaluation.divergence(network, arena.worlds, arena.episodes, torch.Generator().manual_seed(1))
        for network in group.networks
        if network.config.updates
    ]
    return round(sum(found) / len(found), 6) if found else 0.0


def _sha256(episodes: Episodes) -> str:
    return jsonio.sha256([column.tolist() for column in episodes])
