"""Laws of an episode that is driven from outside, in a world without an engine."""

from __future__ import annotations

import random
import threading
import time
from collections.abc import Iterator
from typing import Any

import msgspec
import pytest
from episode_fakes import TASK, trial
from hypothesis import given, settings
from hypothesis import strategies as st
from law_cases import cases
from walking_stage import SEATS, Chancy, WalkingStage, minds

from hthor import tasks
from hthor.episode import Charged, Concurrent, DecisionClock, Episode, EpisodeLog, play
from hthor.errors import HthorError
from hthor.humans.core.recorded_inputs import INPUT_UNIT
from hthor.types import HUMAN, SUBTICKS, Action, Drive, Observation, Reply, Send, TrialSpec, Wait
from hthor.types.events import Event
from hthor.world import World

roots = st.integers(0, 10**6)


def spec(seconds: float = 12.0) -> TrialSpec:
    """A trial of the fake world that lasts this long unless the goal is met."""
    return msgspec.structs.replace(trial(), task=msgspec.structs.replace(TASK, time_limit=seconds))


def played(root: int, clock: DecisionClock | None = None) -> EpisodeLog:
    return play(spec(), WalkingStage(), *minds(root), clock)  # type: ignore[arg-type]


def begun() -> Episode:
    episode = Episode(spec(), WalkingStage())  # type: ignore[arg-type]
    episode.reset()
    return episode


def drive(episode: Episode, actors: dict[str, Any], order: random.Random | None = None, ticks: int = 10**6) -> None:
    """Drive an episode by these actors; ``order`` shuffles every order of calls within a tick."""
    while not episode.done and ticks:
        ticks -= 1
        seats = list(episode.waiting)
        if order:
            order.shuffle(seats)
        seen = {seat: episode.observe(seat) for seat in seats}
        if order:
            order.shuffle(seats)
        for seat in seats:
            episode.submit(seat, actors[seat].act(seen[seat]))
        episode.advance()


def ended(episode: Episode) -> EpisodeLog:
    people = [seat for seat in episode.seats if seat.startswith(HUMAN)]
    return episode.log(dict.fromkeys(people, 5 if episode.met else 3))


def actors(root: int) -> dict[str, Any]:
    people, robots = minds(root)
    return {**people, **robots}


@settings(max_examples=cases(25))
@given(roots, st.randoms(use_true_random=False))
def test_the_order_of_calls_within_a_tick_never_matters(root: int, order: random.Random) -> None:
    episode = begun()
    drive(episode, actors(root), order)
    assert ended(episode) == played(root)


@settings(max_examples=cases(25))
@given(roots, st.integers(0, 119))
def test_a_copy_has_the_same_future(root: int, ticks: int) -> None:
    episode = begun()
    drive(episode, actors(root), ticks=ticks)
    for seat in episode.waiting[:2]:  # in the middle of a tick
        episode.submit(seat, actors(root)[seat].act(episode.observe(seat)))
    state, copy = episode.save_state(), begun()
    copy.load_state(state)
    assert copy.log() == episode.log()
    drive(episode, actors(root))
    drive(copy, actors(root))
    assert ended(copy) == ended(episode) == played(root)


@settings(max_examples=cases(25))
@given(roots, st.sets(st.integers(0, 100), max_size=5))
def test_pausing_changes_nothing(root: int, pauses: set[int]) -> None:
    episode, who = begun(), actors(root)
    while not episode.done:
        if episode.tick in pauses:
            episode.pause("a question")
            with pytest.raises(HthorError, match="paused"):
                episode.advance()
            episode.resume()
        drive(episode, who, ticks=1)
    log = ended(episode)
    quiet = tuple(event for event in log.events if event.kind not in ("paused", "resumed"))
    assert msgspec.structs.replace(log, events=quiet) == played(root)
    assert len(log.events) - len(quiet) == 2 * len([tick for tick in pauses if tick < log.ticks])


@settings(max_examples=cases(25))
@given(roots)
def test_decisions_that_cost_nothing_are_those_of_lock_step(root: int) -> None:
    assert played(root, Charged(lambda: 0.0)) == played(root)
    instant = Concurrent(pace=lambda _: instant.settle())
    assert played(root, instant) == played(root)


def test_nobody_observes_a_later_tick_than_the_one_shown() -> None:
    people, robots = minds(3)
    for mind in robots.values():
        script = mind.script

        def slowly(now: Observation, script: Any = script) -> Action:
            time.sleep(0.002)
            return script(now)

        mind.script = slowly
    play(spec(), WalkingStage(), people, robots, Concurrent(pace=lambda _: time.sleep(0.0005)))  # type: ignore[arg-type]
    shown = [pair for mind in robots.values() for pair in mind.shown]
    assert len(shown) > 10
    assert all(tick == seen for tick, seen in shown)


def test_a_late_answer_is_logged_with_its_delay_and_the_world_goes_on_meanwhile() -> None:
    people, robots = minds(3)
    gate = threading.Event()

    def stuck(now: Observation) -> Action:
        gate.wait(10.0)
        return Action(say=Send(text="late", object="apple"))

    robots["robot"].script = stuck
    log = play(
        spec(),
        WalkingStage(),
        people,
        robots,
        Concurrent(pace=lambda tick: gate.set() or time.sleep(0.05) if tick == 7 else None),
    )
    thoughts = [event for event in log.events if event.kind == "thought" and event.seat == "robot"]
    assert (thoughts[0].tick, thoughts[0].ticks) == (7, 7)
    assert next(event.tick for event in log.events if event.kind == "sent" and event.seat == "robot") == 7


def test_an_agent_that_fails_in_its_thread_leaves_the_trial() -> None:
    people, robots = minds(3)

    def fail(now: Observation) -> Action:
        raise ValueError("lost")

    robots["robot"].script = fail
    log = play(spec(), WalkingStage(), people, robots, Concurrent(pace=lambda _: time.sleep(0.001)))  # type: ignore[arg-type]
    assert [(fault.seat, "lost" in fault.detail) for fault in log.faults] == [("robot", True)]
    assert log.ticks == 120 or log.met


def test_an_observer_sees_every_event_once_and_in_order() -> None:
    episode, seen = Episode(spec(), WalkingStage()), list[Event]()  # type: ignore[arg-type]
    episode.attach(lambda _, events: seen.extend(events))
    episode.reset()
    drive(episode, actors(5))
    assert seen == episode.events


def test_a_voided_trial_ends_there_with_its_reason() -> None:
    episode = begun()
    drive(episode, actors(5), ticks=7)
    episode.void("the headset slipped")
    assert episode.done
    with pytest.raises(HthorError, match="over"):
        episode.advance()
    log = episode.log()
    assert (log.events[-1].kind, log.events[-1].reason, log.ticks) == ("voided", "the headset slipped", 7)
    assert log.ratings == {}


def test_a_seat_may_speak_while_its_body_is_busy_and_drive_at_any_time() -> None:
    episode = begun()
    episode.submit(HUMAN, Action(motion=Wait(seconds=2.0)))
    episode.submit("robot", Action(say=Send(text="here")))
    episode.advance()
    episode.observe(HUMAN)
    episode.submit(HUMAN, Action(motion=Drive(forward=1.0), say=Reply(message=0, accept=True)))
    events = episode.advance()
    assert [event.kind for event in events if event.seat == HUMAN] == ["shown", "accepted"]
    assert episode.world.drives == {HUMAN: Drive(forward=1.0)}  # type: ignore[attr-defined]


def test_what_is_said_in_a_tick_is_not_lost_by_a_second_action() -> None:
    episode = begun()
    episode.submit("robot", Action(say=Send(text="one")))
    episode.submit("robot", Action(motion=Drive(forward=0.2)))
    assert "sent" in [event.kind for event in episode.advance()]


def test_what_is_no_action_or_no_seat_is_refused() -> None:
    episode = begun()
    with pytest.raises(TypeError, match="Action"):
        episode.submit(HUMAN, "forward")  # type: ignore[arg-type]
    with pytest.raises(HthorError, match="human, human2, robot, robot2"):
        episode.submit("robot7", Action())
    assert episode.seats == SEATS


def test_a_body_that_drives_rests_only_while_it_stands() -> None:
    episode = begun()
    for tick in range(20):
        if tick in (0, 10):
            episode.submit(HUMAN, Action(motion=Drive(forward=0.0 if tick else 1.0)))
        episode.advance()
    assert episode.log().idle[HUMAN] == 10


@pytest.fixture(scope="module")
def house() -> World:
    return World("elder", robots=["scout"])


def driven(world: World, inputs: list[int], *, live: bool) -> EpisodeLog:
    """The log of a person who drives by these inputs, step by step as in a live session, or a tick at a time."""
    task = next(task for task in tasks.load_suite("smoke").tasks if task.house == "elder")
    brief = msgspec.structs.replace(trial(), task=msgspec.structs.replace(task, time_limit=9.0))
    episode, points = Episode(brief, world), iter(batched(inputs))
    episode.reset()
    point = next(points, None)
    while not episode.done:
        for step in range(SUBTICKS) if live else (0,):
            while point is not None and point[:2] <= (episode.tick, step):
                forward, left, yaw, pitch = (number * INPUT_UNIT for number in point[2:])
                episode.steer(HUMAN, Drive(forward=forward, left=left, yaw=yaw, pitch=pitch))
                point = next(points, None)
            if live:
                episode.substep()
        episode.advance()
    return episode.log()


def batched(inputs: list[int]) -> Iterator[tuple[int, ...]]:
    return (tuple(inputs[k : k + 6]) for k in range(0, len(inputs), 6))


@settings(max_examples=cases(10))
@given(st.data())
def test_a_trial_is_repeated_from_the_inputs_in_its_log(house: World, data: st.DataObject) -> None:
    numbers = st.integers(-15_000, 15_000)
    points = st.tuples(st.integers(0, 85), st.integers(0, SUBTICKS - 1), numbers, numbers, numbers, numbers)
    given_inputs = sorted(data.draw(st.lists(points, min_size=3, max_size=12)), key=lambda point: point[:2])
    log = driven(house, [number for point in given_inputs for number in point], live=True)
    (inputs,) = [list(entry.runs) for entry in log.journal if entry.kind == "inputs"]
    assert driven(house, inputs, live=True) == log


def test_steps_of_a_tick_change_nothing_if_the_set_points_change_with_the_ticks(house: World) -> None:
    inputs = [0, 0, 12_000, 0, 3_000, -2_000, 20, 0, 9_000, 4_000, 20_000, 0, 60, 0, 0, 0, -9_000, 500]
    assert driven(house, inputs, live=True) == driven(house, inputs, live=False)


def test_a_seat_observes_before_the_first_step_of_a_tick(house: World) -> None:
    episode = Episode(msgspec.structs.replace(trial(), task=TASK), WalkingStage())  # type: ignore[arg-type]
    episode.world.substep = lambda: None  # type: ignore[method-assign]
    episode.reset()
    seen = episode.observe(HUMAN)
    episode.substep()
    assert episode.observe(HUMAN) is seen
    with pytest.raises(HthorError, match="before the first step"):
        episode.observe("robot")
    episode.advance()
    assert episode.observe("robot").tick == 1


def test_an_agent_that_still_thinks_at_the_end_is_told_to_finish() -> None:
    people, robots = minds(3)
    told = threading.Event()
    thought: list[bool] = []

    class Thinker(Chancy):
        def act(self, observation: Observation) -> Action:
            thought.append(told.wait(60.0))
            return Action()

        def finish(self) -> None:
            told.set()

    robots["robot"] = Thinker("robot", 3)
    play(spec(), WalkingStage(), people, robots, Concurrent(pace=lambda _: None))  # type: ignore[arg-type]
    assert thought == [True], "it was told while it thought"
