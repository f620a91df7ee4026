"""The messages between host and guest, as msgpack; described in docs/wire.md.

Arrays are sent from host to guest only: as ``{"__nd__": dtype, "s": shape, "d": bytes}``, or, for a guest that requests
shared memory, with ``"at"``, the offset in it, instead of the bytes.
"""

import math
from typing import Any

import msgspec
import numpy as np
from msgspec import Struct

from hthor.errors import KILLED
from hthor.guest.agent.agent_paths import AgentPaths
from hthor.guest.agent.manifest import File
from hthor.guest.confinement import Policy
from hthor.guest.protocol import versions
from hthor.types import Action, Briefing, Observation

MOST_BYTES = 64 << 10
"""Longest frame that a guest may send [bytes]."""
NAME_MAX = 200
"""Longest id, seat or name of a thing in an action, in characters."""
NUMBER_MAX = 1e12
"""Largest magnitude of a number in an action: beyond it the next multiplication may overflow."""
SIGNALS_MAX = 8
"""Most signals in one action."""
TEXT_MAX = 8000
"""Longest description of an agent or of a failure, in characters."""
PRIVILEGES = ("house_map", "ideal_detector", "object_poses", "pixel_labels")
"""Privileges that an agent may declare to get more information than its robot senses."""
FAULTS = ("raised", "timeout", "died", KILLED, "memory", "disk", "garbage", "wrong_type", "oversized", "not_finite")
"""Kinds of failure during a trial."""
OWN_FAULTS = ("raised", "wrong_type", "garbage", "oversized")
"""Kinds that a guest may report itself; the supervisor and the host find the others."""
_KEPT = (ord("\n"), ord("\t"))
_TURNING = (0x61C, *range(0x200E, 0x2010), *range(0x2028, 0x202F), *range(0x2066, 0x206A))
_UNSEEN = (*range(0x20), *range(0x7F, 0xA0), *_TURNING)
_HALVES = range(0xD800, 0xE000)
_ESCAPED = {
    code: f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}" for code in (*_UNSEEN, *_HALVES) if code not in _KEPT
}


class InvalidAction(ValueError):
    """An action with a value of the wrong type; the message names the field."""


class Load(Struct, tag="load", frozen=True, kw_only=True):
    """Host to supervisor: start this agent.

    Attributes:
        path: its file, which is imported. cls: the class to use, empty for the only one.
        module: the name to import it by, from the folder ``root``; empty for a file that has none.
        words: a program and its arguments, started in ``root`` instead of importing anything.
        args: keyword arguments of the class's constructor. paths: where the agent's own files are.
    """

    path: str
    cls: str
    policy: Policy
    module: str = ""
    words: tuple[str, ...] = ()
    root: str = ""
    args: dict[str, str] = {}
    paths: AgentPaths | None = None


class Begin(Struct, tag="begin", frozen=True, kw_only=True):
    """Host: a trial begins. The guest makes a new agent."""

    briefing: Briefing


class Look(Struct, tag="look", frozen=True, kw_only=True):
    """Host: act. The observation lacks its ``senses`` and its messages' images, which the guest can request.

    A message's ``image`` is true if there is one.

    ``ahead`` holds the sensor data that the guest has read in both of its last two steps, if it accepts that.
    """

    observation: Observation
    ahead: dict[str, msgspec.Raw] = {}


class Given(Struct, tag="given", frozen=True, kw_only=True):
    """Host: the requested data, encoded."""

    value: msgspec.Raw


class End(Struct, tag="end", frozen=True, kw_only=True):
    """Host: the trial is over."""


class Confined(Struct, tag="confined", frozen=True, kw_only=True):
    """Guest: confined, and about to import the file. ``spaces`` are its namespaces, as /proc names them."""

    landlock_abi: int
    seccomp: bool
    spaces: dict[str, str]


class Ready(Struct, tag="ready", frozen=True, kw_only=True):
    """Guest: the agent is loaded; its description of itself.

    ``version`` distinguishes versions of a served agent; ``ahead`` says that it accepts sensor data before it asks;
    ``gpus`` is the share of a GPU it needs; ``files`` are its own files that it has opened, relative to its folder;
    ``manifest`` lists the files of a served agent, as its server reports them; ``wire`` is the version of the protocol.
    """

    name: str = ""
    privileges: tuple[str, ...] = ()
    robots: tuple[str, ...] = ()
    absent: bool = False
    persistent: bool = False
    doc: str = ""
    version: str = ""
    ahead: bool = False
    gpus: float = 0.0
    files: tuple[str, ...] = ()
    manifest: tuple[File, ...] = ()
    wire: int = versions.UNSTATED


class Done(Struct, tag="done", frozen=True, kw_only=True):
    """Guest: ready for the trial; ``files`` as in `Ready`, without those named before."""

    files: tuple[str, ...] = ()


class Ask(Struct, tag="ask", frozen=True, kw_only=True):
    """Guest: needs one of rgb, depth, segmentation, camera, scan, detections, or the image of message ``which``.

    With ``shared`` a picture is put in shared memory, if there is any and it fits.
    """

    what: str
    which: int = -1
    shared: bool = False


class Acted(Struct, tag="acted", frozen=True, kw_only=True):
    """Guest: its action, and which of the data sent ahead it has read; ``files`` as in `Done`."""

    action: Action
    read: tuple[str, ...] = ()
    files: tuple[str, ...] = ()


class Over(Struct, tag="over", frozen=True, kw_only=True):
    """Supervisor: the trial's process has ended, and everything that it left is removed."""


class Failed(Struct, tag="failed", frozen=True, kw_only=True):
    """Guest or supervisor: a failure; ``kind`` as in `GuestFault`, ``files`` as in `Done`."""

    kind: str
    detail: str
    traceback: str = ""
    files: tuple[str, ...] = ()


ToGuest = Load | Begin | Look | Given | End
ToHost = Confined | Ready | Done | Ask | Acted | Failed
SupervisorToHost = Over | Failed


def _encode_array(value: object) -> object:
    if isinstance(value, np.ndarray):
        plain = np.ascontiguousarray(value)
        return {"__nd__": plain.dtype.str, "s": list(plain.shape), "d": plain.tobytes()}
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(f"cannot send a {type(value).__name__}")


def _as_list(value: object) -> object:
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    raise TypeError(f"a {type(value).__name__} has no place in an Action")


def to_plain_action(action: Action) -> Action:
    """The same action with NumPy's numbers and arrays turned into Python's.

    Raises:
        InvalidAction: when a value is of the wrong type.
    """
    try:
        return _action_decoder.decode(_plain_encoder.encode(action))
    except (msgspec.ValidationError, TypeError, OverflowError) as error:
        problem, _, place = str(error).partition(" - at `$.")
        raise InvalidAction(f"{place.rstrip('`')}: {problem}" if place else problem) from None


def decode_array(value: dict[str, Any]) -> Any:
    """The array that a dictionary in a message encodes."""
    return np.frombuffer(value["d"], dtype=np.dtype(value["__nd__"])).reshape(value["s"])


_encoder = msgspec.msgpack.Encoder(enc_hook=_encode_array)
_plain_encoder = msgspec.msgpack.Encoder(enc_hook=_as_list)
_action_decoder = msgspec.msgpack.Decoder(Action)


def encode(message: object) -> bytes:
    """One message or value as bytes, without its length; arrays and NumPy numbers are allowed."""
    return _encoder.encode(message)


def frame(message: ToGuest | ToHost | SupervisorToHost) -> bytes:
    """One message as bytes for a pipe."""
    return add_length(encode(message))


def add_length(body: bytes) -> bytes:
    """An encoded message with its length in front."""
    return len(body).to_bytes(4, "little") + body


def find_action_fault(action: Action) -> tuple[str, str] | None:
    """The error in an action, as a fault's kind and detail; None when the action is valid."""
    if len(action.signals) > SIGNALS_MAX:
        return "oversized", f"an action has {len(action.signals)} signals, at most {SIGNALS_MAX} are taken"
    for part in (action.motion, action.say, *action.signals):
        if part is None:
            continue
        for name in part.__struct_fields__:
            value, field = getattr(part, name), f"{type(part).__name__}.{name}"
            for number in value if isinstance(value, tuple) else (value,):
                if isinstance(number, (float, int)) and not abs(number) <= NUMBER_MAX:
                    if not math.isfinite(number):
                        return "not_finite", f"{field} must be finite, got {value}"
                    return "garbage", f"{field} must lie within {NUMBER_MAX:g} of zero, got {value}"
            if isinstance(value, str) and name != "text" and len(value) > NAME_MAX:
                return "oversized", f"{field} has {len(value)} characters, at most {NAME_MAX} are taken"
    return None


def sanitize_text(text: str) -> str:
    """A guest's text, safe to show and to write to files: with escapes for control characters, characters that change
    the writing direction, and surrogates; line ends and tabs stay.
    """
    return text.replace("\r\n", "\n").translate(_ESCAPED)


def is_printable_name(text: str, most: int) -> bool:
    """Whether a text can stand in a table or a file's name: printable, ``most`` characters at most."""
    return text.isprintable() and len(text) <= most
