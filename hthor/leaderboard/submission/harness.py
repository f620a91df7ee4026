"""Which hthor this is: version, commit, and whether it was changed since."""

from __future__ import annotations

import subprocess
from pathlib import Path

import hthor
from hthor.leaderboard.entries.entry import Harness

_PACKAGE = Path(hthor.__file__).resolve().parent


def here(package: Path = _PACKAGE) -> Harness:
    """The hthor of this process. The commit is the last that touched the package, not what lies around it."""
    commit = _git(package, "log", "-1", "--format=%H", "--", ".") or ""
    changed = _git(package, "status", "--porcelain", "--", ".") if commit else ""
    return Harness(version=hthor.__version__, commit=commit, dirty=bool(changed))


def _git(package: Path, *words: str) -> str | None:
    """What git says, None when it does not know the package or is not there."""
    try:
        said = subprocess.run(["git", "-C", str(package), *words], capture_output=True, text=True, check=False)
    except OSError:
        return None
    return said.stdout.strip() if said.returncode == 0 else None
