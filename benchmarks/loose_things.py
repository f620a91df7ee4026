"""``python -m benchmarks.loose_things``: random actions of people and robots among things strewn on the floor.

After every tick nothing may be in anything: no body in a loose thing or in the house, no object deep in furniture,
walls or other objects, nothing outside the house, no number that is not finite, and when all is at rest, nothing in the
air. How deep a body is in an object is measured with the engine's own shapes, not with the outlines that bodies push
by. Whenever things have been strewn, bodies go to random things, and their hands have to find what `Actor.go_to` says.
Equal seeds make equal actions; the exit code says whether anything was wrong.
"""

from __future__ import annotations

import argparse
import copy
import hashlib
import math
import random
import sys
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from benchmarks import reaching
from hthor.errors import HthorError
from hthor.geometry import plane
from hthor.houses.space import solids
from hthor.types import Close, Drive, Drop, Motion, Move, Open, Pick, Place, Pose, Rotate, Wait
from hthor.types.events import Blocked
from hthor.world import World
from hthor.world.model.engine import mujoco
from hthor.world.state.overlap_test import OVERLAP_M

EDGE_M = 0.15
"""Objects are no farther than this outside all rooms, as in a doorway."""
IMPACT_M = solids.WALL_M / 2
"""Objects in motion are no deeper in anything: contacts of the engine are soft, and deeper in a wall they could pass
through it. How deep they are at most is printed.
"""
CREWS = (("scout", "puck", "tender"), ("porter", "scout"), ("puck", "puck", "tender"))
HOUSES = ("hazel", "alder", "cedar", "birch")
KINDS = (
    "apple", "apple", "basketball", "box", "bottle", "book", "bowl", "mug", "pan", "laptop", "pillow", "plate", "boots",
    "vase", "bat", "phone", "keys", "dumbbell", "trunk",
)  # fmt: skip
_ABOVE_M = 0.05
"""Things are strewn from this height, so that a thin one falls on the edge of a rug, not into it."""
STREW_EVERY = 200
"""Actions after which things are strewn again."""
WALKS = 4
"""How many things bodies go to whenever things have been strewn."""


@dataclass
class Report:
    """What came of the actions."""

    actions: Counter[str] = field(default_factory=Counter)
    findings: list[str] = field(default_factory=list)
    stopped: Counter[str] = field(default_factory=Counter)
    walks: Counter[str] = field(default_factory=Counter)
    ticks: int = 0
    moved: int = 0
    rested: int = 0
    body_mm: float = 0.0
    rest_mm: float = 0.0
    moving_mm: float = 0.0
    digest: str = ""


def main() -> None:
    """Carry the actions out and say what was found; exit code 1 when that is anything."""
    options = argparse.ArgumentParser(prog="python -m benchmarks.loose_things", description=__doc__.splitlines()[0])
    options.add_argument("--actions", type=int, default=20_000, help="how many, over all houses (%(default)s)")
    options.add_argument("--seed", type=int, default=0, help="of all actions (%(default)s)")
    options.add_argument("houses", nargs="*", default=HOUSES, help=f"names or files ({', '.join(HOUSES)})")
    given, report, began = options.parse_args(), Report(), time.process_time()
    for number, house in enumerate(given.houses):
        share = given.actions // len(given.houses) + (number < given.actions % len(given.houses))
        run(house, CREWS[number % len(CREWS)], 1 + number % 2, share, f"{given.seed}/{house}", report)
        print(f"{house}: {share} actions, findings so far: {len(report.findings)}", file=sys.stderr, flush=True)
    for finding in report.findings[:40]:
        print(finding)
    cpu = time.process_time() - began
    print(f"{sum(report.actions.values())} actions, {report.ticks} ticks in {cpu:.0f} s of CPU, digest {report.digest}")
    print("actions: " + ", ".join(f"{count} {name}" for name, count in report.actions.most_common()))
    print(f"ticks in which something loose moved: {report.moved}")
    print(f"times all came to rest: {report.rested}; walks: {reaching.words(report.walks)}")
    print("stopped by: " + ", ".join(f"{count} {name}" for name, count in report.stopped.most_common()))
    print(
        f"deepest: body in object {report.body_mm:.1f} mm, objects at rest {report.rest_mm:.1f} mm, "
        f"objects in motion {report.moving_mm:.1f} mm"
    )
    print(f"findings: {len(report.findings)}")
    sys.exit(bool(report.findings))


def run(house: str, crew: tuple[str, ...], people: int, actions: int, seed: str, report: Report) -> None:
    """Carry out so many actions in one house."""
    objects = tuple((f"{kind}{number}", kind) for number, kind in enumerate(KINDS))
    world = World(house, robots=crew, people=people, objects=objects)
    chance, checker, digest = random.Random(seed), Checker(world, report), hashlib.sha256(report.digest.encode())
    done, until = 0, 0
    while done < actions:
        if done >= until:
            _strew(world, chance)
            for _ in range(WALKS):
                report.findings += [f"{house}, action {done}: {wrong}" for wrong in _walk(world, chance, report)]
            until = done + STREW_EVERY
        for seat in world.seats:
            if world.idle(seat) and done < actions and (seat not in checker.driving or chance.random() < 0.2):
                motion = _motion(world, seat, chance)
                (checker.driving.add if isinstance(motion, Drive) else checker.driving.discard)(seat)
                world.start(seat, motion)
                report.actions[type(motion).__name__] += 1
                done += 1
        for _ in range(chance.choice((0, 0, 3))):
            world.substep()
        for event in world.step():
            if isinstance(event, Blocked):
                report.stopped[_sort(world, event.by)] += 1
        for wrong in checker.check():
            report.findings.append(f"{house}, action {done}: {wrong}")
            print(report.findings[-1], file=sys.stderr, flush=True)
        digest.update(repr((world.poses(), world.truth())).encode())
    report.digest = digest.hexdigest()[:16]


class Checker:
    """What must hold of a world after every tick."""

    def __init__(self, world: World, report: Report) -> None:
        self._world, self._report, self.driving = world, report, set[str]()
        self._model = copy.copy(world.env.model)
        self._model.opt.enableflags &= ~int(mujoco.mjtEnableBit.mjENBL_SLEEP)
        self._data = mujoco.MjData(self._model)
        self._bodies = _Bodies(world)
        self._begun = {item.id: item.position for item in world.parts.objects}
        self._rested = True

    def check(self) -> Iterator[str]:
        """What is wrong now."""
        self._report.ticks += 1
        low = [item for item in self._world.parts.objects if item.number in self._world.parts.objects.low]
        self._report.moved += any(item.position[:2] != self._begun[item.id][:2] for item in low)
        self._begun = {item.id: item.position for item in self._world.parts.objects}
        yield from self._places()
        for seat, item, deep in self._bodies.depths(low):
            self._report.body_mm = max(self._report.body_mm, 1000 * deep)
            if deep > OVERLAP_M:
                yield f"{seat} is {1000 * deep:.0f} mm deep in {item}"
        yield from self._depth()
        if self._world.still and not self._rested:
            self._report.rested += 1
            for state in self._world.objects():
                if not state.held_by and not self._touches(state.id):
                    yield f"{state.id} hangs in the air, at {state.position}"
        self._rested = self._world.still

    def _touches(self, id: str) -> bool:
        item = self._world.parts.objects.get(id)
        return item is None or bool(self._world.parts.objects._overlap.touched(item))

    def _places(self) -> Iterator[str]:
        world = self._world
        for seat, pose in world.poses().items():
            if not all(math.isfinite(value) for value in (pose.x, pose.y, pose.yaw, pose.pitch)):
                yield f"{seat} is at {pose}"
            elif not world.space[seat].is_free(pose.x, pose.y):
                yield f"{seat} stands in something, at {pose}"
        rooms = [room.polygon for room in world.house.rooms]
        for state in world.objects():
            x, y, z = state.position
            if not all(math.isfinite(value) for value in state.position):
                yield f"{state.id} is at {state.position}"
            elif not state.held_by and not any(
                plane.inside((x, y), room) or plane.distance_to_edge((x, y), room) <= EDGE_M for room in rooms
            ):
                yield f"{state.id} is in no room, at {state.position}"
            if not -0.02 <= z <= world.house.height + 0.5:
                yield f"{state.id} is at {state.position}"

    def _depth(self) -> Iterator[str]:
        """Exactly as the engine's shapes are; its own state stays untouched."""
        world, model, data = self._world, self._model, self._data
        model.geom_contype[:], model.geom_conaffinity[:] = (
            world.env.model.geom_contype,
            world.env.model.geom_conaffinity,
        )
        data.qpos[:] = world.env.data.qpos
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_collision(model, data)
        owner, still, report = world.parts.geoms.owner, world.still, self._report
        for pair, distance in zip(data.contact.geom, data.contact.dist, strict=True):
            deep = -float(distance)
            if still:
                report.rest_mm = max(report.rest_mm, 1000 * deep)
            report.moving_mm = max(report.moving_mm, 1000 * deep)
            if deep > (OVERLAP_M if still else IMPACT_M):
                yield f"{owner[pair[0]]} is {1000 * deep:.0f} mm deep in {owner[pair[1]]}{'' if still else ', moving'}"


class _Bodies:
    """Distances between the bodies' cylinders and the objects' solids, with the engine's shapes in another model."""

    def __init__(self, world: World) -> None:
        self._world = world
        spec, model = mujoco.MjSpec(), world.env.model
        for seat in world.seats:
            body = world.bodies[seat]
            size = (body.radius, body.height / 2, 0.0)
            spec.worldbody.add_geom(name=seat, type=mujoco.mjtGeom.mjGEOM_CYLINDER, size=size)
        for item in world.parts.objects:
            for geom in range(item.geoms.start, item.geoms.stop):
                kind = mujoco.mjtGeom(int(model.geom_type[geom]))
                spec.worldbody.add_geom(name=str(geom), type=kind, size=model.geom_size[geom])
        self._model = spec.compile()
        self._data = mujoco.MjData(self._model)

    def depths(self, items: list[Any]) -> Iterator[tuple[str, str, float]]:
        """Seat, object and depth [m] for all bodies that are in objects."""
        world, real, model, data = self._world, self._world.env.data, self._model, self._data
        for seat, pose in world.poses().items():
            mine, body = model.geom(seat).id, world.bodies[seat]
            data.geom_xpos[mine], data.geom_xmat[mine] = (pose.x, pose.y, body.height / 2), (1, 0, 0, 0, 1, 0, 0, 0, 1)
            for item in items:
                if math.dist(item.position[:2], (pose.x, pose.y)) > body.radius + math.hypot(*item.size):
                    continue
                for geom in range(item.geoms.start, item.geoms.stop):
                    other = model.geom(str(geom)).id
                    data.geom_xpos[other], data.geom_xmat[other] = real.geom_xpos[geom], real.geom_xmat[geom]
                    distance = mujoco.mj_geomDistance(model, data, mine, other, 1.0, None)
                    if distance < 0.0:
                        yield seat, item.id, -float(distance)


def _strew(world: World, chance: random.Random) -> None:
    """Begin again, with all bodies and things somewhere on the floor."""
    world.reset()
    for seat in world.seats:
        places = world.space[seat].centres(world.space[seat].free)
        for _ in range(50):
            x, y = places[chance.randrange(len(places))].tolist()
            try:
                world.teleport(seat, Pose(x=x, y=y, yaw=chance.uniform(-3.0, 3.0)))
                break
            except HthorError:
                continue
    for item in world.parts.objects:
        if item.clutter:
            continue
        for _ in range(50):
            seat = chance.choice(world.seats)
            centres = world.space[seat].centres(world.space[seat].raw)
            x, y = centres[chance.randrange(len(centres))].tolist()
            reach = math.hypot(*item.size) / 2
            poses = world.poses().items()
            clear = all(math.dist((one.x, one.y), (x, y)) > world.bodies[name].radius + reach for name, one in poses)
            try:
                if clear:
                    world.put_object(item.id, (x, y, item.size[2] / 2 + _ABOVE_M), yaw=chance.uniform(-3.0, 3.0))
                    break
            except HthorError:
                continue
    world.settle(3.0)


def _walk(world: World, chance: random.Random, report: Report) -> list[str]:
    """Have a body go to a random thing and use it; what it found otherwise than `Actor.go_to` said."""
    actor = world.actor(chance.choice(world.seats))
    targets = [thing.id for thing in world.furniture()] + [one.id for one in world.truth() if not one.held_by]
    reasons: Counter[str] = Counter()
    found = reaching.tried(world, actor, chance.choice(targets), reasons)
    report.walks += found
    world.settle(3.0)
    return [f"{actor.seat}: {reason}" for reason in reasons] if reaching.broken(found) else []


def _motion(world: World, seat: str, chance: random.Random) -> Motion:
    pose, body, sort = world.pose(seat), world.bodies[seat], chance.random()
    low = [item for item in world.parts.objects if item.number in world.parts.objects.low]
    nearest = min(low, key=lambda item: math.dist(item.position[:2], (pose.x, pose.y)), default=None)
    yaw = pose.yaw
    if nearest is not None and chance.random() < 0.7:
        yaw = math.atan2(nearest.position[1] - pose.y, nearest.position[0] - pose.x) + chance.gauss(0.0, 0.25)
    if sort < 0.35:
        x, y = plane.turn((chance.uniform(0.1, 0.5), 0.0), yaw - pose.yaw)
        return Move(forward=x, left=y)
    if sort < 0.45:
        return Rotate(yaw=plane.wrap(yaw - pose.yaw))
    if sort < 0.80 or "pick" not in body.capabilities:
        return Drive(forward=chance.uniform(0.2, 3.0), left=chance.uniform(-0.3, 0.3), yaw=plane.wrap(yaw))
    if sort < 0.90 and nearest is not None:
        return Pick(object=nearest.id)
    if sort < 0.95:
        return Drop()
    if sort < 0.965:
        doors = [one for one in world.truth() if world.parts.doors.get(one.id) is not None]
        door = min(doors, key=lambda one: math.dist(one.position[:2], (pose.x, pose.y)))
        return (Close if door.open else Open)(thing=door.id)
    if sort < 0.98:
        return Place(on=chance.choice([thing.id for thing in world.furniture()]))
    return Wait(seconds=chance.uniform(0.1, 1.0))


def _sort(world: World, by: str) -> str:
    item = world.parts.objects.get(by)
    return item.kind if item is not None else "the house"


if __name__ == "__main__":
    main()
