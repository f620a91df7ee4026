"""Assigning tasks to sessions, ten each in some order, and dividing a run's sessions among machines."""

import math
import re
from collections.abc import Sequence
from pathlib import Path
from typing import TypeVar

import msgspec
from msgspec import Struct

from hthor import code_identity, rules, seeds
from hthor.errors import HthorError
from hthor.eval.config import human_team, robot_team
from hthor.eval.config.human_team import HumanTeam
from hthor.eval.config.robot_team import RobotTeam
from hthor.eval.config.study_design import StudyDesign
from hthor.humans.population.resolve import PROXY
from hthor.tasks import Suite
from hthor.types import TaskSpec, TrialSpec
from hthor.types.detector_specs import OWN
from hthor.types.specs import LOCKSTEP, Clock

_T = TypeVar("_T")
_SHARD_ENDING = re.compile(r"-shard-\d+-of-\d+$")


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


def make_sessions(
    suite: Suite,
    *,
    agent: str | RobotTeam,
    robot: str = "scout",
    humans: str | HumanTeam = PROXY,
    seed: int = 0,
    participants: int | None = None,
    detector: str = OWN,
    kind_sha256: str = "",
    assets_sha256: str | None = None,
    clock: Clock = LOCKSTEP,
    step_limit_s: float | None = None,
    design: StudyDesign | None = None,
) -> tuple[Session, ...]:
    """The sessions of a run.

    Which tasks a session has depends on suite, seed and the session's place in the run alone, never on the robots, so
    that all robots meet the same people with the same tasks. The groups of a between-subjects study have other people
    each, who do the same tasks in the same order.

    Args:
        agent: a built-in agent's name or an agent file, in the body ``robot`` with the detector ``detector`` as
            `hthor.types.detector_specs.canonical_name` spells it; or a team, which includes bodies and detector.
        humans: the people of each trial, or the word by which `hthor.eval.config.human_team` finds them.
        participants: how many people in all; by default the number that is needed to do every task exactly once.
        assets_sha256: hash of the robots' pictures, as `robot_team.team_pictures_sha256`; None: of our own furniture.
        step_limit_s: seconds that submitted agents have for each action; None for the usual deadline.
        design: the between-subjects study that the run is a condition of; it knows the number of people itself.
    """
    team = robot_team.form_team([robot], [agent], detector) if isinstance(agent, str) else agent
    people = human_team.find_team(humans) if isinstance(humans, str) else humans
    rules_hash = rules.sha256()
    code_hash = code_identity.code_sha256(people.models, (task.kind for task in suite.tasks))

    def trial(task: TaskSpec, session: int, index: int) -> TrialSpec:
        return TrialSpec(
            task=task,
            robots=team.seats,
            humans=people.seats(session),
            session=session,
            index=index,
            seed=seed,
            suite_sha256=suite.sha256,
            rules_sha256=rules_hash,
            code_sha256=code_hash,
            assets_sha256=robot_team.team_pictures_sha256(team) if assets_sha256 is None else assets_sha256,
            kind_sha256=kind_sha256,
            clock=msgspec.UNSET if clock == LOCKSTEP else clock,
            step_limit_s=robot_team.step_limit_of(team, step_limit_s),
        )

    together = len(people.members)
    numbers = (
        design.sessions(seed, together) if design else range(count_sessions(len(suite.tasks), participants, together))
    )
    hands = assign_many(suite.tasks, seed, range(len(numbers)))
    return tuple(
        Session(
            number=session,
            trials=tuple(trial(suite.tasks[number], session, index) for index, number in enumerate(hand)),
        )
        for session, hand in zip(numbers, hands, strict=True)
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


class Shard(Struct, frozen=True, kw_only=True):
    """One share of a run: number ``number``, counted from 1, of ``of`` shares; it has ``trials`` trials."""

    number: int
    of: int
    trials: int = 0

    @property
    def words(self) -> str:
        """The shard as the command line names it, such as "3/16"."""
        return f"{self.number}/{self.of}"

    def share(self, whole: Sequence[_T]) -> tuple[_T, ...]:
        """This shard's part of the sessions: every ``of``-th, so that all shards have their share of every house."""
        return tuple(whole[self.number - 1 :: self.of])

    def folder(self, run: Path) -> Path:
        """The folder of this shard when the whole run's would be ``run``."""
        return run.with_name(f"{run.name}-shard-{self.number}-of-{self.of}")


def parse_shard(text: str) -> Shard:
    """The shard that the user named, such as "3/16"; raises HthorError when there is no such shard."""
    number, slash, of = text.partition("/")
    if not (slash and number.isdecimal() and of.isdecimal() and 1 <= int(number) <= int(of)):
        raise HthorError(f"--shard '{text}': expected i/N with i from 1 to N, such as 1/16 up to 16/16.")
    return Shard(number=int(number), of=int(of))


def whole_folder(folder: Path) -> Path:
    """The folder of the whole run, given the folder of a shard, which is named after it."""
    return folder.with_name(_SHARD_ENDING.sub("", folder.name))
