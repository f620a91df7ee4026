"""What a run was asked for, as `run.json`: everything that decides its records."""

from __future__ import annotations

import difflib
import fnmatch
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import msgspec
from msgspec import Struct

from hthor import code_identity, documents, installation, jsonio, rules
from hthor.errors import HthorError, RunError
from hthor.eval.config import human_populations, robot_team, sessions
from hthor.eval.config.human_populations import HumanModelRef
from hthor.eval.config.robot_team import RobotTeam
from hthor.eval.config.sessions import participants_needed
from hthor.eval.config.shard import Shard
from hthor.guest.agent.manifest import Manifest
from hthor.humans.population import resolve
from hthor.humans.population.resolve import PROXY, ParticipantSource
from hthor.tasks import Suite
from hthor.types import RobotSeat

SCHEMA = "hthor.run/4"
LOCKSTEP, REALTIME = "lockstep", "realtime"
_NAME_MAX = 100
_NAMED = 4
"""Of fewer houses than this, a run's folder names each."""
_TITLE = re.compile(r"\w[\w.+-]{0,59}")
_MADE_FIRST = (".lock", "trials.jsonl", ".run.json.*", "control")  # a command that was killed early leaves these alone


class SuiteRef(Struct, frozen=True, kw_only=True):
    """Which tasks: a suite's name and version, and the hash of its content."""

    name: str
    version: str
    sha256: str


PROCEDURAL = "procedural"
"""Name of the furniture that ships with hthor."""


class AssetsRef(Struct, frozen=True, kw_only=True):
    """What robots' pictures show: our own furniture or a pack, and the hash of that and of what draws it.

    ``sha256`` is empty where no robot can take a picture that bears on what it does: where all minds are built in and
    none was given a camera or a pack.
    """

    name: str = PROCEDURAL
    sha256: str = ""


class KindRef(Struct, frozen=True, kw_only=True):
    """The one kind of task that a run was narrowed to, and the hash of its file when it is a user's own."""

    name: str
    sha256: str = ""


class RunConfig(Struct, frozen=True, kw_only=True):
    """A run's configuration.

    ``title`` is the name that the user gave the run; it changes no trial, and two runs that differ only in it are the
    same. ``robots`` lists every robot with its body, mind and detector; a mind that wants no robot stands there without
    a seat. ``kind`` is None when every task of the suite is played,
    ``kinds`` are those of its tasks. ``trials`` is how many there are in a whole run.
    ``shard`` is there only in a run that was divided among machines, ``realtime`` only where robots' thinking took time
    of the trials, ``limit`` only where so many tasks were chosen from the suite, ``houses`` and ``difficulty`` only
    where its tasks in these houses or of this difficulty were, and ``step_limit_s`` only where
    submitted agents had another deadline for each action than usual [s]. ``agents`` lists the files of
    every agent that is not built in.
    """

    schema: str = SCHEMA
    title: str | msgspec.UnsetType = msgspec.UNSET
    robots: tuple[RobotSeat, ...]
    agents: tuple[Manifest, ...] = ()
    humans: HumanModelRef
    suite: SuiteRef
    kind: KindRef | None = None
    kinds: tuple[str, ...]
    seed: int
    participants: int
    trials: int
    rules_sha256: str
    code_sha256: str
    versions: dict[str, str]
    assets: AssetsRef
    realtime: bool | msgspec.UnsetType = msgspec.UNSET
    limit: int | msgspec.UnsetType = msgspec.UNSET
    houses: tuple[str, ...] | msgspec.UnsetType = msgspec.UNSET
    difficulty: str | msgspec.UnsetType = msgspec.UNSET
    step_limit_s: float | msgspec.UnsetType = msgspec.UNSET
    shard: Shard | msgspec.UnsetType = msgspec.UNSET

    @property
    def sha256(self) -> str:
        """Hash of the whole configuration, but for the title."""
        return jsonio.sha256(self.untitled)

    @property
    def untitled(self) -> RunConfig:
        """The run without its title: all that decides its records."""
        return msgspec.structs.replace(self, title=msgspec.UNSET)

    @property
    def whole(self) -> RunConfig:
        """The run that this is a shard of; an undivided run is its own."""
        return msgspec.structs.replace(self, shard=msgspec.UNSET) if self.shard else self

    @property
    def seats(self) -> tuple[RobotSeat, ...]:
        """The robots that there are in a trial."""
        return tuple(robot for robot in self.robots if robot.seat)

    @property
    def mode(self) -> str:
        """ "lockstep", where the trial waits for its minds, or "realtime", where it does not."""
        return REALTIME if self.realtime else LOCKSTEP

    @property
    def name(self) -> str:
        """What to call the run among others: what the user does, or what its robots' minds are called."""
        return self.title or self.crew

    @property
    def label(self) -> str:
        """What tables and sentences call the run."""
        return robot_team.display_name(self.name, self.robots)

    @property
    def crew(self) -> str:
        """What to call the robots and their minds."""
        return team_name(self.robots)

    @property
    def folder_name(self) -> str:
        """The run's folder when neither it nor a name is given.

        Equal configurations share one, so that the same command resumes.
        """
        played = Path(self.suite.name).name
        if self.kind is not None and self.kind.name != played:
            played = f"{played}-{self.kind.name}"
        if self.houses:
            played = f"{played}-{'-'.join(self.houses) if len(self.houses) < _NAMED else f'{len(self.houses)}-houses'}"
        if self.difficulty:
            played = f"{played}-{self.difficulty}"
        if self.limit:
            played = f"{played}-{self.limit}"
        whose = "" if self.humans.name == PROXY else f"-{self.humans.name}"
        whose += f"-{REALTIME}" if self.realtime else ""
        return f"{self.crew}-{played}{whose}-{self.whole.sha256[:10]}"


def team_name(robots: Sequence[RobotSeat]) -> str:
    """The agent's name, of a single robot; "tender-oracle+puck-frontier" of several."""
    if len(robots) == 1:
        return robots[0].agent.name
    names = [f"{robot.robot}-{robot.agent.name}" if robot.robot else robot.agent.name for robot in robots]
    return "+".join(names)[:_NAME_MAX]


def build_config(
    suite: Suite,
    crew: RobotTeam,
    *,
    human: str | ParticipantSource,
    seed: int,
    participants: int | None,
    kind: KindRef | None = None,
    assets: AssetsRef | None = None,
    realtime: bool = False,
    limit: int | None = None,
    houses: Sequence[str] = (),
    difficulty: str = "",
    step_limit_s: float | None = None,
) -> RunConfig:
    """The configuration of a run, every default resolved; ``human`` as `hthor.humans.population.resolve` reads it.

    ``assets`` is the furniture pack that pictures show, with its own hash; None for our own furniture.
    ``realtime`` says whether robots' thinking takes time of the trials; without a robot it makes no difference.
    ``limit`` is how many tasks were chosen for ``suite``; None where it is whole; ``houses`` and ``difficulty`` are
    what it was narrowed to, empty where it was not. ``step_limit_s`` is the deadline of
    an action [s]; it makes no difference where all agents are built in.
    """
    who = resolve.resolve_humans(human) if isinstance(human, str) else human
    hands = participants_needed(len(suite.tasks))
    count = hands if participants is None else participants
    whole, rest = divmod(count, hands)
    size = len(suite.tasks)
    return RunConfig(
        robots=crew.listed,
        agents=crew.agents,
        humans=human_populations.human_model_ref(who, suite, crew),
        suite=SuiteRef(name=suite.name, version=str(suite.version), sha256=suite.sha256),
        kind=kind,
        kinds=tuple(sorted({task.kind for task in suite.tasks})),
        seed=seed,
        participants=count,
        trials=whole * size + rest * size // hands,
        rules_sha256=rules.sha256(),
        code_sha256=code_identity.code_sha256(who.model, (task.kind for task in suite.tasks)),
        versions=installation.versions(),
        assets=AssetsRef(
            name=assets.name if assets else PROCEDURAL,
            sha256=robot_team.team_pictures_sha256(crew, assets.sha256 if assets else ""),
        ),
        realtime=(realtime and bool(crew.seats)) or msgspec.UNSET,
        limit=limit or msgspec.UNSET,
        houses=tuple(houses) or msgspec.UNSET,
        difficulty=difficulty or msgspec.UNSET,
        step_limit_s=robot_team.step_limit_of(crew, step_limit_s),
    )


def shard_config(plan: RunConfig, part: Shard, tasks: int) -> RunConfig:
    """The configuration of one shard of a run over so many tasks.

    Raises:
        HthorError: when there are more shards than people.
    """
    if part.of > plan.participants:
        raise HthorError(
            f"--shard {part.words}: this run has {plan.participants} people of ten tasks each, who are not divided, so "
            f"there can be {plan.participants} shards at most."
        )
    trials = sessions.count_trials(tasks, part.share(range(plan.participants)))
    return msgspec.structs.replace(plan, shard=msgspec.structs.replace(part, trials=trials))


def load_config(folder: Path) -> RunConfig:
    """The configuration of the run in a folder.

    Raises:
        RunError: when the folder holds no run, or its `run.json` is damaged.
    """
    path = folder / "run.json"
    if not path.is_file():
        raise RunError(f"{folder} is not a run's folder: it has no run.json.{_guess(folder)} 'hthor eval' makes one.")
    hint = "evaluate it again, into another folder"
    return documents.read(path, RunConfig, RunError, schema=SCHEMA, hint=hint)


def _guess(folder: Path) -> str:
    """Which run was meant, of those that lie where it was looked for."""
    beside = sorted(path.parent.name for path in folder.parent.glob("*/run.json"))
    near = difflib.get_close_matches(folder.name, beside, n=1, cutoff=0.5)
    return f" Did you mean '{folder.parent / near[0]}'?" if near else ""


def check_folder(folder: Path, plan: RunConfig) -> None:
    """See that a folder is free for a run: absent, empty, or holding a part of the same run.

    Raises:
        RunError: when the folder belongs to another run, naming what differs, or holds other files.
    """
    if not folder.exists():
        return
    if not folder.is_dir():
        raise RunError(f"{folder} is a file; a run needs a folder. Choose another with --out.")
    if not (folder / "run.json").exists():
        strangers = sorted(entry.name for entry in folder.iterdir() if not _made_first(entry.name))
        if strangers or _has_bytes(folder / "trials.jsonl"):
            listed = strangers[0] if strangers else "trials.jsonl"
            raise RunError(f"{folder} is not empty and holds no run ({listed}). Choose another folder with --out.")
        return
    there = load_config(folder)
    if there.untitled != plan.untitled:
        raise RunError(
            f"{folder} holds another run: {'; '.join(differences(there.untitled, plan.untitled))}. "
            "Choose another folder with --out or --name, or delete this one."
        )
    if plan.title and there.title != plan.title:
        called = f"is called '{there.title}'" if there.title else "has no name"
        raise RunError(f"the run in {folder} {called}; a run keeps the name that it began with. Leave out --name.")


def with_stored_title(folder: Path, plan: RunConfig) -> RunConfig:
    """The configuration with the title of the run that lies in the folder already, if one does."""
    if not (folder / "run.json").exists():
        return plan
    return msgspec.structs.replace(plan, title=load_config(folder).title)


def check_title(title: str) -> str:
    """A name that a user gave a run, if it can also be a folder's.

    Raises:
        HthorError: when it cannot.
    """
    if not _TITLE.fullmatch(title):
        raise HthorError(
            f"--name '{title}': a run's name has 1 to 60 letters, digits, '.', '_', '+' or '-', and begins with a "
            "letter or a digit, such as baseline-2."
        )
    return title


def write_config(folder: Path, plan: RunConfig) -> None:
    """Write `run.json`, unless it is there, and clear away what a killed command left of such a write."""
    for torn in folder.glob(".run.json.*"):
        torn.unlink(missing_ok=True)
    if not (folder / "run.json").exists():
        jsonio.write(folder / "run.json", jsonio.pretty(plan))


def _made_first(name: str) -> bool:
    return any(fnmatch.fnmatchcase(name, pattern) for pattern in _MADE_FIRST)


def _has_bytes(path: Path) -> bool:
    return path.exists() and path.stat().st_size > 0


def differences(there: RunConfig, here: RunConfig) -> list[str]:
    """What is not the same in two configurations, in words."""
    before, now = _flat(msgspec.to_builtins(there)), _flat(msgspec.to_builtins(here))
    names = [name for name in {**before, **now} if before.get(name) != now.get(name)]
    return [f"{name} is {_shortened(before.get(name))} there and {_shortened(now.get(name))} here" for name in names]


def _flat(document: dict[str, Any], prefix: str = "") -> dict[str, Any]:
    flat: dict[str, Any] = {}
    for name, value in document.items():
        if isinstance(value, (list, tuple)) and any(isinstance(part, dict) for part in value):
            value = {str(_list_key(part, number)): part for number, part in enumerate(value)}
        flat |= _flat(value, f"{prefix}{name}.") if isinstance(value, dict) else {prefix + name: value}
    return flat


def _list_key(part: Any, number: int) -> object:
    """What to call a member of a list: a file by its path, all others by their number."""
    return part.get("path", number) if isinstance(part, dict) else number


def _shortened(value: object) -> str:
    text = "absent" if value is None else str(value)
    return text[:10] if len(text) == 64 else text
