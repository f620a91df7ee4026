"""Trains a network to do what an expert does who knows the shortest path (behaviour cloning).

Some episodes follow the expert's actions, the others the network's own, for which the expert says what would have been
right (Ross et al. 2011); so the network also learns what to do where the expert never gets to.
"""

from __future__ import annotations

import torch
from torch import Tensor
from torch.nn import functional as F  # noqa: N812

from hthor.agents.skills.savn_network import AdaptiveRun, Network, draw_actions
from hthor.train.grid_worlds import DONE, GridWorlds
from hthor.train.loop import LoopConfig, goal_classes, leave_out_ended


class Config(LoopConfig, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What a training by an expert depends on.

    Attributes:
        expert: share of the episodes that follow the expert.
    """

    expert: float = 0.5


def expert_action(worlds: GridWorlds, pose: Tensor, goal: Tensor) -> Tensor:
    """(B,) the first action of a shortest path from each pose to where its goal is in view."""
    ahead = torch.stack([worlds.length[worlds.next[pose, action], goal] for action in range(DONE)], 1)
    return torch.where(worlds.found(pose, goal), DONE, ahead.argmin(1))


def learn(
    network: Network, worlds: GridWorlds, config: Config, generator: torch.Generator
) -> tuple[Tensor, int, dict[str, float]]:
    """As `hthor.train.loop.Learner`: the cross-entropy of the expert's actions."""
    pose, goal, _ = worlds.draw(config.batch, generator, config.close)
    run = AdaptiveRun(network, goal_classes(worlds.device)[goal], learning=True)
    alive = torch.ones(config.batch, device=worlds.device)
    led = torch.rand(config.batch, generator=generator, device=worlds.device) < config.expert
    losses, right, lived = [], alive.new_zeros(()), alive.new_zeros(())
    for step in range(config.horizon):
        left = leave_out_ended(run, alive, step)
        if left is not None:
            pose, goal, alive, led = pose[left], goal[left], alive[left], led[left]
            if not len(left):
                break
        logits, _ = run.step(worlds.look(pose, generator), alive)
        best = expert_action(worlds, pose, goal)
        losses.append((F.cross_entropy(logits, best, reduction="none") * alive).sum())
        own = draw_actions(logits, generator)
        right, lived = right + ((own == best) * alive).sum(), lived + alive.sum()
        action = torch.where(led, best, own)
        pose, alive = worlds.go(pose, action), alive * ~((action == DONE) & (best == DONE))
    loss = torch.stack(losses).sum() / lived
    return loss, int(lived), {"agreement": float(right / lived)}
