"""The folder in which numba caches compiled functions of exactly this code."""

import os
from pathlib import Path

from hthor import installation
from hthor.code_identity.hashes import modules_sha256
from hthor.code_identity.sources import ours
from hthor.code_identity.syntax import PICTURES, SIMULATION, TOOLS


def compiled() -> Path:
    """The folder, in the user's cache, for compiled functions of exactly this code.

    By itself, numba's cache checks only the file of a function, not those of the functions that it calls: after an
    update it could silently run old code.
    """
    kernels = modules_sha256(ours().containing(b"import numba"), (SIMULATION, PICTURES, TOOLS))
    return installation.cache() / f"compiled-{kernels[:16]}"


def keep_compiled() -> None:
    """Make this process and its children cache compiled functions in `compiled`, unless the user chose a folder.

    To be called before trials are run: without it every process, the agents' too, compiles for 20 s.
    """
    if "NUMBA_CACHE_DIR" not in os.environ:
        os.environ["NUMBA_CACHE_DIR"] = str(compiled())
