"""Unpacks a submitted .zip or .tar.gz: only plain files within a folder, in limited number and size."""

import shutil
import stat
import tarfile
import zipfile
import zlib
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path, PurePosixPath
from typing import IO, TypeVar

from msgspec import Struct

from hthor.leaderboard.entries.files import BoardError

SUFFIXES = (".zip", ".tar.gz", ".tgz")
_CHUNK, _MOST_MEMBERS = 1 << 20, 10_000
_T = TypeVar("_T")


class _Member(Struct, frozen=True):
    """A plain file in an archive."""

    name: str
    open: Callable[[], IO[bytes] | None]


def is_archive(path: Path) -> bool:
    """Whether a path has the name of an archive."""
    return path.name.endswith(SUFFIXES) and path.is_file()


def stem(path: Path) -> str:
    """The archive's name without its ending."""
    return next((path.name[: -len(suffix)] for suffix in SUFFIXES if path.name.endswith(suffix)), path.name)


def unpack(path: Path, folder: Path, *, most_bytes: int, most_files: int) -> Path:
    """Unpack an archive into a new folder; if one folder contains everything in the archive, its contents are unpacked.

    File modes, times and owners are dropped, so that the same files give the same folder.

    Raises:
        BoardError: if the archive is damaged, or contains a link, a path that leads outside, a name twice, or too much;
        then the folder is removed.
    """
    if folder.exists():
        raise BoardError(f"{folder} is there already; name another folder with --out, or remove it.")
    folder.mkdir(parents=True)
    try:
        reader = _zip if path.name.endswith(".zip") else _tar
        _write(path, reader(path), folder, most_bytes, most_files)
        _flatten(folder)
    except (zipfile.BadZipFile, tarfile.TarError, zlib.error, EOFError, OSError, RuntimeError, ValueError) as error:
        shutil.rmtree(folder, ignore_errors=True)
        raise BoardError(f"{path}: $: cannot be unpacked: {error}.") from None
    except BaseException:
        shutil.rmtree(folder, ignore_errors=True)
        raise
    return folder


def _zip(path: Path) -> Iterator[_Member]:
    with zipfile.ZipFile(path) as held:
        for one in _bounded(path, held.infolist()):
            kind = stat.S_IFMT(one.external_attr >> 16)
            if one.is_dir():
                continue
            if kind not in (0, stat.S_IFREG):
                raise _refused(path, one.filename, "is a link or not a plain file")
            if one.flag_bits & 0x1:
                raise _refused(path, one.filename, "is encrypted")
            yield _Member(one.filename, lambda one=one: held.open(one))  # type: ignore[misc]


def _tar(path: Path) -> Iterator[_Member]:
    with tarfile.open(path, "r:gz") as held:
        for one in _bounded(path, held):
            if one.isdir():
                continue
            if not one.isreg() or one.issparse():
                raise _refused(path, one.name, "is a link or not a plain file")
            yield _Member(one.name, lambda one=one: held.extractfile(one))  # type: ignore[misc]


def _bounded(path: Path, members: Iterable[_T]) -> Iterator[_T]:
    for count, one in enumerate(members):
        if count > _MOST_MEMBERS:
            raise BoardError(f"{path}: $: holds more than {_MOST_MEMBERS} entries, folders included.")
        yield one


def _write(path: Path, members: Iterator[_Member], folder: Path, most_bytes: int, most_files: int) -> None:
    size = 0
    for count, member in enumerate(members, 1):
        pure = PurePosixPath(member.name)
        parts = [part for part in pure.parts if part != "."]
        if pure.is_absolute() or not parts or ".." in parts or "\\" in member.name or "\0" in member.name:
            raise _refused(path, member.name, "leads out of the archive's folder")
        if count > most_files:
            raise _refused(path, member.name, f"exceeds the number of files; at most {most_files} are taken")
        target = folder.joinpath(*parts)
        target.parent.mkdir(parents=True, exist_ok=True)
        if target.exists():
            raise _refused(path, member.name, "is there twice")
        source = member.open()
        assert source is not None  # it is a plain file
        with source, target.open("xb") as file:
            while chunk := source.read(_CHUNK):
                size += len(chunk)
                if size > most_bytes:
                    raise _refused(
                        path,
                        member.name,
                        f"makes the archive too large: at most {most_bytes} bytes are accepted, unpacked",
                    )
                file.write(chunk)


def _flatten(folder: Path) -> None:
    """Replace the folder's contents by those of its only subfolder, as most archives have one."""
    held = list(folder.iterdir())
    if len(held) != 1 or not held[0].is_dir():
        return
    inner = held[0].rename(folder.with_name(f"{folder.name}.inner"))
    folder.rmdir()
    inner.rename(folder)


def _refused(path: Path, name: str, problem: str) -> BoardError:
    shown = name.encode("unicode_escape").decode()[:200]
    return BoardError(f"{path}: {shown}: {problem}.")
