"""``python -m benchmarks.training_speed``: actions per second of CPU time that a training sees, on one core.

The networks of the profile slim have the weights that ship, so that episodes are as long as late in a training; those
of the profile paper are untrained, and see random codes in place of pictures. Nothing is learned.
"""

from __future__ import annotations

import argparse
import itertools
import statistics
import time

import numpy as np
import torch
from msgspec import structs

from hthor.agents.skills import savn_checkpoint
from hthor.agents.skills.picture_encoder import CODE
from hthor.agents.skills.semantic_cells import CELLS
from hthor.train import algorithms, grid_data, groups, loop
from hthor.train.grid_worlds import BOTH, GridWorlds
from hthor.train.pose_grid import PoseGrid

BATCHES: dict[algorithms.Profile, tuple[int, ...]] = {"slim": (64, 128), "paper": (8, 16)}


def main() -> None:
    """Measure and print."""
    options = argparse.ArgumentParser(prog="python -m benchmarks.training_speed", description=__doc__.splitlines()[0])
    options.add_argument("--houses", type=int, default=4, help="pose grids (%(default)s)")
    options.add_argument("--rounds", type=int, default=8, help="batches; the median counts (%(default)s)")
    options.add_argument("--horizon", type=int, default=80, help="actions of an episode (%(default)s)")
    given = options.parse_args()
    torch.set_num_threads(1)
    grids = list(grid_data.build_grids("train", given.houses, 1).values())
    for profile, batches in BATCHES.items():
        seen = grids if profile == "slim" else [_with_codes(grid, number) for number, grid in enumerate(grids)]
        worlds = [GridWorlds(seen, zones) for zones in BOTH]
        for name, batch in itertools.product(("a2c", "savn"), batches):
            speed = _speed(name, profile, batch, given.horizon, worlds, given.rounds)
            print(f"{name}, {profile}, {batch} episodes at once: {speed:,.0f} actions per CPU second", flush=True)


def _speed(
    name: str, profile: algorithms.Profile, batch: int, horizon: int, worlds: list[GridWorlds], rounds: int
) -> float:
    """The median over batches."""
    settings = [f"batch={batch}", f"horizon={horizon}", "close=0.25"]
    learner, config = algorithms.make(name, settings, profile)
    network = loop.make_network(config, savn_checkpoint.load(groups.SHIPPED / name) if profile == "slim" else None)
    optimizer = torch.optim.Adam(network.parameters(), lr=0.0, amsgrad=True)
    generator = torch.Generator().manual_seed(0)
    found = []
    for number in range(rounds + 1):
        begin = time.process_time()
        loss, played, _ = learner(network, worlds[number % 2], config, generator)
        optimizer.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(network.parameters(), config.clip)
        optimizer.step()
        found.append(played / (time.process_time() - begin))
    return statistics.median(found[1:])


def _with_codes(grid: PoseGrid, seed: int) -> PoseGrid:
    codes = np.random.default_rng(seed).integers(0, 256, (len(grid.visible), CELLS, CODE), np.uint8)
    return structs.replace(grid, codes=codes)


if __name__ == "__main__":
    main()
