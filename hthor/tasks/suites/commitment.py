"""What is published about a suite made from a secret salt.

``commitment.json`` fixes the salt and every file of the suite by hashes that reveal neither. It can be published before
anybody is evaluated. ``revealed.json`` holds the salt, once the season is over.
"""

import hashlib
from collections.abc import Iterator, Mapping
from pathlib import Path

from msgspec import Struct

from hthor import documents, jsonio
from hthor.errors import TaskError
from hthor.tasks.suites.secret_salt import Salt

COMMITMENT, REVEALED = "commitment.json", "revealed.json"
_COMMITTED, _PUBLISHED = "hthor.commitment/1", "hthor.revealed/1"


class Commitment(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Fixes a suite by hashes. It has no date: the same salt gives the same bytes.

    ``salt`` is `Salt.commitment`; ``houses`` and ``tasks`` are how many there are; ``suite_sha256`` is the hash that
    results name; ``files`` holds the SHA-256 of every file by its path in the suite's folder; ``made_with`` the
    versions of what made them.
    """

    schema: str = _COMMITTED
    name: str
    salt: str
    houses: int
    tasks: int
    suite_sha256: str
    files: dict[str, str]
    made_with: dict[str, str]


class Revealed(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The salt of a suite, published."""

    schema: str = _PUBLISHED
    name: str
    salt: str


def hash_files(files: Mapping[str, bytes]) -> dict[str, str]:
    """The SHA-256 of each file, by path."""
    return {path: hashlib.sha256(data).hexdigest() for path, data in sorted(files.items())}


def load_commitment(path: Path) -> Commitment:
    """A commitment from its file.

    Raises:
        TaskError: when it cannot be read, or is not a commitment.
    """
    return documents.read(path, Commitment, TaskError, schema=_COMMITTED, hint="'hthor suite make' writes one")


def read_revealed_salt(folder: Path) -> Salt | None:
    """The salt that was published in a suite's folder, None when none was.

    Raises:
        TaskError: when the file is there and cannot be read.
    """
    path = folder / REVEALED
    if not path.exists():
        return None
    held = documents.read(path, Revealed, TaskError, schema=_PUBLISHED, hint="'hthor suite reveal' writes one")
    try:
        return Salt(held.salt)
    except UnicodeEncodeError:
        raise TaskError(str(path), "salt", "is not ASCII text, so no suite was made from it") from None


def reveal_salt(folder: Path, salt: Salt) -> Path:
    """Publish the salt of the suite in a folder: write ``revealed.json``.

    Raises:
        TaskError: when it is not the salt that the suite's commitment is to; nothing is written then.
    """
    held = load_commitment(folder / COMMITMENT)
    if salt.commitment() != held.salt:
        problem = f"commits to {held.salt[:10]}..., this salt's commitment is {salt.commitment()[:10]}..."
        raise TaskError(str(folder / COMMITMENT), "salt", f"{problem}: it is the salt of another suite")
    jsonio.write(folder / REVEALED, jsonio.pretty(Revealed(name=held.name, salt=salt.reveal())))
    return folder / REVEALED


def find_changes(folder: Path, held: Commitment) -> Iterator[tuple[str, str]]:
    """What in a suite's folder is not as it was committed to: pairs of a file and a problem."""
    for path, digest in held.files.items():
        if not (folder / path).is_file():
            yield path, "is missing"
        elif hashlib.sha256((folder / path).read_bytes()).hexdigest() != digest:
            yield path, "was changed after it was committed to"
    for there in sorted((folder / "houses").glob("*")):
        if (path := there.relative_to(folder).as_posix()) not in held.files:
            yield path, "is not among the files that were committed to"
