"""Phases of a task: who ends them, what is told in them, and what counts from where."""

from __future__ import annotations

from typing import Any

import msgspec
import pytest
from episode_fakes import TASK, Mind, Stage, trial

from hthor.episode import Episode, play, task_began, task_part
from hthor.eval.metrics.trial_metrics import measure
from hthor.eval.runner.engines import trial_limit_s
from hthor.types import HUMAN, Action, Observation, Phase, Ready, TrialSpec, Wait
from hthor.types.events import PhaseBegan, Refused, SaidReady, Voided

TOUR = Phase(name="tour", instruction="Look around.", time_limit=3.0, objects=TASK.objects)
LATER = msgspec.structs.replace(TOUR, name="later", restarts=False)


class ChangingStage(Stage):
    """Notes how the scene was changed."""

    def reset(self, task: Any, seed: int = 0) -> None:
        super().reset(task, seed)
        self.changes: list[tuple[int, str]] = [(0, "reset")]

    def restart(self, task: Any) -> None:
        self.changes.append((self.tick, "restart"))

    def rearrange(self, before: Any, after: Any) -> None:
        self.changes.append((self.tick, "rearrange"))

    def save_state(self) -> bytes:
        return msgspec.json.encode((self.tick, self.free_at, self.changes))

    def load_state(self, state: bytes) -> None:
        self.tick, self.free_at, changes = msgspec.json.decode(state, type=tuple[int, dict[str, int], list[Any]])
        self.changes = [(tick, kind) for tick, kind in changes]


def spec(*phases: Phase, privileges: tuple[str, ...] = ()) -> TrialSpec:
    given = trial(*privileges)
    return msgspec.structs.replace(given, task=msgspec.structs.replace(TASK, time_limit=2.0, phases=phases))


def ready_from(tick: int) -> Mind:
    return Mind(lambda seen: Action(signals=(Ready(),) if seen.phase and seen.tick >= tick else ()))


def began(log: Any) -> list[tuple[str, int]]:
    return [(event.name, event.tick) for event in log.events if isinstance(event, PhaseBegan)]


def test_a_phase_ends_when_all_are_ready() -> None:
    world, person, robot = ChangingStage(), ready_from(4), ready_from(9)
    log = play(spec(TOUR), world, {HUMAN: person}, {"robot": robot})  # type: ignore[arg-type]
    assert began(log) == [("tour", 0), ("", 10)]
    assert world.changes == [(0, "reset"), (10, "restart")]
    assert [(event.seat, event.tick) for event in log.events if isinstance(event, SaidReady)] == [
        (HUMAN, 4),
        ("robot", 9),
    ]
    assert {seen.phase for seen in person.observed if seen.tick < 10} == {"tour"}
    assert {seen.phase for seen in person.observed if seen.tick >= 10} == {""}
    assert log.ticks == 10 + 20, "the task's own time limit counts from its own beginning"


def test_who_never_says_ready_is_waited_for_until_the_limit() -> None:
    log = play(spec(TOUR), ChangingStage(), {HUMAN: ready_from(0)}, {"robot": Mind()})  # type: ignore[arg-type]
    assert began(log) == [("tour", 0), ("", 30)]


def test_an_agent_that_failed_is_not_waited_for() -> None:
    def fail(seen: Observation) -> Action:
        raise ValueError(seen.tick)

    log = play(spec(TOUR), ChangingStage(), {HUMAN: ready_from(6)}, {"robot": Mind(fail)})  # type: ignore[arg-type]
    assert began(log)[1] == ("", 8), "at the next tick whose poses are logged"


def test_a_phase_may_change_the_scene_around_everybody() -> None:
    world = ChangingStage()
    log = play(spec(TOUR, LATER), world, {HUMAN: ready_from(0)}, {"robot": ready_from(0)})  # type: ignore[arg-type]
    assert began(log) == [("tour", 0), ("later", 2), ("", 4)]
    assert [kind for _, kind in world.changes] == ["reset", "restart", "rearrange"]


def test_the_goal_counts_only_in_the_task_itself() -> None:
    world = ChangingStage(seen=3)  # in view all the time from tick 3 on
    log = play(spec(TOUR), world, {HUMAN: ready_from(8)}, {"robot": ready_from(8)})  # type: ignore[arg-type]
    assert log.met
    assert log.ticks == 10, "at once, but not before"


def test_a_task_without_phases_has_nothing_to_be_ready_for() -> None:
    person = Mind(lambda seen: Action(signals=(Ready(),) if seen.tick == 0 else ()))
    log = play(spec(), ChangingStage(), {HUMAN: person}, {"robot": Mind()})  # type: ignore[arg-type]
    refused = [event for event in log.events if isinstance(event, Refused)]
    assert [event.reason for event in refused] == ["this task has no further phase"]
    assert began(log) == []
    assert task_began(log) == 0
    assert task_part(log) is log


def test_what_is_true_is_told_to_nobody_before_the_task() -> None:
    robot = ready_from(4)
    play(spec(TOUR, privileges=("object_poses",)), ChangingStage(), {HUMAN: ready_from(4)}, {"robot": robot})  # type: ignore[arg-type]
    assert {bool(seen.truth) for seen in robot.observed if seen.phase} == {False}
    assert {bool(seen.truth) for seen in robot.observed if not seen.phase} == {True}
    assert robot.briefing.phases[0].name == "tour"
    assert not hasattr(robot.briefing.phases[0], "objects")


def test_metrics_are_about_the_task_itself() -> None:
    log = play(spec(TOUR), ChangingStage(seen=16), {HUMAN: ready_from(8)}, {"robot": ready_from(8)})  # type: ignore[arg-type]
    part = task_part(log)
    assert (log.ticks, part.ticks) == (16, 6)
    assert {len(path) for path in part.paths.values()} == {4}
    assert part.paths[HUMAN][0] == (10, 0, 0), "where it was when the task began"
    assert measure(spec(TOUR), log).time_s == pytest.approx(0.6)
    assert measure(spec(TOUR), log).idle_s == pytest.approx(0.6), "rest counts from there as well"


def test_of_a_trial_that_ended_on_the_tour_only_the_end_is_left() -> None:
    episode = Episode(spec(TOUR), ChangingStage())  # type: ignore[arg-type]
    episode.reset()
    for _ in range(5):
        episode.advance()
    episode.void("the cable")
    part = task_part(episode.log())
    assert part.ticks == 0
    assert part.events == (Voided(tick=0, seat=HUMAN, reason="the cable"),)
    assert {len(path) for path in part.paths.values()} == {1}


@pytest.mark.parametrize("stop", [3, 7, 12])
def test_a_trial_goes_on_from_the_middle_of_a_tour(stop: int) -> None:
    def go(episode: Episode, until: int) -> None:
        while not episode.done and episode.tick < until:
            for seat in episode.waiting:
                signals = (Ready(),) if episode.tick >= (5 if seat == HUMAN else 9) else ()
                if episode.observe(seat).phase:
                    episode.submit(seat, Action(motion=Wait(), signals=signals))
            episode.advance()

    whole, half = (Episode(spec(TOUR), ChangingStage()) for _ in range(2))  # type: ignore[arg-type]
    whole.reset()
    go(whole, 10**6)
    half.reset()
    go(half, stop)
    state = half.save_state()
    go(half, 10**6)
    half.load_state(state)
    assert half.tick == stop
    go(half, 10**6)
    assert half.log() == whole.log()
    assert began(whole.log())[1] == ("", 10)


def test_a_worker_is_given_time_for_all_phases() -> None:
    with_tour, without = (trial_limit_s([one.task], guests=1) for one in (spec(TOUR), spec()))
    assert with_tour > without
