"""One trial's process: held first, then it imports the agent's file and plays; knows nothing but its two pipes.

All that a submitted file ever does, it does here, and nothing of it lasts: the next trial has another process.
"""

from __future__ import annotations

import os
import sys
import traceback
from pathlib import Path
from typing import Any

import msgspec

from hthor.guest import loading, wire
from hthor.guest.confinement import holding
from hthor.guest.confinement.holding import Refused
from hthor.guest.confinement.landlock import Ruleset
from hthor.guest.senses import Pipe, RemoteSenses
from hthor.types import Action, Message, Observation

ORDERLY = 97
"""Exit status of a trial that came to its end, which an agent would hardly choose for itself."""


def serve(pipe: Pipe, order: wire.Load, held: Ruleset | None, *, first: bool) -> None:
    """Play one trial, or, with an agent that says ``persistent = True``, all of them.

    Args:
        held: rules for files. first: say what holds this process, and what the file is.
    """
    try:
        holding.confine(order.policy, held)
    except Refused as error:
        pipe.send(wire.Failed(kind="confinement", detail=str(error)))
        return
    if first:
        pipe.send(_confined(held))
    _tidy_numba(order.policy.scratch)
    os.chdir(Path(order.path).parent)
    try:
        cls, ready = loading.load(Path(order.path), order.cls)
    except loading.Refusal as error:
        pipe.send(wire.Failed(kind="contract", detail=str(error)))
        return
    if first:
        pipe.send(ready)
    while isinstance(begin := pipe.receive(), wire.Begin):
        _play(pipe, cls, begin)
        if not ready.persistent:
            return


def _confined(held: Ruleset | None) -> wire.Confined:
    return wire.Confined(landlock_abi=held.abi if held else 0, seccomp=held is not None, spaces=SPACES)


def spaces() -> dict[str, str]:
    """The namespaces of this process that isolation is about."""
    if sys.platform != "linux":
        return {}
    return {name: os.readlink(f"/proc/self/ns/{name}") for name in ("net", "pid")}


SPACES = spaces()


def _tidy_numba(scratch: str) -> None:
    """Read code that was compiled before from where it is, which is not ours to change; keep none of this trial's."""
    if "numba" not in sys.modules:
        os.environ["NUMBA_CACHE_DIR"] = scratch
        return
    from numba.core import caching

    caching._CacheLocator.ensure_cache_path = lambda _: None  # it would try whether it may write there
    caching.Cache.save_overload = lambda *_: None


def _play(pipe: Pipe, cls: type[Any], order: wire.Begin) -> None:
    """One trial. A failure is the agent's last word; the host then ends the process."""
    try:
        agent = cls()
        agent.begin(order.briefing)
        pipe.send(wire.Done())
        while isinstance(look := pipe.receive(), wire.Look):
            pipe.send(_act(pipe, agent, look.observation))
    except BaseException as error:
        pipe.send(_failed(error))


def _act(pipe: Pipe, agent: Any, observation: Observation) -> wire.Acted | wire.Failed:
    senses = RemoteSenses(pipe)
    inbox = tuple(_with_image(message, senses) for message in observation.inbox)
    action = agent.act(msgspec.structs.replace(observation, senses=senses, inbox=inbox))
    senses.expire()
    if not isinstance(action, Action):
        detail = f"act must return an hthor.types.Action, got {type(action).__name__}: {repr(action)[:200]}"
        return wire.Failed(kind="wrong_type", detail=detail)
    try:
        message = wire.Acted(action=wire.plain(action))
    except wire.Unfit as error:
        return wire.Failed(kind="garbage", detail=f"act returned an Action that cannot be taken: {error}")
    size = len(wire.encode(message))
    if size > wire.MOST_BYTES:
        return wire.Failed(
            kind="oversized", detail=f"the action takes {size} bytes, at most {wire.MOST_BYTES} are taken"
        )
    return message


def _with_image(message: Message, senses: RemoteSenses) -> Message:
    return msgspec.structs.replace(message, image=lambda: senses.image(message.id))


def _failed(error: BaseException) -> wire.Failed:
    detail = traceback.format_exception_only(error)[-1].strip()[: loading.TEXT_MAX]
    return wire.Failed(kind="raised", detail=detail, traceback=loading.shown(error))
