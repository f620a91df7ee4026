"""A submission as it is handed in: a folder with one agent and what its authors say of it; runs nothing of it."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import msgspec
from msgspec import Struct

from hthor.errors import HthorError
from hthor.leaderboard.entry import Agent
from hthor.leaderboard.files import Problem, parse, refuse

ABOUT, MIND = "submission.json", "agent.py"
_ALSO = ("README.md", "LICENSE")
_NAME = re.compile(r"[a-z0-9][a-z0-9_-]{0,39}")
_MAX_BYTES = 256 * 1024
_LEAST = 'a file with the agent\'s name at least: {"name": "My agent"}'


class Submission(Struct, frozen=True, kw_only=True):
    """A folder of submissions/: its name, the agent's file, and who it is."""

    name: str
    path: Path
    agent: Agent


class _Said(Agent, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """`submission.json`."""


def read(folder: Path) -> Submission:
    """The submission in a folder.

    Raises:
        BoardError: when it is not one; names all that is wrong, not only the first.
    """
    refuse(problems(folder))
    said = parse((folder / ABOUT).read_bytes(), str(folder / ABOUT), _Said)
    about = Agent(**msgspec.structs.asdict(said))
    return Submission(name=folder.resolve().name, path=folder / MIND, agent=about)


def problems(folder: Path) -> Iterator[Problem]:
    """What keeps a folder from being a submission, without running anything of it."""
    shown = str(folder)
    if folder.is_symlink() or not folder.is_dir():
        yield Problem(file=shown, field="$", problem="is not a folder; a submission is one, submissions/NAME")
        return
    name = folder.resolve().name
    if not _NAME.fullmatch(name):
        rule = "takes a to z, 0 to 9, - and _, begins with a letter or digit, and has at most 40 characters"
        yield Problem(file=shown, field="$", problem=f"'{name}' cannot be a submission's name, which {rule}")
    for path in sorted(folder.iterdir()):  # what lies in a folder that is not taken goes without saying
        yield from _file(path, path.relative_to(folder).as_posix())
    for needed, what in ((MIND, "a file with a class Agent, see docs/agents.md"), (ABOUT, _LEAST)):
        if not (folder / needed).is_file():
            yield Problem(file=str(folder / needed), field="$", problem=f"is missing: {what}")
    total = sum(path.stat().st_size for path in folder.rglob("*") if path.is_file() and not path.is_symlink())
    if total > _MAX_BYTES:
        yield Problem(file=shown, field="$", problem=f"has {total} bytes; at most {_MAX_BYTES} are taken")
    about = folder / ABOUT
    if about.is_file() and not about.is_symlink():
        try:
            parse(about.read_bytes(), str(about), _Said)
        except HthorError as error:
            file, field, problem = str(error).split(": ", 2)
            yield Problem(file=file, field=field, problem=problem)


def _file(path: Path, name: str) -> Iterator[Problem]:
    taken = (MIND, ABOUT, *_ALSO)
    if path.is_symlink():
        yield Problem(file=str(path), field="$", problem="is a link; hand in the file itself")
    elif name not in taken:
        rule = f"the hash of an entry covers one file, so a submission is {', '.join(taken)} and nothing else"
        yield Problem(file=str(path), field="$", problem=f"is not taken: {rule}")
    elif path.is_file():
        data = path.read_bytes()
        try:
            data.decode("utf-8")
        except UnicodeDecodeError as error:
            yield Problem(file=str(path), field="$", problem=f"is not text in UTF-8 (byte {error.start})")
        else:
            if b"\x00" in data:
                yield Problem(file=str(path), field="$", problem="is binary: it has a zero byte")
