"""The robots that a comparison tries: networks, the same in variants, and robots without any."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import NamedTuple

import torch
from torch import Tensor

from hthor import seeds
from hthor.agents.skills.savn_network import without_adaptation
from hthor.agents.skills.semantic_cells import GOALS
from hthor.train.grid_worlds import Episodes, GridWorlds
from hthor.train.groups import Group
from hthor.train.map_walker import Kind, MapWalker
from hthor.train.walkers import PLAIN, Aids, ExpertWalker, NetworkWalker, RandomWalker, Walker

_MAPPED: tuple[Kind, ...] = ("frontier", "nearest")


class Robot(NamedTuple):
    """A robot to be tried.

    Attributes:
        name: as in tables. group: of its checkpoints, "" if it has none. walkers: one for each checkpoint, not yet
            made, as some take much memory.
    """

    name: str
    group: str
    walkers: list[Callable[[], Walker]]


def robots(worlds: GridWorlds, episodes: Episodes, groups: Sequence[Group], *, variants: bool) -> Iterator[Robot]:
    """Every robot, for a list of episodes.

    Args:
        variants: whether also to try robots without networks, and the first group in variants.
    """
    goal = episodes.goal
    chance = torch.Generator().manual_seed(seeds.derive(0, "walk", "goals"))
    another = (goal + torch.randint(1, len(GOALS), goal.shape, generator=chance)) % len(GOALS)

    def robot(
        name: str,
        group: Group,
        aids: Aids = PLAIN,
        *,
        wanted: Tensor = goal,
        mapped: bool = False,
        adapts: bool = True,
    ) -> Robot:
        def walker(index: int) -> Walker:
            explorer = MapWalker(worlds, None, "nearest") if mapped else None
            network = group.networks[index] if adapts else without_adaptation(group.networks[index])
            return NetworkWalker(network, worlds, wanted, _generator(index), aids, explorer)

        return Robot(name, group.name, [partial(walker, index) for index in range(len(group.networks))])

    first = groups[0]
    if variants:
        yield Robot("random", "", [lambda: RandomWalker(worlds, None, _generator(0))])
        yield Robot("random with ideal Done", "", [lambda: RandomWalker(worlds, goal, _generator(0))])
        yield robot(f"{first.name}, blind", first, Aids(sight=False))
        yield robot(f"{first.name}, another goal", first, wanted=another)
    for group in reversed(groups[1:]):
        yield robot(group.name, group)
    if first.networks[0].config.updates:
        yield robot(f"{first.name}, not adapted", first, adapts=False)
    yield robot(first.name, first)
    if variants:
        if first.networks[0].config.profile == "slim":  # the other reads pictures, which do not err
            yield robot(f"{first.name}, ideal detector", first, Aids(noise=False))
        yield robot(f"{first.name}, ideal Done", first, Aids(ideal_done=True))
        yield robot(f"{first.name}, with a map", first, mapped=True)
        for kind in _MAPPED:
            yield Robot(kind, "", [partial(MapWalker, worlds, goal, kind)])
        yield Robot("oracle", "", [lambda: ExpertWalker(worlds, goal)])


def _generator(index: int) -> torch.Generator:
    """The draws of a walk, the same for every robot."""
    return torch.Generator().manual_seed(seeds.derive(0, "walk", index))
