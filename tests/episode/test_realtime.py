"""In real time an action comes as late as it was decided on, and the person goes on meanwhile."""

from __future__ import annotations

from typing import Any

import eval_fakes as fakes
import msgspec
import pytest
from episode_fakes import Mind, Stage, trial
from hypothesis import given, settings
from hypothesis import strategies as st

from hthor import rules
from hthor.episode import EpisodeLog, play
from hthor.episode.clocks import Charged
from hthor.eval.records import trial_record
from hthor.eval.results import pairing
from hthor.types import HUMAN, Action, Move, Observation, Send


class Clock:
    """Goes on only when somebody takes their time."""

    def __init__(self) -> None:
        self.now = 0.0

    def __call__(self) -> float:
        return self.now


class Thinker(Mind):
    """Thinks for ``seconds`` each time."""

    def __init__(self, clock: Clock, seconds: float, script: Any = lambda _: Action(motion=Move(forward=0.1))) -> None:
        super().__init__(script)
        self.clock, self.seconds = clock, seconds

    def act(self, observation: Observation) -> Action:
        self.clock.now += self.seconds
        return super().act(observation)


def run(stage: Stage, robot: Thinker, *, realtime: bool = True) -> EpisodeLog:
    spec = msgspec.structs.replace(trial(), clock="charged" if realtime else msgspec.UNSET)
    return play(spec, stage, {"human": Mind()}, {"robot": robot}, Charged(robot.clock) if realtime else None)  # type: ignore[arg-type]


def starts(stage: Stage, seat: str) -> list[int]:
    return [tick for tick, who, _ in stage.started if who == seat]


def test_an_action_comes_as_late_as_it_was_decided_on() -> None:
    clock, stage = Clock(), Stage(busy=5)
    robot = Thinker(clock, 0.3)
    log = run(stage, robot)
    assert starts(stage, "robot")[:3] == [3, 11, 19], "three ticks of thought before each motion of five"
    assert [look.tick for look in robot.observed[:3]] == [0, 8, 16], "asked when free, not again while at it"
    assert starts(stage, HUMAN)[:3] == [0, 5, 10], "the person waits for nobody"
    thoughts = [event for event in log.events if event.kind == "thought"]
    assert [(event.tick, event.ticks) for event in thoughts[:2]] == [(3, 3), (11, 3)]
    assert log.idle["robot"] == 3 * len(thoughts), "a body that waits for its mind does nothing"


def test_lock_step_waits_for_every_mind() -> None:
    clock, stage = Clock(), Stage(busy=5)
    log = run(stage, Thinker(clock, 3.0), realtime=False)
    assert starts(stage, "robot")[:3] == [0, 5, 10]
    assert not any(event.kind == "thought" for event in log.events)


@settings(max_examples=30)
@given(seconds=st.floats(0.0, 0.35), busy=st.integers(1, 4))
def test_no_thinking_is_rounded_away(seconds: float, busy: int) -> None:
    clock, stage = Clock(), Stage(seen=200, busy=busy)
    robot = Thinker(clock, seconds)
    log = run(stage, robot)
    most = seconds / rules.TICK_S  # of the last thought, which may not have come to its end
    late = sum(event.ticks for event in log.events if event.kind == "thought")
    assert late == pytest.approx(seconds * len(robot.observed) / rules.TICK_S, abs=1.001 + most)


def test_who_is_asked_while_busy_only_speaks_and_late() -> None:
    clock, stage = Clock(), Stage(seen=60, busy=50)
    said = iter([Send(text="one", object="apple"), Send(text="two", object="apple")])
    robot = Thinker(clock, 0.2, lambda _: Action(motion=Move(forward=0.1), say=next(said, None)))
    log = run(stage, robot)
    assert [event.tick for event in log.events if event.kind == "sent"][:1] == [2]
    assert starts(stage, "robot") == [2, 54], "news of the message moved nothing"


def test_what_it_takes_to_draw_for_a_mind_is_not_its_own_time() -> None:
    clock = Clock()

    class Senses:
        def rgb(self) -> str:
            clock.now += 9.0
            return "picture"

    charged, robot = Charged(clock), Thinker(clock, 0.25, lambda look: Action(say=Send(text=look.rgb)))
    look = Observation(tick=0, pose=Stage().pose, idle=True, senses=Senses())  # type: ignore[arg-type]
    Stage().reset(trial().task)
    charged.ask("robot", robot, look)
    assert charged.answers(1) == []
    assert [answer.action.say for answer in charged.answers(2)] == [Send(text="picture")]
    assert not charged.busy("robot")


def test_it_is_another_trial_for_the_same_occasion() -> None:
    spec = fakes.run_of()[1][0].trials[0]
    late = msgspec.structs.replace(spec, clock="charged")
    assert trial_record.key(spec) != trial_record.key(late)
    assert pairing.pairing_key(spec) == pairing.pairing_key(late)
    assert b"clock" not in msgspec.json.encode(spec), "lock-step reads as it always did"
