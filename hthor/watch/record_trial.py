"""Plays a logged trial again and records it."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from hthor import activity, rules
from hthor.eval.config.human_populations import LIVE
from hthor.eval.replay import repeated_trial
from hthor.live.event_sentences import TOO_MANY, sentence
from hthor.live.gltf import house_file
from hthor.live.pictures import to_jpeg
from hthor.report.drawing import trial_trace
from hthor.types import is_person
from hthor.types.events import Blocked, Covered, Displayed, InWay, Refused, Sent, Shown
from hthor.watch import recording
from hthor.watch.recorder import RecordedWorld
from hthor.watch.recording import Letter, Line, Recording, RoomPlan, Seat
from hthor.watch.screens import hands, screens

if TYPE_CHECKING:
    from collections.abc import Iterable

    from hthor.eval.records.scored_trial import ScoredTrial
    from hthor.eval.replay.session_history import RunFiles
    from hthor.guest import AgentInputs
    from hthor.live.gltf.house_file import HouseFile
    from hthor.types import Camera, TrialSpec, Vec2
    from hthor.types.events import Event

_MINOR = (Blocked, InWay, Refused, Covered, Shown, Displayed)
"""Events that are listed, and not marked on the timeline."""
_SAME_TICKS = 50
"""[ticks] A minor event that follows its like within this time is left out. Our choice."""


class RecordedTrial(NamedTuple):
    """A recording, and the house that it took place in."""

    recording: Recording
    house: HouseFile


def record_trial(folder: Path, record: ScoredTrial, files: RunFiles, given: AgentInputs | None = None) -> RecordedTrial:
    """Play a trial of the run in ``folder`` again, and record it.

    Args:
        files: the user's files that the run's folder lacks. given: arguments and files that the agents were given.

    Raises:
        RunError, HthorError: if it cannot be played again, see `hthor.eval.replay.repeated_trial.repeat_trial`.
    """
    world = repeated_trial.repeat_trial(folder, record, files, RecordedWorld, given)
    return finish(folder.resolve().name, record, world)


def finish(run: str, record: ScoredTrial, world: RecordedWorld) -> RecordedTrial:
    """What was recorded of a trial of the ``run`` with this name that has just been played in a world."""
    activity.say(f"computing the light of the house {record.spec.task.house}")
    return RecordedTrial(_recording(run, record, world), house_file.house_file(world.scene, world.house))


def _recording(run: str, record: ScoredTrial, world: RecordedWorld) -> Recording:
    spec, events, house = record.spec, record.events, world.house
    sent = [event for event in events if isinstance(event, Sent)]
    pictures = {number: recording.picture(to_jpeg(one)) for number, one in world.pictures(sent).items()}
    return Recording(
        run=run,
        key=record.key,
        task=spec.task.id,
        instruction=spec.task.instruction,
        outcome=outcome(record),
        ticks=record.ticks,
        tick_s=rules.TICK_S,
        time_limit=spec.task.time_limit,
        height=house.height,
        rooms=tuple(RoomPlan(name=room.name, polygon=room.polygon) for room in house.rooms),
        seats=_seats(spec, world),
        tracks=world.tracks(),
        events=lines(events),
        messages=tuple(
            Letter(
                message=one.message,
                sender=one.seat,
                text=one.text,
                question=one.question,
                object=one.object,
                position=one.position,
                picture=pictures.get(one.message, ""),
            )
            for one in sent
        ),
        screens={human.seat: screens(events, human.seat) for human in spec.humans},
        hands={seat: hands(events, seat) for seat in world.seats},
    )


def lines(events: Iterable[Event]) -> tuple[Line, ...]:
    """Events in sentences; of the minor ones, those that go on saying the same are left out."""
    found, said = [], dict[str, int]()
    for event in events:
        if isinstance(event, TOO_MANY):
            continue
        words, minor = sentence(event), isinstance(event, _MINOR)
        repeated = minor and words in said and event.tick - said[words] < _SAME_TICKS
        said[words] = event.tick
        if not repeated:
            found.append(Line(tick=event.tick, seat=event.seat, kind=event.kind, words=words, minor=minor))
    return tuple(found)


def outcome(record: ScoredTrial) -> tuple[str, ...]:
    """How a trial ended, in phrases: its end, adoption, and the people's trust in the order of their seats."""
    seconds = f"{record.ticks * rules.TICK_S:.1f} s"
    end = f"void: {record.log.voided}" if record.log.voided else f"{'done' if record.met else 'not done'} in {seconds}"
    ratings = [str(rating) for rating in record.ratings.values() if rating is not None]
    rated = [f"trust {' and '.join(ratings)} of {rules.TRUST_MAX}"] if ratings else []
    adopted = record.metrics["adoption"]
    took = [] if adopted is None else ["a suggestion was adopted" if adopted > 0 else "no suggestion was adopted"]
    return (end, *took, *rated)


def _seats(spec: TrialSpec, world: RecordedWorld) -> tuple[Seat, ...]:
    names = {robot.seat: f"{robot.robot}, {robot.agent.name}" for robot in spec.robots}
    names |= {human.seat: human.model for human in spec.humans}
    live = {human.seat for human in spec.humans if human.model == LIVE}
    found = []
    for seat in world.seats:
        body = world.bodies[seat]
        found.append(
            Seat(
                seat=seat,
                name=names[seat],
                person=is_person(seat),
                colour=trial_trace.seat_colour(seat),
                eye=body.eye,
                height=body.height,
                own=world.scene.seats[seat],
                fov=None if seat in live else _fov(world.camera(seat)),
            )
        )
    return tuple(found)


def _fov(camera: Camera) -> Vec2:
    """[rad] The field of view, horizontal and vertical, of a seat's own camera, or of the one that the run gave it."""
    (width, height), matrix = camera.size, camera.matrix
    wide, high = (2.0 * math.atan(side / 2.0 / matrix[k, k]) for k, side in enumerate((width, height)))
    return round(wide, 6), round(high, 6)
