"""Where numba keeps compiled loops: a folder for exactly this code."""

from __future__ import annotations

import os
from pathlib import Path

from hthor import installation
from hthor.code_identity.hashes import modules_sha256
from hthor.code_identity.sources import ours
from hthor.code_identity.syntax import PICTURES, SIMULATION, TOOLS


def compiled() -> Path:
    """Where compiled loops of exactly this code are kept, in the user's cache.

    Left to itself the compiler's cache looks only at the file of the loop it is asked for, not at those that the loop
    calls into: after an update it could run old code, and nothing would tell.
    """
    kernels = modules_sha256(ours().containing(b"import numba"), (SIMULATION, PICTURES, TOOLS))
    return installation.cache() / f"compiled-{kernels[:16]}"


def keep_compiled() -> None:
    """Have this process, and those that it starts, keep compiled loops in `compiled`, unless the user chose a place.

    Whatever plays trials calls this first: without it every process, the agents' too, compiles for 20 s.
    """
    if "NUMBA_CACHE_DIR" not in os.environ:
        os.environ["NUMBA_CACHE_DIR"] = str(compiled())
