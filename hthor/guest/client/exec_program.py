"""Turns a confined process into an agent's program, in any language.

The program reads messages from standard input and writes them to standard output; standard error is its log.
"""

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
    """Replace this process by the program.

    Args:
        words: the program and its arguments. folder: its working folder.
        pipes: from the host and to it. shared: the shared memory for pictures, -1 for none.
        word: the token that the system call filter demands, empty where there is no filter.

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
        for number in (signal.SIGPIPE, signal.SIGXFSZ):  # ignored by Python, which the program would inherit
            signal.signal(number, signal.SIG_DFL)
        if word:
            seccomp.exec_with_token(words, env, word)
        os.execve(words[0], list(words), env)
    except OSError as error:
        raise Refused(f"starting {words[0]}: {error.strerror}") from None


def _has_compiled(folder: str) -> bool:
    """Whether the folder has compiled modules, which a Python program would use even if their sources have changed.

    Then the program must compile all that it imports itself, which takes libraries about a second.
    """
    for count, (_, inner, _) in enumerate(os.walk(folder)):
        if "__pycache__" in inner or count > _MOST_FOLDERS:
            return True
        inner[:] = [name for name in inner if not name.startswith(".") and name != "site-packages"]
    return False
