"""A run's configuration, `run.json`: everything that decides its records."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

import msgspec
from msgspec import Struct

from hthor import code_identity, installation, jsonio, rules, seeds
from hthor.errors import HthorError
from hthor.eval.config import human_populations
from hthor.eval.config.human_populations import HumanModelRef
from hthor.eval.config.shards import Shard
from hthor.eval.config.study_design import BETWEEN, StudyDesign
from hthor.guest.agent.manifest import Manifest
from hthor.humans.population.resolve import PROXY
from hthor.tasks import Suite
from hthor.trials import human_team, robot_team, sessions
from hthor.trials.human_team import HumanTeam
from hthor.trials.robot_team import RobotTeam
from hthor.types import RobotSeat
from hthor.types.specs import LOCKSTEP, Clock

SCHEMA = "hthor.run/5"
OLD_SCHEMA = "hthor.run/4"
"""The schema of runs that `hthor migrate` converts."""
_NAME_MAX = 100
_HOUSES_NAMED = 4
"""A run's folder names its houses when they are fewer than this."""
_TITLE = re.compile(r"\w[\w.+-]{0,59}")


class SuiteRef(Struct, frozen=True, kw_only=True):
    """The tasks: a suite's name and version, and the hash of its content."""

    name: str
    version: str
    sha256: str


PROCEDURAL = "procedural"
"""Name of the furniture that ships with hthor."""


class AssetsRef(Struct, frozen=True, kw_only=True):
    """The furniture in robots' pictures: our own or a pack, and the hash of it and of the code that draws it.

    ``sha256`` is empty where no picture can affect what a robot does: where all agents are built in and neither a
    camera nor a pack was chosen.
    """

    name: str = PROCEDURAL
    sha256: str = ""


class KindRef(Struct, frozen=True, kw_only=True):
    """The one task kind that a run was narrowed to, and the hash of its file when it is the user's own."""

    name: str
    sha256: str = ""


class RunConfig(Struct, frozen=True, kw_only=True):
    """A run's configuration.

    Attributes:
        title: the user's name for the run; it changes no trial, and runs that differ only in it are the same run.
        options: options of the user's that change no trial either, but belong to the command that goes on with the run,
            by their names in `hthor.eval.config.options`.
        robots: every robot with its agent and detector; an agent that needs no robot is listed without a seat.
        agents: the files of every submitted agent.
        kind: the task kind that the suite was narrowed to, None for all its tasks; ``kinds``: the kinds of the tasks,
            which older runs do not have.
        participants: how many people take part in all sessions together.
        design: the between-subjects study that this run is a condition of, if it is one.
        trials: how many trials the whole run has.
        clock: when agents' answers take effect, where it is not in lock-step.
        limit: how many tasks were chosen from the suite, if not all.
        houses: the houses, and ``difficulty`` the difficulty, that the suite was narrowed to.
        step_limit_s: the submitted agents' deadline for each action [s], where it is not the default.
        shard: the share that this run is, if a run was divided among machines.
    """

    schema: str = SCHEMA
    title: str | msgspec.UnsetType = msgspec.UNSET
    options: dict[str, str | float] | msgspec.UnsetType = msgspec.UNSET
    robots: tuple[RobotSeat, ...]
    agents: tuple[Manifest, ...] = ()
    humans: HumanModelRef
    suite: SuiteRef
    kind: KindRef | None = None
    kinds: tuple[str, ...] | msgspec.UnsetType = msgspec.UNSET
    seed: int
    participants: int
    trials: int
    rules_sha256: str
    code_sha256: str
    versions: dict[str, str]
    assets: AssetsRef
    clock: Clock | msgspec.UnsetType = msgspec.UNSET
    limit: int | msgspec.UnsetType = msgspec.UNSET
    houses: tuple[str, ...] | msgspec.UnsetType = msgspec.UNSET
    difficulty: str | msgspec.UnsetType = msgspec.UNSET
    step_limit_s: float | msgspec.UnsetType = msgspec.UNSET
    design: StudyDesign | msgspec.UnsetType = msgspec.UNSET
    shard: Shard | msgspec.UnsetType = msgspec.UNSET

    @property
    def sha256(self) -> str:
        """Hash of everything that decides the records."""
        return jsonio.sha256(self.untitled)

    @property
    def untitled(self) -> RunConfig:
        """The configuration without its title and options: everything that decides the records."""
        return msgspec.structs.replace(self, title=msgspec.UNSET, options=msgspec.UNSET)

    @property
    def whole(self) -> RunConfig:
        """The run that this is a shard of; the run itself when it is not divided."""
        return msgspec.structs.replace(self, shard=msgspec.UNSET) if self.shard else self

    @property
    def expected_trials(self) -> int:
        """How many trials the run's folder has when it is complete: those of the shard, if this is one."""
        return self.shard.trials if self.shard else self.trials

    @property
    def seats(self) -> tuple[RobotSeat, ...]:
        """The robots that are in the world."""
        return tuple(robot for robot in self.robots if robot.seat)

    @property
    def sessions(self) -> int:
        """How many sessions the whole run has."""
        return self.participants // len(self.humans.members)

    @property
    def session_numbers(self) -> Sequence[int]:
        """The numbers of the whole run's sessions."""
        return self.design.sessions(self.seed, len(self.humans.members)) if self.design else range(self.sessions)

    @property
    def mode(self) -> Clock:
        """The decision clock: "lockstep", "charged" or "concurrent"."""
        return self.clock or LOCKSTEP

    @property
    def name(self) -> str:
        """The run's name: the user's name for it, or else its team's."""
        return self.title or self.team_name

    @property
    def label(self) -> str:
        """The run's name in tables and sentences."""
        return robot_team.display_name(self.name, self.robots)

    @property
    def team_name(self) -> str:
        """The name of the robots and their agents."""
        return team_name(self.robots)

    @property
    def folder_name(self) -> str:
        """The run's folder when the user names neither a folder nor the run.

        Equal configurations share a folder, so that repeating the command resumes the run.
        """
        tasks = Path(self.suite.name).name
        if self.kind is not None and self.kind.name != tasks:
            tasks = f"{tasks}-{self.kind.name}"
        if self.houses:
            few = len(self.houses) < _HOUSES_NAMED
            tasks = f"{tasks}-{'-'.join(self.houses) if few else f'{len(self.houses)}-houses'}"
        if self.difficulty:
            tasks = f"{tasks}-{self.difficulty}"
        if self.limit:
            tasks = f"{tasks}-{self.limit}"
        parts = [self.team_name, tasks, *([] if self.humans.name == PROXY else [self.humans.name])]
        parts += [self.clock] if self.clock else []
        return "-".join([*parts, *([BETWEEN] if self.design else []), self.whole.sha256[:10]])


def team_name(robots: Sequence[RobotSeat]) -> str:
    """The agent's name for a single robot; such as "tender-oracle+puck-frontier" for several."""
    if len(robots) == 1:
        return robots[0].agent.name
    names = [f"{robot.robot}-{robot.agent.name}" if robot.robot else robot.agent.name for robot in robots]
    return "+".join(names)[:_NAME_MAX]


def build_config(
    suite: Suite,
    team: RobotTeam,
    *,
    humans: str | HumanTeam,
    seed: int,
    participants: int | None,
    kind: KindRef | None = None,
    assets: AssetsRef | None = None,
    clock: Clock = LOCKSTEP,
    limit: int | None = None,
    houses: Sequence[str] = (),
    difficulty: str = "",
    step_limit_s: float | None = None,
    design: StudyDesign | None = None,
) -> RunConfig:
    """The configuration of a run, with every default resolved.

    Args:
        humans: the people of each trial, or the word by which `hthor.trials.human_team` finds them.
        participants: how many people in all; None for the number that is needed to do every task once.
        assets: the furniture pack that pictures show, with its own hash; None for our own furniture.
        clock, step_limit_s: as in `RunConfig`; without a robot, or submitted agents, they make no difference.
        design: the between-subjects study that the run is a condition of; ``participants`` then makes no difference.
        limit, houses, difficulty: how ``suite`` was narrowed; empty or None where it was not.
    """
    seeds.check_seed(seed)
    people = human_team.find_team(humans) if isinstance(humans, str) else humans
    size = len(suite.tasks)
    together = len(people.members)
    numbers = design.sessions(seed, together) if design else ()
    count = len(numbers) or sessions.count_sessions(size, participants, together)
    return RunConfig(
        robots=team.listed,
        agents=team.agents,
        humans=human_populations.human_model_ref(people, suite, team),
        suite=SuiteRef(name=suite.name, version=str(suite.version), sha256=suite.sha256),
        kind=kind,
        kinds=tuple(sorted({task.kind for task in suite.tasks})),
        seed=seed,
        participants=count * together,
        trials=sessions.count_trials(size, range(count)),
        rules_sha256=rules.sha256(),
        code_sha256=code_identity.code_sha256(people.models, (task.kind for task in suite.tasks)),
        versions=installation.versions(),
        assets=AssetsRef(
            name=assets.name if assets else PROCEDURAL,
            sha256=robot_team.team_pictures_sha256(team, assets.sha256 if assets else ""),
        ),
        clock=clock if team.seats and clock != LOCKSTEP else msgspec.UNSET,
        limit=limit or msgspec.UNSET,
        houses=tuple(houses) or msgspec.UNSET,
        difficulty=difficulty or msgspec.UNSET,
        step_limit_s=robot_team.step_limit_of(team, step_limit_s),
        design=design or msgspec.UNSET,
    )


def shard_config(config: RunConfig, shard: Shard, tasks: int) -> RunConfig:
    """The configuration of one shard of a run with ``tasks`` tasks.

    Raises:
        HthorError: when there are more shards than sessions.
    """
    if shard.of > config.sessions:
        raise HthorError(
            f"--shard {shard.words}: the tasks of a session stay together, and this run has {config.sessions} "
            f"sessions, so there can be {config.sessions} shards at most."
        )
    trials = sessions.count_trials(tasks, shard.share(range(config.sessions)))
    return msgspec.structs.replace(config, shard=msgspec.structs.replace(shard, trials=trials))


def check_title(title: str) -> str:
    """The user's name for a run; raises HthorError unless it can also be a folder's name."""
    if not _TITLE.fullmatch(title):
        raise HthorError(
            f"--name '{title}': a run's name has 1 to 60 letters, digits, '.', '_', '+' or '-', and begins with a "
            "letter or a digit, such as baseline-2."
        )
    return title


def differences(there: RunConfig, here: RunConfig) -> list[str]:
    """The differences between two configurations, in words."""
    before, after = _flat(msgspec.to_builtins(there)), _flat(msgspec.to_builtins(here))
    names = [name for name in {**before, **after} if before.get(name) != after.get(name)]
    return [f"{name} is {_shortened(before.get(name))} there and {_shortened(after.get(name))} here" for name in names]


def _flat(document: dict[str, object], prefix: str = "") -> dict[str, object]:
    flat: dict[str, object] = {}
    for name, value in document.items():
        members = _members(value)
        flat |= {prefix + name: value} if members is None else _flat(members, f"{prefix}{name}.")
    return flat


def _members(value: object) -> dict[str, object] | None:
    """The members of an object or of a list of objects by name; in a list, the name is a file's path or a number."""
    if isinstance(value, dict):
        return value
    if not isinstance(value, (list, tuple)) or not any(isinstance(part, dict) for part in value):
        return None
    return {str(part.get("path", k) if isinstance(part, dict) else k): part for k, part in enumerate(value)}


def _shortened(value: object) -> str:
    text = "absent" if value is None else str(value)
    return text[:10] if len(text) == 64 else text
