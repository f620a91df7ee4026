"""A trial by decisions is the trial of the batch, and its masks agree with the rules."""

from __future__ import annotations

import itertools
import math
from typing import Any

import learning_tasks
import msgspec
import numpy as np
import pytest
import world_house as tiny
from episode_fakes import Mind, trial
from learning_tasks import ALL_KNOWN, few, follow_the_way
from still_person import StillPerson
from world_house import TABLE, on

from hthor.agents.skills.learner import LearnerView
from hthor.agents.skills.learner.actions import action_names
from hthor.agents.skills.learner.state import state_fields, state_size
from hthor.envs.decision_trial import DecisionTrial, RewardWeights
from hthor.envs.episode_control import EpisodeControl
from hthor.envs.trial_source import TrialSource
from hthor.episode import play
from hthor.types import Action, Briefing, Observation, Pose, Send, TrialSpec
from hthor.world import World

UNCERTAIN = ("put", "drop", "open", "close")
"""The hand's actions whose mask cannot know what the rules know: free room, what is in the way."""


class Policy:
    """An agent of the batch that plays what a learner would."""

    def __init__(self) -> None:
        self.asked_while_busy = 0

    def begin(self, briefing: Briefing) -> None:
        self.view = LearnerView(briefing)

    def act(self, observation: Observation) -> Action:
        self.view.see(observation)
        if not observation.idle:
            self.asked_while_busy += 1
            return Action()
        return self.view.action(follow_the_way(self.view.state(), self.view.mask(), self.view.names))


def tiny_trial(*, human: Pose, robot: Pose, seconds: float = 60.0) -> TrialSpec:
    task = tiny.task(on(TABLE, "apple"), human=human, robots=(robot,))
    task = msgspec.structs.replace(task, kind="object_goal_navigation", time_limit=seconds)
    return msgspec.structs.replace(trial("ideal_detector"), task=task)


def tiny_played(robot: str = "scout", person: Any = None, **where: Any) -> DecisionTrial:
    """The person looks away from the apple on the table; the robot stands beside it."""
    spec = tiny_trial(**{"human": Pose(x=2.5, y=3.4, yaw=math.pi / 2), "robot": Pose(x=1.7, y=2.6), **where})
    world = World(tiny.house(), robots=(robot,))
    return DecisionTrial(EpisodeControl(spec, world, lambda: {"human": person or StillPerson()}), 1)


def test_a_trial_by_decisions_is_the_trial_of_the_batch() -> None:
    source = TrialSource(few(seconds=40.0), privileges=ALL_KNOWN)
    messages = busy = 0
    for participant, task in enumerate(source.tasks):
        spec = source.trial(task, 5, participant)
        control = source.control(spec)
        played = DecisionTrial(control, 1)
        played.begin()
        while not control.done:
            view = played.views["robot"]
            played.decide({"robot": follow_the_way(view.state(), view.mask(), view.names)})
        log, agent = control.log(), Policy()
        people = source._runner.make_people(spec)
        assert play(spec, source._runner.world(spec), people, {"robot": agent}) == log
        messages += sum(event.kind == "sent" for event in log.events)
        busy += agent.asked_while_busy
    assert messages
    assert busy, "mail has to come while the robot's body is busy"


@pytest.mark.parametrize("robot", ["scout", "tender"])
def test_what_the_mask_allows_the_rules_do_not_refuse(robot: str) -> None:
    """Except for hands that put down, open and close: see `UNCERTAIN`."""
    played, random = tiny_played(robot), np.random.default_rng(3)
    legal, refused, tried = set(), 0, 0
    for _ in range(12):
        played.begin()
        while not played.control.done:
            view = played.views["robot"]
            mask = view.mask()
            likely = np.where(mask & np.array([name[:4] in ("take", "put", "tell") for name in view.names]), 5.0, 1.0)
            number = int(random.choice(len(mask), p=likely / likely.sum()))
            reason = played.decide({"robot": number}).refused["robot"]
            if mask[number] and view.names[number] not in UNCERTAIN:
                assert not reason, view.names[number]
                legal.add(view.names[number])
            refused += bool(reason) and not mask[number]
            tried += not mask[number]
    certain = set(action_names(played.episode.world.bodies["robot"], 1)) - set(UNCERTAIN)
    assert legal == certain
    assert 0 < refused <= tried


def test_a_decision_lasts_until_the_body_is_free() -> None:
    played = tiny_played()
    played.begin()
    names = played.views["robot"].names
    seconds = {name: played.decide({"robot": names.index(name)}).seconds for name in ("wait", "turn left", "forward")}
    assert seconds == {"wait": pytest.approx(1.0), "turn left": pytest.approx(0.1), "forward": pytest.approx(0.2)}
    assert played.free == ("robot",)


def test_nothing_that_is_no_action_raises_or_moves_anybody() -> None:
    played = tiny_played()
    played.begin()
    before = played.episode.world.pose("robot")
    for number in (math.nan, math.inf, -1, 99, 1.5, None, "forward", True, [1], {}, np.array([1, 2]), np.float32(2)):
        decided = played.decide({"robot": number})
        assert decided.refused["robot"].startswith("an action is a whole number from 0 to 7, got")
        assert decided.seconds == pytest.approx(0.1)
    assert played.episode.world.pose("robot") == before
    assert played.decide({"robot": np.array([1])}).refused == {"robot": ""}
    assert played.decide({"robot": np.int64(2)}).refused == {"robot": ""}


def test_telling_needs_something_in_view_and_sends_where_it_is() -> None:
    played = tiny_played(robot="scout")
    played.begin()
    view = played.views["robot"]
    tell = view.names.index("tell 1")
    assert view.mask()[tell]
    assert played.decide({"robot": tell}).refused == {"robot": ""}
    (sent,) = (event for event in played.episode.events if event.kind == "sent")
    assert (sent.object, sent.text, sent.off) == ("apple", "I found the apple on the dining table in front of me.", 0.0)
    assert not view.mask()[tell], "the message waits for an answer"
    for _ in range(6):
        played.decide({"robot": view.names.index("turn left")})
    assert "is not in view" in played.decide({"robot": tell}).refused["robot"]


def test_messages_to_the_robot_are_shown_as_in_the_batch() -> None:
    says = Send(text="where are you?", to="robot")
    played = tiny_played(person=Mind(lambda seen: Action(say=says if seen.tick == 3 else None)))
    played.begin()
    while played.episode.tick < 8:
        played.decide({"robot": 0})
    assert [(event.tick, event.kind) for event in played.episode.events if event.kind in ("sent", "shown")] == [
        (3, "sent"),
        (4, "shown"),
    ]


def test_the_state_is_what_its_fields_say() -> None:
    played = tiny_played()
    played.begin()
    view, fields = played.views["robot"], {field.name: field for field in state_fields(1)}
    state = view.state()
    found = {name: state[field.start : field.stop].tolist() for name, field in fields.items()}
    assert len(state) == state_size(1) == max(field.stop for field in fields.values())
    assert all(a.stop == b.start for a, b in itertools.pairwise(fields.values()))
    pose, (x, y, z) = played.episode.world.pose("robot"), view.things.last["apple"].position
    assert found["pose"] == pytest.approx([pose.x / 25, pose.y / 25, 1.0, 0.0, 0.0])
    assert found["target 1"] == pytest.approx([1.0, 1.0, (x - pose.x) / 10, (y - pose.y) / 10, z / 2], abs=1e-6)
    assert found["kind 1"].index(1.0) == 0
    assert found["way 1"] == [0.0, 0.0, 0.0], "the way needs privileges"
    assert found["time"] == [0.0]
    played.decide({"robot": view.names.index("tell 1")})
    receipt = fields["receipt"]
    assert view.state()[receipt.start : receipt.stop].sum() == 1.0


def test_a_state_with_all_privileges_has_the_way_to_the_object() -> None:
    source = TrialSource(few(), privileges=ALL_KNOWN)
    played = DecisionTrial(source.control(source.trial(source.tasks[0], 0, 0)), 1, measures_ways=True)
    played.begin()
    way = next(field for field in state_fields(1) if field.name == "way 1")
    metres, ahead, left = played.views["robot"].state()[way.start : way.stop]
    assert metres * 20.0 == pytest.approx(played.metres("robot"), rel=1e-4)
    assert math.hypot(ahead, left) == pytest.approx(1.0, abs=1e-5)
    before, gained = played.metres("robot"), 0.0
    while not played.control.done:
        view = played.views["robot"]
        gained += played.decide({"robot": follow_the_way(view.state(), view.mask(), view.names)}).nearer["robot"]
    assert gained == pytest.approx(before - played.metres("robot"))
    assert gained > 0.5


def test_a_reward_is_the_sum_of_its_terms() -> None:
    played = tiny_played()
    played.begin()
    decided = played.decide({"robot": 0})
    terms = RewardWeights(time_cost=0.6).terms(1.0, decided, "robot", played.episode.task)
    assert terms == {"goal": 1.0, "time": pytest.approx(-0.01), "approach": 0.0}


def test_tasks_of_other_kinds_fit_into_the_state() -> None:
    for suite, jobs, robot in (("vln", 1, "scout"), ("collect", 3, "tender"), ("rearrange", 6, "tender")):
        source = TrialSource(learning_tasks.few(suite, count=1), robots=(robot,))
        played = DecisionTrial(source.control(source.trial(source.tasks[0], 0, 0)), source.jobs, measures_ways=True)
        played.begin()
        random = np.random.default_rng(0)
        for _ in range(40):
            view = played.views["robot"]
            assert source.jobs <= jobs
            assert len(view.state()) == state_size(source.jobs)
            assert np.isfinite(view.state()).all()
            if played.control.done:
                break
            played.decide({"robot": int(random.integers(len(view.names)))})
