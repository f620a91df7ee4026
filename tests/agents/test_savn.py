"""SAVN as a robot beside a person: what it says, when it goes on, how it adapts, and that it does the same again."""

from __future__ import annotations

import math
import shutil
from pathlib import Path

import levels
import msgspec
import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="needs torch: pip install 'hthor[torch]'", exc_type=ImportError)

from guest_agents import BRIEFING, look  # noqa: E402

from hthor import houses, plugins, tasks  # noqa: E402
from hthor.agents import savn  # noqa: E402
from hthor.agents.skills import savn_checkpoint  # noqa: E402
from hthor.agents.skills.network_search import (  # noqa: E402
    STEP_M,
    TILT_RAD,
    TURN_RAD,
    Decision,
    NetworkSearch,
    align,
    make_motion,
)
from hthor.agents.skills.savn_network import Network, NetworkConfig  # noqa: E402
from hthor.agents.skills.semantic_cells import CLASSES  # noqa: E402
from hthor.episode import EpisodeLog, play  # noqa: E402
from hthor.errors import AgentError  # noqa: E402
from hthor.guest import Guest, GuestConfig  # noqa: E402
from hthor.tasks.suite import make_suite  # noqa: E402
from hthor.trials import TrialRunner  # noqa: E402
from hthor.trials.sessions import make_sessions  # noqa: E402
from hthor.types import Briefing, Move, Observation, Pose, Receipt, Rotate, Send, Wait  # noqa: E402
from hthor.types.events import Adapted  # noqa: E402
from hthor.world import World  # noqa: E402

LABELS = ("floor", "wall", "apple", "fridge")
TASK = msgspec.structs.replace(BRIEFING, target="apple", destination="fridge", relation="in", labels=LABELS)
HERE = Pose(x=0.0, y=0.0)
ON = Decision(Wait(), (0.0, 0.0, 0.0), None)


def done(*position: float) -> Decision:
    return Decision(None, (position[0], position[1], position[2]), 0.25)


class Script:
    """Replaces what the network decides."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, *decisions: Decision) -> None:
        self.left, self.sought = list(decisions), []
        begin = NetworkSearch.begin

        def begun(search: NetworkSearch, kind: str) -> bool:
            known = begin(search, kind)
            self.sought += [kind] if known else []
            return known

        monkeypatch.setattr(NetworkSearch, "begin", begun)
        monkeypatch.setattr(NetworkSearch, "decide", lambda *_: self.left.pop(0) if self.left else ON)


def begun(briefing: Briefing = TASK) -> savn.Agent:
    agent = savn.Agent()
    agent.begin(briefing)
    return agent


def seen(tick: int, status: str = "", since: int = 0) -> Observation:
    receipt = Receipt(message=0, status=status, tick=since) if status else None  # type: ignore[arg-type]
    return msgspec.structs.replace(look(tick), pose=HERE, receipt=receipt)


def test_done_becomes_a_message_and_an_acceptance_leads_to_the_destination(monkeypatch: pytest.MonkeyPatch) -> None:
    script = Script(monkeypatch, ON, done(1.0, 0.5, 0.9), done(2.0, 0.0, 0.5))
    agent = begun()
    assert agent.act(seen(0)).say is None
    said = agent.act(seen(1))
    assert said.say == Send(text="I found the apple in front of me.", object="apple", position=(1.0, 0.5, 0.9))
    assert [signal.divergence for signal in said.signals] == [0.25]
    assert agent.act(seen(2, "shown", 2)).say is None  # it waits
    assert script.left
    second = agent.act(seen(9, "accepted", 8)).say
    assert second == Send(text="I found the fridge in front of me.", object="fridge", position=(2.0, 0.0, 0.5))
    agent.act(seen(20, "accepted", 19))
    assert script.sought == ["apple", "fridge"]
    assert agent._unfinished() == []
    assert agent.act(seen(21, "accepted", 19)).say is None


@pytest.mark.parametrize("status", ["declined", "covered", ""])
def test_after_a_decline_or_no_answer_it_goes_on_and_does_not_tell_of_the_place_again(
    monkeypatch: pytest.MonkeyPatch, status: str
) -> None:
    script = Script(monkeypatch, done(1.0, 0.0, 0.9), done(1.5, 0.5, 0.9), done(2.5, 0.0, 0.9))
    agent = begun()
    assert agent.act(seen(0)).say is not None
    late = 5 if status else 101
    assert agent.act(seen(late, status, 4)).say is None  # within a metre of what it told of
    again = agent.act(seen(late + 1, status, 4)).say
    assert isinstance(again, Send)
    assert again.position == (2.5, 0.0, 0.9)
    assert script.sought == ["apple"]


def test_what_its_network_does_not_know_is_left_to_the_people(monkeypatch: pytest.MonkeyPatch) -> None:
    script = Script(monkeypatch)
    agent = begun(msgspec.structs.replace(TASK, target="sphinx", destination=""))
    assert script.sought == []
    assert agent.act(seen(0)).say is None
    with pytest.raises(AgentError, match="detector is noisy or ideal, got 'real'"):
        savn.Agent(detector="real")


@pytest.mark.parametrize("yaw", [0.0, 0.3, math.pi, -2.9])
@pytest.mark.parametrize("pitch", [0.0, -0.4])
def test_its_motions_are_those_of_the_training_s_lattice(yaw: float, pitch: float) -> None:
    pose = Pose(x=0.0, y=0.0, yaw=yaw, pitch=pitch)
    turn = align(pose)
    if turn is not None:
        pose = msgspec.structs.replace(pose, yaw=yaw + turn.yaw, pitch=pitch + turn.pitch)
    assert align(pose) is None
    heading = pose.yaw / TURN_RAD
    assert heading == pytest.approx(round(heading))
    ahead = make_motion("ahead", pose)
    assert isinstance(ahead, Move)
    x, y = (ahead.forward * f(pose.yaw) / STEP_M for f in (math.cos, math.sin))
    assert (x, y) == (pytest.approx(round(x)), pytest.approx(round(y)))
    for name, yaw_after, pitch_after in (
        ("left", pose.yaw + TURN_RAD, pose.pitch),
        ("right", pose.yaw - TURN_RAD, pose.pitch),
        ("up", pose.yaw, 0.0),
        ("down", pose.yaw, -TILT_RAD),
    ):
        motion = make_motion(name, pose)
        turned = (motion.yaw, motion.pitch) if isinstance(motion, Rotate) else (0.0, 0.0)
        assert math.remainder(pose.yaw + turned[0] - yaw_after, 2 * math.pi) == pytest.approx(0.0, abs=1e-9)
        assert pose.pitch + turned[1] == pytest.approx(pitch_after)
    assert make_motion("done", pose) is None


def test_it_believes_a_thing_to_be_about_where_it_is() -> None:
    house = houses.load("hazel")
    objects = next(task for task in tasks.load_suite("smoke").tasks if task.house == "hazel").objects
    world = World(house, robots=["scout"], objects=[(one.id, one.kind) for one in objects])
    world.rearrange((), objects)
    network = savn_checkpoint.load(savn.CHECKPOINTS / "savn")
    briefing = msgspec.structs.replace(TASK, labels=tuple(world.label_kinds))
    search = NetworkSearch(network, briefing, adapts=False, noisy=False, seed=0)
    place = objects[0].position
    errors = []
    for angle in np.linspace(0.0, 2.0 * math.pi, 24, endpoint=False).tolist():
        x, y = place[0] + 1.1 * math.cos(angle), place[1] + 1.1 * math.sin(angle)
        if not world.space["robot"].is_free(x, y):
            continue
        pose = Pose(x=x, y=y, yaw=math.remainder(angle + math.pi, 2.0 * math.pi))
        world.teleport("robot", pose)
        if objects[0].id not in {one.id for one in world.detections("robot")}:
            continue
        assert search.begin(objects[0].kind)
        found = search.decide(Observation(tick=0, pose=pose, idle=True, senses=world.senses("robot")))
        errors.append(math.dist(found.position, place))
    assert len(errors) >= 2
    assert max(errors) < 0.35


def trials(agent: str, count: int = 2) -> list[EpisodeLog]:
    """The first trials of one person in one house."""
    smoke = tasks.load_suite("smoke")
    few = make_suite("few", 1, tuple(task for task in smoke.tasks if task.house == "hazel"))
    session = make_sessions(few, agent=agent)[0]
    stage = TrialRunner()
    with stage.enter(session) as company:
        some = session.trials[:count]
        return [play(trial, stage.world(trial), company.humans, company.ready_agents()) for trial in some]


def test_it_adapts_by_gradient_tells_so_and_does_the_same_again() -> None:
    files = [savn.CHECKPOINTS.parent / name for name in savn.Agent.ingredients]
    before = [path.read_bytes() for path in files]
    logs = trials("savn")
    assert logs == trials("savn")
    assert [path.read_bytes() for path in files] == before
    for log in logs:
        adapted = [event for event in log.events if isinstance(event, Adapted)]
        assert adapted
        assert all(event.seat == "robot" and event.divergence >= 0.0 for event in adapted)
        assert max(event.divergence for event in adapted) > 0.0
        assert not log.faults


@pytest.mark.slow
def test_a_network_that_reads_pictures_plays_trials_and_does_the_same_again(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    torch.manual_seed(0)
    sizes = {"channels": 8, "image": 4, "goal": 4, "action": 3, "fused": 2, "hidden": 8, "classes": len(CLASSES)}
    network = Network(NetworkConfig(profile="paper", rate=5.0, **sizes))
    with torch.no_grad():
        for weight in network.parameters():
            weight *= 4.0  # as nothing has been learned yet, what it sees hardly moves it
        network.actor.bias[-1] -= 5.0  # so that it seldom says "here it is"
    savn_checkpoint.save(tmp_path / "savn", savn_checkpoint.Checkpoint(network=network, classes=CLASSES))
    monkeypatch.setattr(savn, "CHECKPOINTS", tmp_path)
    logs = trials("savn", 1)
    assert logs == trials("savn", 1)
    for log in logs:
        assert not log.faults
        assert max(event.divergence for event in log.events if isinstance(event, Adapted)) > 0.0


@pytest.mark.parametrize("level", levels.CONFINED)
def test_a_checkpoint_of_the_user_s_own_acts_in_isolation(level: str, tmp_path: Path) -> None:
    own = shutil.copytree(savn.CHECKPOINTS / "savn", tmp_path / "own")
    with Guest(f"savn:{own}", config=GuestConfig(isolation=levels.need(level))) as guest:
        guest.begin(TASK)
        assert guest.act(look(0)).motion is not None


@pytest.mark.parametrize("agent", ["savn_frozen", "a2c"])
def test_the_controls_never_adapt(agent: str) -> None:
    for log in trials(agent):
        assert not log.faults
        assert not [event for event in log.events if isinstance(event, Adapted)]


@pytest.mark.parametrize("name", ["savn", "savn_frozen", "a2c"])
def test_they_follow_the_contract_of_agents(name: str) -> None:
    made = plugins.load("agent", name)
    assert {"pixel_labels"} <= set(made.privileges)
    assert made.__doc__
    assert all((savn.CHECKPOINTS.parent / file).is_file() for file in made.ingredients)


def test_shipped_checkpoints_know_every_class_and_are_small() -> None:
    for name in ("savn", "a2c"):
        folder = savn.CHECKPOINTS / name
        assert savn_checkpoint.load(folder).classes == CLASSES
        assert sum(path.stat().st_size for path in folder.iterdir()) < 4e6
