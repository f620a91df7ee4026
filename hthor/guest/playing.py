"""One trial of a Python agent on the guest's side; knows nothing of what holds it or what carries the messages."""

from __future__ import annotations

import traceback
from typing import Any

import msgspec

from hthor.guest import loading, wire
from hthor.guest.senses import Gone, RemoteSenses, Wire
from hthor.guest.showing import shown
from hthor.types import Action, Message


def play(pipe: Wire, cls: type[Any], order: wire.Begin) -> None:
    """One trial. A failure is the agent's last word; the host then ends the process."""
    try:
        agent = cls()
        agent.begin(order.briefing)
        pipe.send(wire.Done())
        while isinstance(look := pipe.receive(), wire.Look):
            pipe.send(_act(pipe, agent, look))
    except Gone:
        raise
    except BaseException as error:
        pipe.send(_failed(error))


def _act(pipe: Wire, agent: Any, look: wire.Look) -> wire.Acted | wire.Failed:
    observation, senses = look.observation, RemoteSenses(pipe, look.ahead)
    inbox = tuple(_with_image(message, senses) for message in observation.inbox)
    action = agent.act(msgspec.structs.replace(observation, senses=senses, inbox=inbox))
    senses.expire()
    if not isinstance(action, Action):
        detail = f"act must return an hthor.types.Action, got {type(action).__name__}: {repr(action)[:200]}"
        return wire.Failed(kind="wrong_type", detail=shown(detail))
    try:
        message = wire.Acted(action=wire.plain(action), read=senses.read)
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
    detail = shown(traceback.format_exception_only(error)[-1].strip())[: wire.TEXT_MAX]
    return wire.Failed(kind="raised", detail=detail, traceback=loading.shown(error))
