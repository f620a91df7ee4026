"""The checkpoints of several seeds of a training, as one robot."""

from __future__ import annotations

import hashlib
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from msgspec import structs

from hthor import documents, jsonio
from hthor.agents import savn
from hthor.agents.skills import picture_encoder, savn_checkpoint
from hthor.agents.skills.savn_network import Network
from hthor.agents.skills.semantic_cells import CLASSES
from hthor.errors import HthorError
from hthor.train.training_state import TRAIN_CONFIG, TrainConfig

SHIPPED = savn.CHECKPOINTS
"""Where the checkpoints of built-in robots are."""


class Group(NamedTuple):
    """Networks of trainings that differ in nothing but the seed.

    Attributes:
        name: of the robot, usually the algorithm. networks: in double precision, so that what they decide does not
            depend on the processor. hashes: of the files of their weights.
    """

    name: str
    networks: tuple[Network, ...]
    hashes: tuple[str, ...]


def load_groups(folders: Sequence[Path]) -> list[Group]:
    """The checkpoints in folders of trainings, in the order of each group's first one.

    Raises:
        HthorError: when a checkpoint cannot be read, or is for other classes than pose grids have.
    """
    held: dict[str, tuple[str, list[Network], list[str]]] = {}
    for folder in folders:
        checkpoint = savn_checkpoint.load(folder)
        if checkpoint.classes != CLASSES:
            path = folder / savn_checkpoint.CONFIG
            raise HthorError.in_file(str(path), "classes", "are not those that this version of hthor trains with")
        training, algorithm = _read_training(folder)
        _, networks, hashes = held.setdefault(training, (algorithm, [], []))
        networks.append(checkpoint.network.double())
        hashes.append(hashlib.sha256((folder / savn_checkpoint.WEIGHTS).read_bytes()).hexdigest())
    groups: list[Group] = []
    alike: Counter[str] = Counter()
    for algorithm, networks, hashes in held.values():
        alike[algorithm] += 1
        name = f"{algorithm} {alike[algorithm]}" if alike[algorithm] > 1 else algorithm
        groups.append(Group(name, tuple(networks), tuple(hashes)))
    return groups


def find_encoder(groups: Sequence[Group]) -> bytes | None:
    """The weights of the encoder of pictures that all networks see with; None if they read labels.

    Raises:
        HthorError: when some read labels and others pictures, or pictures with another encoder.
    """
    found = {
        picture_encoder.dump(network.encoder) if network.config.profile == "paper" else None: group.name
        for group in groups
        for network in group.networks
    }
    if len(found) > 1:
        names = " and ".join(sorted(set(found.values())))
        raise HthorError(
            f"{names} do not all read the same: labels (slim), or pictures (paper) with the same encoder. They cannot "
            "be compared in one call; compare those that read the same"
        )
    return next(iter(found))


def _read_training(folder: Path) -> tuple[str, str]:
    """What all seeds of a training have in common, and its algorithm; the folder if it does not say."""
    path = folder / TRAIN_CONFIG
    if not path.exists():
        return str(folder), folder.name
    config = documents.read(path, TrainConfig, HthorError)
    training = {name: value for name, value in config.training.items() if name != "seed"}
    same = structs.replace(config, training=training, begin="a checkpoint" if config.begin else "")
    return jsonio.sha256(same), config.algorithm
