"""A flat of two rooms in the plane, just enough of a world for a human model: no engine, no house file."""

from __future__ import annotations

import math

import numpy as np

from hthor import catalog
from hthor.geometry.plane import distance_to_rectangle, turn, wrap
from hthor.types import (
    HUMAN,
    BodySpec,
    Briefing,
    Detection,
    Job,
    Move,
    Observation,
    Open,
    Outcome,
    Pick,
    Place,
    Pose,
    Rotate,
    Scan,
    Sighting,
    Wait,
)

BODY = BodySpec(
    name="human",
    title="person",
    radius=0.2,
    height=1.75,
    eye=1.6,
    fov=(1.7, 1.7),
    speed=1.0,
    turn_rate=2.5,
    sight_range=12.0,
    scan_range=8.0,
    scan_beams=61,
    pitch_limit=1.0,
    capabilities=frozenset({"navigate", "pick", "open"}),
    reach=1.2,
    reach_high=2.0,
    strength=5.0,
    handling=0.5,
)
ROOMS = {"kitchen": (0.0, 0.0, 5.0, 4.0), "living": (5.1, 0.0, 10.0, 4.0)}
WALLS = [
    ((5.0, -0.1), (10.2, 0.1)),
    ((5.0, 4.1), (10.2, 0.1)),
    ((-0.1, 2.0), (0.1, 4.2)),
    ((10.1, 2.0), (0.1, 4.2)),
    ((5.05, 0.75), (0.1, 1.5)),
    ((5.05, 3.25), (0.1, 1.5)),
]
FURNITURE = {
    "Table|1": ("dining_table", (2.0, 2.6)),
    "Fridge|1": ("fridge", (0.45, 0.45)),
    "Sofa|1": ("sofa", (8.9, 0.6)),
    "Bed|1": ("bed", (8.9, 2.7)),
}
DOORWAY = Detection(
    id="door|1",
    kind="doorway",
    family="doorway",
    position=(5.05, 2.0, 1.0),
    size=(1.0, 0.1, 2.0),
    yaw=math.pi / 2,
    distance=0.0,
)


class Flat:
    """One person in the flat. ``support`` is where the apple lies; ``robot`` a disc in the way, unseen by scans."""

    def __init__(self, support="Bed|1", robot=None, start=(1.0, 1.5, 0.0)):
        self.pose = Pose(x=start[0], y=start[1], yaw=start[2])
        self.tick, self.support, self.robot = 0, support, robot
        self.open, self.held, self.outcome, self.busy = False, False, None, 0
        self.motion = Wait()
        kind, centre = FURNITURE[support]
        self.apple = (centre[0] - (0.4 if kind == "bed" else 0.0), centre[1], 0.6)
        self.extra = ()
        self.inbox = ()

    def briefing(self, relation="find", destination="", teammates=()):
        return Briefing(
            seat=HUMAN,
            instruction="",
            target="apple",
            destination=destination,
            relation=relation,
            body=BODY,
            tick_s=0.1,
            time_limit=90.0,
            teammates=teammates,
            jobs=(Job(target="apple", relation=relation, destinations=(destination,) if destination else ()),),
        )

    def observation(self, idle=True):
        return Observation(
            tick=self.tick,
            pose=self.pose,
            idle=idle,
            senses=self,
            room=self.room(),
            holding="apple" if self.held else "",
            outcome=self.outcome,
            inbox=self.inbox,
        )

    def room(self):
        return "kitchen" if self.pose.x < 5.05 else "living"

    def found(self):
        return not self.held and any(seen.id == "apple" and seen.distance < 1.5 for seen in self.detections())

    def step(self, motion):
        """Start ``motion`` when idle, and let one tick pass."""
        if not self.busy:
            self.motion, self.busy = motion, self._ticks(motion)
        self.busy -= 1
        self.tick += 1
        if not self.busy:
            self.outcome = self._done(self.motion)

    def _ticks(self, motion):
        if isinstance(motion, Move):
            assert math.hypot(motion.forward, motion.left) <= 0.5
            return max(1, math.ceil(math.hypot(motion.forward, motion.left) / 0.1 - 1e-9))
        if isinstance(motion, Rotate):
            assert abs(self.pose.pitch + motion.pitch) <= BODY.pitch_limit + 1e-9
            return max(1, math.ceil(max(abs(motion.yaw), abs(motion.pitch)) / 0.25 - 1e-9))
        return max(1, round(motion.seconds / 0.1)) if isinstance(motion, Wait) else 5

    def _done(self, motion):
        name, pose = type(motion).__name__.lower(), self.pose
        if isinstance(motion, Rotate):
            self.pose = Pose(x=pose.x, y=pose.y, yaw=wrap(pose.yaw + motion.yaw), pitch=pose.pitch + motion.pitch)
        elif isinstance(motion, Move):
            dx, dy = turn((motion.forward, motion.left), pose.yaw)
            by = self._hit(pose.x + dx, pose.y + dy)
            if by:
                return Outcome(motion=name, ok=False, reason="blocked", by=by)
            self.pose = Pose(x=pose.x + dx, y=pose.y + dy, yaw=pose.yaw, pitch=pose.pitch)
        elif isinstance(motion, Pick):
            hidden = self.support == "Fridge|1" and not self.open
            if hidden or self._apart(self.apple) > BODY.reach:
                return Outcome(motion=name, ok=False, reason="out of reach")
            self.held = True
        elif isinstance(motion, Open):
            self.open = True
        elif isinstance(motion, Place):
            far = motion.position is not None and self._apart(motion.position) > BODY.reach
            if not self.held or far or (motion.on == "Fridge|1" and not self.open):
                return Outcome(motion=name, ok=False, reason="refused")
            self.held, self.support, self.apple = False, motion.on, motion.position
        return Outcome(motion=name, ok=True)

    def _apart(self, point):
        return math.hypot(point[0] - self.pose.x, point[1] - self.pose.y)

    def _boxes(self):
        return [*WALLS, *((centre, catalog.kind(kind).size[:2]) for kind, centre in FURNITURE.values())]

    def _hit(self, x, y):
        if self.robot and math.hypot(x - self.robot[0], y - self.robot[1]) < 0.4:
            return "robot"
        return "wall" if any(distance_to_rectangle((x, y), c, s, 0.0) < 0.2 for c, s in self._boxes()) else ""

    def _sees(self, point):
        yaw = wrap(math.atan2(point[1] - self.pose.y, point[0] - self.pose.x) - self.pose.yaw)
        return abs(yaw) < BODY.fov[0] / 2 and not any(
            self._cuts((self.pose.x, self.pose.y), point, centre, size) for centre, size in WALLS
        )

    @staticmethod
    def _cuts(a, b, centre, size):
        near, far = 0.0, 1.0
        for k in range(2):
            d = b[k] - a[k] or 1e-12
            t = sorted(((centre[k] - size[k] / 2 - a[k]) / d, (centre[k] + size[k] / 2 - a[k]) / d))
            near, far = max(near, t[0]), min(far, t[1])
        return near <= far

    def detections(self):
        seen = [*self.extra]
        for name, (kind, centre) in FURNITURE.items():
            size = catalog.kind(kind).size
            state = ("open" if self.open else "closed") if kind == "fridge" else ""
            seen.append(
                Detection(
                    id=name,
                    kind=kind,
                    family="furniture",
                    position=(*centre, size[2] / 2),
                    size=size,
                    yaw=0.0,
                    distance=0.0,
                    state=state,
                )
            )
        if self.support != "Fridge|1" or self.open:
            seen.append(
                Detection(
                    id="apple",
                    kind="apple",
                    family="object",
                    position=self.apple,
                    size=(0.08, 0.08, 0.08),
                    yaw=0.0,
                    distance=0.0,
                    support=self.support,
                    held_by=HUMAN if self.held else "",
                )
            )
        seen.append(DOORWAY)
        eye = (self.pose.x, self.pose.y, BODY.eye)
        return tuple(
            Detection(**{**{f: getattr(d, f) for f in d.__struct_fields__}, "distance": math.dist(eye, d.position)})
            for d in seen
            if self._sees(d.position) or d.family in ("robot", "person")
        )

    def sighting(self, id):
        seen = any(one.id == id for one in self.detections())
        return Sighting(share=1.0 if seen else 0.0)

    def scan(self):
        bearings = np.linspace(-0.85, 0.85, BODY.scan_beams)
        ranges = np.full(len(bearings), BODY.scan_range)
        for k, bearing in enumerate(bearings):
            u = (math.cos(self.pose.yaw + bearing), math.sin(self.pose.yaw + bearing))
            for centre, size in self._boxes():
                near, far = 0.0, ranges[k]
                for axis, o in enumerate((self.pose.x, self.pose.y)):
                    d = u[axis] or 1e-12
                    t = sorted(((centre[axis] + sign * size[axis] / 2 - o) / d) for sign in (-1, 1))
                    near, far = max(near, t[0]), min(far, t[1])
                if near <= far:
                    ranges[k] = near
        return Scan(origin=self.pose, bearings=bearings, ranges=ranges, limit=BODY.scan_range)


def play(model, flat, ticks=900, until=None, say=None):
    """Let ``model`` act in ``flat``; returns every pose and what was said.

    ``until`` ends it, ``say(tick)`` gives the inbox.
    """
    trace, said = [], []
    for _ in range(ticks):
        old = flat.inbox
        if say is not None:
            flat.inbox = say(flat.tick)
        idle = not flat.busy
        action = None
        if idle or flat.inbox != old:
            action = model.act(flat.observation(idle))
            if action.say is not None:
                said.append((flat.tick, action.say))
        flat.step(action.motion if action is not None else Wait())
        trace.append((flat.pose.x, flat.pose.y, flat.pose.yaw))
        if until is not None and until():
            break
    return trace, said
