"""One training from beginning to end: grids, training with validation as it goes, and the files that it leaves.

The folder holds the checkpoint (`config.json`, `model.safetensors`), what it was made from (`train_config.json`), a row
for each validation (`metrics.jsonl`, and the same for TensorBoard), and the state to go on from.
"""

from __future__ import annotations

import functools
import hashlib
from pathlib import Path
from typing import Any, Literal

import msgspec
import torch
from msgspec import Struct

from hthor.agents.skills import picture_encoder, savn_checkpoint
from hthor.agents.skills.savn_checkpoint import Checkpoint
from hthor.agents.skills.savn_network import Network
from hthor.errors import HthorError
from hthor.train import evaluation, loop, walkers
from hthor.train.grid_pictures import load_grids
from hthor.train.grid_worlds import BOTH, GridWorlds, Zones
from hthor.train.groups import SHIPPED
from hthor.train.training_folder import Metrics, choose_device, signals, write_config
from hthor.train.training_state import TrainConfig, load_frames
from hthor.train.watcher import Watcher

VALIDATION_HOUSES, VALIDATION_EPISODES = 8, 200


class Setup(Struct, frozen=True, kw_only=True):
    """What a training works with.

    Attributes:
        algorithm: its name. out: its folder. houses, arrangements: how many of the split "train", and of each house.
        zones: whether episodes are in single rooms, in whole houses, or half of them in each.
        every: actions between two validations. device: such as "cpu", "cuda", or "auto". jobs: processes that build
            grids, None for one a processor. begin: folder of a checkpoint to start from, None for random weights.
        encoder: folder of an encoder of pictures for the profile "paper", None for that of ``begin``, or else for the
            one that comes with hthor.
    """

    algorithm: str
    out: Path
    houses: int = 96
    arrangements: int = 2
    zones: Literal["rooms", "houses", "both"] = "both"
    every: int = 500_000
    device: str = "auto"
    jobs: int | None = None
    begin: Path | None = None
    encoder: Path | None = None


def run(learner: loop.Learner[Any], config: loop.LoopConfig, setup: Setup, watcher: Watcher) -> dict[str, Any] | None:
    """Train, or go on with the training in the folder.

    Returns:
        The last row of `metrics.jsonl`, or None when a signal stopped it; the same call then goes on.

    Raises:
        HthorError: when the folder holds another training, or a checkpoint cannot be read.
    """
    torch.set_num_threads(1)  # more threads wait for each other longer than they compute
    device = choose_device(setup.device)
    begin = None if setup.begin is None else savn_checkpoint.load(setup.begin)
    zones: tuple[Zones, ...] = BOTH if setup.zones == "both" else (setup.zones,)
    encoder = _choose_encoder(config, setup, begin)
    network = loop.make_network(config, begin, encoder)
    held = TrainConfig(
        algorithm=setup.algorithm,
        houses=setup.houses,
        arrangements=setup.arrangements,
        zones=setup.zones,
        every=setup.every,
        begin="" if setup.begin is None else setup.begin.name,
        encoder="" if encoder is None else hashlib.sha256(encoder).hexdigest(),
        training=msgspec.to_builtins(config),
    )
    write_config(setup.out, held)
    load = functools.partial(
        load_grids, encoder=encoder, jobs=setup.jobs, building=watcher.building, drawing=watcher.drawing
    )
    grids = load("train", setup.houses, setup.arrangements)
    worlds = [GridWorlds(grids, zone, device) for zone in zones]
    grids = load("validation", VALIDATION_HOUSES, 1)
    validation = [_Validation(GridWorlds(grids, zone, device), zone) for zone in zones]
    del grids  # which the worlds hold once more
    metrics = Metrics(setup.out, load_frames(setup.out))

    def report(frames: int, means: dict[str, float] | None) -> None:
        watcher.training(frames, config.frames)
        if means is not None:
            row: dict[str, Any] = {"frames": frames, "train": means}
            row |= {str(one.zone): one.row(network) for one in validation}
            metrics.add(row)
            watcher.validated(row)

    with signals() as stops, metrics:
        finished = loop.train(learner, config, network, worlds, setup.out, report, stops=stops, every=setup.every)
    return metrics.last if finished else None


def _choose_encoder(config: loop.LoopConfig, setup: Setup, begin: Checkpoint | None) -> bytes | None:
    """The weights of the encoder of pictures; None if the network reads labels."""
    if config.network.profile != "paper":
        if setup.encoder is not None:
            raise HthorError(
                "only networks of the profile paper read pictures: add --profile paper, or give no --encoder"
            )
        return None
    if begin is not None and setup.encoder is not None:
        raise HthorError(f"{setup.begin} has an encoder of its own: give either --begin or --encoder")
    if begin is None:
        return picture_encoder.dump(picture_encoder.read_file(setup.encoder or SHIPPED / "encoder"))
    return picture_encoder.dump(begin.network.encoder) if begin.network.config.profile == "paper" else None


class _Validation:
    """Episodes in houses that training never sees, the same for all trainings."""

    def __init__(self, worlds: GridWorlds, zone: Zones) -> None:
        self.worlds, self.zone = worlds, zone
        self._episodes = worlds.draw(VALIDATION_EPISODES, self._generator())

    def row(self, network: Network) -> dict[str, float]:
        network.eval()
        episodes = self._episodes
        walker = walkers.NetworkWalker(network, self.worlds, episodes.goal, self._generator())
        found = evaluation.evaluate(walker, self.worlds, episodes, evaluation.MOST_ACTIONS[self.zone]).summary()
        if network.config.updates:
            found["divergence"] = evaluation.divergence(network, self.worlds, episodes, self._generator())
        network.train()
        return found

    def _generator(self) -> torch.Generator:
        return torch.Generator(self.worlds.device).manual_seed(1)
