"""Events of a trial as sentences, for the experimenter who follows it."""

from __future__ import annotations

from hthor.types.events import (
    Accepted,
    Adapted,
    AdoptionJudged,
    AgentFault,
    Answered,
    Blocked,
    Closed,
    Covered,
    Declined,
    Displayed,
    Dropped,
    Event,
    Held,
    InWay,
    Lifted,
    Lowered,
    Opened,
    Paused,
    PhaseBegan,
    Picked,
    Placed,
    Predicted,
    Progress,
    Refused,
    Released,
    Resumed,
    SaidReady,
    Sent,
    Shown,
    Success,
    Thought,
    Timeout,
    Voided,
)

TOO_MANY = (Thought, Progress)
"""Events that nobody could read one by one."""


def sentence(event: Event) -> str:
    """What happened, in words that begin with the seat, or with the trial for what concerns all of it.

    Messages are called by their numbers in the log; things by their ids, in which bars and underscores become spaces.
    """
    seat = event.seat
    match event:
        case Sent():
            kind = "asked" if event.question else "answered" if event.answers is not None else "said"
            to = f" {event.to}" if event.to and kind == "asked" else f" to {event.to}" if event.to else ""
            return f"{seat} {kind}{to} (message {event.message}): “{event.text}”"
        case Shown():
            return f"{seat} saw message {event.message} of {event.sender}"
        case Accepted():
            return f"{seat} confirmed message {event.message} of {event.sender}"
        case Declined():
            return f"{seat} declined message {event.message} of {event.sender}"
        case Covered():
            return f"{seat} replaced message {event.message} by message {event.by}"
        case Answered():
            words = {True: " with yes", False: " with no", None: ""}[event.yes]
            return f"{seat} answered message {event.message} of {event.sender}{words}"
        case Displayed():
            what = {"panel": "message", "map": "map"}[event.what]
            return f"{seat} {'showed' if event.on else 'hid'} the {what}"
        case Predicted():
            return f"{seat} predicted what {event.person} believes and does next"
        case Adapted():
            return f"{seat} adapted its policy"
        case AgentFault():
            return f"{seat} failed ({event.fault.replace('_', ' ')}) and takes no further part"
        case PhaseBegan():
            return f"the part “{event.name.replace('_', ' ')}” began" if event.name else "the task itself began"
        case SaidReady():
            return f"{seat} is ready for the next part"
        case Paused():
            return f"the trial was paused: {event.reason}" if event.reason else "the trial was paused"
        case Resumed():
            return "the trial went on"
        case Voided():
            return f"the trial was voided: {event.reason}"
        case Success():
            return "the goal was met"
        case Timeout():
            return "the time ran out"
        case AdoptionJudged():
            judged = {True: "counts as adopted", False: "counts as not adopted", None: "is excluded"}[event.adopted]
            return f"the adoption of {seat} {judged}: {event.reason}"
        case Refused():
            what = f" {event.motion.replace('_', ' ')}" if event.motion else " do that"
            return f"{seat} could not{what}: {event.reason}"
        case _:
            return f"{seat} {_of_bodies(event)}"


def _of_bodies(event: Event) -> str:
    match event:
        case Picked():
            return f"picked up {_name(event.object)}"
        case Placed():
            return f"put {_name(event.object)} on or in {_name(event.on)}"
        case Dropped():
            return f"let go of {_name(event.object)}"
        case Opened():
            return f"opened {_name(event.thing)}"
        case Closed():
            return f"closed {_name(event.thing)}"
        case Held():
            return f"took hold of {_name(event.object)}"
        case Lifted():
            return f"lifted {_name(event.object)} with {_others(event.seat, event.bearers)}"
        case Lowered():
            return f"put down {_name(event.object)}, carried with {_others(event.seat, event.bearers)}"
        case Released():
            return f"let go of the handle of {_name(event.object)}"
        case Blocked():
            return f"stopped at {_name(event.by)}"
        case InWay():
            return f"had {event.by} in the way"
        case _:
            return event.kind.replace("_", " ")


def _name(identity: str) -> str:
    return identity.replace("|", " ").replace("_", " ")


def _others(seat: str, bearers: tuple[str, ...]) -> str:
    return ", ".join(one for one in bearers if one != seat) or "nobody else"
