"""The guest's process: loads one agent's file, then plays trials with it; knows nothing but its two pipes.

Each trial is played in a fork of the freshly loaded process, so nothing that an agent does in one trial can reach
another. An agent that cannot be forked (one that holds a GPU or threads) says so by ``persistent = True`` in its
class; then only a new object is made for each trial.
"""

from __future__ import annotations

import contextlib
import ctypes
import gc
import importlib.util
import os
import resource
import signal
import sys
import traceback
from pathlib import Path
from types import ModuleType
from typing import Any

import msgspec

from hthor.errors import StaleObservation
from hthor.guest import wire
from hthor.types import Action, Camera, Detection, Message, Observation, Scan

_PRIVILEGES = ("house_map", "ideal_detector", "object_poses")
_TEXT_MAX = 8000
_ORDERLY = 97
"""Exit status of a trial that came to its end, which an agent would hardly choose for itself."""
_MODULE = "hthor_guest_agent"  # not the file's name, which could hide a module of the standard library
_hosts_words = msgspec.msgpack.Decoder(wire.ToGuest)


class Refusal(Exception):
    """The file does not follow the contract; the message goes to its author."""


class Pipe:
    """The guest's end of the wire. Reads exactly one frame at a time, so that a fork shares nothing half read."""

    def __init__(self, read: int, write: int) -> None:
        self._read, self._write = read, write

    def receive(self) -> wire.ToGuest:
        """The host's next message; ends the process when the host is gone."""
        size = int.from_bytes(self._exactly(4), "little")
        message: wire.ToGuest = _hosts_words.decode(self._exactly(size))
        return message

    def send(self, message: wire.ToHost) -> None:
        data = memoryview(wire.frame(message))
        while data:
            data = data[os.write(self._write, data) :]

    def ask(self, what: str, which: int = -1) -> bytes:
        """The encoded answer of the host."""
        self.send(wire.Ask(what=what, which=which))
        answer = self.receive()
        if not isinstance(answer, wire.Given):
            os._exit(1)
        return bytes(answer.value)

    def _exactly(self, size: int) -> bytes:
        chunks = []
        while size:
            chunk = os.read(self._read, min(size, 1 << 20))
            if not chunk:
                os._exit(0)
            chunks.append(chunk)
            size -= len(chunk)
        return b"".join(chunks)


class RemoteSenses:
    """Asks the host for what the agent reads, each thing once; useless after `expire`."""

    def __init__(self, pipe: Pipe) -> None:
        self._pipe, self._known, self._fresh = pipe, dict[tuple[str, int], Any](), True

    def expire(self) -> None:
        """The tick is over."""
        self._fresh = False

    def detections(self) -> tuple[Detection, ...]:
        return self._get("detections", lambda data: msgspec.msgpack.decode(data, type=tuple[Detection, ...]))  # type: ignore[no-any-return]

    def scan(self) -> Scan:
        return self._get("scan", _scan)  # type: ignore[no-any-return]

    def rgb(self) -> Any:
        return self._get("rgb", _array)

    def depth(self) -> Any:
        return self._get("depth", _array)

    def segmentation(self) -> Any:
        return self._get("segmentation", _array)

    def camera(self) -> Camera:
        return self._get("camera", _camera)  # type: ignore[no-any-return]

    def image(self, number: int) -> Any:
        """The picture of message ``number``."""
        return self._get("image", _array, number)

    def _get(self, what: str, decode: Any, which: int = -1) -> Any:
        if not self._fresh:
            raise StaleObservation("this observation is of an earlier tick: read what you need during act")
        key = (what, which)
        if key not in self._known:
            self._known[key] = decode(self._pipe.ask(what, which))
        return self._known[key]


def main(read: int, write: int, parent: int) -> None:
    """Serve the host until it hangs up."""
    _settle(read, write, parent)
    pipe = Pipe(read, write)
    order = pipe.receive()
    if not isinstance(order, wire.Load):
        os._exit(1)
    try:
        cls, ready = _load(Path(order.path), order.cls)
    except Refusal as error:
        pipe.send(wire.Failed(kind="contract", detail=str(error)))
        return
    pipe.send(ready)
    gc.collect()
    gc.freeze()
    while True:
        order = pipe.receive()
        if isinstance(order, wire.Begin):
            if getattr(cls, "persistent", False):
                _play(pipe, cls, order)
            else:
                _fork(pipe, cls, order)


def _settle(read: int, write: int, parent: int) -> None:
    """Die with the parent, leave no core files, and send whatever is printed to the log instead of the wire."""
    _die_with_parent(parent)
    _guard_group((read, write))
    with contextlib.suppress(OSError):  # where memory runs out, let it be the guest that is ended, not the evaluation
        Path("/proc/self/oom_score_adj").write_text("1000")
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    for handle in (read, write):
        os.set_inheritable(handle, False)
    os.dup2(2, 1)
    sys.stdout = sys.stderr


def _die_with_parent(parent: int) -> None:
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(1, signal.SIGKILL)  # PR_SET_PDEATHSIG
    if os.getppid() != parent:
        os._exit(0)


def _guard_group(pipes: tuple[int, ...]) -> None:
    """Leave a process behind that ends the whole group when this process ends: an agent may have started others."""
    me = os.getpid()
    if sys.platform != "linux" or os.getpgrp() != me:
        return
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGUSR1})
    if os.fork():
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGUSR1})
        return
    try:
        ctypes.CDLL(None).prctl(1, signal.SIGUSR1)  # PR_SET_PDEATHSIG
        for handle in (*pipes, 1, 2):  # the host takes an open end for a guest that lives
            os.close(handle)
        if os.getppid() == me:
            signal.sigwait({signal.SIGUSR1})
    finally:
        os.killpg(me, signal.SIGKILL)


def _fork(pipe: Pipe, cls: type[Any], order: wire.Begin) -> None:
    """Play one trial in a child of our own, and tell the host if it dies without a word."""
    me = os.getpid()
    pid = os.fork()
    if pid == 0:
        try:
            _die_with_parent(me)
            _play(pipe, cls, order)
            os._exit(_ORDERLY)
        finally:
            os._exit(1)
    _, status = os.waitpid(pid, 0)
    code = os.waitstatus_to_exitcode(status)
    if code != _ORDERLY:
        pipe.send(wire.Failed(kind="died", detail=_last_words(code)))


def _last_words(code: int) -> str:
    return f"the agent's process was killed by {signal.Signals(-code).name}" if code < 0 else _exited(code)


def _exited(code: int) -> str:
    return f"the agent's process exited with status {code}"


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


def _scan(data: bytes) -> Scan:
    scan = msgspec.msgpack.decode(data, type=Scan)
    return msgspec.structs.replace(
        scan,
        bearings=wire.decode_array(scan.bearings),
        ranges=wire.decode_array(scan.ranges),
        tops=scan.tops if scan.tops is None else wire.decode_array(scan.tops),
    )


def _camera(data: bytes) -> Camera:
    camera = msgspec.msgpack.decode(data, type=Camera)
    return msgspec.structs.replace(camera, matrix=wire.decode_array(camera.matrix), pose=wire.decode_array(camera.pose))


def _array(data: bytes) -> Any:
    return wire.decode_array(msgspec.msgpack.decode(data))


def _load(path: Path, wanted: str) -> tuple[type[Any], wire.Ready]:
    module = _import(path)
    cls = _pick(module, path, wanted)
    privileges = _names(cls, "privileges", path)
    unknown = [name for name in privileges if name not in _PRIVILEGES]
    if unknown:
        raise Refusal(f"{path}: {cls.__name__}.privileges names '{unknown[0]}'. Valid: {', '.join(_PRIVILEGES)}.")
    ready = wire.Ready(
        name=path.stem,
        privileges=privileges,
        robots=_names(cls, "robots", path),
        absent=bool(getattr(cls, "absent", False)),
        doc=(cls.__doc__ or module.__doc__ or "").strip()[:_TEXT_MAX],
    )
    return cls, ready


def _import(path: Path) -> ModuleType:
    sys.path.insert(0, str(path.parent))
    spec = importlib.util.spec_from_file_location(_MODULE, path)
    if spec is None or spec.loader is None:
        raise Refusal(f"{path}: not a Python file; an agent is one file that ends in .py")
    module = importlib.util.module_from_spec(spec)
    sys.modules[_MODULE] = module
    try:
        spec.loader.exec_module(module)
    except SyntaxError as error:
        line = f":{error.lineno}" if error.lineno else ""
        raise Refusal(f"{error.filename or path}{line}: {error.msg}") from None
    except BaseException as error:
        raise Refusal(f"{path}: importing it failed.\n{_traceback(error)}") from None
    return module


def _pick(module: ModuleType, path: Path, wanted: str) -> type[Any]:
    """The class to use: the one asked for, the only one, or the one called Agent."""
    found = {
        name: value
        for name, value in vars(module).items()
        if isinstance(value, type)
        and (value.__module__ == module.__name__ or name == "Agent")
        and callable(getattr(value, "begin", None))
        and callable(getattr(value, "act", None))
    }
    listed = ", ".join(found) or "none"
    if wanted:
        if wanted not in found:
            raise Refusal(f"{path}: no agent class '{wanted}' (a class with begin and act). Found: {listed}.")
        return found[wanted]
    if not found:
        raise Refusal(f"{path}: no agent class found. Define 'class Agent' with begin(briefing) and act(observation).")
    if len(found) > 1 and "Agent" not in found:
        raise Refusal(f"{path}: several agent classes: {listed}. Say which one: {path.name}:{next(iter(found))}.")
    return found.get("Agent") or next(iter(found.values()))


def _names(cls: type[Any], attribute: str, path: Path) -> tuple[str, ...]:
    value = getattr(cls, attribute, ())
    if not isinstance(value, (tuple, list)) or not all(isinstance(name, str) for name in value):
        raise Refusal(f"{path}: {cls.__name__}.{attribute} must be a tuple of names, got {value!r}.")
    return tuple(value)


def _failed(error: BaseException) -> wire.Failed:
    detail = traceback.format_exception_only(error)[-1].strip()[:_TEXT_MAX]
    return wire.Failed(kind="raised", detail=detail, traceback=_traceback(error))


def _traceback(error: BaseException) -> str:
    """The traceback without our own frames in front, its end kept when it is long."""
    ours = (str(Path(__file__).parent), "<frozen importlib")
    trace = error.__traceback__
    while trace is not None and trace.tb_frame.f_code.co_filename.startswith(ours):
        trace = trace.tb_next
    return "".join(traceback.format_exception(type(error), error, trace))[-_TEXT_MAX:]
