"""``python -m benchmarks.worldfuzz``: random calls of a `World`, most of them sensible, many with extreme values.

After every call the world must be sound (see `Checker`), and a call may end in no error but the documented ones:
`HthorError` and, for pictures, `ValueError`. Equal seeds make equal calls; what was found is printed with the calls
that led to it, and the exit code says whether there was anything.
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
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from hthor.errors import HthorError, PhysicsError
from hthor.geometry import plane
from hthor.types import Close, Drive, Drop, Move, Open, Outcome, Pick, Place, Rotate, Wait
from hthor.world import World
from hthor.world.model.engine import mujoco

DEEP_M = 0.015
"""Things at rest are no deeper in one another than this."""
EDGE_M = 0.15
"""Nor are they farther than this outside all rooms, as in a doorway."""
ODD = (
    math.nan, math.inf, -math.inf, 1e308, -1e308, 1e300, 5e-324, 0.0, -0.0, 10**400, -(10**5000), 2**63, "a", "", None,
    True, np.float64(0.3), np.float32(0.3), np.nan, (), (1.0,), b"x",
)  # fmt: skip
"""Numbers that are none, or that nobody expects."""
BOGUS = ("", "nope", "a\0b", "apple ", "ROBOT", "🙂" * 100, 5, None, math.nan, ("apple",))
CREWS = (("tender", "scout"), ("porter", "puck"), ("tender", "tender"))
HOUSES = ("hazel", "alder", "cedar")
RESET_EVERY = 250
"""Calls between two resets, more or less."""
_DOCUMENTED = (HthorError, ValueError)


Call = tuple[str, Callable[[], Any]]
"""A call's name, and what makes it."""


@dataclass
class Report:
    """What came of the calls: how many of each sort, how they ended, and what was wrong."""

    calls: Counter[str] = field(default_factory=Counter)
    errors: Counter[str] = field(default_factory=Counter)
    findings: list[str] = field(default_factory=list)
    digest: str = ""


def main() -> None:
    """Make the calls and say what was found; exit code 1 when that is anything."""
    options = argparse.ArgumentParser(prog="python -m benchmarks.worldfuzz", description=__doc__.splitlines()[0])
    options.add_argument("--calls", type=int, default=20_000, help="how many, over all houses (%(default)s)")
    options.add_argument("--seed", type=int, default=0, help="of all calls (%(default)s)")
    options.add_argument("--odd", type=float, default=0.15, help="share of numbers that are odd (%(default)s)")
    options.add_argument("houses", nargs="*", default=HOUSES, help=f"names or files ({', '.join(HOUSES)})")
    given = options.parse_args()
    began, found = time.process_time(), Report()
    for number, house in enumerate(given.houses):
        share = given.calls // len(given.houses) + (number < given.calls % len(given.houses))
        world = World(house, robots=CREWS[number % len(CREWS)], people=1 + number % 2)
        found = run(world, share, f"{given.seed}/{house}", odd=given.odd, report=found)
        print(f"{house}: {share} calls, findings so far: {len(found.findings)}", file=sys.stderr, flush=True)
    for finding in found.findings:
        print(finding)
    print(f"{sum(found.calls.values())} calls in {time.process_time() - began:.0f} s of CPU, digest {found.digest}")
    print("refused: " + ", ".join(f"{count} {name}" for name, count in found.errors.most_common()))
    print(f"findings: {len(found.findings)}")
    sys.exit(bool(found.findings))


def run(world: World, calls: int, seed: str, *, odd: float = 0.15, report: Report | None = None) -> Report:
    """Make so many calls; what was wrong, each finding with the last calls before it."""
    fuzz, report = Fuzz(world, random.Random(seed), odd), report or Report()
    checker, made, digest = Checker(world), list[str](), hashlib.sha256(report.digest.encode())
    for _ in range(calls):
        name, call = fuzz.next()
        report.calls[name] += 1
        made = [*made[-7:], fuzz.words]
        wrong = ""
        try:
            answer = call()
            if isinstance(answer, Outcome) and answer.ok == bool(answer.reason):
                wrong = f"an outcome is ok={answer.ok} with the reason '{answer.reason}'"
        except PhysicsError as error:
            wrong = f"PhysicsError: {error}"
        except _DOCUMENTED as error:
            report.errors[type(error).__name__] += 1
            wrong = "an error without words" if not str(error) else ""
            wrong = wrong or (f"an error of {len(str(error))} characters" if len(str(error)) > 2000 else "")
        except Exception as error:  # this is what is looked for
            wrong = f"{type(error).__name__}: {error}"[:300]
        wrong = wrong or checker.check()
        if wrong:
            report.findings.append(f"{world.house.id}: {wrong}\n    after " + "\n          ".join(made))
            world.reset()
        digest.update(repr(checker.state()).encode())
    report.digest = digest.hexdigest()[:16]
    return report


class Checker:
    """What must hold of a world after every call."""

    def __init__(self, world: World) -> None:
        self._world, env = world, world.env
        self._model = copy.copy(env.model)
        self._model.opt.enableflags &= ~int(mujoco.mjtEnableBit.mjENBL_SLEEP)
        self._data = mujoco.MjData(self._model)
        self._tick = (-1, -1)

    def state(self) -> tuple[Any, ...]:
        """Where everything is."""
        world = self._world
        return (
            world.tick,
            tuple(world.poses().items()),
            tuple((one.id, one.position, one.support) for one in world.truth()),
        )

    def check(self) -> str:
        """What is wrong, empty for nothing."""
        return next(self._wrong(), "")

    def _wrong(self) -> Iterator[str]:
        yield from self._bodies()
        yield from self._objects()
        if self._world.moment < self._tick:
            yield f"time went back from {self._tick} to {self._world.moment}"
        self._tick = self._world.moment
        if self._world.still:
            yield from self._depth()

    def _bodies(self) -> Iterator[str]:
        for seat, pose in self._world.poses().items():
            body = self._world.bodies[seat]
            steepest = body.pitch_limit if seat in self._world.robots else math.pi / 2  # as heads are measured
            if not all(math.isfinite(value) for value in (pose.x, pose.y, pose.yaw, pose.pitch, pose.gaze)):
                yield f"{seat} is at {pose}"
            elif not self._world.space[seat].is_free(pose.x, pose.y):
                yield f"{seat} stands in something, at {pose}"
            elif abs(pose.pitch) > steepest + 1e-6 or abs(pose.yaw) > math.pi + 1e-9:
                yield f"{seat} looks where it cannot, {pose}"

    def _objects(self) -> Iterator[str]:
        world = self._world
        states = {state.id: state for state in world.truth()}
        things = {thing.id for thing in world.furniture()} | {""}
        x0, y0, x1, y1 = world.top_view_bounds
        for state in world.objects():
            x, y, z = state.position
            if not all(math.isfinite(value) for value in state.position):
                yield f"{state.id} is at {state.position}"
            elif not (x0 <= x <= x1 and y0 <= y <= y1 and -0.02 <= z <= world.house.height + 0.5):
                yield f"{state.id} is out of the house, at {state.position}"
            elif not state.held_by and not self._indoors(x, y):
                yield f"{state.id} is in no room, at {state.position}"
            if state.support not in things:
                yield f"{state.id} lies on '{state.support}', which does not exist"
            if state.held_by and state.support:
                yield f"{state.id} is in the hand of {state.held_by} and on {state.support}"
            holders = [seat for seat in world.seats if world.holding(seat) == state.id]
            if sorted(holders) != sorted(state.bearers or ((state.held_by,) if state.held_by else ())):
                yield f"{state.id} is held by {holders}, its state says {state.held_by} {state.bearers}"
            if states.get(state.id) != state or world.state(state.id) != state:
                yield f"{state.id} has two states, {state} and {states.get(state.id)}"
        for seat in world.seats:
            if world.holding(seat) and world.holding(seat) not in states:
                yield f"{seat} holds {world.holding(seat)}, which does not exist"

    def _indoors(self, x: float, y: float) -> bool:
        rooms = [room.polygon for room in self._world.house.rooms]
        inside = any(plane.inside((x, y), room) for room in rooms)
        return inside or min(plane.distance_to_edge((x, y), room) for room in rooms) < EDGE_M

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
        owner = world.parts.geoms.owner
        for pair, distance in zip(data.contact.geom, data.contact.dist, strict=True):
            if distance < -DEEP_M:
                yield f"{owner[pair[0]]} is {-1000 * distance:.0f} mm deep in {owner[pair[1]]}"


class Fuzz:
    """Draws calls of one world.

    Args:
        odd: the share of numbers and names that are not what a caller should give.

    Attributes:
        words: the last call, as one would type it.
    """

    def __init__(self, world: World, chance: random.Random, odd: float) -> None:
        self._world, self._chance, self._odd = world, chance, odd
        self._ids = [item.id for item in world.parts.objects]
        self._things = [thing.id for thing in world.furniture()]
        self._opens = [leaf.thing.id for leaf in world.parts.doors]
        self._rooms = [room.id for room in world.house.rooms]
        self._state = world.save_state()
        self.words = ""

    def next(self) -> Call:
        """The next call: its name, and what makes it."""
        if self._chance.random() < 1.0 / RESET_EVERY:
            return self._call("world.reset", self._world.reset, seed=self._chance.randrange(1000))
        sorts = (self._arrange, self._act, self._move, self._look, self._say, self._keep)
        sort = self._chance.choices(sorts, (8, 12, 10, 8, 2, 1))[0]
        return sort()

    # ------------------------------------------------------------------------------------------------------- sorts

    def _arrange(self) -> Call:
        world, sort = self._world, self._chance.randrange(10)
        if sort < 3:
            return self._call("world.put_object", world.put_object, self._id(), on=self._thing(), **self._extra())
        if sort < 6:
            return self._call("world.put_object", world.put_object, self._id(), self._point(), **self._extra(True))
        if sort == 6:
            return self._call("world.remove_object", world.remove_object, self._id())
        if sort == 7:
            return self._call("world.set_open", world.set_open, self._name(self._opens), self._chance.random() < 0.5)
        if sort == 8:
            return self._call("world.settle", world.settle, self._number(0.0, 5.0))
        return self._call("world.step", world.step, self._number(0, 20, whole=True))

    def _act(self) -> Call:
        world, seat = self._world, self._chance.choice(self._world.seats)
        actor, sort = world.actor(seat), self._chance.randrange(9)
        name = f"world.actor('{seat}')"
        if sort < 2:
            return self._call(f"{name}.go_to", actor.go_to, self._target())
        if sort < 4:
            return self._call(f"{name}.pick", actor.pick, self._id())
        if sort < 6:
            point = self._point() if self._chance.random() < 0.5 else None
            return self._call(f"{name}.place", actor.place, self._thing(), point)
        if sort == 6:
            return self._call(f"{name}.drop", actor.drop)
        door = self._name(self._opens)
        return (
            self._call(f"{name}.open", actor.open, door)
            if sort == 7
            else self._call(f"{name}.close", actor.close, door)
        )

    def _move(self) -> Call:
        world, seat = self._world, self._chance.choice(self._world.seats)
        actor, sort = world.actor(seat), self._chance.randrange(8)
        name = f"world.actor('{seat}')"
        if sort < 2:
            return self._call(f"{name}.move", actor.move, self._number(-1.0, 1.0), self._number(-1.0, 1.0))
        if sort == 2:
            return self._call(f"{name}.rotate", actor.rotate, self._number(-3.0, 3.0), self._number(-0.3, 0.3))
        if sort == 3:
            x, y = self._spot(seat)
            return self._call(
                f"{name}.teleport", actor.teleport, x, y, self._number(-4.0, 4.0), self._number(-0.5, 0.5)
            )
        if sort == 4:
            return self._call(f"{name}.look_at", actor.look_at, self._target(high=True))
        if sort == 5:
            return self._call(f"{name}.wait", actor.wait, self._number(0.0, 2.0))
        if sort == 6:  # two at once, then let time pass
            other = self._chance.choice(world.seats)
            one, two = self._motion(), self._motion()
            self.words = f"world.start('{seat}', {_shown(one)}); world.start('{other}', {_shown(two)}); world.step(30)"

            def both() -> None:
                world.start(seat, one)
                world.start(other, two)
                world.step(30)

            return "start", both
        return self._call("world.start", world.start, self._name(world.seats), self._motion())

    def _look(self) -> Call:
        world, seat, sort = self._world, self._name(self._world.seats), self._chance.randrange(10)
        size = (self._number(1, 64, whole=True), self._number(1, 64, whole=True))
        calls: tuple[tuple[Any, ...], ...] = (
            ("picture", seat, self._chance.choice(("rgb", "depth", "segmentation", "odd")), size),
            ("look", seat, size),
            ("camera", seat, size),
            ("detections", seat),
            ("scan", seat),
            ("hidden", self._id(), self._point()),
            ("objects", self._name(("", "apple", "mug")), self._name(("", *self._rooms))),
            ("position", self._name((*self._ids, *self._things, *world.seats))),
            ("state", self._name((*self._ids, *self._opens))),
            ("count", self._name(("apple", "chair", "fridge"))),
        )
        name, *given = calls[sort]
        return self._call(f"world.{name}", getattr(world, name), *given)

    def _say(self) -> Call:
        world, sort = self._world, self._chance.randrange(4)
        if sort < 2:
            robot = world.actor(self._chance.choice(world.seats))
            given = {"object": self._id(), "position": self._point()}
            return self._call("send", robot.send, self._name(("Here it is.", "", "I see it")), **given)
        if sort == 2:
            return self._call("reply", world.human.reply, True, self._number(0, 3, whole=True))
        return self._call("inbox", world.human.inbox)

    def _keep(self) -> Call:
        world, sort = self._world, self._chance.randrange(3)
        if sort == 0:
            self.words = "state = world.save_state()"
            return "save_state", self._save
        state = self._name((self._state,)) if sort == 1 else self._state[: self._chance.randrange(len(self._state))]
        return self._call("world.load_state", world.load_state, state)

    def _save(self) -> None:
        """Keep the state; loaded at once, it changes nothing."""
        self._state = self._world.save_state()
        self._world.load_state(self._state)
        if self._world.save_state() != self._state:
            raise AssertionError("a state that was loaded is not the one that was saved")

    # ------------------------------------------------------------------------------------------------------ values

    def _call(self, name: str, function: Callable[..., Any], *given: Any, **named: Any) -> Call:
        listed = [*(_shown(value) for value in given), *(f"{key}={_shown(value)}" for key, value in named.items())]
        self.words = f"{name}({', '.join(listed)})"
        return name.rpartition(".")[2], lambda: function(*given, **named)

    def _is_odd(self) -> bool:
        return self._chance.random() < self._odd

    def _number(self, low: float, high: float, whole: bool = False) -> Any:
        if self._is_odd():
            return self._chance.choice(ODD if not whole else [one for one in ODD if one != 2**63])
        return self._chance.randint(int(low), int(high)) if whole else self._chance.uniform(low, high)

    def _name(self, known: Any) -> Any:
        return self._chance.choice(BOGUS) if self._is_odd() else self._chance.choice(known)

    def _id(self) -> Any:
        return self._name(self._ids)

    def _thing(self) -> Any:
        return self._name(self._things)

    def _target(self, high: bool = False) -> Any:
        if self._chance.random() < 0.7:
            return self._name((*self._ids, *self._things, *self._opens))
        point = self._point()
        return point if high or not isinstance(point, tuple) else point[:2]

    def _point(self) -> Any:
        if self._is_odd() and self._is_odd():
            return self._chance.choice(ODD)
        x0, y0, x1, y1 = self._world.top_view_bounds
        return self._number(x0, x1), self._number(y0, y1), self._number(0.02, 2.4)

    def _spot(self, seat: str) -> tuple[Any, Any]:
        if self._is_odd():
            return self._number(-2.0, 12.0), self._number(-2.0, 12.0)
        places = self._world.space[seat]
        centres = places.centres(places.free)
        x, y = centres[self._chance.randrange(len(centres))].tolist()
        return x, y

    def _extra(self, thrown: bool = False) -> dict[str, Any]:
        extra: dict[str, Any] = {"yaw": self._number(-4.0, 4.0)} if self._chance.random() < 0.5 else {}
        if thrown and self._chance.random() < 0.5:
            extra["velocity"] = tuple(self._number(-10.0, 10.0) for _ in range(3))
        return extra

    def _motion(self) -> Any:
        return self._chance.choice(
            (
                Move(forward=self._number(-0.5, 0.5), left=self._number(-0.2, 0.2)),
                Rotate(yaw=self._number(-3.0, 3.0), pitch=self._number(-0.3, 0.3)),
                Pick(object=self._id()),
                Place(on=self._thing(), position=None if self._chance.random() < 0.5 else self._point()),
                Drop(),
                Open(thing=self._name(self._opens)),
                Close(thing=self._name(self._opens)),
                Wait(seconds=self._number(0.0, 1.0)),
                *(
                    Drive(
                        forward=self._number(-1.5, 1.5),
                        left=self._number(-1.0, 1.0),
                        yaw=self._number(-4.0, 4.0),
                        pitch=self._number(-1.0, 1.0),
                    )
                    for _ in range(2)
                ),
                5,
            )
        )


def _shown(value: object) -> str:
    try:
        return f"{value!r:.90}"
    except ValueError:  # a whole number of more digits than Python prints
        return "something with 10**5000"


if __name__ == "__main__":
    main()
