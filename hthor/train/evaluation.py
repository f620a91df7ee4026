"""How well robots find things on pose grids: success, and success weighted by path length (Anderson et al. 2018)."""

from __future__ import annotations

from typing import NamedTuple

import torch
from torch import Tensor

from hthor.agents.skills.savn_network import Network
from hthor.train.grid_worlds import DONE, Episodes, GridWorlds, Zones
from hthor.train.walkers import NetworkWalker, Walker

LONG = 5
"""Episodes of at least so many actions are counted by themselves too, as in the published tables."""
MOST_ACTIONS: dict[Zones, int] = {"rooms": 100, "houses": 200}
"""The longest episodes of an evaluation, as published: 200 actions in living rooms, 100 in other rooms."""


class Results(NamedTuple):
    """What became of each episode, all (B,): found the goal, actions taken, and the least number of them."""

    found: Tensor
    actions: Tensor
    least: Tensor

    @property
    def spl(self) -> Tensor:
        """(B,) success weighted by path length."""
        return self.found * self.least / torch.maximum(self.least, self.actions)

    def summary(self) -> dict[str, float]:
        """Shares of all episodes, and of the long ones."""
        long = self.least >= LONG
        return {
            "success": float(self.found.float().mean()),
            "spl": float(self.spl.mean()),
            "success_long": float(self.found[long].float().mean()),
            "spl_long": float(self.spl[long].mean()),
            "actions": float(self.actions.float().mean()),
        }


def evaluate(walker: Walker, worlds: GridWorlds, episodes: Episodes, most: int) -> Results:
    """Let a walker go through episodes of at most ``most`` actions."""
    pose, goal, least = episodes
    alive = torch.ones(len(pose), device=worlds.device)
    found = torch.zeros(len(pose), dtype=torch.bool, device=worlds.device)
    actions = torch.zeros(len(pose), dtype=torch.long, device=worlds.device)
    for _ in range(most):
        action = walker.act(pose, alive)
        found |= (alive > 0) & (action == DONE) & worlds.found(pose, goal)
        actions += alive.long()
        pose = worlds.go(pose, action)
        alive = alive * (action != DONE)
        if not alive.any():
            break
    return Results(found, actions, least)


def divergence(network: Network, worlds: GridWorlds, episodes: Episodes, generator: torch.Generator) -> float:
    """How far adaptation has moved the policy when it is over, [nats]: the mean over the poses reached until then of
    `AdaptiveRun.divergence`.
    """
    config = network.config
    walker = NetworkWalker(network, worlds, episodes.goal, generator)
    pose, alive = episodes.pose, torch.ones(len(episodes.pose), device=worlds.device)
    for _ in range(config.window * config.updates):
        action = walker.act(pose, alive)
        pose, alive = worlds.go(pose, action), alive * (action != DONE)
    return float(walker.run.divergence(worlds.look(pose, None)).mean())
