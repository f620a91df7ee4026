"""The state of a training, in one file, so that a training which was stopped goes on as if it had not been."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import torch
from msgspec import Struct
from safetensors import SafetensorError, safe_open
from safetensors import torch as tensors
from torch import nn

from hthor import documents, jsonio
from hthor.errors import HthorError

STATE = "state.safetensors"
TRAIN_CONFIG = "train_config.json"


class TrainConfig(Struct, frozen=True, kw_only=True):
    """What a training was made from, as its `train_config.json` says.

    Attributes:
        algorithm, houses, arrangements, zones, every: see `hthor.train.session.Setup`.
        begin: name of the folder of the checkpoint that it started from, "" for none.
        encoder: hash of the weights of the encoder of pictures, "" for none.
        training: the algorithm's own configuration.
    """

    algorithm: str
    houses: int
    arrangements: int
    zones: str
    every: int
    begin: str
    encoder: str = ""
    training: dict[str, Any]


class TrainingState(Struct, kw_only=True, eq=False):
    """Everything that changes in a training.

    Attributes:
        frames: actions or pictures so far. batches: of them. sums: of what was measured since the last means. summed:
            over how many batches.
    """

    network: nn.Module
    optimizer: torch.optim.Optimizer
    generator: torch.Generator
    frames: int = 0
    batches: int = 0
    sums: dict[str, float] = {}
    summed: int = 0

    def add(self, measured: dict[str, float]) -> None:
        """Count what was measured in a batch."""
        self.sums = {name: self.sums.get(name, 0.0) + value for name, value in measured.items()}
        self.summed += 1

    def take_means(self) -> dict[str, float]:
        """The means of what was measured since they were taken last."""
        means = {name: value / self.summed for name, value in self.sums.items()}
        self.sums, self.summed = {}, 0
        return means


_NUMBERS = ("frames", "batches", "sums", "summed")


def save_state(folder: Path, state: TrainingState) -> None:
    """Write the state; the file is replaced in one step."""
    parts = {f"network.{name}": value for name, value in state.network.state_dict().items()}
    for index, one in state.optimizer.state_dict()["state"].items():
        parts |= {f"optimizer.{index}.{name}": torch.as_tensor(value) for name, value in one.items()}
    parts |= {"generator": state.generator.get_state(), "torch": torch.get_rng_state()}
    numbers = {name: getattr(state, name) for name in _NUMBERS}
    note = {"numbers": jsonio.canonical(numbers).decode()}
    held = {name: value.detach().cpu().contiguous() for name, value in parts.items()}
    jsonio.write(folder / STATE, tensors.save(held, note))


def load_state(folder: Path, state: TrainingState) -> None:
    """Bring a training to where its folder says that it was; one without a state is left as it is.

    Raises:
        HthorError: when the file is damaged, or of another network.
    """
    path = folder / STATE
    if not path.exists():
        return
    with _opened(path) as (file, numbers):
        held = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118
        network = {name.removeprefix("network."): value for name, value in held.items() if name.startswith("network.")}
        state.network.load_state_dict(network)
        steps: dict[int, dict[str, Any]] = {}
        for name, value in held.items():
            if name.startswith("optimizer."):
                _, index, key = name.split(".")
                steps.setdefault(int(index), {})[key] = value
        state.optimizer.load_state_dict({**state.optimizer.state_dict(), "state": steps})
        state.generator.set_state(held["generator"])
        torch.set_rng_state(held["torch"])
        for name in _NUMBERS:
            setattr(state, name, numbers[name])


def load_frames(folder: Path) -> int:
    """How many actions the training in a folder has seen, 0 if it holds none.

    Raises:
        HthorError: when the file is damaged.
    """
    path = folder / STATE
    if not path.exists():
        return 0
    with _opened(path) as (_, numbers):
        return int(numbers["frames"])


@contextmanager
def _opened(path: Path) -> Iterator[tuple[Any, dict[str, Any]]]:
    """The file of a state, and its numbers."""
    try:
        with safe_open(path, "pt") as file:
            numbers = file.metadata()["numbers"].encode()
            yield file, documents.parse(numbers, dict[str, Any], HthorError, shown=str(path))
    except (SafetensorError, OSError, KeyError, TypeError, ValueError, RuntimeError) as error:
        raise HthorError(f"{path} is not the state of this training ({error}); remove it to begin again") from None
