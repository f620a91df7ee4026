"""Dealing tasks to people: who does which ten tasks in which order."""

from __future__ import annotations

import math
from collections.abc import Sequence

import msgspec
from msgspec import Struct

from hthor import code_identity, rules, seeds
from hthor.eval.config import robot_team
from hthor.eval.config.robot_team import RobotTeam
from hthor.humans.population import resolve
from hthor.humans.population.resolve import PROXY, ParticipantSource
from hthor.tasks import Suite
from hthor.types import TaskSpec, TrialSpec
from hthor.types.detector_specs import OWN


class Session(Struct, frozen=True, kw_only=True):
    """One person's trials in order. The person remembers earlier ones, so a session is played whole, by one process."""

    participant: int
    trials: tuple[TrialSpec, ...]


def participants_needed(tasks: int) -> int:
    """How many people it takes for everyone to do `rules.SESSION_TASKS` tasks and every task to be done once."""
    return max(1, math.ceil(tasks / rules.SESSION_TASKS))


def make_sessions(
    suite: Suite,
    *,
    agent: str | RobotTeam,
    robot: str = "scout",
    human: str | ParticipantSource = PROXY,
    seed: int = 0,
    participants: int | None = None,
    detector: str = OWN,
    kind_sha256: str = "",
    assets_sha256: str | None = None,
    realtime: bool = False,
    step_limit_s: float | None = None,
) -> tuple[Session, ...]:
    """The sessions of a run.

    Who does what depends on suite, seed and participant alone, never on the robots, so that they all meet the same
    people at the same tasks.

    Args:
        agent: a built-in agent's name or an agent file, in the body ``robot`` with the detector ``detector`` as
            `hthor.types.detector_specs.canonical_name` spells it; or a whole crew, which has all of that.
        human: who the people are, as `hthor.humans.population.resolve` reads it.
        participants: how many people; by default as many as let every task be done exactly once.
        kind_sha256: hash of the file of the tasks' kind, for a kind that is not one of ours.
        assets_sha256: hash of what robots' pictures show and of what draws it, where they may take any;
            None: of our own furniture.
        realtime: whether robots' thinking takes time of the trial.
        step_limit_s: seconds that submitted agents have for each action; None for the usual deadline.
    """
    crew = robot_team.form_team([robot], [agent], detector) if isinstance(agent, str) else agent
    who = resolve.resolve_humans(human) if isinstance(human, str) else human
    rules_hash = rules.sha256()
    code_hash = code_identity.code_sha256(who.model, (task.kind for task in suite.tasks))

    def trial(task: TaskSpec, participant: int, index: int) -> TrialSpec:
        return TrialSpec(
            task=task,
            robots=crew.seats,
            human=who.name,
            human_sha256=who.sha256,
            participant=participant,
            index=index,
            seed=seed,
            suite_sha256=suite.sha256,
            rules_sha256=rules_hash,
            code_sha256=code_hash,
            assets_sha256=robot_team.team_pictures_sha256(crew) if assets_sha256 is None else assets_sha256,
            kind_sha256=kind_sha256,
            realtime=realtime or msgspec.UNSET,
            step_limit_s=robot_team.step_limit_of(crew, step_limit_s),
        )

    count = participants_needed(len(suite.tasks)) if participants is None else participants
    return tuple(
        Session(
            participant=participant,
            trials=tuple(trial(suite.tasks[number], participant, index) for index, number in enumerate(hand)),
        )
        for participant, hand in enumerate(assign_many(suite.tasks, seed, range(count)))
    )


def assign_many(tasks: Sequence[TaskSpec], seed: int, participants: Sequence[int]) -> list[list[int]]:
    """Indices of the tasks that each of these participants does, in order: `deal` for many, each deck mixed once."""
    count = participants_needed(len(tasks))
    decks = {round_: _deck(tasks, seed, round_) for round_ in {participant // count for participant in participants}}
    return [_hand_of(decks[participant // count], seed, participant) for participant in participants]


def count_trials(tasks: int, participants: Sequence[int]) -> int:
    """How many trials these participants have, with so many tasks in the suite."""
    hands = participants_needed(tasks)
    places = (participant % hands for participant in participants)
    return sum((hand + 1) * tasks // hands - hand * tasks // hands for hand in places)


def assign_tasks(tasks: Sequence[TaskSpec], seed: int, participant: int) -> list[int]:
    """Indices of the tasks that a participant does, in order.

    The tasks are a deck, dealt out in hands of at most `rules.SESSION_TASKS`; when it is used up it is mixed anew. The
    houses alternate in the deck, so that each hand has its share of every house.
    """
    return _hand_of(_deck(tasks, seed, participant // participants_needed(len(tasks))), seed, participant)


def _hand_of(deck: Sequence[int], seed: int, participant: int) -> list[int]:
    """What a participant is dealt from the deck of their round."""
    hands = participants_needed(len(deck))
    hand = participant % hands
    held = deck[hand * len(deck) // hands : (hand + 1) * len(deck) // hands]
    return [held[place] for place in seeds.shuffled(len(held), seed, "order", participant)]


def _deck(tasks: Sequence[TaskSpec], seed: int, round_: int) -> list[int]:
    by_house: dict[str, list[int]] = {}
    for number, task in enumerate(tasks):
        by_house.setdefault(task.house, []).append(number)
    places: list[tuple[float, int]] = []
    for house, numbers in by_house.items():
        mixed = seeds.shuffled(len(numbers), seed, "deal", round_, house)
        places += [((rank + 0.5) / len(numbers), numbers[place]) for rank, place in enumerate(mixed)]
    return [number for _, number in sorted(places)]
