"""``python -m benchmarks.reaching``: how often `Actor.go_to` keeps its word that what it went to can be seen and used.

For every piece of furniture, doorway with a door and object of every house and every body, from the house's start:
``go_to``, a picture, and what hands would do there. Empty hands pick up an object, and open or close what opens; with
something in hand, each piece of furniture that it can be placed on is gone to once more. A promise is broken where
``go_to`` is ok and no pixel shows the thing, or the hand is refused; also where ``go_to`` says no, and the hand is not
refused. By default the ten scenes; name house files to measure these.
"""

from __future__ import annotations

import argparse
import math
import re
from collections import Counter

from hthor import houses
from hthor.errors import HthorError
from hthor.types import Outcome
from hthor.world import World
from hthor.world.actor import Actor

BODIES = ("human", "tender", "porter", "scout", "puck")
IN_HAND = "apple in hand"
PICTURE = (480, 480)
_AWAY = (0.0, 0.0, -50.0, 1.0, 0.0, 0.0, 0.0)
"""Position [m] and quaternion of what is to be in no picture."""


def main() -> None:
    """Measure and print a line for each house and body, then the sums."""
    options = argparse.ArgumentParser(prog="python -m benchmarks.reaching", description=__doc__.splitlines()[0])
    options.add_argument("houses", nargs="*", help="house files or names (the ten scenes)")
    options.add_argument("--body", action="append", choices=BODIES, help="only this body; may be given more than once")
    options.add_argument("--reasons", action="store_true", help="also count the reasons of what was not ok")
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
    """How often a body went to something, with which outcome, and how often that was not true."""
    world = World(houses.load(house), robots=() if body == "human" else [body], objects=[(IN_HAND, "apple")])
    actor = world.human if body == "human" else world.robot
    things = [thing.id for thing in world.furniture()]
    doors = [state.id for state in world.truth() if state.kind == "door"]
    objects = [state.id for state in world.objects()]
    found: Counter[str] = Counter()
    for target in (*things, *doors, *objects):
        begin(world, actor)
        found += tried(world, actor, target, reasons)
    for target in things if "pick" in actor.body.capabilities else ():
        begin(world, actor)
        if take(world, actor):
            found += tried(world, actor, target, reasons)
    return found


def begin(world: World, actor: Actor) -> None:
    """Begin an episode; nobody but the body stands in the middle of the house."""
    world.reset()
    if actor.seat != "human":
        x0, y0, _, _ = world.top_view_bounds
        world.human.teleport(*world.space["human"].nearest_free(x0, y0))


def take(world: World, actor: Actor) -> bool:
    """Give the body an apple out of the air before it; False where it stands with no room for one on any side."""
    for _ in range(8):
        pose = actor.pose
        for ahead in (0.5, 0.6, 0.7):
            try:
                x, y = pose.x + ahead * math.cos(pose.yaw), pose.y + ahead * math.sin(pose.yaw)
                world.put_object(IN_HAND, (x, y, 0.9))
            except HthorError:
                continue
            if actor.pick(IN_HAND).ok:
                return True
        actor.rotate(math.pi / 4)
    return False


def tried(world: World, actor: Actor, target: str, reasons: Counter[str]) -> Counter[str]:
    """Have a body go to a thing and use it: whether it was ok, and whether it was true."""
    went = actor.go_to(target)
    shown = went.ok and bool((actor.segmentation(PICTURE) == world.names.index(target)).any())
    used = use(world, actor, target)
    found = Counter({"targets": 1, "ok": int(went.ok), "used": int(used is not None)})
    if went.ok and not shown and not _behind_somebody(world, actor, target):
        found["unseen"] += 1
        reasons[f"ok, but no pixel: {target} in {world.house.id}"] += 1
    if used is not None and used.ok != went.ok:
        found["refused" if went.ok else "not refused"] += 1
        reasons[f"{went.ok} is not {used.ok}: {_plain(went.reason or used.reason, target)}"] += 1
    elif not went.ok:
        reasons[_plain(went.reason, target)] += 1
    return found


def use(world: World, actor: Actor, target: str) -> Outcome | None:
    """What hands do with the target; None if there is nothing for them to do."""
    state = next((one for one in world.truth() if one.id == target), None)
    skills, is_object = actor.body.capabilities, any(one.id == target for one in world.objects())
    if is_object:
        return actor.pick(target) if "pick" in skills and not actor.holding else None
    if actor.holding:
        placed = actor.place(target)
        if not placed.reason.startswith("nothing can be placed") and not placed.reason.endswith("is closed"):
            return placed
    if state is None or "open" not in skills:
        return None
    return actor.close(target) if state.open else actor.open(target)


def words(found: Counter[str]) -> str:
    """The counts as a line."""
    return (
        f"went to {found['targets']:5}, ok {found['ok']:5}, used {found['used']:5}; ok, but unseen {found['unseen']}, "
        f"ok, but refused {found['refused']}; not ok, but not refused {found['not refused']}"
    )


def broken(found: Counter[str]) -> int:
    """How many promises were broken."""
    return found["unseen"] + found["refused"] + found["not refused"]


def _behind_somebody(world: World, actor: Actor, target: str) -> bool:
    """Whether another body, or what one carries, stands between the eye and the target, or the target is beyond the
    camera's pitch.
    """
    if not world.in_sight(actor.seat, target, picture=True):
        return True
    before = world.save_state()
    for carried in [state.id for state in world.objects() if state.held_by]:
        world.parts.objects.put(carried, _AWAY, "")
    picture = actor.segmentation(PICTURE)
    world.load_state(before)
    others = [seat for seat in world.seats if seat != actor.seat]
    return any((picture == world.names.index(name)).any() for name in (target, *others))


def _plain(reason: str, id: str) -> str:
    """A reason without its names and numbers."""
    return re.sub(r"\d+\.\d+", "N", reason.replace(id, "X"))


if __name__ == "__main__":
    main()
