"""One trial's process: confines itself, then imports the agent's file and runs the trial.

A submitted file is executed here and nowhere else, and nothing of it lasts: the next trial has another process.
"""

import os
import sys
from collections.abc import Callable

import msgspec

from hthor.guest.agent import arguments
from hthor.guest.client import exec_program, loading
from hthor.guest.client.agent_loop import run_trial
from hthor.guest.client.file_recorder import FileRecorder
from hthor.guest.confinement import enforcement, seccomp
from hthor.guest.confinement.enforcement import Refused
from hthor.guest.confinement.landlock import Ruleset
from hthor.guest.protocol import sanitize, shared_frames, wire
from hthor.guest.protocol.pipe import HostPipe
from hthor.guest.protocol.trial_channel import GuestEnds

COMPLETED = 97
"""Exit status of a completed trial, which an agent would hardly choose by chance."""


def run_trials(awaited: Callable[[], GuestEnds | None], order: wire.Load, held: Ruleset | None, *, first: bool) -> None:
    """Run one trial, or, for an agent with ``persistent = True``, all of them.

    Args:
        awaited: waits for the trial's pipes; None when none will come. Until then nothing is sent, and nothing of the
            agent is read.
        held: rules for files. first: whether to report how this process is confined, and what the agent is.
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
        pipe.send(_confined(held))
    if order.words:
        try:
            exec_program.exec_program(order.words, order.root, pipe.handles, pipe.shared, word)
        except Refused as error:
            pipe.send(wire.Failed(kind="contract", detail=str(error)))
            return
    _tidy_numba(order.policy.scratch)
    os.chdir(order.root)
    recorder = _watched(order)
    try:
        cls, ready = loading.load_agent(order)
    except loading.ContractViolation as error:
        pipe.send(wire.Failed(kind="contract", detail=sanitize.sanitize_text(str(error))[-wire.TEXT_MAX :]))
        return
    if first:
        pipe.send(msgspec.structs.replace(ready, files=recorder.take() if recorder else ()))
    make = arguments.make_factory(cls, order.args)
    while isinstance(begin := pipe.receive(), wire.Begin):
        run_trial(pipe, make, begin, recorder)
        if not ready.persistent:
            return


def _watched(order: wire.Load) -> FileRecorder | None:
    """Record which files the agent opens from here on, and import its own modules from their sources alone."""
    if order.paths is None:
        return None
    loading.import_from_sources(order.paths)
    recorder = FileRecorder(order.paths)
    recorder.start()
    return recorder


def _taken(ends: GuestEnds) -> HostPipe:
    """The pipes of this trial, with standard input and output of its own."""
    nothing = os.open(os.devnull, os.O_RDONLY)
    for handle, number in ((nothing, 0), (ends.printed, 1), (ends.printed, 2)):
        os.dup2(handle, number)
    os.close(nothing)
    os.close(ends.printed)
    if ends.shared >= 0:
        os.environ[shared_frames.VARIABLE] = str(ends.shared)
    return HostPipe(ends.read, ends.write, ends.shared)


def _confined(held: Ruleset | None) -> wire.Confined:
    return wire.Confined(landlock_abi=held.abi if held else 0, seccomp=held is not None, spaces=NAMESPACES)


def namespaces() -> dict[str, str]:
    """The namespaces of this process that isolation is about."""
    if sys.platform != "linux":
        return {}
    return {name: os.readlink(f"/proc/self/ns/{name}") for name in ("net", "pid")}


NAMESPACES = namespaces()


def _tidy_numba(scratch: str) -> None:
    """Let numba read its cache, which agents may not change, and write none of this trial's code."""
    if "numba" not in sys.modules:
        os.environ["NUMBA_CACHE_DIR"] = scratch
        return
    from numba.core import caching

    caching._CacheLocator.ensure_cache_path = lambda _: None  # numba would test whether it may write there
    caching.Cache.save_overload = lambda *_: None
