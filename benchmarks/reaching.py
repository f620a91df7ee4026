"""``python -m benchmarks.reaching``: how often `Actor.go_to` keeps its word that what it went to can be picked up.

For every object of every house and every body with a hand, from the house's start: ``go_to``, then ``pick``. A broken
promise is an ok of ``go_to`` that ``pick`` refuses. By default the ten scenes; name house files to measure these.
"""

from __future__ import annotations

import argparse
import re
from collections import Counter

from hthor.world import World

BODIES = ("human", "tender", "porter")


def main() -> None:
    """Measure and print a line for each house and body, then the sums."""
    options = argparse.ArgumentParser(prog="python -m benchmarks.reaching", description=__doc__.splitlines()[0])
    options.add_argument("houses", nargs="*", help="house files or names (the ten scenes)")
    options.add_argument("--body", action="append", choices=BODIES, help="only this body; may be given more than once")
    options.add_argument("--reasons", action="store_true", help="also count why picks were refused")
    given = options.parse_args()
    total: Counter[str] = Counter()
    reasons: Counter[str] = Counter()
    for house in given.houses or World.scenes():
        for body in given.body or BODIES:
            found = measure(house, body, reasons)
            total += found
            print(f"{house.rpartition('/')[2]:40} {body:7} {words(found)}", flush=True)
    print(f"{'all':40} {'':7} {words(total)}")
    for reason, count in reasons.most_common() if given.reasons else ():
        print(f"{count:6}  {reason}")


def measure(house: str, body: str, reasons: Counter[str]) -> Counter[str]:
    """How often going to an object succeeded, and how often picking it up then did."""
    world = World(house, robots=() if body == "human" else [body])
    actor = world.human if body == "human" else world.robot
    found: Counter[str] = Counter()
    for item in world.objects():
        world.reset()
        if body != "human":
            world.human.teleport(*world.space["human"].nearest_free(*_far(world)))
        found["objects"] += 1
        went = actor.go_to(item.id)
        if not went.ok:
            reasons[f"go_to: {_plain(went.reason, item.id)}"] += 1
            continue
        found["went"] += 1
        picked = actor.pick(item.id)
        found["picked"] += picked.ok
        if not picked.ok:
            reasons[f"pick: {_plain(picked.reason, item.id)}"] += 1
    return found


def words(found: Counter[str]) -> str:
    """The counts as a line."""
    broken = found["went"] - found["picked"]
    share = 100.0 * broken / max(found["went"], 1)
    return (
        f"{found['objects']:5} objects, went to {found['went']:5}, picked up {found['picked']:5}, "
        f"broken promises {broken:4} ({share:.1f} %)"
    )


def _far(world: World) -> tuple[float, float]:
    """A corner of the house, out of everybody's way."""
    x0, y0, _, _ = world.top_view_bounds
    return (x0, y0)


def _plain(reason: str, id: str) -> str:
    """A reason without its names and numbers."""
    return re.sub(r"\d+\.\d+", "N", reason.replace(id, "X"))


if __name__ == "__main__":
    main()
