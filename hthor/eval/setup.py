"""What a run was asked for, as `run.json`: everything that decides its records; knows nothing of how far it came."""

from __future__ import annotations

import fnmatch
from pathlib import Path
from typing import Any

import msgspec
from msgspec import Struct

from hthor import humans, jsonio, rules
from hthor.detectors import OWN
from hthor.errors import RunError
from hthor.eval import cast, provenance
from hthor.eval.session import people_for
from hthor.tasks import Suite
from hthor.types import AgentRef

SCHEMA = "hthor.run/1"
_MADE_FIRST = (".lock", "trials.jsonl", ".run.json.*")  # a command that was killed early leaves these alone


class SuiteRef(Struct, frozen=True, kw_only=True):
    """Which tasks: a suite's name and version, and the hash of its content."""

    name: str
    version: str
    sha256: str


PROCEDURAL = "procedural"
"""Name of the furniture that ships with hthor."""


class AssetsRef(Struct, frozen=True, kw_only=True):
    """What the furniture in pictures is: our own, made by the code of this hash, or a pack with its own hash."""

    name: str = PROCEDURAL
    sha256: str


class Setup(Struct, frozen=True, kw_only=True):
    """A run's configuration. ``robot`` and ``detector`` are empty without a robot.

    ``trials`` is how many there are in a whole run. ``robot_sha256`` is the hash of a user's own robot file, empty for
    a robot that ships with hthor.
    """

    schema: str = SCHEMA
    agent: AgentRef
    robot: str
    detector: str
    human: str
    human_sha256: str
    suite: SuiteRef
    seed: int
    participants: int
    trials: int
    rules_sha256: str
    code_sha256: str
    versions: dict[str, str]
    assets: AssetsRef
    robot_sha256: str = ""

    @property
    def sha256(self) -> str:
        """Hash of the whole configuration."""
        return jsonio.sha256(self)

    @property
    def folder_name(self) -> str:
        """The run's folder when none is given: equal configurations share one, so that the same command resumes."""
        return f"{self.agent.name}-{Path(self.suite.name).name}-{self.sha256[:10]}"


def settle(
    suite: Suite,
    character: cast.Character,
    *,
    robot: str,
    human: str,
    seed: int,
    participants: int | None,
    detector: str = OWN,
    robot_sha256: str = "",
    assets: AssetsRef | None = None,
) -> Setup:
    """The configuration of a run, every default resolved."""
    hands = people_for(len(suite.tasks))
    people = hands if participants is None else participants
    whole, rest = divmod(people, hands)
    size = len(suite.tasks)
    return Setup(
        agent=character.ref,
        robot="" if character.absent else robot,
        detector="" if character.absent else detector,
        human=human,
        human_sha256=humans.fingerprint(human),
        suite=SuiteRef(name=suite.name, version=str(suite.version), sha256=suite.sha256),
        seed=seed,
        participants=people,
        trials=whole * size + rest * size // hands,
        rules_sha256=rules.sha256(),
        code_sha256=provenance.code_sha256(),
        versions=provenance.versions(),
        assets=assets or AssetsRef(sha256=provenance.code_sha256()),
        robot_sha256="" if character.absent else robot_sha256,
    )


def load(folder: Path) -> Setup:
    """The configuration of the run in a folder.

    Raises:
        RunError: when the folder holds no run, or its `run.json` is damaged.
    """
    path = folder / "run.json"
    if not path.is_file():
        raise RunError(f"{folder} is not a run's folder: it has no run.json. 'hthor eval' makes one.")
    try:
        setup = msgspec.json.decode(path.read_bytes(), type=Setup)
    except (msgspec.DecodeError, UnicodeDecodeError) as error:
        raise RunError(f"{path}: {error}. The file was changed after it was written.") from None
    if setup.schema != SCHEMA:
        raise RunError(f"{path}: schema is '{setup.schema}', this version reads '{SCHEMA}'.")
    return setup


def examine(folder: Path, plan: Setup) -> None:
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
    there = load(folder)
    if there != plan:
        raise RunError(
            f"{folder} holds another run: {'; '.join(_differences(there, plan))}. "
            "Choose another folder with --out, or delete this one."
        )


def write(folder: Path, plan: Setup) -> None:
    """Write `run.json`, unless it is there, and clear away what a killed command left of such a write."""
    for torn in folder.glob(".run.json.*"):
        torn.unlink(missing_ok=True)
    if not (folder / "run.json").exists():
        jsonio.write(folder / "run.json", jsonio.pretty(plan))


def _made_first(name: str) -> bool:
    return any(fnmatch.fnmatchcase(name, pattern) for pattern in _MADE_FIRST)


def _has_bytes(path: Path) -> bool:
    return path.exists() and path.stat().st_size > 0


def _differences(there: Setup, here: Setup) -> list[str]:
    before, now = _flat(msgspec.to_builtins(there)), _flat(msgspec.to_builtins(here))
    names = [name for name in {**before, **now} if before.get(name) != now.get(name)]
    return [f"{name} is {_short(before.get(name))} there and {_short(now.get(name))} here" for name in names]


def _flat(document: dict[str, Any], prefix: str = "") -> dict[str, Any]:
    flat: dict[str, Any] = {}
    for name, value in document.items():
        flat |= _flat(value, f"{prefix}{name}.") if isinstance(value, dict) else {prefix + name: value}
    return flat


def _short(value: object) -> str:
    text = "absent" if value is None else str(value)
    return text[:10] if len(text) == 64 else text
