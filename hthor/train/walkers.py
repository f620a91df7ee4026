"""Who walks through episodes on pose grids: a network in several variants, chance, and an expert."""

from __future__ import annotations

from typing import NamedTuple, Protocol

import torch
from torch import Tensor

from hthor.agents.skills.savn_network import AdaptiveRun, Network, draw_actions
from hthor.train.bc import expert_action
from hthor.train.grid_worlds import DONE, GridWorlds
from hthor.train.loop import goal_classes


class Walker(Protocol):
    """Walks through a batch of episodes: says the next action of each."""

    def act(self, pose: Tensor, alive: Tensor) -> Tensor:
        """(B,) int64, an action for each pose (B,). alive: (B,) 1 for the episodes that go on."""
        ...


class Aids(NamedTuple):
    """What a network has on its way besides its weights.

    Attributes:
        sight: whether it sees anything; a blind one gets zeros for all cells.
        noise: whether its detector errs, as in training.
        ideal_done: whether "here it is" is said for it, when it is right and only then.
    """

    sight: bool = True
    noise: bool = True
    ideal_done: bool = False


PLAIN = Aids()
"""As in training."""


class NetworkWalker:
    """Acts as a network decides, which adapts on the way if it was made to.

    Attributes:
        run: the network's run.

    Args:
        goal: (B,) what the network looks for. generator: draws actions and the detector's noise.
        explorer: with a map, leads the way whenever no cell is likely to show the goal; the network still says "here
            it is".
    """

    def __init__(
        self,
        network: Network,
        worlds: GridWorlds,
        goal: Tensor,
        generator: torch.Generator,
        aids: Aids = PLAIN,
        explorer: Walker | None = None,
    ) -> None:
        self.run = AdaptiveRun(network, goal_classes(worlds.device)[goal], learning=False)
        self._worlds, self._goal, self._generator, self._aids = worlds, goal, generator, aids
        self._explorer = explorer

    def act(self, pose: Tensor, alive: Tensor) -> Tensor:
        """As `Walker.act`."""
        features = self._worlds.look(pose, self._generator if self._aids.noise else None)
        if not self._aids.sight:
            features = tuple(torch.zeros_like(part) for part in features)
        logits, _ = self.run.step(features, alive)
        if self._aids.ideal_done:
            logits = logits.detach().clone()
            logits[:, DONE] = -torch.inf
        action = draw_actions(logits, self._generator)
        if self._aids.ideal_done:
            action[self._worlds.found(pose, self._goal)] = DONE
        if self._explorer is None:
            return action
        led = (action != DONE) & ~(self.run.network.likelihood(features, self.run.goal) > 0.5).any(1)
        return torch.where(led, self._explorer.act(pose, alive), action)


class RandomWalker:
    """Takes every action with the same probability.

    Args:
        goal: (B,) what makes "here it is" right, if that is said for it; None if it says so at random, too.
    """

    def __init__(self, worlds: GridWorlds, goal: Tensor | None, generator: torch.Generator) -> None:
        self._worlds, self._goal, self._generator = worlds, goal, generator

    def act(self, pose: Tensor, alive: Tensor) -> Tensor:
        """As `Walker.act`."""
        del alive
        choices = DONE + 1 if self._goal is None else DONE
        action = torch.randint(choices, pose.shape, generator=self._generator, device=pose.device)
        return action if self._goal is None else torch.where(self._worlds.found(pose, self._goal), DONE, action)


class ExpertWalker:
    """Goes the shortest way to where the goal (B,) is in view: what no robot can do better."""

    def __init__(self, worlds: GridWorlds, goal: Tensor) -> None:
        self._worlds, self._goal = worlds, goal

    def act(self, pose: Tensor, alive: Tensor) -> Tensor:
        """As `Walker.act`."""
        del alive
        return expert_action(self._worlds, pose, self._goal)
