"""What of a machine can move a number's last bit, noted beside a run's log; decides nothing.

A run can be played by several commands on several machines, so its folder keeps a list, `platform.json`. It is no part
of the run's configuration: equal platforms give equal bytes, and others may.
"""

from __future__ import annotations

import functools
import importlib
import platform
from collections.abc import Iterable
from pathlib import Path

import msgspec
from msgspec import Struct

from hthor import jsonio
from hthor.errors import RunError
from hthor.eval import provenance

NAME = "platform.json"


class Machine(Struct, frozen=True, kw_only=True):
    """A platform: system, processor and the vector units that numpy uses on it, C library, versions of libraries."""

    system: str
    machine: str
    libc: str
    vector_units: tuple[str, ...]
    versions: dict[str, str]

    @property
    def sha256(self) -> str:
        """Hash of it all."""
        return jsonio.sha256(self)


@functools.cache
def here() -> Machine:
    """The platform that this process runs on."""
    features = importlib.import_module("numpy._core._multiarray_umath").__cpu_features__
    versions = {name: version for name, version in provenance.versions().items() if name != "hthor"}
    return Machine(
        system=platform.system(),
        machine=platform.machine(),
        libc="-".join(platform.libc_ver()),
        vector_units=tuple(sorted(name for name, there in features.items() if there)),
        versions=versions,
    )


def note(folder: Path) -> None:
    """Add this machine to those that played a part of the run in a folder."""
    join(folder, (folder,), (here(),))


def join(out: Path, folders: Iterable[Path], more: Iterable[Machine] = ()) -> None:
    """Keep the machines of several folders, and ``more``, with the run in ``out``."""
    before = load(out)
    found = {one.sha256: one for one in (*before, *(one for folder in folders for one in load(folder)), *more)}
    if found and tuple(found.values()) != before:
        jsonio.write(out / NAME, jsonio.pretty([found[digest] for digest in sorted(found)]))


def load(folder: Path) -> tuple[Machine, ...]:
    """The machines that played the run in a folder; none where that was not noted.

    Raises:
        RunError: when the file cannot be read.
    """
    path = folder / NAME
    if not path.is_file():
        return ()
    try:
        return msgspec.json.decode(path.read_bytes(), type=tuple[Machine, ...])
    except (msgspec.DecodeError, UnicodeDecodeError) as error:
        raise RunError(f"{path}: {error}. Delete the file; the run is then of unknown platforms.") from None
