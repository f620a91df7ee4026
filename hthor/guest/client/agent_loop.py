"""One trial of a Python agent: observations in, actions out."""

import traceback
from collections.abc import Callable
from typing import Any

import msgspec

from hthor.guest.client import file_recorder, loading
from hthor.guest.client.file_recorder import FileRecorder
from hthor.guest.client.remote_senses import HostConnection, HostGone, RemoteSenses
from hthor.guest.protocol import wire
from hthor.guest.protocol.wire import sanitize_text
from hthor.types import Action, Message


def run_trial(
    pipe: HostConnection, make: Callable[[], Any], order: wire.Begin, recorder: FileRecorder | None = None
) -> None:
    """Run one trial with the new agent that ``make`` returns; ``recorder`` records the files that it opens.

    After a failure, which is reported, the host ends the process.
    """
    try:
        agent = make()
        agent.begin(order.briefing)
        pipe.send(wire.Done(files=recorder.take() if recorder else ()))
        while isinstance(look := pipe.receive(), wire.Look):
            said = _act(pipe, agent, look)
            if (
                recorder
                and recorder.waiting
                and len(wire.encode(said)) <= wire.MOST_BYTES - 2 * file_recorder.BATCH_BYTES
            ):
                said = msgspec.structs.replace(said, files=recorder.take())
            pipe.send(said)
    except HostGone:
        raise
    except BaseException as error:
        failed = _failed(error)
        pipe.send(msgspec.structs.replace(failed, files=recorder.take() if recorder else ()))


def _act(pipe: HostConnection, agent: Any, look: wire.Look) -> wire.Acted | wire.Failed:
    observation, senses = look.observation, RemoteSenses(pipe, look.ahead)
    inbox = tuple(_with_image(message, senses) if message.image else message for message in observation.inbox)
    action = agent.act(msgspec.structs.replace(observation, senses=senses, inbox=inbox))
    senses.expire()
    if not isinstance(action, Action):
        detail = f"act must return an hthor.types.Action, got {type(action).__name__}: {repr(action)[:200]}"
        return wire.Failed(kind="wrong_type", detail=sanitize_text(detail))
    try:
        message = wire.Acted(action=wire.to_plain_action(action), read=senses.read)
    except wire.InvalidAction as error:
        return wire.Failed(kind="garbage", detail=f"act returned an Action that cannot be taken: {error}")
    size = len(wire.encode(message))
    if size > wire.MOST_BYTES:
        return wire.Failed(
            kind="oversized", detail=f"the action takes {size} bytes, at most {wire.MOST_BYTES} are accepted"
        )
    return message


def _with_image(message: Message, senses: RemoteSenses) -> Message:
    return msgspec.structs.replace(message, image=lambda: senses.image(message.id))


def _failed(error: BaseException) -> wire.Failed:
    detail = sanitize_text(traceback.format_exception_only(error)[-1].strip())[: wire.TEXT_MAX]
    return wire.Failed(kind="raised", detail=detail, traceback=loading.format_traceback(error))
