"""A person plays whole trials in a world that tells them nothing but what a headset's wearer perceives."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pytest

from hthor import tasks
from hthor.episode import EpisodeLog, play
from hthor.tasks.suite import make_suite
from hthor.trials import Participants, TrialRunner
from hthor.trials.sessions import make_sessions
from hthor.types import Action, Briefing, Observation, TrialSpec
from hthor.types.events import Event

PERCEIVED = ("detections", "scan", "sighting")
"""What a headset's wearer has of the senses: what is in view and how much of it, and what stops a walker."""
TOLD = ("tick", "pose", "idle", "room", "holding", "outcome", "inbox", "receipt", "phase", "display")
BRIEFED = ("instruction", "body", "tick_s", "time_limit", "teammates", "kind", "jobs", "todo", "crew", "phases")
BRIEFED_GOAL = ("seat", "target", "destination", "relation")


class Hidden(AssertionError):
    """Somebody looked at what they cannot know."""


class Veil:
    """Lets only some names of a thing through."""

    def __init__(self, thing: Any, allowed: tuple[str, ...], extra: Mapping[str, Any] | None = None) -> None:
        self.__dict__["_inside"] = (thing, allowed, dict(extra or {}))

    def __getattr__(self, name: str) -> Any:
        thing, allowed, extra = self.__dict__["_inside"]
        if name in extra:
            return extra[name]
        if name not in allowed:
            raise Hidden(f"{type(thing).__name__}.{name}")
        return getattr(thing, name)

    def __setattr__(self, name: str, value: object) -> None:
        raise Hidden(f"changing {name}")


class Guarded:
    """A human model behind the veil; while it thinks, the world itself is shut as well."""

    def __init__(self, human: Any, world: Shut) -> None:
        self.human, self.world = human, world

    def begin(self, briefing: Briefing) -> None:
        self.world.shut = True
        self.human.begin(Veil(briefing, (*BRIEFED, *BRIEFED_GOAL)))
        self.world.shut = False

    def act(self, observation: Observation) -> Action:
        self.world.shut = True
        action: Action = self.human.act(Seen(observation))
        self.world.shut = False
        return action

    def rate(self, met: bool, tick: int) -> int | None:
        self.world.shut = True
        rating: int | None = self.human.rate(met, tick)
        self.world.shut = False
        return rating

    def state(self) -> Mapping[str, Any]:
        state: Mapping[str, Any] = self.human.state()
        return state

    @property
    def journal(self) -> tuple[Event, ...]:
        return tuple(self.human.journal)


class Seen(Veil):
    """An observation without truth, pictures, or senses other than the eyes' and the map's."""

    def __init__(self, observation: Observation) -> None:
        super().__init__(observation, TOLD, {"senses": Veil(observation.senses, PERCEIVED)})

    @property
    def detections(self) -> Any:
        return self.senses.detections()

    @property
    def scan(self) -> Any:
        return self.senses.scan()


class Shut:
    """A world of which nothing can be had while it is ``shut``."""

    def __init__(self, world: Any) -> None:
        self._world, self.shut = world, False

    def __getattr__(self, name: str) -> Any:
        if self.shut:
            raise Hidden(f"the world's {name}")
        return getattr(self._world, name)


def trials(agent: str, stage: TrialRunner, *, veiled: bool) -> list[EpisodeLog]:
    smoke = tasks.load_suite("smoke")
    few = make_suite("few", 1, tuple(task for task in smoke.tasks if task.house == "elder"))
    session, logs = make_sessions(few, agent=agent, seed=2)[0], []
    with stage.enter(session) as company:
        for trial in session.trials[:4]:
            logs.append(_one(trial, stage, company, veiled))
    return logs


def _one(trial: TrialSpec, stage: TrialRunner, company: Participants, veiled: bool) -> EpisodeLog:
    world = stage.world(trial)
    if not veiled:
        return play(trial, world, company.humans, company.ready_agents())
    shut = Shut(world)
    return play(trial, shut, {"human": Guarded(company.humans["human"], shut)}, company.ready_agents())  # type: ignore[arg-type]


@pytest.fixture(scope="module")
def stage() -> TrialRunner:
    return TrialRunner()


@pytest.mark.parametrize("agent", [pytest.param("silent", marks=pytest.mark.nightly), "oracle"])
def test_a_person_plays_on_without_the_truth(agent: str, stage: TrialRunner) -> None:
    veiled, plain = trials(agent, stage, veiled=True), trials(agent, stage, veiled=False)
    assert veiled == plain, "what was hidden had been used"
    assert sum(log.ticks for log in veiled) > 4 * 50
    kinds = {event.kind for log in veiled for event in log.journal}
    assert {"choice", "exposure", "stick", "head"} <= kinds, "they did not search, so this test showed little"
    assert ("offer" in kinds) == (agent == "oracle")


def test_the_veil_holds(stage: TrialRunner) -> None:
    """The guard itself: whoever looks at the truth is caught."""

    class Cheat:
        def begin(self, briefing: Briefing) -> None:
            self.briefing = briefing

        def act(self, observation: Observation) -> Action:
            for look in (
                lambda: observation.truth,
                lambda: observation.rgb,
                lambda: observation.senses.segmentation(),
                lambda: self.briefing.house,
                lambda: self.briefing.privileges,
                lambda: shut.snapshot(),
                lambda: shut.house,
                lambda: shut.truth(),
            ):
                with pytest.raises(Hidden):
                    look()
            return Action()

        def rate(self, met: bool, tick: int) -> int | None:
            with pytest.raises(Hidden):
                shut.pose("robot")
            return None

        journal = ()

    smoke = tasks.load_suite("smoke")
    few = make_suite("one", 1, tuple(task for task in smoke.tasks if task.house == "elder")[:1])
    trial = make_sessions(few, agent="silent")[0].trials[0]
    shut = Shut(stage.world(trial))
    log = play(trial, shut, {"human": Guarded(Cheat(), shut)}, {})  # type: ignore[arg-type]
    assert not log.met
