"""The observations of a seat as arrays of fixed shapes.

Everything comes from the same `hthor.types.Observation` that an agent of that seat would get. Lists are padded: their
first ``count`` rows count, the others are empty texts and zeros.
"""

from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np
from dm_env import specs
from numpy.typing import NDArray

from hthor.types import BodySpec, Detection, Message, Observation, Outcome, Pose, Receipt
from hthor.world.model.trial_control import Reading

MAIL_ROWS = 8
"""Rows for messages; our choice. If a robot has more new messages and open questions, the newest are observed."""
POSE = ("x", "y", "yaw", "pitch", "head")
"""The numbers of ``pose``: [m, m, rad, rad, rad] in the house frame; ``head`` is relative to ``yaw``."""
OUTCOME = ("motion", "reason", "by")
"""The texts of ``outcome``, see `hthor.types.Outcome`; all empty before any motion has ended."""
DETECTION_TEXTS = ("id", "kind", "family", "state", "support", "held_by", "bearers")
"""The texts of a row of ``detections/texts``, see `hthor.types.Detection`; ``bearers`` has a space between seats."""
DETECTION_NUMBERS = ("x", "y", "z", "size x", "size y", "size z", "yaw", "distance")
"""The numbers of a row of ``detections/numbers`` [m, rad]."""
SCAN = ("bearings", "ranges", "tops")
"""The rows of ``scan`` [rad, m, m], see `hthor.types.Scan`."""
MESSAGE_TEXTS = ("sender", "text", "object", "to")
"""The texts of a row of ``mail/texts``, see `hthor.types.Message`."""
MESSAGE_NUMBERS = ("id", "tick", "question", "answers")
"""The numbers of a row of ``mail/numbers``; ``question`` is 0 or 1, ``answers`` -1 for none."""
RECEIPT_TEXTS, RECEIPT_NUMBERS = ("status", "by"), ("message", "tick", "yes")
"""The status of the seat's own last message, see `hthor.types.Receipt`: empty and -1 before the first. ``yes`` is the
answer to a question: 0, 1, or -1 for none.
"""
PICTURES = ("rgb", "depth", "segmentation")
"""They cost a millisecond each tick, so they are not observed unless somebody asks for them."""


def seat_readings(
    observe: Callable[[], Observation], body: BodySpec, size: tuple[int, int], rows: int
) -> dict[str, Reading]:
    """The observables of a seat by name.

    Args:
        observe: what the seat observes now. body: its body.
        size: (width, height) [pixels] of its pictures. rows: of detections; at least as many as there are things.
    """
    return {
        "pose": Reading(_floats(len(POSE)), lambda: _pose(observe().pose)),
        "idle": Reading(specs.Array((), np.bool_), lambda: np.array(observe().idle)),
        "room": Reading(_texts(), lambda: _text(observe().room)),
        "holding": Reading(_texts(), lambda: _text(observe().holding)),
        "outcome": Reading(_texts(len(OUTCOME)), lambda: _outcome(observe().outcome)),
        "outcome_ok": Reading(specs.Array((), np.bool_), lambda: np.array(_is_ok(observe().outcome))),
        "scan": Reading(_floats(len(SCAN), body.scan_beams), lambda: _scan(observe())),
        **_detections(lambda: observe().detections, rows),
        **_mail(observe),
        **_pictures(observe, size),
    }


def _detections(detections: Callable[[], Sequence[Detection]], rows: int) -> dict[str, Reading]:
    return {
        "detections/count": Reading(_integers(), lambda: np.array(len(detections()), np.int64)),
        "detections/texts": Reading(
            _texts(rows, len(DETECTION_TEXTS)),
            lambda: _table("", object, rows, len(DETECTION_TEXTS), map(_detected_texts, detections())),
        ),
        "detections/numbers": Reading(
            _floats(rows, len(DETECTION_NUMBERS)),
            lambda: _table(0.0, np.float64, rows, len(DETECTION_NUMBERS), map(_detected_numbers, detections())),
        ),
    }


def _mail(observe: Callable[[], Observation]) -> dict[str, Reading]:
    def inbox() -> tuple[Message, ...]:
        return observe().inbox[-MAIL_ROWS:]

    return {
        "mail/count": Reading(_integers(), lambda: np.array(len(inbox()), np.int64)),
        "mail/texts": Reading(
            _texts(MAIL_ROWS, len(MESSAGE_TEXTS)),
            lambda: _table("", object, MAIL_ROWS, len(MESSAGE_TEXTS), map(_message_texts, inbox())),
        ),
        "mail/numbers": Reading(
            _integers(MAIL_ROWS, len(MESSAGE_NUMBERS)),
            lambda: _table(0, np.int64, MAIL_ROWS, len(MESSAGE_NUMBERS), map(_message_numbers, inbox())),
        ),
        "mail/has_position": Reading(
            specs.Array((MAIL_ROWS,), np.bool_),
            lambda: _table(False, np.bool_, MAIL_ROWS, 1, ([one.position is not None] for one in inbox()))[:, 0],
        ),
        "mail/positions": Reading(
            _floats(MAIL_ROWS, 3),
            lambda: _table(0.0, np.float64, MAIL_ROWS, 3, (one.position or (0.0, 0.0, 0.0) for one in inbox())),
        ),
        "receipt/texts": Reading(_texts(len(RECEIPT_TEXTS)), lambda: _receipt_texts(observe().receipt)),
        "receipt/numbers": Reading(_integers(len(RECEIPT_NUMBERS)), lambda: _receipt_numbers(observe().receipt)),
    }


def _pictures(observe: Callable[[], Observation], size: tuple[int, int]) -> dict[str, Reading]:
    width, height = size
    return {
        "rgb": Reading(specs.Array((height, width, 3), np.uint8), lambda: observe().rgb, enabled=False),
        "depth": Reading(specs.Array((height, width), np.float32), lambda: observe().depth, enabled=False),
        "segmentation": Reading(specs.Array((height, width), np.int32), lambda: observe().segmentation, enabled=False),
    }


def _floats(*shape: int) -> specs.Array:
    return specs.Array(shape, np.float64)


def _integers(*shape: int) -> specs.Array:
    return specs.Array(shape, np.int64)


def _texts(*shape: int) -> specs.Array:
    return specs.StringArray(shape)


def _text(*texts: str) -> NDArray[Any]:
    return np.array(texts if len(texts) > 1 else texts[0], object)


def _table(blank: Any, dtype: Any, rows: int, columns: int, filled: Iterable[Sequence[Any]]) -> NDArray[Any]:
    """A table whose first rows are filled."""
    table = np.full((rows, columns), blank, dtype)
    for number, row in enumerate(filled):
        table[number] = row
    return table


def _pose(pose: Pose) -> NDArray[np.float64]:
    return np.array((pose.x, pose.y, pose.yaw, pose.pitch, pose.head or 0.0))


def _outcome(outcome: Outcome | None) -> NDArray[Any]:
    return _text("", "", "") if outcome is None else _text(outcome.motion, outcome.reason, outcome.by)


def _is_ok(outcome: Outcome | None) -> bool:
    return outcome is not None and outcome.ok


def _scan(observation: Observation) -> NDArray[np.float64]:
    scan = observation.scan
    tops = np.full_like(scan.ranges, np.inf) if scan.tops is None else scan.tops
    return np.stack((scan.bearings, scan.ranges, tops))


def _detected_texts(one: Detection) -> tuple[str, ...]:
    return (one.id, one.kind, one.family, one.state, one.support, one.held_by, " ".join(one.bearers))


def _detected_numbers(one: Detection) -> tuple[float, ...]:
    return (*one.position, *one.size, one.yaw, one.distance)


def _message_texts(one: Message) -> tuple[str, ...]:
    return (one.sender, one.text, one.object, one.to)


def _message_numbers(one: Message) -> tuple[int, ...]:
    return (one.id, one.tick, int(one.question), -1 if one.answers is None else one.answers)


def _receipt_texts(receipt: Receipt | None) -> NDArray[Any]:
    return _text("", "") if receipt is None else _text(receipt.status, receipt.by)


def _receipt_numbers(receipt: Receipt | None) -> NDArray[np.int64]:
    if receipt is None:
        return np.array((-1, -1, -1))
    return np.array((receipt.message, receipt.tick, -1 if receipt.yes is None else int(receipt.yes)))
