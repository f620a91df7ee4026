"""Which platforms played a run, noted beside its log; decides nothing.

A run can be played by several commands on several machines, so its folder keeps a list, `platform.json`. It is no part
of the run's configuration: equal platforms give equal bytes, and others may.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from hthor import documents, jsonio
from hthor.errors import RunError
from hthor.eval.records import platform_fingerprint

NAME = "platform.json"
Platform = dict[str, str]
"""As `hthor.eval.records.platform_fingerprint` describes it."""


def note(folder: Path) -> None:
    """Add this machine to those that played a part of the run in a folder."""
    join(folder, (), (platform_fingerprint.this_platform(),))


def join(out: Path, folders: Iterable[Path], more: Iterable[Platform] = ()) -> None:
    """Keep the platforms of several folders, and ``more``, with the run in ``out``."""
    before = load(out)
    all_ = (*before, *(one for folder in folders for one in load(folder)), *more)
    found = {jsonio.sha256(one): one for one in all_}
    kept = tuple(found[digest] for digest in sorted(found))
    if kept != before:
        jsonio.write(out / NAME, jsonio.pretty(kept))


def load(folder: Path) -> tuple[Platform, ...]:
    """The platforms that played the run in a folder; none where that was not noted.

    Raises:
        RunError: when the file cannot be read.
    """
    path = folder / NAME
    if not path.is_file():
        return ()
    hint = "delete the file; the run is then of unknown platforms"
    return documents.read(path, tuple[Platform, ...], RunError, hint=hint)
