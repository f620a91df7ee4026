"""A secret salt, and the files published about the suite that is made from it.

The salt's commitment is SHA-256 over a fixed prefix and the salt: it neither reveals a salt of 128 bits or more, nor
can a second salt with the same commitment be found. Roots of random draws come from HMAC-SHA256 with the salt as the
key, 128 bits for each purpose: knowing one root, or everything made from it, tells nothing about the salt
or other roots.

``commitment.json`` fixes the salt and every file of the suite by hashes that reveal neither. It can be published before
anybody is evaluated. ``revealed.json`` contains the salt; it is published when the season is over.
"""

import hashlib
import hmac
import math
import os
import secrets
import stat
import zlib
from collections import Counter
from collections.abc import Iterator, Mapping
from pathlib import Path

from msgspec import Struct

from hthor import documents, jsonio
from hthor.errors import HthorError, TaskError
from hthor.seeds import Name

LEAST_CHARACTERS, LEAST_BITS = 32, 128
_TO_COMMIT, _TO_DRAW = b"hthor.commitment/1\0", b"hthor.root/1\0"
_FRAME = 8
"""Bytes that zlib adds to compressed data."""
COMMITMENT, REVEALED = "commitment.json", "revealed.json"
_COMMITTED, _PUBLISHED = "hthor.commitment/1", "hthor.revealed/1"


class Salt:
    """A secret text. Only `reveal` shows it: printing and tracebacks do not."""

    __slots__ = ("_bytes",)

    def __init__(self, text: str) -> None:
        """Take a salt as it is; only `read_salt` checks its strength."""
        self._bytes = text.encode("ascii")

    def __repr__(self) -> str:
        return "Salt(hidden)"

    def __reduce__(self) -> tuple[object, ...]:
        raise TypeError("a salt stays in the process that read it; pass on the roots that are drawn from it")

    def commitment(self) -> str:
        """A hash that fixes the salt without revealing it, 64 hexadecimal digits."""
        return hashlib.sha256(_TO_COMMIT + self._bytes).hexdigest()

    def root(self, *purpose: Name) -> int:
        """A root for the draws of one purpose, 128 bits, for `hthor.seeds`."""
        return int.from_bytes(self._mac(purpose)[:16], "little", signed=True)

    def word(self, digits: int, *purpose: Name) -> str:
        """An opaque id for one purpose, with this number of hexadecimal digits."""
        return self._mac(purpose).hex()[:digits]

    def reveal(self) -> str:
        """The salt itself, to be published at the end."""
        return self._bytes.decode("ascii")

    def _mac(self, purpose: tuple[Name, ...]) -> bytes:
        return hmac.digest(self._bytes, _TO_DRAW + jsonio.canonical(purpose), "sha256")


def create_salt(path: Path) -> None:
    """Write a new salt of 256 bits to a file that only its owner can read.

    Raises:
        HthorError: when the file exists already; a salt that something was made from must not be lost.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    try:
        handle = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
    except FileExistsError:
        raise HthorError(f"{path} exists, and a salt is never overwritten. Choose another name.") from None
    with os.fdopen(handle, "w", encoding="ascii") as file:
        file.write(secrets.token_hex(32) + "\n")


def read_salt(path: Path) -> Salt:
    """The salt in a file: its text, without the white space around it.

    Raises:
        HthorError: when the file cannot be read, or its text could be guessed; the salt is never part of the
            message.
    """
    advice = "'hthor suite salt --out FILE' makes a good one."
    try:
        text = path.read_text(encoding="ascii").strip()
    except UnicodeDecodeError:
        raise HthorError(f"{path}: a salt is plain ASCII text, but this is not. {advice}") from None
    except OSError as error:
        raise HthorError(f"{path}: the salt cannot be read: {error.strerror}. {advice}") from None
    if not text.isprintable():
        raise HthorError(f"{path}: a salt is one line of text, but the file has several. {advice}")
    if len(text) < LEAST_CHARACTERS:
        problem = f"the salt has {len(text)} characters, at least {LEAST_CHARACTERS} are needed"
        raise HthorError(f"{path}: {problem}: a short one can be guessed. {advice}")
    if estimate_bits(text) < LEAST_BITS:
        problem = f"the salt looks as if it held {estimate_bits(text):.0f} bits, at least {LEAST_BITS} are needed"
        raise HthorError(f"{path}: {problem}: a repetitive one or a simple word can be guessed. {advice}")
    return Salt(text)


def estimate_bits(text: str) -> float:
    """Estimated entropy of a text [bit], from its letters' frequencies and from how far it can be compressed.

    It finds gross errors, such as one letter repeated, but cannot tell a line of a poem from random text.
    """
    data = text.encode("ascii")
    letters = -sum(count * math.log2(count / len(data)) for count in Counter(data).values())
    packed = 8.0 * max(len(zlib.compress(data, 9)) - _FRAME, 0)
    return min(letters, packed)


def is_exposed(path: Path) -> bool:
    """Whether users other than the owner can read the file."""
    return bool(path.stat().st_mode & (stat.S_IRGRP | stat.S_IROTH))


class Commitment(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Fixes a suite by hashes. It has no date: the same salt gives the same bytes.

    ``salt`` is `Salt.commitment`; ``houses`` and ``tasks`` are how many there are; ``suite_sha256`` is the hash that
    results name; ``files`` holds the SHA-256 of every file by its path in the suite's folder; ``made_with`` the
    versions of the software that made them.
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
    """The published salt of a suite."""

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
        TaskError: when the file exists but cannot be read.
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
        TaskError: when it is not the salt in the suite's commitment; nothing is written then.
    """
    held = load_commitment(folder / COMMITMENT)
    if salt.commitment() != held.salt:
        problem = f"commits to {held.salt[:10]}..., this salt's commitment is {salt.commitment()[:10]}..."
        raise TaskError(str(folder / COMMITMENT), "salt", f"{problem}: it is the salt of another suite")
    jsonio.write(folder / REVEALED, jsonio.pretty(Revealed(name=held.name, salt=salt.reveal())))
    return folder / REVEALED


def find_changes(folder: Path, held: Commitment) -> Iterator[tuple[str, str]]:
    """The differences of a suite's folder from its commitment: pairs of a file and a problem."""
    for path, digest in held.files.items():
        if not (folder / path).is_file():
            yield path, "is missing"
        elif hashlib.sha256((folder / path).read_bytes()).hexdigest() != digest:
            yield path, "was changed after it was committed to"
    for there in sorted((folder / "houses").glob("*")):
        if (path := there.relative_to(folder).as_posix()) not in held.files:
            yield path, "is not among the files that were committed to"
