"""What a guest observes is what a local agent observes: every field of every record, and every byte of every array."""

from __future__ import annotations

import functools
import json
import shutil
import threading
from collections.abc import Callable
from pathlib import Path
from queue import SimpleQueue
from typing import Any

import levels
import mirror_agent
import msgspec
import numpy as np
import pytest
import world_house
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from law_cases import cases
from msgspec import inspect

from hthor import houses
from hthor.guest import Guest, GuestConfig
from hthor.guest.client import agent_loop
from hthor.guest.host.channel import MessageChannel
from hthor.guest.host.trial_exchange import TrialExchange
from hthor.guest.protocol import wire
from hthor.types import (
    Action,
    Briefing,
    Camera,
    Detection,
    Display,
    DisplayMap,
    Drive,
    Job,
    MapBody,
    Message,
    Observation,
    Outcome,
    PhaseBriefing,
    Pose,
    Receipt,
    Scan,
    Send,
    Senses,
    ThingState,
)
from hthor.types.sensors import READINGS
from hthor.world import World
from tests.support.guest_agents import BRIEFING

HEAD = Pose(x=1.0, y=2.0, yaw=0.5, pitch=-0.1, head=0.7)


@functools.cache
def measured() -> Senses:
    """Every sensor, as a robot in a house reads it."""
    return World(world_house.house(), robots=("scout",)).frozen_senses("robot")


class AllSenses:
    """Every sensor that there is: made up for what a house would not show at once, else measured."""

    def __getattr__(self, name: str) -> Any:
        return getattr(measured(), name)

    def detections(self) -> tuple[Detection, ...]:
        person = {"kind": "person", "family": "person", "size": (0.5, 0.5, 1.7), "yaw": 0.1, "distance": 1.4}
        return (
            Detection(id="human", position=(1.0, 2.0, 0.9), **person),
            Detection(id="human2", position=(3.0, 2.0, 0.9), held_by="", bearers=("human", "robot"), **person),
        )

    def scan(self) -> Scan:
        tops = np.array([0.5, np.inf, 1.2])
        return Scan(origin=HEAD, bearings=np.array([-0.5, 0.0, 0.5]), ranges=np.full(3, 2.5), limit=5.0, tops=tops)

    def rgb(self) -> Any:
        return np.arange(24, dtype=np.uint8).reshape(2, 4, 3)

    def depth(self) -> Any:
        return np.linspace(0.1, 80.0, 8, dtype=np.float32).reshape(2, 4)

    def segmentation(self) -> Any:
        return np.arange(-1, 7, dtype=np.int32).reshape(2, 4)

    def camera(self) -> Camera:
        return Camera(size=(4, 2), matrix=np.diag((2.0, 2.0, 1.0)), pose=np.eye(4), near=0.02, far=80.0)


def trial() -> tuple[Briefing, list[Observation]]:
    """A tour, two people, mail of every kind, a head that looks aside, hands that are busy, and the truth."""
    bodies = dict.fromkeys(("human", "human2", "robot", "robot2"), BRIEFING.body)
    briefing = msgspec.structs.replace(
        BRIEFING,
        teammates=("human", "human2", "robot2"),
        crew=bodies,
        house=houses.load("alder"),
        privileges=mirror_agent.Agent.privileges,
        kind="collect",
        jobs=(Job(target="apple", relation="on", destinations=("table", "desk")), Job(target="mug", relation="back")),
        phases=(PhaseBriefing(name="tour", instruction="Look around.", time_limit=60.0),),
        labels=("wall", "apple", "floor"),
    )
    question = Message(id=4, sender="human2", tick=3, text="Where is the mug?", object="mug", to="robot", question=True)
    answer = Message(id=5, sender="human", tick=4, text="In the kitchen.", position=(1.0, 2.0, 0.8), answers=1)
    picture = Message(id=6, sender="robot2", tick=4, text="Look.", image=lambda: np.full((2, 2, 3), 7, np.uint8))
    more: list[dict[str, Any]] = [
        {"pose": HEAD, "phase": "tour"},
        {"inbox": (question,), "receipt": Receipt(message=1, status="shown", tick=4, by="human2")},
        {"inbox": (question, answer, picture), "receipt": Receipt(message=1, status="answered", tick=5, yes=False)},
        {"outcome": Outcome(motion="drive", ok=True), "idle": False, "holding": "mug", "room": "room|1"},
        {"truth": (ThingState(id="mug", kind="mug", position=(1.0, 2.0, 0.9), held_by="human2", bearers=("human",)),)},
        {"phase": "tour"},
        {"display": Display(message=answer, map=DisplayMap(bodies=(MapBody(seat="robot", forward=1.0, left=-2.0),)))},
    ]
    senses: Any = AllSenses()
    plain = Observation(tick=0, pose=Pose(x=1.0, y=2.0), idle=True, senses=senses)
    return briefing, [msgspec.structs.replace(plain, tick=tick, **fields) for tick, fields in enumerate(more)]


def seen_by(agent: Any) -> list[Action]:
    briefing, observations = trial()
    agent.begin(briefing)
    return [agent.act(observation) for observation in observations]


@pytest.mark.parametrize("level", levels.EVERY)
def test_a_guest_gets_the_trial_that_a_local_agent_gets(level: str, tmp_path: Path) -> None:
    levels.need(level)
    path = shutil.copy(mirror_agent.__file__, tmp_path)
    with Guest(path, config=GuestConfig(isolation=level)) as guest:
        there = seen_by(guest)
    assert_same(there, seen_by(mirror_agent.Agent()))


def assert_same(there: list[Action], here: list[Action]) -> None:
    for one, other in zip(there, here, strict=True):
        assert isinstance(one.say, Send)
        assert isinstance(other.say, Send)
        assert json.loads(one.say.text) == json.loads(other.say.text)
    assert there == here
    assert {type(action.motion) for action in there} == {Drive}


def test_the_fake_trial_has_everything_that_there_is() -> None:
    """Every field of the records that agents get differs from its default somewhere in it."""
    briefing, observations = trial()
    inbox = [message for one in observations for message in one.inbox]
    receipts = [one.receipt for one in observations if one.receipt]
    for records in ([briefing], observations, inbox, receipts, [one.pose for one in observations]):
        kind = type(records[0])
        for field in msgspec.structs.fields(kind):
            assert any(getattr(one, field.name) != field.default for one in records), (kind, field.name)
    assert {name for name in vars(AllSenses) if name[0] != "_"} <= set(READINGS)
    assert mirror_agent.readings(observations[0]).keys() == READINGS.keys()


class InMemory:
    """Both ends of a connection, without a process: implements the host's and the guest's side."""

    view, pid, log = None, 0, ""

    def __init__(self) -> None:
        self.to_guest, self.to_host = SimpleQueue[bytes](), SimpleQueue[bytes]()

    def write(self, body: bytes, end: float) -> None:
        self.to_guest.put(body)

    def read(self, most: int, end: float) -> tuple[bool, bytes | int]:
        return False, self.to_host.get(timeout=900)

    def end_reason(self) -> tuple[str, str]:
        return "died", "gone"

    def kill(self) -> None:
        self.to_guest.put(wire.encode(wire.End()))

    def receive(self) -> wire.ToGuest:
        message: wire.ToGuest = msgspec.msgpack.decode(self.to_guest.get(timeout=900), type=wire.ToGuest)
        return message

    def send(self, message: object) -> None:
        self.to_host.put(wire.encode(message))

    def fail(self) -> Any:
        raise AssertionError("the host broke the protocol")


def over_the_wire(briefing: Briefing, observations: list[Observation], make: Callable[[], Any]) -> list[Action]:
    """The actions of an agent on the other side of an exchange."""
    line, channel = InMemory(), MessageChannel()
    channel.open(line)
    channel.loaded = True
    sent = msgspec.msgpack.decode(wire.encode(wire.Begin(briefing=briefing)), type=wire.Begin)
    thread = threading.Thread(target=agent_loop.run_trial, args=(line, make, sent))
    thread.start()
    try:
        assert isinstance(channel.receive(20)[0], wire.Done)
        exchange = TrialExchange(channel, step_s=20, bank_s=0, ahead=True, window=None)
        return [exchange.act(observation) for observation in observations]
    finally:
        line.kill()
        thread.join()


def records(kind: type[Any]) -> st.SearchStrategy[Any]:
    """Any record of a type, whatever fields it has."""
    return _values(inspect.type_info(kind))


FLAT: dict[type, st.SearchStrategy[Any]] = {
    inspect.NoneType: st.none(),
    inspect.AnyType: st.none(),
    inspect.BoolType: st.booleans(),
    inspect.IntType: st.integers(-(2**63), 2**63 - 1),
    inspect.FloatType: st.floats(allow_nan=False),
    inspect.StrType: st.text(st.characters(exclude_categories=["Cs"]), max_size=9),
}


def _values(kind: Any) -> st.SearchStrategy[Any]:
    if type(kind) in FLAT:
        return FLAT[type(kind)]
    if isinstance(kind, inspect.UnionType):
        return st.one_of([_values(each) for each in kind.types])
    if isinstance(kind, inspect.LiteralType):
        return st.sampled_from(kind.values)
    if isinstance(kind, inspect.VarTupleType):
        return st.lists(_values(kind.item_type), max_size=2).map(tuple)
    if isinstance(kind, inspect.TupleType):
        return st.tuples(*(_values(each) for each in kind.item_types))
    if isinstance(kind, inspect.FrozenSetType):
        return st.frozensets(_values(kind.item_type), max_size=2)
    if isinstance(kind, inspect.DictType):
        return st.dictionaries(_values(kind.key_type), _values(kind.value_type), max_size=2)
    assert isinstance(kind, inspect.StructType), kind
    return st.builds(kind.cls, **{field.name: _field(field) for field in kind.fields})


def _field(field: inspect.Field) -> st.SearchStrategy[Any]:
    values = _values(field.type)
    return values | st.just(msgspec.UNSET) if field.default is msgspec.UNSET else values


@settings(suppress_health_check=[HealthCheck.too_slow, HealthCheck.large_base_example], max_examples=cases(30))
@given(records(Briefing), st.lists(records(Observation), max_size=3))
def test_whatever_a_local_agent_gets_a_guest_gets(briefing: Briefing, seen: list[Observation]) -> None:
    kept: list[Any] = []

    class Keeper:
        def begin(self, briefing: Briefing) -> None:
            kept.append(briefing)

        def act(self, observation: Observation) -> Action:
            kept.append(msgspec.structs.replace(observation, senses=None))
            return Action()

    over_the_wire(briefing, seen, Keeper)
    assert [mirror_agent.plain(one) for one in kept] == [mirror_agent.plain(one) for one in (briefing, *seen)]


@settings(max_examples=cases(50))
@given(records(Send), records(Drive))
def test_whatever_an_agent_says_a_guest_says(say: Send, motion: Drive) -> None:
    wanted = Action(motion=motion, say=say)
    assert wire.to_plain_action(wanted) == wanted
    briefing, observations = trial()

    class Speaker(mirror_agent.Agent):
        def act(self, observation: Observation) -> Action:
            return wanted

    if wire.find_action_fault(wanted) is None:
        assert over_the_wire(briefing, observations[:1], Speaker) == [wanted]


@pytest.mark.parametrize("sensor", READINGS)
def test_what_a_sensor_measures_arrives(sensor: str) -> None:
    """A sensor of which this file knows nothing keeps to this, too."""

    class Reader(mirror_agent.Agent):
        def act(self, observation: Observation) -> Action:
            return Action(say=Send(text=json.dumps(mirror_agent.plain(getattr(observation, sensor)))))

    briefing, observations = trial()
    seen = [msgspec.structs.replace(one, senses=measured()) for one in observations[:4]]
    there = over_the_wire(briefing, seen, Reader)
    assert there == [Reader().act(one) for one in seen]


def test_without_a_process_too() -> None:
    briefing, observations = trial()
    assert_same(over_the_wire(briefing, observations, mirror_agent.Agent), seen_by(mirror_agent.Agent()))
