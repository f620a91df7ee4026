"""How much memory a process takes that builds very many houses: `python -m benchmarks.many_houses [HOUSES]`."""

from __future__ import annotations

import functools
import sys
import time

from hthor.train import houses
from hthor.trials import Worlds
from hthor.trials.worlds import Objects
from hthor.types import HouseSpec
from hthor.world import World

_EVERY = 50


def main(count: int) -> None:
    """Build the world of each house, and print the memory [MB] and the CPU time per house [s] as they go."""
    worlds, began, most = Worlds(), time.process_time(), 0.0
    print("houses  worlds kept  memory  CPU a house")
    for number in range(1, count + 1):
        house = houses.make_house("train", number - 1)
        world = worlds.get(house.sha256, (("apple", "apple"),), functools.partial(_build, house))
        world.reset()
        most = max(most, _memory_mb())
        if number % _EVERY == 0 or number == count:
            spent = (time.process_time() - began) / number
            print(f"{number:6d}  {len(worlds):11d}  {_memory_mb():4.0f} MB  {spent:.2f} s", flush=True)
    print(f"most: {most:.0f} MB")


def _build(house: HouseSpec, objects: Objects) -> World:
    return World(house, robots=["scout"], objects=objects)


def _memory_mb() -> float:
    with open("/proc/self/status", encoding="ascii") as file:
        return next(int(line.split()[1]) / 1024.0 for line in file if line.startswith("VmRSS"))


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 1000)
