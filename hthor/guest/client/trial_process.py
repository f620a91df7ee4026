"""One trial's process: confines itself, then imports the agent's file and runs the trial.

A submitted file is executed only here and leaves nothing behind: the next trial has a new process.
"""

import os
import signal
import sys
from collections.abc import Callable, Sequence
from typing import NoReturn

import msgspec

from hthor.guest.agent import inputs
from hthor.guest.client import loading
from hthor.guest.client.agent_loop import run_trial
from hthor.guest.client.file_recorder import FileRecorder
from hthor.guest.confinement import enforcement, seccomp
from hthor.guest.confinement.kernel import Refused
from hthor.guest.confinement.landlock import Ruleset
from hthor.guest.protocol import shared_frames, wire
from hthor.guest.protocol.trial_channel import GuestEnds, HostPipe

COMPLETED = 97
"""Exit status of a completed trial, which an agent would hardly choose by chance."""
_OURS = ("PYTHONPATH", "PYTHONHASHSEED", "PYTHONDONTWRITEBYTECODE", "NUMBA_CACHE_DIR", "NUMBA_NUM_THREADS")
_FRAMES = 3
_MOST_FOLDERS = 1000


def run_trials(awaited: Callable[[], GuestEnds | None], order: wire.Load, held: Ruleset | None, *, first: bool) -> None:
    """Run one trial, or, for an agent with ``persistent = True``, all of them.

    Args:
        awaited: waits for the trial's pipes and returns them, or None when no trial follows. Before that, nothing is
            sent and none of the agent's files is read.
        held: rules for files. first: whether to report the confinement of this process and the agent's description.
    """
    word = seccomp.new_token() if order.words and held is not None else b""
    try:
        enforcement.confine_trial(order.policy, held, word)
    except Refused as error:
        problem = str(error)
    else:
        problem = ""
    if (ends := awaited()) is None:
        return
    pipe = _taken(ends)
    if problem:
        pipe.send(wire.Failed(kind="confinement", detail=problem))
        return
    if first:
        pipe.send(wire.Confined(landlock_abi=held.abi if held else 0, seccomp=held is not None, spaces=NAMESPACES))
    if order.words:
        try:
            exec_program(order.words, order.root, pipe.handles, pipe.shared, word)
        except Refused as error:
            pipe.send(wire.Failed(kind="contract", detail=str(error)))
            return
    _tidy_numba(order.policy.scratch)
    os.chdir(order.root)
    recorder = _watched(order)
    try:
        cls, ready = loading.load_agent(order)
    except loading.ContractViolation as error:
        pipe.send(wire.Failed(kind="contract", detail=wire.sanitize_text(str(error))[-wire.TEXT_MAX :]))
        return
    if first:
        pipe.send(msgspec.structs.replace(ready, files=recorder.take() if recorder else ()))
    make = inputs.make_factory(cls, order.args)
    while isinstance(begin := pipe.receive(), wire.Begin):
        run_trial(pipe, make, begin, recorder)
        if not ready.persistent:
            return


def _watched(order: wire.Load) -> FileRecorder | None:
    """Record which files the agent opens from now on, and import its own modules only from their sources."""
    if order.paths is None:
        return None
    loading.import_from_sources(order.paths)
    recorder = FileRecorder(order.paths)
    recorder.start()
    return recorder


def _taken(ends: GuestEnds) -> HostPipe:
    """The messages of this trial; its output pipe becomes this process's standard output."""
    nothing = os.open(os.devnull, os.O_RDONLY)
    for handle, number in ((nothing, 0), (ends.printed, 1), (ends.printed, 2)):
        os.dup2(handle, number)
    os.close(nothing)
    os.close(ends.printed)
    if ends.shared >= 0:
        os.environ[shared_frames.VARIABLE] = str(ends.shared)
    return HostPipe(ends.read, ends.write, ends.shared)


def namespaces() -> dict[str, str]:
    """The namespaces of this process that isolation separates."""
    if sys.platform != "linux":
        return {}
    return {name: os.readlink(f"/proc/self/ns/{name}") for name in ("net", "pid")}


NAMESPACES = namespaces()


def _tidy_numba(scratch: str) -> None:
    """Let numba read its cache, which agents may not change, but store nothing from this trial."""
    if "numba" not in sys.modules:
        os.environ["NUMBA_CACHE_DIR"] = scratch
        return
    from numba.core import caching

    caching._CacheLocator.ensure_cache_path = lambda _: None  # numba would test whether it may write there
    caching.Cache.save_overload = lambda *_: None


def exec_program(words: Sequence[str], folder: str, pipes: tuple[int, int], shared: int, word: bytes) -> NoReturn:
    """Replace this confined process by the agent's program, in any language.

    The program reads messages from standard input and writes them to standard output; standard error is its log.

    Args:
        words: the program and its arguments. folder: the working folder.
        pipes: from the host and to it. shared: the shared memory for pictures, -1 for none.
        word: the token that the system call filter demands, empty if there is no filter.

    Raises:
        Refused: when the program cannot be started.
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

    If so, the program is made to compile all modules that it imports, which takes about a second for libraries.
    """
    for count, (_, inner, _) in enumerate(os.walk(folder)):
        if "__pycache__" in inner or count > _MOST_FOLDERS:
            return True
        inner[:] = [name for name in inner if not name.startswith(".") and name != "site-packages"]
    return False
