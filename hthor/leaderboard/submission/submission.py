"""A submission: a folder with one agent, its files, and its authors' description. Its code is never run here."""

import re
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import msgspec
from msgspec import Struct

from hthor.errors import HthorError
from hthor.guest import File
from hthor.guest.agent import manifest
from hthor.leaderboard.entries.entry import Agent
from hthor.leaderboard.entries.files import Problem, parse_document, raise_problems
from hthor.leaderboard.submission import archive

ABOUT, AGENT_FILE = "submission.json", "agent.py"
MAX_BYTES, MAX_FILES = 64 << 20, 500
"""Largest size of all files of a submission together, and largest number of files."""
_NAME = re.compile(r"[a-z0-9][a-z0-9_-]{0,39}")
_PATH = re.compile(r"[A-Za-z0-9_+-][A-Za-z0-9_.+-]*(/[A-Za-z0-9_+-][A-Za-z0-9_.+-]*){0,7}")
_PATH_MAX = 200
_TEXT = (".py", ".json", ".md", ".txt")
_COMPILED = (".pyc", ".pyo")
_LEAST = 'a file with the agent\'s name at least: {"name": "My agent"}'


class Submission(Struct, frozen=True, kw_only=True):
    """A folder in submissions/: its name, the agent's file, the authors' description, and all submitted files."""

    name: str
    path: Path
    agent: Agent
    files: tuple[File, ...]


class _Said(Agent, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """`submission.json`."""


@contextmanager
def submission_folder(place: Path) -> Iterator[Path]:
    """A submission's folder; an archive is unpacked for as long as the context lasts.

    Raises:
        BoardError: if the archive cannot be unpacked.
    """
    if not archive.is_archive(place):
        yield place
        return
    with tempfile.TemporaryDirectory(prefix="hthor-submission-") as folder:
        yield archive.unpack(place, Path(folder) / archive.stem(place), most_bytes=MAX_BYTES, most_files=MAX_FILES)


def read_submission(folder: Path) -> Submission:
    """Read the submission in a folder.

    Raises:
        BoardError: if the folder is not a submission; lists all problems.
    """
    raise_problems(submission_problems(folder))
    said = parse_document((folder / ABOUT).read_bytes(), str(folder / ABOUT), _Said)
    about = Agent(**msgspec.structs.asdict(said))
    return Submission(name=folder.resolve().name, path=folder / AGENT_FILE, agent=about, files=list_files(folder))


def list_files(folder: Path) -> tuple[File, ...]:
    """Every file in a folder with its hash, sorted; the result does not depend on how the files were packed."""
    found = []
    for path in folder.rglob("*"):
        if path.is_file() and not path.is_symlink():
            sha256, size = manifest.hash_file(path)
            found.append(File(path=path.relative_to(folder).as_posix(), sha256=sha256, bytes=size))
    return tuple(sorted(found))


def submission_problems(folder: Path) -> Iterator[Problem]:
    """All problems of a folder as a submission; none of its code is run."""
    shown = str(folder)
    if folder.is_symlink() or not folder.is_dir():
        rule = "is not a folder, and no .zip or .tar.gz of one; a submission is a folder, submissions/NAME"
        yield Problem(file=shown, field="$", problem=rule)
        return
    name = folder.resolve().name
    if not _NAME.fullmatch(name):
        rule = "takes a to z, 0 to 9, - and _, begins with a letter or digit, and has at most 40 characters"
        yield Problem(file=shown, field="$", problem=f"'{name}' cannot be a submission's name, which {rule}")
    held = sorted(folder.rglob("*"))
    for path in held:
        yield from _file(path, path.relative_to(folder).as_posix())
    yield from _alike(folder, held)
    for needed, what in ((AGENT_FILE, "a file with a class Agent, see docs/agents.md"), (ABOUT, _LEAST)):
        if not (folder / needed).is_file():
            yield Problem(file=str(folder / needed), field="$", problem=f"is missing: {what}")
    sizes = [path.stat().st_size for path in held if path.is_file() and not path.is_symlink()]
    if sum(sizes) > MAX_BYTES:
        yield Problem(file=shown, field="$", problem=f"has {sum(sizes)} bytes; at most {MAX_BYTES} are taken")
    if len(sizes) > MAX_FILES:
        yield Problem(file=shown, field="$", problem=f"has {len(sizes)} files; at most {MAX_FILES} are taken")
    about = folder / ABOUT
    if about.is_file() and not about.is_symlink():
        try:
            parse_document(about.read_bytes(), str(about), _Said)
        except HthorError as error:
            file, field, problem = str(error).split(": ", 2)
            yield Problem(file=file, field=field, problem=problem)


def _file(path: Path, name: str) -> Iterator[Problem]:
    def wrong(problem: str) -> Problem:
        return Problem(file=str(path), field="$", problem=problem)

    if path.is_symlink():
        yield wrong("is a link; submit the file itself")
        return
    if not _PATH.fullmatch(name) or len(name) > _PATH_MAX:
        rule = f"letters, digits, _ + - and ., no leading ., eight folders deep and {_PATH_MAX} characters at most"
        yield wrong(f"is not taken: a name has {rule}")
    elif path.name == "__pycache__" or path.suffix in _COMPILED:
        yield wrong("is not taken: compiled files are not run; submit the sources")
    elif not path.is_dir() and not path.is_file():
        yield wrong("is neither a file nor a folder")
    elif path.is_file() and path.suffix in _TEXT:
        yield from (wrong(problem) for problem in _no_text(path))


def _no_text(path: Path) -> Iterator[str]:
    data = path.read_bytes()
    try:
        data.decode("utf-8")
    except UnicodeDecodeError as error:
        yield f"is not text in UTF-8 (byte {error.start})"
    else:
        if b"\x00" in data:
            yield "is binary: it has a zero byte"


def _alike(folder: Path, held: list[Path]) -> Iterator[Problem]:
    """Names that some file systems cannot tell apart."""
    seen: dict[str, str] = {}
    for path in held:
        name = path.relative_to(folder).as_posix()
        other = seen.setdefault(name.lower(), name)
        if other != name:
            yield Problem(file=str(path), field="$", problem=f"and {other} differ only in capitals; rename one")
