"""An unprivileged user to be attacked: an interpreter that it can start, and what its processes are given."""

from __future__ import annotations

import functools
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

NOBODY = 65534
ROOT = Path(__file__).resolve().parents[2]


@functools.cache
def runner() -> tuple[list[str], dict[str, Any]]:
    """An interpreter, and as whom: an unprivileged user where one can start it."""
    libraries = [path for path in sys.path if Path(path).name in ("site-packages", "dist-packages")]
    env = {"PATH": os.environ["PATH"], "PYTHONPATH": os.pathsep.join([str(ROOT), *libraries])}
    if os.getuid() == 0:
        as_nobody = {"user": NOBODY, "group": NOBODY, "extra_groups": [], "env": env, "cwd": "/"}
        for python in (sys.executable, f"/usr/bin/python{sys.version_info.major}.{sys.version_info.minor}"):
            words = [python, "-P", "-c", "import numpy, msgspec, hthor.guest"]
            try:
                if subprocess.run(words, capture_output=True, **as_nobody).returncode == 0:
                    return [python], as_nobody
            except OSError:
                continue
    return [sys.executable], {"env": env, "cwd": "/"}


def scored(levels: str, *names: str) -> subprocess.CompletedProcess[str]:
    """Play agents in scored trials, with a copy of what is compiled here, which that user may read and write."""
    python, how = runner()
    with tempfile.TemporaryDirectory(prefix="hthor-redteam-") as folder:
        compiled = Path(folder) / "compiled"
        ours = Path(os.environ.get("NUMBA_CACHE_DIR", ""))
        if ours.name and ours.is_dir():
            shutil.copytree(ours, compiled)
        else:
            compiled.mkdir()
        env = {**how["env"], "NUMBA_CACHE_DIR": str(compiled), "HOME": folder, "TMPDIR": folder}
        if os.getuid() == 0:
            for place in (Path(folder), *Path(folder).rglob("*")):
                os.chown(place, how.get("user", 0), how.get("group", 0))
        words = [*python, "-P", "-m", "tests.redteam.scored", levels, *names]
        return subprocess.run(words, capture_output=True, text=True, **{**how, "env": env})
