"""How well robots find things on pose grids: success, and success weighted by path length (Anderson et al. 2018)."""

from __future__ import annotations

from typing import NamedTuple, Protocol

import torch
from torch import Tensor

from hthor.agents.skills.savn_network import AdaptiveRun, Network, draw_actions
from hthor.train.grid_worlds import DONE, Episodes, GridWorlds
from hthor.train.loop import goal_classes

LONG = 5
"""Episodes of at least so many actions are counted by themselves too, as in the published tables."""


class Walker(Protocol):
    """Walks through a batch of episodes: says the next action of each."""

    def act(self, pose: Tensor, alive: Tensor) -> Tensor:
        """(B,) int64, an action for each pose (B,). alive: (B,) 1 for the episodes that go on."""
        ...


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


class NetworkWalker:
    """Acts as a network decides, which adapts on the way if it was made to.

    Attributes:
        run: the network's run.
    """

    def __init__(
        self, network: Network, worlds: GridWorlds, goal: Tensor, generator: torch.Generator, *, noisy: bool = True
    ) -> None:
        """``generator`` draws actions and, if ``noisy``, the detector's noise."""
        self.run = AdaptiveRun(network, goal_classes(worlds.device)[goal], learning=False)
        self.worlds, self.generator, self.noisy = worlds, generator, noisy

    def act(self, pose: Tensor, alive: Tensor) -> Tensor:
        """As `Walker.act`."""
        logits, _ = self.run.step(self.worlds.look(pose, self.generator if self.noisy else None), alive)
        return draw_actions(logits, self.generator)


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
