"""What one job of the official evaluation hands to the next: signed, unpacked and taken piece by piece.

A machine that ran a submitted agent is not to be trusted: what comes from it is unpacked into an empty folder, and of
that only files with the names, kinds and sizes that are expected are taken. `parcel.py sign KEY FILE`, `check KEY FILE
OUT`, `unpack KIND OUT <TAR`, `move FROM TO`, `place FROM BOARD`, `only FROM NAME...`.
"""

from __future__ import annotations

import hashlib
import hmac
import os
import re
import shutil
import sys
import tarfile
from pathlib import Path, PurePosixPath

MAC = 32
HOUSE = r"houses/h[0-9a-f]{12}\.json"
RUN = rf"(run|result|platform|isolation|replays|effort|suite)\.json|trials\.jsonl|{HOUSE}"
EXPECTED = {
    "suite": rf"suite/((suite|commitment)\.json|{HOUSE})",
    "control": rf"runs/control/({RUN})",
    "shard": rf"runs/mine-shard-\d{{1,4}}-of-\d{{1,4}}/({RUN})",
}
"""The files that are taken of each kind of parcel."""
IGNORED = r"runs/[\w-]+/(faults/[\w.-]+|\.lock|error\.txt|setup\.json)"
"""Files that such a folder may have, and that nobody needs."""
ENTRY = r"[A-Za-z0-9_+.-]{1,120}-[0-9a-f]{10}\.json"
LARGEST, IN_ALL, MOST = 1 << 29, 1 << 31, 20_000
"""Bytes of a file and of a parcel, and members of it."""
LARGEST_ENTRY = 4 << 20


def sign(key: str, file: str) -> None:
    """Append the MAC of a file that was encrypted."""
    with Path(file).open("ab") as out:
        out.write(_mac(key, Path(file)))


def check(key: str, file: str, body: str) -> None:
    """Write a sealed file without its MAC, if that is the salt's."""
    shutil.copyfile(file, body)
    size = os.path.getsize(body) - MAC
    _demand(size >= 0, f"{file} is too short to be sealed")
    with Path(body).open("r+b") as held:
        held.seek(size)
        mac = held.read(MAC)
        held.truncate(size)
    _demand(
        hmac.compare_digest(mac, _mac(key, Path(body))), f"{file} was not sealed with this salt, or was changed since"
    )


def _mac(key: str, file: Path) -> bytes:
    own = hashlib.sha256(b"hthor.seal/1\0" + Path(key).read_bytes().strip()).digest()
    with file.open("rb") as held:
        digest = hashlib.file_digest(held, "sha256").digest()
    return hmac.digest(own, digest, "sha256")


def unpack(kind: str, out: str) -> None:
    """Write the files of a tar archive on standard input that are expected of its kind to an empty folder."""
    _demand(kind in EXPECTED, f"KIND is one of {', '.join(EXPECTED)}, got '{kind}'")
    _demand(not any(Path(out).iterdir()), f"{out} is not empty")
    total = 0
    with tarfile.open(fileobj=sys.stdin.buffer, mode="r|") as parcel:
        for number, member in enumerate(parcel):
            name = member.name
            total += member.size
            _demand(number < MOST and member.size <= LARGEST and total <= IN_ALL, f"{name}: there is too much of it")
            if member.isdir():
                continue
            _demand(member.isreg(), f"{name} is no plain file")
            _demand(PurePosixPath(name).as_posix() == name and ".." not in name.split("/"), f"{name}: odd path")
            if re.fullmatch(IGNORED, name):
                continue
            _demand(re.fullmatch(EXPECTED[kind], name) is not None, f"{name} is not expected in a {kind}")
            held = parcel.extractfile(member)
            path = Path(out, name)
            _demand(held is not None and not path.exists(), f"{name} comes twice")
            path.parent.mkdir(parents=True, exist_ok=True)
            with path.open("xb") as file:
                shutil.copyfileobj(held, file)


def move(source: str, to: str) -> None:
    """Move files from an unpacked parcel, none over another."""
    for path in sorted(Path(source).rglob("*")):
        if path.is_file():
            there = Path(to, path.relative_to(source))
            _demand(not there.exists() and not there.is_symlink(), f"{there} is there already")
            there.parent.mkdir(parents=True, exist_ok=True)
            shutil.move(path, there)


def only(folder: str, *names: str) -> None:
    """See that a folder has these plain files, and nothing else."""
    found = {path.relative_to(folder).as_posix() for path in Path(folder).rglob("*")}
    _demand(found == set(names), f"{folder} must have {', '.join(names)} and nothing else, but has {sorted(found)}")
    for name in names:
        path = Path(folder, name)
        _demand(not path.is_symlink() and path.is_file(), f"{path} is no plain file")
        _demand(path.stat().st_size <= LARGEST_ENTRY, f"{path} is too large")


def place(source: str, board: str) -> None:
    """Copy entries to a board; one that is there already must be the same."""
    names = sorted(path.relative_to(source).as_posix() for path in Path(source).rglob("*") if path.name != "entries")
    for name in names:
        _demand(re.fullmatch(f"entries/{ENTRY}", name) is not None, f"{name} is no entry's file")
        path, there = Path(source, name), Path(board, name)
        _demand(not path.is_symlink() and path.is_file(), f"{path} is no plain file")
        _demand(path.stat().st_size <= LARGEST_ENTRY, f"{path} is too large")
        if there.is_file():
            _demand(there.read_bytes() == path.read_bytes(), f"{there} is another entry, and is not written over")
        else:
            there.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(path, there)
        sys.stdout.write(f"{there}\n")


def _demand(is_so: bool, problem: str) -> None:
    if not is_so:
        sys.exit(problem)


if __name__ == "__main__":
    verbs = {"sign": sign, "check": check, "unpack": unpack, "move": move, "only": only, "place": place}
    if len(sys.argv) < 2 or sys.argv[1] not in verbs:
        sys.exit(__doc__)
    verbs[sys.argv[1]](*sys.argv[2:])
