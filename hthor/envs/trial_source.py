"""The trials of an environment for learners: the tasks of a suite, new people for each, and kept worlds."""

from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Any

import msgspec

from hthor import catalog, plugins
from hthor.envs.episode_control import EpisodeControl
from hthor.errors import HthorError, UnknownName
from hthor.guest.protocol.wire import PRIVILEGES
from hthor.humans.model import HumanModel
from hthor.tasks.suite import Suite
from hthor.tasks.suites.library import load_suite
from hthor.trials import robot_team
from hthor.trials.robot_team import AgentInfo
from hthor.trials.sessions import StudySetup, make_setup
from hthor.trials.sources import make_sources
from hthor.trials.trial_runner import TrialRunner
from hthor.types import Action, AgentRef, BodySpec, Briefing, Observation, TaskSpec, TrialSpec, Wait, cameras
from hthor.types.detector_specs import OWN, canonical_name

LEARNER = "learner"
"""The name of the agent in the trials of these environments."""
BYSTANDER = "bystander"
"""The name of the human model of people who stand aside."""


class Bystander:
    """A person who stands where the task begins, does nothing and says nothing."""

    def begin(self, briefing: Briefing) -> None:
        """There is nothing to prepare."""

    def act(self, observation: Observation) -> Action:  # noqa: ARG002
        """Wait."""
        return Action(motion=Wait(seconds=60.0))

    def rate(self, met: bool, tick: int) -> int | None:  # noqa: ARG002
        """No rating."""
        return None

    def state(self) -> Mapping[str, bool | int | float | str | None]:
        """Nothing carries over."""
        return {}


class TrialSource:
    """Makes trials and their worlds, which are kept for later trials in the same house within a bound on their memory.

    Args:
        suite: a suite, its name or its path. houses, kinds: only its tasks in these houses and of these kinds, if any.
        robots: the bodies. humans: the people, as a word of `--humans`; None for a person who stands aside.
        detector, camera: as in `hthor.trials.robot_team.form_team`. privileges: of the learner.

    Attributes:
        tasks: the tasks. bodies: the robots' bodies, by seat. jobs: the most jobs that a task has.

    Raises:
        HthorError: when there is no such suite, house, kind, robot or privilege, or no task is left.
    """

    def __init__(
        self,
        suite: Suite | str | Path,
        *,
        houses: Collection[str] = (),
        kinds: Collection[str] = (),
        robots: Sequence[str] = ("scout",),
        humans: str | None = "proxy",
        detector: str = OWN,
        camera: str = cameras.OWN,
        privileges: Sequence[str] = (),
    ) -> None:
        if not robots:
            raise HthorError("robots is empty; name at least one robot, such as robots=['tender']")
        suite = load_suite(suite) if isinstance(suite, (str, Path)) else suite
        self.tasks = _select(suite.tasks, houses, kinds)
        if unknown := [name for name in privileges if name not in PRIVILEGES]:
            raise UnknownName("privilege", unknown[0], PRIVILEGES)
        ref = AgentRef(name=LEARNER, source="", sha256="", privileges=tuple(privileges))
        team = robot_team.form_team(robots, [AgentInfo(ref=ref)] * len(robots), canonical_name(detector), camera)
        self._alone, self._houses = humans is None, suite.houses
        self._setup: StudySetup = make_setup(
            {task.kind for task in self.tasks}, agent=team, humans=humans or "proxy", suite_sha256=suite.sha256
        )
        word = "" if humans is None else self._setup.people.word
        self._runner = TrialRunner(make_sources(team, houses=suite.houses.folder, humans=word))
        paths = team.robot_paths
        self.bodies: dict[str, BodySpec] = {
            seat.seat: plugins.load("robot", paths.get(seat.seat, seat.robot)) for seat in team.seats
        }
        self.jobs = max(len(task.goal.todo) for task in self.tasks)

    def leave_out_hidden(self) -> None:
        """Leave out the tasks whose object cannot be seen unless somebody opens what it is in."""
        things = {name: self._houses.load(name).things for name in {task.house for task in self.tasks}}
        kinds = {house: {thing.id: thing.kind for thing in known} for house, known in things.items()}
        self.tasks = tuple(task for task in self.tasks if not _hidden(task, kinds[task.house]))
        if not self.tasks:
            raise HthorError("the objects of all these tasks are behind doors, which this robot cannot open")

    def find(self, id: Any) -> TaskSpec:
        """The task with this id. Raises UnknownName when there is none."""
        found = next((task for task in self.tasks if task.id == id), None)
        if found is None:
            raise UnknownName("task", str(id), [task.id for task in self.tasks])
        return found

    def trial(self, task: TaskSpec, seed: int, participant: int) -> TrialSpec:
        """The first trial of the session of this number in the study with this seed."""
        trial = msgspec.structs.replace(self._setup, seed=seed).session(participant, [task]).trials[0]
        if not self._alone:
            return trial
        humans = tuple(msgspec.structs.replace(seat, model=BYSTANDER, sha256="") for seat in trial.humans)
        return msgspec.structs.replace(trial, humans=humans)

    def control(self, trial: TrialSpec) -> EpisodeControl:
        """The trial in its world, which no other trial of this source may use at the same time."""
        return EpisodeControl(trial, self._runner.world(trial), lambda: self._people(trial))

    def close(self) -> None:
        """Drop the worlds; the next trial makes new ones."""
        self._runner = TrialRunner(self._runner.sources)

    def _people(self, trial: TrialSpec) -> Mapping[str, HumanModel]:
        if self._alone:
            return {seat.seat: Bystander() for seat in trial.humans}
        return self._runner.make_people(trial)


def _hidden(task: TaskSpec, kinds: Mapping[str, str]) -> bool:
    """Whether the task's object is in something that hides it; ``kinds`` are those of the house's things, by id."""
    target = next(placed for placed in task.objects if placed.id == task.goal.target)
    return target.relation == "in" and catalog.kind(kinds[target.support]).hides


def _select(tasks: Sequence[TaskSpec], houses: Collection[str], kinds: Collection[str]) -> tuple[TaskSpec, ...]:
    for sort, asked, known in (
        ("house", houses, {task.house for task in tasks}),
        ("task kind", kinds, {task.kind for task in tasks}),
    ):
        if isinstance(asked, str):
            raise HthorError(f"name each {sort} in a list, such as [{asked!r}]")
        for name in asked:
            if name not in known:
                raise UnknownName(sort, name, sorted(known))
    found = tuple(task for task in tasks if (not houses or task.house in houses) and (not kinds or task.kind in kinds))
    if not found:
        raise HthorError("the suite has no such task")
    return found
