"""Trials and sessions from tasks, robots and people; assigning a suite's tasks to sessions, ten each in some order."""

import math
from collections.abc import Iterable, Sequence
from typing import Any

import msgspec
from msgspec import Struct

from hthor import code_identity, rules, seeds
from hthor.errors import HthorError
from hthor.humans.population.resolve import PROXY
from hthor.tasks import Suite, load_suite
from hthor.trials import human_team, robot_team
from hthor.trials.human_team import HumanTeam
from hthor.trials.robot_team import RobotTeam
from hthor.types import TaskSpec, TrialSpec
from hthor.types.detector_specs import OWN
from hthor.types.specs import LOCKSTEP, Clock


class Session(Struct, frozen=True, kw_only=True):
    """The trials of some people in order. They remember earlier trials, so one process runs the whole session.

    ``number`` counts the sessions of a run from 0.
    """

    number: int
    trials: tuple[TrialSpec, ...]


def sessions_needed(tasks: int) -> int:
    """How many sessions are needed to do every task once, at most `rules.SESSION_TASKS` tasks in each."""
    return max(1, math.ceil(tasks / rules.SESSION_TASKS))


def count_sessions(tasks: int, participants: int | None, people: int) -> int:
    """How many sessions a run has.

    Args:
        participants: how many people take part in all; None for as many as are needed to do every task once.
        people: how many of them are together in a trial.

    Raises:
        HthorError: when they do not come out even.
    """
    if participants is None:
        return sessions_needed(tasks)
    if participants % people:
        raise HthorError(
            f"--participants {participants}: with {people} people in every trial, the number must be a multiple of "
            f"{people}, such as {people * math.ceil(participants / people)}."
        )
    return participants // people


class StudySetup(Struct, frozen=True, kw_only=True):
    """What all trials of a study have in common: robots, people, seed and rules; it makes the trials of any tasks.

    Attributes:
        team: the robots. people: who they meet; which of them, a session's number decides.
        suite_sha256, kind_sha256: hashes of the suite and of a user's own task kind; empty where there is none.
        assets_sha256: hash of the robots' pictures, as `robot_team.team_pictures_sha256`.
        step_limit_s: seconds that submitted agents have for each action; None for the usual deadline.
    """

    team: RobotTeam
    people: HumanTeam
    seed: int
    rules_sha256: str
    code_sha256: str
    suite_sha256: str = ""
    kind_sha256: str = ""
    assets_sha256: str = ""
    clock: Clock = LOCKSTEP
    step_limit_s: float | None = None

    def session(self, number: int, tasks: Sequence[TaskSpec]) -> Session:
        """The session in which the people of this number do these tasks, in order."""
        robots, humans = self.team.seats, self.people.seats(number)
        trials = (
            TrialSpec(
                task=task,
                robots=robots,
                humans=humans,
                session=number,
                index=index,
                seed=self.seed,
                suite_sha256=self.suite_sha256,
                rules_sha256=self.rules_sha256,
                code_sha256=self.code_sha256,
                assets_sha256=self.assets_sha256,
                kind_sha256=self.kind_sha256,
                clock=msgspec.UNSET if self.clock == LOCKSTEP else self.clock,
                step_limit_s=robot_team.step_limit_of(self.team, self.step_limit_s),
            )
            for index, task in enumerate(tasks)
        )
        return Session(number=number, trials=tuple(trials))


def make_setup(
    kinds: Iterable[str],
    *,
    agent: str | RobotTeam,
    robot: str = "scout",
    humans: str | HumanTeam = PROXY,
    seed: int = 0,
    detector: str = OWN,
    suite_sha256: str = "",
    kind_sha256: str = "",
    assets_sha256: str | None = None,
    clock: Clock = LOCKSTEP,
    step_limit_s: float | None = None,
) -> StudySetup:
    """The setup of a study with tasks of these kinds.

    Args:
        agent: a built-in agent's name or an agent file, in the body ``robot`` with the detector ``detector`` as
            `hthor.types.detector_specs.canonical_name` spells it; or a team, which includes bodies and detector.
        humans: the people of each trial, or the word by which `hthor.trials.human_team` finds them.
        assets_sha256: hash of the robots' pictures, as `robot_team.team_pictures_sha256`; None: of our own furniture.
        suite_sha256, kind_sha256, clock, step_limit_s: see `StudySetup`.

    Raises:
        HthorError: when there is no such agent, robot or population, or they do not go together; for a negative seed.
    """
    team = robot_team.form_team([robot], [agent], detector) if isinstance(agent, str) else agent
    people = human_team.find_team(humans) if isinstance(humans, str) else humans
    return StudySetup(
        team=team,
        people=people,
        seed=seeds.check_seed(seed),
        rules_sha256=rules.sha256(),
        code_sha256=code_identity.code_sha256(people.models, kinds),
        suite_sha256=suite_sha256,
        kind_sha256=kind_sha256,
        assets_sha256=robot_team.team_pictures_sha256(team) if assets_sha256 is None else assets_sha256,
        clock=clock,
        step_limit_s=step_limit_s,
    )


def make_session(tasks: Sequence[TaskSpec], *, number: int = 0, **setup: Any) -> Session:
    """The session of this number with these tasks, in order; ``setup`` as in `make_setup`."""
    return make_setup(sorted({task.kind for task in tasks}), **setup).session(number, tasks)


def make_sessions(
    suite: Suite | str, *, participants: int | None = None, numbers: Sequence[int] | None = None, **setup: Any
) -> tuple[Session, ...]:
    """The sessions of a study with the tasks of a suite.

    Which tasks a session has depends on suite, seed and the session's place in the study alone, never on the robots, so
    that all robots meet the same people with the same tasks.

    Args:
        suite: a suite, or the name of one that ships with hthor.
        participants: how many people in all; by default the number that is needed to do every task exactly once.
        numbers: the sessions' own numbers, which decide their people; by default they count from 0. The groups of a
            between-subjects study have other people each, who do the same tasks in the same order.
        setup: as in `make_setup`.

    Raises:
        HthorError: also when there is no such suite.
    """
    suite = load_suite(suite) if isinstance(suite, str) else suite
    study = make_setup((task.kind for task in suite.tasks), suite_sha256=suite.sha256, **setup)
    if numbers is None:
        numbers = range(count_sessions(len(suite.tasks), participants, len(study.people.members)))
    hands = assign_many(suite.tasks, study.seed, range(len(numbers)))
    return tuple(
        study.session(number, [suite.tasks[place] for place in hand])
        for number, hand in zip(numbers, hands, strict=True)
    )


def assign_many(tasks: Sequence[TaskSpec], seed: int, sessions: Sequence[int]) -> list[list[int]]:
    """`assign_tasks` for each of these sessions; faster, as each deck is shuffled once."""
    per_deck = sessions_needed(len(tasks))
    decks = {number: _deck(tasks, seed, number) for number in {session // per_deck for session in sessions}}
    return [_hand(decks[session // per_deck], seed, session) for session in sessions]


def count_trials(tasks: int, sessions: Sequence[int]) -> int:
    """How many trials these sessions have, with ``tasks`` tasks in the suite."""
    hands = sessions_needed(tasks)
    numbers = (session % hands for session in sessions)
    return sum((number + 1) * tasks // hands - number * tasks // hands for number in numbers)


def assign_tasks(tasks: Sequence[TaskSpec], seed: int, session: int) -> list[int]:
    """Indices of the tasks of a session, in order.

    The tasks are a deck of cards, dealt in hands of at most `rules.SESSION_TASKS` tasks; a used-up deck is shuffled
    again. The houses alternate in the deck, so that each hand has its share of every house.
    """
    return _hand(_deck(tasks, seed, session // sessions_needed(len(tasks))), seed, session)


def _hand(deck: Sequence[int], seed: int, session: int) -> list[int]:
    """The tasks that a session gets from its deck, in order."""
    hands = sessions_needed(len(deck))
    number = session % hands
    hand = deck[number * len(deck) // hands : (number + 1) * len(deck) // hands]
    return [hand[place] for place in seeds.shuffled(len(hand), seed, "order", session)]


def _deck(tasks: Sequence[TaskSpec], seed: int, deck: int) -> list[int]:
    by_house: dict[str, list[int]] = {}
    for number, task in enumerate(tasks):
        by_house.setdefault(task.house, []).append(number)
    places: list[tuple[float, int]] = []
    for house, numbers in by_house.items():
        order = seeds.shuffled(len(numbers), seed, "deal", deck, house)
        places += [((rank + 0.5) / len(numbers), numbers[place]) for rank, place in enumerate(order)]
    return [number for _, number in sorted(places)]
