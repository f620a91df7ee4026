"""The state of a world as bytes: made from the records of its parts, and put back into the same or an equal world.

The bytes are a line that names the format, a SHA-256 of the rest, and a compressed `WorldRecord` with the `_Origin` of
the state, by which another world is refused. They hold numbers and names only, no code.
"""

import hashlib
import zlib
from collections.abc import Callable, Iterable, Mapping
from typing import Any

import msgspec
from msgspec import Struct

from hthor import rules
from hthor.errors import HthorError
from hthor.types import BodySpec, DetectorSpec, HouseSpec
from hthor.types.events import Event
from hthor.world.model.composer_env import QPose
from hthor.world.model.engine import mujoco
from hthor.world.motion.reach import held_pose
from hthor.world.records import BodyRecord, WorldRecord
from hthor.world.simulation_parts import SimulationParts
from hthor.world.state.body_state import BodyState
from hthor.world.state.movable_object import MovableObject

FORMAT = 1
"""Version of the bytes; a state of another version is refused."""
_MAGIC = b"hthor world state "
_LEVEL = 1
"""Of compression: states are saved often and kept briefly."""


class _Origin(Struct, frozen=True):
    """What a state belongs to: what differs in words, by the name of what it is about."""

    house: str
    bodies: dict[str, str]
    objects: dict[str, str]
    detectors: dict[str, str]
    versions: dict[str, str]


class _Saved(Struct, frozen=True):
    origin: _Origin
    world: WorldRecord


class StateKeeper:
    """Saves and loads the state of the parts of one simulation."""

    def __init__(
        self,
        house: HouseSpec,
        parts: SimulationParts,
        bodies: Mapping[str, BodySpec],
        detectors: Mapping[str, DetectorSpec],
    ) -> None:
        self._parts, self._house, self._bodies, self._detectors = parts, house, bodies, detectors

    def save(self, tick: int, seed: int, spares: Iterable[str], events: Iterable[Event]) -> bytes:
        """The state of the parts, and of the simulation itself."""
        parts = self._parts
        world = WorldRecord(
            tick=tick,
            seed=seed,
            spares=tuple(sorted(spares)),
            steps=parts.driven.steps,
            events=tuple(events),
            bodies={seat: self._body(body) for seat, body in parts.seats.items()},
            objects=parts.objects.records(),
            doors=parts.doors.records(),
            loads=parts.joint_carrying.records(),
            engine=parts.env.record(),
        )
        return _sealed(_Saved(self._origin(), world))

    def load(self, state: bytes) -> WorldRecord:
        """Put the parts back into a state; returns it with what the simulation itself keeps.

        Raises:
            HthorError: when the state is damaged or belongs to a different world.
        """
        saved = _opened(state)
        difference = _difference(saved.origin, self._origin())
        if difference:
            raise HthorError(f"this state belongs to a different world: {difference}")
        record, parts = saved.world, self._parts
        if not parts.env.fits(record.engine) or set(record.bodies) != set(parts.seats):
            raise HthorError("this state is damaged: its numbers do not fit this world's model")
        parts.env.restore(record.engine)
        parts.doors.restore(record.doors)
        parts.doorways.update(parts.doors.shut())
        parts.joint_carrying.restore(record.loads)
        for seat, body in parts.seats.items():
            body.clear(record.bodies[seat].pose)
            body.holding = record.bodies[seat].holding
        parts.objects.restore(record.objects, self._hand)
        parts.driven.reset()
        parts.driven.steps = record.steps
        for seat, body in parts.seats.items():
            self._resume(body, record.bodies[seat])
        parts.mocap.rewrite()
        return record

    def _body(self, body: BodyState) -> BodyRecord:
        room, within = self._parts.rooms.record(body.name)
        return BodyRecord(
            pose=body.pose,
            holding=body.holding,
            outcome=body.outcome,
            activity=body.activity.state() if body.activity is not None else None,
            drive=body.drive.state() if body.drive is not None else None,
            room=room,
            within=within,
        )

    def _resume(self, body: BodyState, record: BodyRecord) -> None:
        body.outcome = record.outcome
        self._parts.rooms.restore(body.name, record.room, record.within)
        if record.activity is not None:
            body.activity = self._parts.dispatch.resume(body, record.activity)
        if record.drive is not None:
            self._parts.driven.resume(body, record.drive)

    def _hand(self, item: MovableObject) -> Callable[[], QPose]:
        if item.bearers:
            return self._parts.joint_carrying.load(item.id).pose
        body, size = self._parts.seats[item.held_by], item.size
        return lambda: held_pose(body, size)

    def _origin(self) -> _Origin:
        house = self._house
        return _Origin(
            house=f"{house.id} ({house.sha256[:12]})",
            bodies={seat: f"{spec.title} ({_digest(spec)})" for seat, spec in self._bodies.items()},
            objects={item.id: f"{item.kind} ({_digest((item.size, item.mass))})" for item in self._parts.objects},
            detectors={seat: f"{spec.name} ({_digest(spec)})" for seat, spec in self._detectors.items()},
            versions={"simulation": str(rules.SIMULATION), "mujoco": mujoco.__version__},
        )


def _digest(value: Any) -> str:
    return hashlib.sha256(msgspec.json.encode(value, order="sorted")).hexdigest()[:8]


def _difference(theirs: _Origin, ours: _Origin) -> str:
    """The first thing in which two worlds differ, in words; empty if they are equal."""
    if theirs.house != ours.house:
        return f"its house is {theirs.house}, here it is {ours.house}"
    for what in ("bodies", "objects", "detectors", "versions"):
        one, two = getattr(theirs, what), getattr(ours, what)
        for name in sorted({*one, *two}):
            if one.get(name) != two.get(name):
                return f"among its {what}, {name} is {one.get(name, 'missing')}, here it is {two.get(name, 'missing')}"
    return ""


def _sealed(saved: _Saved) -> bytes:
    body = zlib.compress(msgspec.msgpack.encode(saved, enc_hook=_plain), _LEVEL)
    return b"%s%d\n%s%s" % (_MAGIC, FORMAT, hashlib.sha256(body).digest(), body)


def _opened(state: bytes) -> _Saved:
    head, _, rest = state.partition(b"\n") if isinstance(state, bytes) else (b"", b"", b"")
    if not head.startswith(_MAGIC):
        raise HthorError("this is not the state of a world; load_state takes what save_state returned")
    version = head.removeprefix(_MAGIC).decode(errors="replace")
    if version != str(FORMAT):
        raise HthorError(f"this state has format {version:.20}; this version of hthor loads format {FORMAT}")
    digest, body = rest[:32], rest[32:]
    if hashlib.sha256(body).digest() != digest:
        raise HthorError("this state is damaged: its checksum is wrong")
    try:
        return msgspec.msgpack.decode(zlib.decompress(body), type=_Saved)
    except (zlib.error, msgspec.MsgspecError) as error:
        raise HthorError(f"this state is damaged: {error}") from None


def _plain(value: Any) -> Any:
    """A number of numpy as one of Python."""
    return value.item()
