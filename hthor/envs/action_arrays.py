"""Actions as arrays and back, for environments whose actions are arrays.

Every valid `hthor.types.Action` can be encoded, and decoding gives the same action again. The arrays of a seat are a
dict with the fields of `action_spec`; a motion, message or reply uses some of them, and the others are ignored. The
values that ``generate_value()`` gives, zeros and empty texts, are the action of waiting for a tick.
"""

from collections.abc import Mapping
from typing import Any, NoReturn

import msgspec
import numpy as np
from dm_env import specs
from numpy.typing import NDArray

from hthor.errors import HthorError
from hthor.types import Action, Close, Drive, Drop, Motion, Move, Open, Pick, Place, Reply, Rotate, Send, Vec3, Wait
from hthor.types.signals import Signal

MOTIONS: tuple[type[Motion], ...] = (Wait, Move, Rotate, Drive, Pick, Place, Drop, Open, Close)
"""The motions in the order of their numbers in the field ``motion``."""
SPEECH: tuple[type[Send | Reply] | None, ...] = (None, Send, Reply)
"""What may be said, in the order of its numbers in the field ``say``."""
_NUMBERS: dict[type[Motion], tuple[str, ...]] = {
    Wait: ("seconds",),
    Move: ("forward", "left"),
    Rotate: ("yaw", "pitch"),
    Drive: ("forward", "left", "yaw", "pitch"),
}
"""The fields of a motion that are in ``numbers``."""
_THINGS: dict[type[Motion], str] = {Pick: "object", Place: "on", Open: "thing", Close: "thing"}
"""The field of a motion that is in ``thing``."""
_signals = msgspec.json.Decoder(tuple[Signal, ...])
Arrays = dict[str, NDArray[Any]]


def action_spec() -> dict[str, specs.Array]:
    """The arrays of one seat's action.

    - ``motion``: number of the motion in `MOTIONS`. ``numbers`` (4,): its numbers in the order of its fields, [m],
      [rad], [s] or [m/s]. ``thing``: the id of the object or thing that it is about.
    - ``position`` (3,) [m] of a Place, if ``has_position``.
    - ``say``: number in `SPEECH`. Of a Send: ``text``, ``object``, ``object_position`` (3,) [m] if
      ``has_object_position``, ``to``, ``question``, and ``answers``, the number of the question, or -1 if it answers
      none. Of a Reply: ``message`` and ``accept``.
    - ``signals``: signals as JSON, such as ``[{"type": "ready"}]``; empty for none.
    """
    found: tuple[specs.Array, ...] = (
        specs.DiscreteArray(len(MOTIONS), np.int64, name="motion"),
        specs.Array((4,), np.float64, name="numbers"),
        specs.StringArray((), name="thing"),
        specs.Array((3,), np.float64, name="position"),
        _flag("has_position"),
        specs.DiscreteArray(len(SPEECH), np.int64, name="say"),
        specs.StringArray((), name="text"),
        specs.StringArray((), name="object"),
        specs.Array((3,), np.float64, name="object_position"),
        _flag("has_object_position"),
        specs.StringArray((), name="to"),
        _flag("question"),
        specs.BoundedArray((), np.int64, -1, np.iinfo(np.int64).max, name="answers"),
        specs.BoundedArray((), np.int64, 0, np.iinfo(np.int64).max, name="message"),
        _flag("accept"),
        specs.StringArray((), name="signals"),
    )
    return {spec.name: spec for spec in found}


def _flag(name: str) -> specs.Array:
    return specs.BoundedArray((), np.bool_, False, True, name=name)


_SPECS = action_spec()


def encode_action(action: Action) -> Arrays:
    """The arrays of an action.

    Raises:
        HthorError: when the arrays cannot hold it, such as a negative number of a message.
    """
    values: dict[str, Any] = {**_of_motion(action.motion), **_of_speech(action.say)}
    if action.signals:
        values["signals"] = msgspec.json.encode(action.signals).decode()
    blank = {name: spec.generate_value() for name, spec in _SPECS.items()}
    return {**blank, **{name: _array(name, value) for name, value in values.items()}}


def decode_action(arrays: Mapping[str, Any]) -> Action:
    """The action of such arrays; numbers of Python, and texts, may stand for arrays without dimensions.

    Raises:
        HthorError: when a field is missing, unknown, or not as `action_spec` says; the error names the field.
    """
    if not isinstance(arrays, Mapping):
        raise HthorError(f"an action is a dict with the fields {', '.join(_SPECS)}; got {type(arrays).__name__}")
    if missing := [name for name in _SPECS if name not in arrays]:
        raise HthorError(f"field '{missing[0]}' is missing; start from encode_action(Action()) and set what you need")
    if unknown := [name for name in arrays if name not in _SPECS]:
        raise HthorError(f"there is no field '{unknown[0]}'; the fields are {', '.join(_SPECS)}")
    values = {name: _array(name, arrays[name]).tolist() for name in _SPECS}
    return Action(motion=_motion(values), say=_speech(values), signals=_decoded_signals(values["signals"]))


def _array(name: str, value: Any) -> NDArray[Any]:
    """The value as an array that fits the field's specification."""
    spec = _SPECS[name]
    try:
        array = np.asarray(value, object if spec.dtype == object else None)
        if array.dtype != spec.dtype and np.can_cast(array.dtype, spec.dtype, "same_kind"):
            array = array.astype(spec.dtype)
        checked: NDArray[Any] = spec.validate(array)
    except (TypeError, ValueError, OverflowError) as error:
        _refuse(name, str(error))
    return checked


def _refuse(name: str, why: str) -> NoReturn:
    raise HthorError(f"field '{name}': {why.rstrip('.')}. It must be {_SPECS[name]}") from None


def _of_motion(motion: Motion) -> dict[str, Any]:
    kind = type(motion)
    numbers = [getattr(motion, name) for name in _NUMBERS.get(kind, ())]
    found: dict[str, Any] = {
        "motion": MOTIONS.index(kind),
        "numbers": [float(number) for number in numbers] + [0.0] * (4 - len(numbers)),
    }
    if kind in _THINGS:
        found["thing"] = getattr(motion, _THINGS[kind])
    if isinstance(motion, Place) and motion.position is not None:
        found["position"], found["has_position"] = motion.position, True
    return found


def _of_speech(say: Send | Reply | None) -> dict[str, Any]:
    if say is None:
        return {}
    if isinstance(say, Reply):
        return {"say": SPEECH.index(Reply), "message": say.message, "accept": say.accept}
    found = {"say": SPEECH.index(Send), "text": say.text, "object": say.object, "to": say.to, "question": say.question}
    if say.position is not None:
        found["object_position"], found["has_object_position"] = say.position, True
    if say.answers is not None and say.answers < 0:
        _refuse("answers", f"the numbers of messages are 0, 1, 2 ..., got {say.answers}")
    found["answers"] = -1 if say.answers is None else say.answers
    return found


def _motion(values: Mapping[str, Any]) -> Motion:
    kind = MOTIONS[values["motion"]]
    fields = dict(zip(_NUMBERS.get(kind, ()), values["numbers"], strict=False))
    if kind in _THINGS:
        fields[_THINGS[kind]] = values["thing"]
    if kind is Place and values["has_position"]:
        fields["position"] = _point(values["position"])
    motion: Motion = kind(**fields)
    return motion


def _speech(values: Mapping[str, Any]) -> Send | Reply | None:
    kind = SPEECH[values["say"]]
    if kind is None:
        return None
    if kind is Reply:
        return Reply(message=values["message"], accept=values["accept"])
    return Send(
        text=values["text"],
        object=values["object"],
        position=_point(values["object_position"]) if values["has_object_position"] else None,
        to=values["to"],
        question=values["question"],
        answers=values["answers"] if values["answers"] >= 0 else None,
    )


def _point(numbers: list[float]) -> Vec3:
    x, y, z = numbers
    return (x, y, z)


def _decoded_signals(text: str) -> tuple[Signal, ...]:
    try:
        return _signals.decode(text) if text else ()
    except (msgspec.MsgspecError, UnicodeError) as error:
        _refuse("signals", f"not signals as JSON ({error})")
