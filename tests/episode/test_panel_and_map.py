"""Panel and map in a trial: people see and switch them, robots have none, and a copy of a trial has the same ones."""

from __future__ import annotations

import msgspec
from episode_fakes import Mind, Stage, trial
from walking_stage import WalkingStage

from hthor import jsonio
from hthor.episode import Episode, play
from hthor.types import HUMAN, Action, MapBody, MapPlace, Move, Observation, Reply, Send, Show, Wait
from hthor.types.events import Displayed, Refused


def messenger(*ticks: int) -> Mind:
    """A robot that sends a message at these ticks, about a place one metre to the left of the house's origin."""

    def script(now: Observation) -> Action:
        said = Send(text=f"at {now.tick}", object="apple", position=(0.0, 1.0, 0.5)) if now.tick in ticks else None
        return Action(motion=Wait(seconds=0.1), say=said)

    return Mind(script)


def person(*, signals: dict[int, tuple[Show, ...]] | None = None, accept: bool = True) -> Mind:
    """A person who answers two ticks after a message came, and switches their display at some ticks."""

    def script(now: Observation) -> Action:
        ripe = [one for one in now.inbox if now.tick >= one.tick + 2]
        say = Reply(message=ripe[0].id, accept=accept) if ripe else None
        return Action(motion=Wait(seconds=0.1), say=say, signals=(signals or {}).get(now.tick, ()))

    return Mind(script)


def seen(mind: Mind) -> dict[int, tuple[int | None, bool]]:
    """By tick: the message on the panel, and whether the map was shown."""
    return {
        now.tick: (now.display.message.id if now.display.message is not None else None, now.display.map is not None)
        for now in mind.observed
        if now.display is not None
    }


def test_a_person_sees_panel_and_map_when_the_paper_says_and_a_robot_neither() -> None:
    human, robot = person(), messenger(5)
    log = play(trial(), Stage(seen=20), {HUMAN: human}, {"robot": robot})
    shown = seen(human)
    assert [shown[tick] for tick in (5, 6, 7, 8, 19)] == [
        (None, False),
        (0, False),
        (0, False),
        (None, True),
        (None, True),
    ]
    assert all(now.display is None for now in robot.observed)
    assert not [event for event in log.events if isinstance(event, (Displayed, Refused))]
    declines = person(accept=False)
    play(trial(), Stage(seen=20), {HUMAN: declines}, {"robot": messenger(5)})
    assert seen(declines)[19] == (None, False), "who declines gets no map"


def test_panel_and_map_are_hidden_and_shown_whenever_the_person_wants() -> None:
    off, on = (Show(what="panel", on=False),), (Show(what="panel"), Show(what="map", on=False))
    human = person(signals={6: off, 10: on, 12: (Show(what="map"),)})
    log = play(trial(), Stage(seen=20), {HUMAN: human}, {"robot": messenger(5)})
    shown = seen(human)
    assert shown[7] == (None, False), "hidden before it is answered"
    assert [shown[tick] for tick in (10, 11, 13)] == [(None, True), (0, False), (0, True)]
    assert [(e.tick, e.what, e.on, e.message) for e in log.events if isinstance(e, Displayed)] == [
        (6, "panel", False, 0),
        (10, "panel", True, 0),
        (10, "map", False, 0),
        (12, "map", True, 0),
    ]


def test_what_does_not_exist_is_refused_with_a_reason() -> None:
    human = person(signals={1: (Show(what="map"), Show(what="panel"))})
    robot = Mind(lambda now: Action(signals=(Show(what="map"),) if now.tick == 2 else ()))
    log = play(trial(), Stage(seen=4), {HUMAN: human}, {"robot": robot})
    refused = [(event.seat, event.reason) for event in log.events if isinstance(event, Refused)]
    assert [seat for seat, _ in refused] == [HUMAN, HUMAN, "robot"]
    assert "no message was confirmed yet" in refused[0][1]
    assert "no message has come yet" in refused[1][1]


def test_the_map_is_live() -> None:
    """Person and robot walk along x; places and bodies on the map stay where they are in the house."""
    human = Mind(
        lambda now: Action(
            motion=Move(forward=0.3), say=Reply(message=now.inbox[0].id, accept=True) if now.inbox else None
        )
    )
    robot = Mind(lambda now: Action(motion=Move(forward=-0.3), say=messenger(3).script(now).say))
    play(trial(), WalkingStage((HUMAN, "robot")), {HUMAN: human}, {"robot": robot})
    at = {now.tick: now for now in human.observed}
    robots = {now.tick: now.pose.x for now in robot.observed}
    maps = [(tick, now.pose.x, now.display.map) for tick, now in at.items() if now.display and now.display.map]
    assert len({x for _, x, _ in maps}) > 2
    for tick, x, shown in maps:
        if tick in robots:
            assert shown.bodies == (MapBody(seat="robot", forward=round(robots[tick] - x, 3), left=0.0),)
        (place,) = shown.places
        assert place == MapPlace(message=0, sender="robot", object="apple", forward=round(-x, 3), left=1.0)


def test_a_copy_of_a_trial_has_the_same_display() -> None:
    stage = WalkingStage((HUMAN, "robot"))
    episode = Episode(trial(), stage)
    episode.reset()
    human = person(signals={9: (Show(what="map", on=False),)})
    minds = {HUMAN: human, "robot": messenger(5)}

    def run(until: int) -> bytes:
        while episode.tick < until:
            for seat in episode.waiting:
                episode.submit(seat, minds[seat].act(episode.observe(seat)))
            episode.advance()
        return jsonio.pretty([msgspec.to_builtins(event) for event in episode.events])

    run(8)
    state = episode.save_state()
    once = run(14)
    assert episode.observe(HUMAN).display is not None
    assert (episode.observe(HUMAN).display.map, episode.observe(HUMAN).display.message) == (None, None)  # type: ignore[union-attr]
    episode.load_state(state)
    shown = episode.observe(HUMAN).display
    assert shown is not None
    assert shown.map is not None
    assert run(14) == once
