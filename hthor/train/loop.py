"""Trainings of networks that act: their configuration, the network before it, and batches of episodes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Protocol, TypeVar

import torch
from msgspec import Struct, structs
from torch import Tensor, nn

from hthor import seeds
from hthor.agents.skills import picture_encoder, savn_checkpoint
from hthor.agents.skills.savn_checkpoint import Checkpoint
from hthor.agents.skills.savn_network import AdaptiveRun, Network, NetworkConfig
from hthor.agents.skills.semantic_cells import CLASSES, GOALS
from hthor.errors import HthorError
from hthor.train.grid_worlds import DONE, GridWorlds
from hthor.train.optimization import Report, Schedule, optimize
from hthor.train.training_state import TrainingState
from hthor.train.words import word_vectors


class LoopConfig(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What every training depends on.

    Attributes:
        network: sizes of the network, and how it adapts. seed: of the first weights and of every draw.
        frames: actions to train on. batch: episodes at once. horizon: actions of an episode in training.
        learning_rate: of Adam; falls evenly to a tenth. clip: largest norm of a gradient.
        done_bias: added to the first weights, so that untrained networks seldom say "here it is".
        close: share of the episodes that begin near their goal, where there is most to learn at first.
    """

    network: NetworkConfig = NetworkConfig()
    seed: int = 0
    frames: int = 10_000_000
    batch: int = 64
    horizon: int = 40
    learning_rate: float = 1e-3
    clip: float = 10.0
    done_bias: float = -3.0
    close: float = 0.5


_Config = TypeVar("_Config", bound=LoopConfig, contravariant=True)


class Learner(Protocol[_Config]):
    """Plays a batch of episodes and says what is to be made smaller."""

    def __call__(
        self, network: Network, worlds: GridWorlds, config: _Config, generator: torch.Generator
    ) -> tuple[Tensor, int, dict[str, float]]:
        """The loss, the number of actions in the batch, and what was measured."""
        ...


def make_network(config: LoopConfig, begin: Checkpoint | None = None, encoder: bytes | None = None) -> Network:
    """A network before training.

    Args:
        begin: a checkpoint to start with instead of random weights. encoder: weights of the encoder of pictures for the
            profile "paper", see `hthor.agents.skills.picture_encoder.dump`; random ones if None.

    Raises:
        HthorError: when the checkpoint or the encoder is of another size.
    """
    torch.manual_seed(seeds.check_seed(config.seed))
    network = Network(structs.replace(config.network, classes=len(CLASSES)))
    with torch.no_grad():
        network.words.copy_(torch.from_numpy(word_vectors(CLASSES)))
        hidden = config.network.hidden
        network.gates.bias[hidden : 2 * hidden] += 1.0  # so that it remembers at first
        network.actor.bias[DONE] += config.done_bias
    if encoder is not None:
        _copy(network.encoder, picture_encoder.load(encoder), "the encoder of pictures")
    if begin is not None:
        _copy(network, begin.network, "the checkpoint to begin with")
    return network


def _copy(network: nn.Module, other: nn.Module, shown: str) -> None:
    try:
        network.load_state_dict(other.state_dict())
    except RuntimeError as error:
        first = str(error).strip().splitlines()[-1].strip()
        raise HthorError(f"{shown} has other sizes than this network: {first}") from None


def goal_classes(device: torch.device) -> Tensor:
    """(goals,) int64, the class of each goal."""
    return torch.tensor([CLASSES.index(name) for name in GOALS], device=device)


def leave_out_ended(run: AdaptiveRun, alive: Tensor, step: int) -> Tensor | None:
    """Leave the episodes that have ended out of a run, so that they cost no more time; only after a whole window.

    Args:
        alive: (B,) 1 for episodes that go on. step: how many actions they have taken.

    Returns:
        (K,) int64, the numbers of the episodes that are left; None if all are.
    """
    if not step or step % run.network.config.window or alive.all():
        return None
    left = torch.nonzero(alive).squeeze(1)
    run.keep(left)
    return left


def train(
    learner: Learner[_Config],
    config: _Config,
    network: Network,
    worlds: Sequence[GridWorlds],
    folder: Path,
    report: Report,
    *,
    stops: Callable[[], bool] = lambda: False,
    every: int = 500_000,
) -> bool:
    """Train a network, going on from where a training in the same folder stopped.

    Args:
        network: before training. worlds: the batches come from each of them in turn. folder: of the checkpoint and the
            training's state. report, stops: see `hthor.train.optimization.optimize`.
        every: actions between two reports of means.

    Returns:
        Whether it has come to its end; the state is kept either way.

    Raises:
        HthorError: when the state in the folder is damaged, or of another network. FloatingPointError: when the loss is
            not finite.
    """
    device = worlds[0].device
    network.to(device)
    optimizer = torch.optim.Adam(network.parameters(), lr=config.learning_rate, amsgrad=True)
    generator = torch.Generator(device).manual_seed(config.seed)
    return optimize(
        TrainingState(network=network, optimizer=optimizer, generator=generator),
        lambda number: learner(network, worlds[number % len(worlds)], config, generator),
        Schedule(frames=config.frames, every=every, learning_rate=config.learning_rate, clip=config.clip),
        folder,
        report=report,
        save=lambda: savn_checkpoint.save(folder, Checkpoint(network=network, classes=CLASSES)),
        stops=stops,
    )
