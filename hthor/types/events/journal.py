"""Entries of the journal: what a headset's recorder stores of a person in addition to the log.

The trial's log has what the system sees: poses (x, y and yaw at 5 Hz), messages, picks and places, the rating. The
journal adds the person's inputs, what they saw, and what they chose. The episode records `Stick` and `Head` for every
human model, and `Inputs` and `Acted` of every person who drives; only some human models record the other kinds.
"""

from typing import Literal

from msgspec import UNSET, UnsetType, field

from hthor.types.actions import Motion, Reply, Send, Wait
from hthor.types.events.entry import LogEntry
from hthor.types.house import Vec3
from hthor.types.signals import Signal

ExposureRow = tuple[float, float, float, float, int, int]
"""Glimpses that were alike, see `Exposure.gathered`."""
OptionRow = tuple[float, float, float, float, int, int]
"""One option of a choice, see `Choice.options`."""


class Stick(LogEntry, frozen=True, kw_only=True, tag="stick"):
    """How far the person's stick was pushed, once per trial; the direction is in the path.

    Attributes:
        full: [m/s] the speed at full deflection.
        runs: flat pairs of a tick and the deflection from that tick on, in thousandths of ``full``.
    """

    full: float
    runs: tuple[int, ...]


class Head(LogEntry, frozen=True, kw_only=True, tag="head"):
    """How the person's head was tilted, once per trial.

    Attributes:
        fastest: [rad/s] the fastest that the body can turn.
        pitch: flat pairs of a tick and the pitch from that tick on [mrad], up positive.
    """

    fastest: float
    pitch: tuple[int, ...]


class Inputs(LogEntry, frozen=True, kw_only=True, tag="inputs"):
    """Every set-point of `Drive` that the person's body was given; once per trial, if there was any.

    Attributes:
        runs: flat groups of six: the tick and the step of the tick (0 to `hthor.types.SUBTICKS` - 1) from which on the
            set-point holds; forward and left [0.1 mm/s] in the frame of the head's yaw; the head's yaw, house frame,
            and pitch [0.1 mrad].
    """

    runs: tuple[int, ...]


class Acted(LogEntry, frozen=True, kw_only=True, tag="acted"):
    """An action of a person who drives, other than a mere set-point: hands, buttons and words. Also every action of a
    robot, where the time that it takes to decide counts.

    With `Inputs`, these are everything that the seat did, so that the trial can be repeated from them. The tick is
    the one at whose beginning the action takes effect. Of several for one tick the last motion counts, and all signals.

    Attributes:
        motion: what the body was to do; "wait" if left out.
        say: a message or an answer, null for none.
        signals: what was shown or hidden, and what else was told by buttons.
        early: [steps] how long before that tick it was given, in steps of `hthor.types.SUBTICKS` to a tick.
        seen: the tick of the observation on which it was decided; absent if it named none.
    """

    motion: Motion = Wait()
    say: Send | Reply | None = None
    signals: tuple[Signal, ...] = ()
    early: int = 0
    seen: int | UnsetType = UNSET


class Attempt(LogEntry, frozen=True, kw_only=True, tag="attempt"):
    """The hands tried something; the tick is when they began. One that the trial's end cut off has no outcome.

    Attributes:
        what: "pick", "place", "open", "close" or "drop".
        seconds: [s] how long it took; absent if it was cut off.
        ok: whether it succeeded; absent if it was cut off.
        why: "missed" when the hand closed on nothing, else the world's reason; empty if it succeeded.
        at: [m], house frame, where an object was to be put; only for a "place" that says so.
    """

    what: str
    seconds: float | UnsetType = UNSET
    ok: bool | UnsetType = UNSET
    why: str = ""
    at: Vec3 | None = None


class Exposure(LogEntry, frozen=True, kw_only=True, tag="exposure"):
    """The glimpses of one object until it was noticed, or until the trial ended.

    Attributes:
        object: its id.
        noticed: whether it was noticed at the last glimpse.
        seconds: [s] how long it was in view.
        gathered: rows, each for glimpses that were alike: their seconds together [s], visual angle [rad], eccentricity
            [rad], share in view (0 to 1), how many small things were beside it, and whether the person was searching
            there (0 or 1). The last row is the last glimpse alone.
    """

    object: str
    noticed: bool
    seconds: float
    gathered: tuple[ExposureRow, ...]


class Choice(LogEntry, frozen=True, kw_only=True, tag="choice"):
    """A decision about where to search next.

    Attributes:
        aim: what is searched for: "target", "destination" or "room".
        options: a row for each option, or for a sample if there are many: probability by common knowledge and without
            it (0 to 1), path length [m], exposure so far, whether it must be opened first, and whether it is a doorway
            (0 or 1).
        chosen: the index of the chosen option.
    """

    aim: str
    options: tuple[OptionRow, ...]
    chosen: int


class Offer(LogEntry, frozen=True, kw_only=True, tag="offer"):
    """A message that the person read and decided on; see `hthor.humans.core.policy.Offer`.

    Attributes:
        message: its number in the trial.
        number: counts the messages read in the trial, from 1.
        trust: the proxy's mean trust, 0 to 1; a live person's log does not have it.
        useful: whether following it could still help.
        relevant: whether it was about the task.
        gain: [s] the time that following it was expected to save.
        load: work in hand, 0 to 1.
        again: how often the same offer was refused before.
        words: length of the text in words.
        read_s: [s] from when it was shown to the answer.
        answer: what the person did with it.
    """

    message: int
    number: int
    trust: float | UnsetType = UNSET
    useful: bool
    relevant: bool
    gain: float
    load: float
    again: int
    words: int
    read_s: float
    answer: Literal["accept", "decline", "ignore"]


class Misled(LogEntry, frozen=True, kw_only=True, tag="misled"):
    """The person left the place that an accepted message had named without having found the object there."""


class Asked(LogEntry, frozen=True, kw_only=True, tag="asked"):
    """The person began to ask a question; the event `Sent` follows when it has been said.

    Attributes:
        object: id or kind of what it is about.
        words: its length in words.
        seconds: [s] how long it takes to think of it and to say it.
    """

    object: str
    words: int
    seconds: float


class Replied(LogEntry, frozen=True, kw_only=True, tag="replied"):
    """The person read a question, and began to answer it.

    Attributes:
        message: its number in the trial.
        words: its length in words.
        read_s: [s] from when it was shown until it was read.
        answer: "yes" or "no" on a button, "told" by a message of their own, or "ignore" for none.
        seconds: [s] how long it takes to think of the answer and to press or say it.
    """

    message: int
    words: int
    read_s: float
    answer: Literal["yes", "no", "told", "ignore"]
    seconds: float = 0.0


class Note(LogEntry, frozen=True, kw_only=True, tag="note"):
    """What a user's own human model records in addition, such as how often a language model was asked.

    Attributes:
        topic: what the note is about.
        values: plain values by name.
    """

    topic: str
    values: dict[str, bool | int | float | str] = field(default_factory=dict)
