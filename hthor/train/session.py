"""One training from beginning to end: grids, training with validation as it goes, and the files that it leaves.

The folder holds the checkpoint (`config.json`, `model.safetensors`), what it was made from (`train_config.json`), a row
for each validation (`metrics.jsonl`, and the same for TensorBoard), and the state to go on from.
"""

from __future__ import annotations

import contextlib
import signal
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, Literal

import msgspec
import torch
from msgspec import Struct

from hthor import documents, jsonio
from hthor.agents.skills import savn_checkpoint
from hthor.agents.skills.savn_network import Network
from hthor.errors import HthorError
from hthor.train import evaluation, loop, walkers
from hthor.train.grid_data import load_grids
from hthor.train.grid_worlds import BOTH, GridWorlds, Zones
from hthor.train.training_state import TRAIN_CONFIG, TrainConfig, load_frames

METRICS = "metrics.jsonl"
VALIDATION_HOUSES, VALIDATION_EPISODES = 8, 200


class Setup(Struct, frozen=True, kw_only=True):
    """What a training works with.

    Attributes:
        algorithm: its name. out: its folder. houses, arrangements: how many of the split "train", and of each house.
        zones: whether episodes are in single rooms, in whole houses, or half of them in each.
        every: actions between two validations. device: such as "cpu", "cuda", or "auto". jobs: processes that build
            grids, None for one a processor. begin: folder of a checkpoint to start from, None for random weights.
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


class Watcher:
    """Is told how a training goes; this one does nothing with it."""

    def building(self, done: int, total: int) -> None:
        """So many grids are there."""

    def walking(self, done: int, total: int) -> None:
        """So many robots have been through all episodes."""

    def training(self, frames: int, total: int) -> None:
        """So many actions were trained on."""

    def validated(self, row: dict[str, Any]) -> None:
        """A row of `metrics.jsonl`."""


def choose_device(name: str) -> str:
    """The device that a name stands for.

    Raises:
        HthorError: when there is no such device here.
    """
    if name == "auto":
        return "cuda" if torch.cuda.is_available() else "cpu"
    try:
        torch.empty(0, device=name)
    except (RuntimeError, AssertionError) as error:
        first = str(error).strip().splitlines()[0]
        raise HthorError(f"the device {name!r} cannot be used here ({first}); give auto, cpu or cuda") from None
    return name


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
    _write_config(config, setup)
    grids = load_grids("train", setup.houses, setup.arrangements, jobs=setup.jobs, progress=watcher.building)
    worlds = [GridWorlds(grids, zone, device) for zone in zones]
    grids = load_grids("validation", VALIDATION_HOUSES, 1, jobs=setup.jobs, progress=watcher.building)
    validation = [_Validation(GridWorlds(grids, zone, device), zone) for zone in zones]
    del grids  # which the worlds hold once more
    metrics = _Metrics(setup.out, load_frames(setup.out))

    def report(frames: int, network: Network, means: dict[str, float] | None) -> None:
        watcher.training(frames, config.frames)
        if means is not None:
            row: dict[str, Any] = {"frames": frames, "train": means}
            row |= {str(one.zone): one.row(network) for one in validation}
            metrics.add(row)
            watcher.validated(row)

    with _signals() as stops, metrics:
        finished = loop.train(learner, config, worlds, setup.out, report, begin=begin, stops=stops, every=setup.every)
    return None if finished is None else metrics.last


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


class _Metrics:
    """Rows of `metrics.jsonl` and, where TensorBoard is installed, its events."""

    def __init__(self, folder: Path, frames: int) -> None:
        """Rows after so many ``frames`` are left out: the training goes on from there, and writes them again."""
        self._path = folder / METRICS
        rows = []
        if self._path.exists():
            lines = self._path.read_bytes().splitlines(keepends=True)
            lines = [line for line in lines if line.endswith(b"\n")]  # the last one may have been cut off
            rows = [documents.parse(line, dict[str, Any], HthorError, shown=str(self._path)) for line in lines]
        rows = [row for row in rows if row["frames"] <= frames]
        jsonio.write(self._path, b"".join(jsonio.canonical(row) + b"\n" for row in rows))
        self.last: dict[str, Any] = rows[-1] if rows else {}
        self._board = _board(folder, frames)

    def __enter__(self) -> _Metrics:
        return self

    def __exit__(self, *error: object) -> None:
        if self._board is not None:
            self._board.close()

    def add(self, row: dict[str, Any]) -> None:
        with self._path.open("ab") as file:
            file.write(jsonio.canonical(row) + b"\n")
        self.last = row
        if self._board is not None:
            for group, numbers in row.items():
                for name, value in numbers.items() if isinstance(numbers, dict) else ():
                    self._board.add_scalar(f"{group}/{name}", value, row["frames"])
            self._board.flush()


def _board(folder: Path, frames: int) -> Any:
    """A writer of TensorBoard's events, None where it is not installed."""
    try:
        from torch.utils.tensorboard import SummaryWriter
    except ImportError:
        return None
    return SummaryWriter(str(folder / "tensorboard"), purge_step=frames + 1)


def _write_config(config: loop.LoopConfig, setup: Setup) -> None:
    held = TrainConfig(
        algorithm=setup.algorithm,
        houses=setup.houses,
        arrangements=setup.arrangements,
        zones=setup.zones,
        every=setup.every,
        begin="" if setup.begin is None else setup.begin.name,
        training=msgspec.to_builtins(config),
    )
    path = setup.out / TRAIN_CONFIG
    if path.exists() and path.read_bytes() != jsonio.pretty(held):
        old = documents.read(path, dict[str, Any], HthorError)
        new = msgspec.to_builtins(held)
        different = sorted(name for name in {*old, *new} if old.get(name) != new.get(name))
        raise HthorError(
            f"{setup.out} holds a training with other settings ({', '.join(different)}); give another --out"
        )
    jsonio.write(path, jsonio.pretty(held))


@contextlib.contextmanager
def _signals() -> Iterator[Callable[[], bool]]:
    """Whether SIGINT or SIGTERM has come; a second SIGINT interrupts as usual."""
    came = []

    def note(number: int, frame: object) -> None:
        del frame
        came.append(number)
        signal.signal(signal.SIGINT, before[signal.SIGINT])

    before = {number: signal.signal(number, note) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield lambda: bool(came)
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
