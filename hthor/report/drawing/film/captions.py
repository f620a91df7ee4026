"""What is written below a video's picture: the time, the progress, the end, faults, and what is said."""

from hthor import rules
from hthor.episode import EpisodeLog
from hthor.report.drawing import trial_trace
from hthor.types import is_person
from hthor.types.events import Accepted, Answered, Declined, PhaseBegan, Progress, Sent

MESSAGE_S, ANSWER_S = 5.0, 3.0
"""How long a message and an answer are shown [s]."""

Caption = tuple[str, str]
"""Words and their colour."""


def status(log: EpisodeLog, tick: int) -> list[Caption]:
    """The time, the share of the goal that is met if it has parts, the end, recent answers, and faults."""
    said = [(_clock(log, tick), trial_trace.INK)]
    if log.progress is not None:
        steps = [event.value for event in log.events if isinstance(event, Progress) and event.tick <= tick]
        said.append((f"{100.0 * (steps or [0.0])[-1]:.0f} %", trial_trace.TARGET))
    if log.ticks <= tick:
        said.append((trial_trace.end_word(log), trial_trace.TARGET if log.met else trial_trace.FAILED))
    for event in log.events:
        if isinstance(event, (Accepted, Declined, Answered)) and _recent(event.tick, tick, ANSWER_S):
            name = trial_trace.seat_name(event.seat, log.paths)
            said.append((f"{name}: {event.kind}", trial_trace.seat_colour(event.seat)))
    for fault in log.faults:
        if fault.tick <= tick:
            said.append((f"{fault.seat} failed at {fault.tick * rules.TICK_S:.1f} s: {fault.kind}", trial_trace.FAILED))
    return said


def _clock(log: EpisodeLog, tick: int) -> str:
    """The time since the present phase began, with its name; in the task itself the time alone."""
    begun = [event for event in log.events if isinstance(event, PhaseBegan) and event.tick <= tick]
    name, first = (begun[-1].name, begun[-1].tick) if begun else ("", 0)
    return f"{f'{name}: ' if name else ''}{(tick - first) * rules.TICK_S:5.1f} s"


def newest_message(log: EpisodeLog, tick: int, seat: str = "") -> Sent | None:
    """The newest message of the last `MESSAGE_S` seconds, if there is one.

    Args:
        seat: only messages that this seat sent or that were for it; by default all. A message for everybody is for
            people if a robot sent it, and for everybody if a person did.
    """
    recent = [sent for sent in trial_trace.messages(log) if _recent(sent.tick, tick, MESSAGE_S)]
    mine = [sent for sent in recent if not seat or seat in (sent.seat, sent.to) or _is_for_all(sent, seat)]
    return mine[-1] if mine else None


def message_words(message: Sent) -> str:
    """A message as words below a picture."""
    return f"{message.seat}: “{message.text}”"


def _is_for_all(message: Sent, seat: str) -> bool:
    return not message.to and (is_person(seat) or is_person(message.seat))


def _recent(then: int, now: int, seconds: float) -> bool:
    return 0 <= now - then <= seconds / rules.TICK_S
