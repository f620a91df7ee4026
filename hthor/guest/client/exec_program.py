"""How a held process becomes an agent's program, in any language.

The program finds the wire at its standard input and output, and what it writes to standard error is its log.
"""

from __future__ import annotations

import os
import signal
from collections.abc import Sequence
from typing import NoReturn

from hthor.guest.confinement import seccomp
from hthor.guest.confinement.kernel import Refused
from hthor.guest.protocol import shared_frames

_OURS = ("PYTHONPATH", "PYTHONHASHSEED", "PYTHONDONTWRITEBYTECODE", "NUMBA_CACHE_DIR", "NUMBA_NUM_THREADS")
_FRAMES = 3
_MOST_FOLDERS = 1000


def exec_program(words: Sequence[str], folder: str, pipes: tuple[int, int], shared: int, word: bytes) -> NoReturn:
    """Start it in this process's place.

    Args:
        folder: where. pipes: from the host and to it. shared: the frames' memory, -1 for none.
        word: what the filter of system calls waits for, empty where there is none.

    Raises:
        Refused: when it cannot be started.
    """
    env = {name: value for name, value in os.environ.items() if name not in (*_OURS, shared_frames.VARIABLE)}
    read, write = (os.dup(handle) for handle in pipes)
    held = os.dup(shared) if shared >= 0 else -1
    if folder and _has_compiled(folder):
        env["PYTHONPYCACHEPREFIX"] = os.path.join(env["TMPDIR"], "compiled")
    try:
        os.chdir(folder or env["TMPDIR"])
        os.dup2(read, 0)
        os.dup2(write, 1)
        if held >= 0:
            os.dup2(held, _FRAMES)
            env[shared_frames.VARIABLE] = str(_FRAMES)
        for number in (signal.SIGPIPE, signal.SIGXFSZ):  # Python ignores them, and a program would inherit that
            signal.signal(number, signal.SIG_DFL)
        if word:
            seccomp.exec_with_token(words, env, word)
        os.execve(words[0], list(words), env)
    except OSError as error:
        raise Refused(f"starting {words[0]}: {error.strerror}") from None


def _has_compiled(folder: str) -> bool:
    """Whether modules lie there compiled, which a Python program would believe whatever their sources say now.

    Then it compiles all that it imports, which takes libraries a second; where nothing is compiled they need not.
    """
    for count, (_, inner, _) in enumerate(os.walk(folder)):
        if "__pycache__" in inner or count > _MOST_FOLDERS:
            return True
        inner[:] = [name for name in inner if not name.startswith(".") and name != "site-packages"]
    return False
