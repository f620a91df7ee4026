"""A trial as composer's environment: it keeps the contract of dm_env, and it is the trial of the batch."""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator
from typing import Any

import msgspec
import numpy as np
import pytest
import world_house as tiny
from absl.testing import absltest
from dm_env import StepType, test_utils
from episode_fakes import Mind, trial
from still_person import StillPerson
from world_house import TABLE, on

from benchmarks import composer_trials
from hthor import tasks
from hthor.envs import encode_action, trial_environment
from hthor.episode import play
from hthor.errors import HthorError, TaskError, UnknownName
from hthor.tasks.suite import make_suite
from hthor.trials import TrialRunner
from hthor.trials.sessions import make_sessions
from hthor.types import Action, Move, Observation, Pick, Pose, Rotate, Send, TrialSpec
from hthor.world import World

TICKS = 15
WAIT = {"robot": encode_action(Action())}
HUMAN, ROBOT = Pose(x=2.5, y=3.4, yaw=math.pi / 2), Pose(x=4.0, y=2.0, yaw=math.pi)


@pytest.fixture(scope="module")
def world() -> World:
    return _world()


@functools.cache
def _world() -> World:
    return World(tiny.house(), robots=("scout",))


def _trial(ticks: int = TICKS) -> TrialSpec:
    """The person looks away from the apple."""
    task = tiny.task(on(TABLE, "apple"), human=HUMAN, robots=(ROBOT,))
    task = msgspec.structs.replace(task, kind="object_goal_navigation", time_limit=ticks / 10)
    return msgspec.structs.replace(trial(), task=task)


def _act(motion: Any = None, say: Any = None) -> dict[str, Any]:
    return {"robot": encode_action(Action(say=say) if motion is None else Action(motion=motion, say=say))}


def _turn(observation: Observation) -> Action:
    return Action(motion=Rotate(yaw=math.pi)) if observation.tick == 0 else Action()


class TestContract(test_utils.EnvironmentTestMixin, absltest.TestCase):
    """The conformance tests of dm_env."""

    world: World

    @classmethod
    def setUpClass(cls) -> None:
        super().setUpClass()
        cls.world = _world()

    def make_object_under_test(self) -> Any:
        pictures = ("rgb", "depth", "segmentation")
        return trial_environment(_trial(), self.world, {"human": StillPerson()}, observe=pictures)

    def make_action_sequence(self) -> Iterator[Any]:
        """Beyond the end of the trial."""
        says = Send(text="hello", object="apple", position=(1.0, 2.0, 0.5))
        yield from (_act(Move(forward=0.1), says), _act(Rotate(yaw=0.3)))
        yield from (self.make_action() for _ in range(2 * TICKS))


def test_a_trial_has_a_beginning_a_middle_and_an_end(world: World) -> None:
    environment = trial_environment(_trial(), world, {"human": StillPerson()})
    kinds = [environment.step(WAIT).step_type for _ in range(TICKS + 2)]
    assert kinds == [StepType.FIRST, *[StepType.MID] * (TICKS - 1), StepType.LAST, StepType.FIRST]
    assert environment.control_timestep() == pytest.approx(0.1)


def test_time_that_runs_out_is_no_terminal_state(world: World) -> None:
    environment = trial_environment(_trial(), world, {"human": StillPerson()})
    environment.reset()
    steps = [environment.step(WAIT) for _ in range(TICKS)]
    assert steps[-1].last()
    assert {step.discount for step in steps} == {1.0}
    assert {step.reward for step in steps} == {0.0}
    assert not environment.task.control.log().met


def test_the_goal_is_rewarded_and_ends_the_episode(world: World) -> None:
    environment = trial_environment(_trial(100), world, {"human": Mind(_turn)})
    step, rewards = environment.reset(), []
    while not step.last():
        step = environment.step(WAIT)
        rewards.append(step.reward)
    assert rewards[-1] == sum(rewards) == 1.0
    assert step.discount == 0.0
    log = environment.task.control.log()
    assert (log.met, log.ticks, log.ratings) == (True, len(rewards), {"human": 5})


def test_a_voided_trial_ends_without_a_rating(world: World) -> None:
    environment = trial_environment(_trial(), world, {"human": StillPerson()})
    environment.reset()
    environment.task.control.episode.void("the cable came loose")
    step = environment.step(WAIT)
    assert step.last()
    assert (step.reward, environment.task.control.log().ratings) == (0.0, {})


def test_a_step_is_a_tick_and_a_busy_body_takes_no_other_motion(world: World) -> None:
    environment = trial_environment(_trial(), world, {"human": StillPerson()})
    environment.reset()
    first = environment.step(_act(Move(forward=-0.3)))
    assert (int(first.observation["tick"]), bool(first.observation["robot/idle"])) == (1, False)
    ignored = environment.step(_act(Rotate(yaw=1.0), Send(text="on my way")))
    assert ignored.observation["robot/pose"][2] == first.observation["robot/pose"][2]
    assert ignored.observation["robot/receipt/texts"].tolist()[0] in ("sent", "shown")  # words need no hands


def test_observations_are_what_an_agent_observes(world: World) -> None:
    environment = trial_environment(_trial(), world, {"human": StillPerson()}, observe=("rgb", "depth"))
    environment.reset()
    for action in (_act(Rotate(yaw=0.4, pitch=-0.2), Send(text="hello")), WAIT, _act(Pick(object="apple"))):
        step = environment.step(action)
    seen, one = step.observation, environment.task.control.episode.observe("robot")
    assert seen["robot/pose"].tolist() == [one.pose.x, one.pose.y, one.pose.yaw, one.pose.pitch, 0.0]
    assert (seen["robot/rgb"] == one.rgb).all()
    assert (seen["robot/depth"] == one.depth).all()
    count = int(seen["robot/detections/count"])
    assert count == len(one.detections) > 0
    assert seen["robot/detections/texts"][:count, 0].tolist() == [found.id for found in one.detections]
    assert seen["robot/detections/numbers"][:count, :3].tolist() == [list(found.position) for found in one.detections]
    assert not seen["robot/detections/texts"][count:].any()
    assert seen["robot/scan"][1].tolist() == one.scan.ranges.tolist()
    assert seen["robot/outcome"].tolist() == ["pick", "scout cannot pick things up", ""]
    assert not seen["robot/outcome_ok"]
    assert seen["robot/receipt/numbers"].tolist() == [0, 1, -1]
    assert str(seen["robot/instruction"]) == "find an apple"


def test_mail_is_observed_until_it_was_shown(world: World) -> None:
    says = Send(text="bring it", object="apple", position=(1.0, 2.0, 0.5), to="robot")
    environment = trial_environment(_trial(), world, {"human": Mind(lambda seen: Action(say=says))})
    environment.reset()
    seen = environment.step(WAIT).observation
    assert int(seen["robot/mail/count"]) == 1
    assert seen["robot/mail/texts"][0].tolist() == ["human", "bring it", "apple", "robot"]
    assert seen["robot/mail/numbers"][0].tolist() == [0, 0, 0, -1]
    assert seen["robot/mail/positions"][0].tolist() == [1.0, 2.0, 0.5]
    assert seen["robot/mail/has_position"].tolist() == [True, *[False] * 7]
    assert seen["robot/asked"]


def test_pictures_are_drawn_only_if_asked_for(world: World, monkeypatch: pytest.MonkeyPatch) -> None:
    environment = trial_environment(_trial(), world, {"human": StillPerson()})
    monkeypatch.setattr(World, "look", lambda *_: pytest.fail("a picture was drawn"))
    assert not [name for name in environment.reset().observation if name.endswith(("rgb", "depth", "segmentation"))]
    environment.step(WAIT)
    monkeypatch.undo()
    environment.task.observables["robot/rgb"].enabled = True
    assert environment.reset().observation["robot/rgb"].dtype == np.uint8


def test_an_invalid_action_names_the_seat_and_the_field_and_changes_nothing(world: World) -> None:
    environment = trial_environment(_trial(), world, {"human": StillPerson()})
    environment.reset()
    with pytest.raises(HthorError, match="action of 'robot': field 'motion'"):
        environment.step({"robot": {**WAIT["robot"], "motion": 99}})
    with pytest.raises(HthorError, match="keys robot; got robot2"):
        environment.step({"robot2": WAIT["robot"]})
    assert int(environment.step(WAIT).observation["tick"]) == 1


def test_what_does_not_belong_together_is_refused(world: World) -> None:
    spec = _trial()
    with pytest.raises(HthorError, match="the trial has the robots none"):
        trial_environment(msgspec.structs.replace(spec, robots=()), world, {"human": StillPerson()})
    with pytest.raises(UnknownName, match=r"'rbg'.*Did you mean 'rgb'"):
        trial_environment(spec, world, {"human": StillPerson()}, observe=("rbg",))
    with pytest.raises(HthorError, match="people must have the seats human"):
        trial_environment(spec, world, {}).reset()
    elsewhere = msgspec.structs.replace(spec, task=msgspec.structs.replace(spec.task, house_sha256="0"))
    with pytest.raises(TaskError):
        trial_environment(elsewhere, world, {"human": StillPerson()}).reset()


def test_people_may_be_made_anew_for_every_reset(world: World) -> None:
    made: list[Mind] = []

    def people() -> dict[str, Mind]:
        made.append(Mind())
        return {"human": made[-1]}

    environment = trial_environment(_trial(), world, people)
    assert made == []
    environment.reset()
    environment.step(WAIT)
    environment.reset()
    assert [len(mind.observed) for mind in made] == [1, 0]


def test_the_world_may_be_used_between_steps_and_after_close(world: World) -> None:
    environment = trial_environment(_trial(), world, {"human": StillPerson()})
    environment.reset()
    environment.step(WAIT)
    world.reset()
    world.human.rotate(0.4)
    assert environment.step(WAIT).first()
    environment.close()
    world.reset()
    assert world.human.rotate(0.4).ok
    assert world.env.task.control is None
    assert environment.step(environment.action_spec().generate_value()).mid()


def test_closing_it_twice_is_fine_and_then_nobody_acts(world: World) -> None:
    environment = trial_environment(_trial(), world, {"human": StillPerson()})
    environment.reset()
    environment.close()
    environment.close()
    for _ in range(2):
        with pytest.raises(HthorError, match="this environment has no trial"):
            environment.step(WAIT)
        environment.reset()
        assert environment.step(None).mid()
    world.reset()
    assert world.human.rotate(0.4).ok


def test_shapes_follow_the_bodies_as_the_engine_would_move_them(world: World) -> None:
    environment = trial_environment(_trial(), world, {"human": Mind(_turn)})
    environment.reset()
    model, data = environment.physics.model.ptr, environment.physics.data.ptr
    for _ in range(6):
        environment.step(_act(Move(forward=-0.5)))
        poses = world.poses()
        assert [data.mocap_pos[n, :2].tolist() for n in range(2)] == [[p.x, p.y] for p in poses.values()]
        apart = type(data)(model)
        apart.qpos[:], apart.mocap_pos[:], apart.mocap_quat[:] = data.qpos, data.mocap_pos, data.mocap_quat
        _kinematics(model, apart)
        for name in ("xpos", "xquat", "xmat", "xipos", "ximat", "geom_xpos", "geom_xmat"):
            bodies = model.body_mocapid >= 0
            rows = bodies[model.geom_bodyid] if name.startswith("geom") else bodies
            assert (getattr(data, name)[rows] == getattr(apart, name)[rows]).all(), name


def _kinematics(model: Any, data: Any) -> None:
    from hthor.world.model.engine import mujoco

    mujoco.mj_kinematics(model, data)


def test_composers_hooks_and_delays_work_in_ticks(world: World) -> None:
    environment = trial_environment(_trial(), world, {"human": StillPerson()})
    calls: list[str] = []
    for hook in ("before_step", "before_substep", "after_substep", "after_step"):
        environment.add_extra_hook(hook, lambda *_, hook=hook: calls.append(hook))
    environment.task.observables["tick"].delay = 2
    environment.reset()
    ticks = [int(environment.step(WAIT).observation["tick"]) for _ in range(5)]
    assert calls == ["before_step", "before_substep", "after_substep", "after_step"] * 5
    assert ticks == [0, 0, 1, 2, 3]


@pytest.mark.parametrize(
    ("suite", "agent"), [("smoke", "frontier"), pytest.param("smoke", "oracle", marks=pytest.mark.nightly)]
)
def test_a_trial_in_steps_is_the_trial_of_the_batch(suite: str, agent: str) -> None:
    few = make_suite("few", 1, tuple(task for task in tasks.load_suite(suite).tasks if task.house == "elder"))
    session = make_sessions(few, agent=agent)[0]
    short = msgspec.structs.replace(session, trials=session.trials[:2])
    assert [alike for _, alike, _, _ in composer_trials.compare(short, TrialRunner())] == [True] * 2


def test_a_tour_and_the_task_after_it_are_one_episode() -> None:
    session = make_sessions(tasks.load_suite("rearrange"), agent="oracle", robot="tender")[0]
    task = session.trials[0].task
    phases = tuple(msgspec.structs.replace(phase, time_limit=8.0) for phase in task.phases)
    short = msgspec.structs.replace(task, phases=phases, time_limit=12.0)
    session = msgspec.structs.replace(session, trials=(msgspec.structs.replace(session.trials[0], task=short),))
    ((_, alike, _, _),) = composer_trials.compare(session, TrialRunner())
    assert alike


def test_rewards_add_up_to_the_progress_that_was_made() -> None:
    session, runner = make_sessions(tasks.load_suite("tidy"), agent="oracle", robot="tender")[0], TrialRunner()
    spec = session.trials[0]
    with runner.enter(session) as minds, runner.enter(session) as others:
        expected = play(spec, runner.world(spec), minds.humans, minds.ready_agents())
        environment = trial_environment(spec, runner.world(spec), others.humans)
        control, step, total = environment.task.control, environment.reset(), 0.0
        before = next((one.value for one in control.episode.events if one.kind == "progress"), 0.0)
        agent = others.ready_agents()["robot"]
        agent.begin(control.episode.briefing("robot"))
        while not step.last():
            asked = step.observation["robot/asked"]
            step = environment.step(
                {"robot": encode_action(agent.act(control.episode.observe("robot")))} if asked else WAIT
            )
            total += step.reward
    assert control.log() == expected
    assert expected.progress is not None
    assert total == pytest.approx(expected.progress - before)
    assert total > 0.0
