"""Trains SAVN, and with ``updates=0`` the actor-critic without adaptation (A2C), on pose grids.

A batch of episodes runs in lock-step. After ``horizon`` actions the network moves down the gradient of the actor-critic
loss (Mnih et al. 2016), with advantages by Schulman et al. (2016). The gradient goes through the adaptations, so that
it also teaches the weights that an episode starts with, and the learned loss (Wortsman et al. 2019). Unlike the
published training, which many processes did without waiting for each other, this one gives the same weights again.
"""

from __future__ import annotations

from typing import NamedTuple

import torch
from torch import Tensor

from hthor.agents.skills.savn_network import AdaptiveRun, Network, draw_actions
from hthor.train.grid_worlds import DONE, GridWorlds
from hthor.train.loop import LoopConfig, goal_classes, leave_out_ended


class Config(LoopConfig, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What a training of SAVN depends on.

    Attributes:
        gamma: discount of an action. trace: of the advantages. entropy, critic: weights of these parts of the loss.
        found, step: rewards of a right "here it is" and of each action, as published.
        nearer: reward of each action by which the goal comes nearer, 0 as published.
        wrong: reward of a wrong "here it is", 0 as published. wrong_ends: whether it ends an episode in training, as
            published; if it does, networks first learn to say it at once.
    """

    gamma: float = 0.99
    trace: float = 0.95
    entropy: float = 0.01
    critic: float = 0.25
    found: float = 5.0
    step: float = -0.01
    nearer: float = 0.1
    wrong: float = -0.25
    wrong_ends: bool = False


class Rollout(NamedTuple):
    """What happened in a batch of episodes, each (steps, B); what came after an episode's end does not count.

    Attributes:
        chosen: log of the probability of the action taken. entropy: of the policy. value: by the critic.
        reward: of the action. alive: 1 until the episode has ended. after: (B,) value of what followed the last action.
        found: (B,) bool, whether the episode ended with success.
    """

    chosen: Tensor
    entropy: Tensor
    value: Tensor
    reward: Tensor
    alive: Tensor
    after: Tensor
    found: Tensor


def play(network: Network, worlds: GridWorlds, config: Config, generator: torch.Generator) -> Rollout:
    """Episodes of at most ``horizon`` actions with a network that learns from them."""
    pose, goal, _ = worlds.draw(config.batch, generator, config.close)
    run = AdaptiveRun(network, goal_classes(worlds.device)[goal], learning=True)
    alive = torch.ones(config.batch, device=worlds.device)
    found = torch.zeros(config.batch, dtype=torch.bool, device=worlds.device)
    lane = torch.arange(config.batch, device=worlds.device)  # the episode of each row of what follows
    columns: list[tuple[Tensor, ...]] = []
    for step in range(config.horizon):
        left = leave_out_ended(run, alive, step)
        if left is not None:
            pose, goal, alive, lane = pose[left], goal[left], alive[left], lane[left]
            if not len(left):
                break
        logits, value = run.step(worlds.look(pose, generator), alive)
        log = logits.log_softmax(1)
        chance = log.exp()
        action = draw_actions(logits, generator)
        moved = worlds.go(pose, action)
        done = action == DONE
        right = done & worlds.found(pose, goal)
        nearer = (worlds.length[pose, goal] - worlds.length[moved, goal]).float()
        reward = config.step + config.nearer * nearer + torch.where(right, config.found, config.wrong) * done
        chosen = log.gather(1, action.unsqueeze(1)).squeeze(1)
        rows = (chosen, -(chance * log).sum(1), value, reward * alive, alive)
        columns.append(tuple(row.new_zeros(config.batch).index_copy(0, lane, row) for row in rows))
        found[lane] |= right & (alive > 0)
        alive, pose = alive * ~(done if config.wrong_ends else right), moved
    after = torch.zeros(config.batch, device=worlds.device)
    if len(lane):
        with torch.no_grad():
            _, value, _ = network(worlds.look(pose, generator), run.goal, run.memory, run.fast)
        after[lane] = value * alive
    chosen, entropy, values, rewards, lived = (torch.stack(column) for column in zip(*columns, strict=True))
    return Rollout(chosen, entropy, values, rewards, lived, after, found)


def loss_of(rollout: Rollout, config: Config) -> Tensor:
    """The actor-critic loss of a batch, per episode."""
    value, alive = rollout.value.detach(), rollout.alive
    following = torch.cat((value[1:] * alive[1:], rollout.after.unsqueeze(0)))
    surprise = (rollout.reward + config.gamma * following - value) * alive
    advantage, ahead = torch.empty_like(surprise), torch.zeros_like(rollout.after)
    for step in reversed(range(len(surprise))):
        ahead = surprise[step] + config.gamma * config.trace * ahead
        advantage[step] = ahead = ahead * alive[step]
    actor = -(rollout.chosen * advantage * alive).sum()
    critic = ((rollout.value - value - advantage).square() * alive).sum()
    entropy = (rollout.entropy * alive).sum()
    return (actor + config.critic * critic - config.entropy * entropy) / alive.shape[1]


def learn(
    network: Network, worlds: GridWorlds, config: Config, generator: torch.Generator
) -> tuple[Tensor, int, dict[str, float]]:
    """As `hthor.train.loop.Learner`."""
    rollout = play(network, worlds, config, generator)
    lived = float(rollout.alive.sum())
    measured = {
        "success": float(rollout.found.float().mean()),
        "reward": float(rollout.reward.sum()) / config.batch,
        "entropy": float((rollout.entropy.detach() * rollout.alive).sum()) / lived,
    }
    return loss_of(rollout, config), int(lived), measured
