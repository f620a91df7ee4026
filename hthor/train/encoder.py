"""Trains the encoder of pictures that SAVN sees with in the profile "paper", on the simulator's own pictures.

It learns to say of each of 7 x 7 cells what it shows and how far off that is, as the simulator knows it for every
pixel. What lies before these answers are the features. See `hthor.agents.skills.picture_encoder`.
"""

from __future__ import annotations

import functools
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import torch
from msgspec import Struct
from torch import Tensor
from torch.nn import functional as F  # noqa: N812

from hthor import catalog, jsonio, seeds
from hthor.agents.skills import picture_encoder
from hthor.agents.skills.picture_encoder import WEIGHTS, PictureEncoder
from hthor.agents.skills.savn_network import PAPER
from hthor.agents.skills.semantic_cells import CELLS, CLASSES, FAR_M, GRID, LEVELS
from hthor.train.grid_pictures import Pictures, load_pictures
from hthor.train.optimization import Schedule, optimize
from hthor.train.training_folder import Metrics, choose_device, signals, write_config
from hthor.train.training_state import TrainingState, load_frames
from hthor.train.watcher import Watcher

VALIDATION_HOUSES = 8


class Config(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What a training of an encoder depends on.

    Attributes:
        seed: of the first weights and of every draw. houses: of the split "train". each: pictures of each house.
        pictures: to train on, the same ones again and again. batch: of them at once. learning_rate: of Adam; falls
            evenly to a tenth. small: weight of a cell that shows a thing to bring, of which there are few; that of any
            other cell is 1. range: weight of the mean error of ranges. every: pictures between two validations.
    """

    seed: int = 0
    houses: int = 96
    each: int = 300
    pictures: int = 400_000
    batch: int = 64
    learning_rate: float = 1e-3
    small: float = 8.0
    range: float = 4.0
    every: int = 50_000


class Answers(NamedTuple):
    """What cells show: classes (N, 49) int64, and how far off it is (N, 49), from 0 to 1 for `FAR_M`."""

    shown: Tensor
    ranges: Tensor


def train(config: Config, folder: Path, device: str, jobs: int | None, watcher: Watcher) -> dict[str, Any] | None:
    """Train an encoder, or go on with the training in the folder.

    Args:
        device: such as "cpu", "cuda", or "auto". jobs: processes that draw pictures, None for one a processor.

    Returns:
        The last row of `metrics.jsonl`, or None when a signal stopped it; the same call then goes on.

    Raises:
        HthorError: when the folder holds another training.
    """
    seeds.check_seed(config.seed)
    torch.set_num_threads(1)  # more threads wait for each other longer than they compute
    device = choose_device(device)
    write_config(folder, config)
    load = functools.partial(load_pictures, jobs=jobs, building=watcher.building, drawing=watcher.drawing)
    known = load("train", config.houses, config.each)
    new = load("validation", VALIDATION_HOUSES, config.each)
    torch.manual_seed(config.seed)
    encoder: PictureEncoder = PictureEncoder(len(CLASSES), PAPER.channels).to(device)
    optimizer = torch.optim.Adam(encoder.parameters(), lr=config.learning_rate)
    generator = torch.Generator().manual_seed(config.seed)
    state = TrainingState(network=encoder, optimizer=optimizer, generator=generator)
    weight = torch.ones(len(CLASSES), device=device)
    weight[_small(device)] = config.small

    def batch(number: int) -> tuple[Tensor, int, dict[str, float]]:
        del number
        rgb, answers = _draw(known, config.batch, generator, device)
        return _loss(encoder, rgb, answers, weight, config.range), len(rgb), {}

    def report(pictures: int, means: dict[str, float] | None) -> None:
        watcher.seeing(pictures, config.pictures)
        if means is not None:
            row = {"frames": pictures, "train": means, "validation": _validate(encoder, new)}
            metrics.add(row)
            watcher.recognised(row)

    schedule = Schedule(frames=config.pictures, every=config.every, learning_rate=config.learning_rate)
    with signals() as stops, Metrics(folder, load_frames(folder)) as metrics:
        finished = optimize(
            state,
            batch,
            schedule,
            folder,
            report=report,
            save=lambda: jsonio.write(folder / WEIGHTS, picture_encoder.dump(encoder)),
            stops=stops,
        )
    return metrics.last if finished else None


def _draw(pictures: Pictures, batch: int, generator: torch.Generator, device: str) -> tuple[Tensor, Answers]:
    """Pictures drawn at random, half of them mirrored, and the answers to them."""
    which = torch.randint(len(pictures.rgb), (batch,), generator=generator)
    mirrored = (torch.rand(batch, generator=generator) < 0.5).to(device)
    rgb, answers = _take(pictures, which.numpy(), device)
    shown, ranges = (torch.where(mirrored[:, None], _mirror(part), part) for part in answers)
    return torch.where(mirrored[:, None, None, None], rgb.flip(2), rgb), Answers(shown, ranges)


def _mirror(cells: Tensor) -> Tensor:
    """Cells (N, 49) with left and right exchanged."""
    return cells.unflatten(1, (GRID, GRID)).flip(2).flatten(1)


def _take(pictures: Pictures, which: Any, device: str) -> tuple[Tensor, Answers]:
    rgb = torch.from_numpy(pictures.rgb[which]).to(device)
    shown = torch.from_numpy(pictures.shown[which].astype(np.int64)).to(device)
    ranges = torch.from_numpy(pictures.depth[which].astype(np.float32) / LEVELS).to(device)
    return rgb, Answers(shown, ranges)


def _loss(encoder: PictureEncoder, rgb: Tensor, answers: Answers, weight: Tensor, range_weight: float) -> Tensor:
    """``weight``: (classes,) of the cells that show each class."""
    logits, ranges = encoder.read(encoder.features(encoder.compress(rgb)))
    named = F.cross_entropy(logits.flatten(0, 1), answers.shown.flatten(), weight)
    return named + range_weight * (ranges - answers.ranges).abs().mean()


def _small(device: torch.device) -> Tensor:
    """The classes of things to bring."""
    return torch.tensor([CLASSES.index(name) for name in catalog.TARGETS], device=device)


def _validate(encoder: PictureEncoder, pictures: Pictures) -> dict[str, float]:
    """How well it reads new houses: the share of cells that it names rightly; of those that show a thing to bring, and
    of those that it says show one; and the mean error of ranges [m].
    """
    right, told, there, hits, error = 0, 0, 0, 0, 0.0
    device = encoder.expand.weight.device
    small = _small(device)
    for begin in range(0, len(pictures.rgb), 256):
        rgb, answers = _take(pictures, slice(begin, begin + 256), str(device))
        with torch.no_grad():
            logits, ranges = encoder.read(encoder.features(encoder.encode(rgb)))
        named = logits.argmax(2)
        good = named == answers.shown
        is_small, says_small = torch.isin(answers.shown, small), torch.isin(named, small)
        right, hits = right + int(good.sum()), hits + int((good & is_small).sum())
        there, told = there + int(is_small.sum()), told + int(says_small.sum())
        error += float((ranges - answers.ranges).abs().sum()) * FAR_M
    cells = len(pictures.rgb) * CELLS
    return {
        "right": right / cells,
        "small_found": hits / max(there, 1),
        "small_right": hits / max(told, 1),
        "range_error_m": error / cells,
    }
