"""The practice before a session's first trial: everybody tries each control once, in any order.

It is played as a trial is, in a room of its own (`hthor.live.practice_room`), and its record is thrown away. A robot
sends each person messages to answer. The practice is the same whatever robots a session has, so that the groups of a
study stay comparable.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import msgspec

from hthor.live import wire
from hthor.live.practice_room import FRIDGE, TABLE
from hthor.live.wire import Step
from hthor.types import Action, Briefing, Observation, Pose, Send, Wait
from hthor.types.events import Accepted, Closed, Declined, Displayed, Dropped, Event, Opened, Picked, Placed, Sent

if TYPE_CHECKING:
    from hthor.episode import Episode
    from hthor.live.seat import LiveSeat

WALK_M = 2.0
"""[m] So far one walks to have tried it. Our choice."""
LOOK_RAD = math.pi / 2
"""[rad] So far one turns the head to have tried it. Our choice."""
OVER = "the practice is over"
_LULL_S = 2.0
"""[s] Between two messages of the guide. Our choice."""

STEPS = (
    Step(name="walk", words="walk about", actions=("forward", "left", "back", "right")),
    Step(name="look", words="look round, or with the mouse", actions=("turnLeft", "turnRight")),
    Step(name="pick", words="pick up the apple or the mug", actions=("hand",)),
    Step(name="open", words="open the fridge", actions=("door",)),
    Step(name="place", words="put something in the fridge", actions=("hand",)),
    Step(name="close", words="close the fridge", actions=("door",)),
    Step(name="drop", words="let go of something", actions=("drop",)),
    Step(name="panel", words="hide the message and show it again", actions=("panel",)),
    Step(name="confirm", words="confirm a message", actions=("accept",)),
    Step(name="map", words="hide the map and show it again", actions=("map",)),
    Step(name="decline", words="decline a message", actions=("decline",)),
)
"""What there is to try; the actions are those of web/src/keys.js."""


class Progress:
    """What one person has tried.

    Attributes:
        done: the names of these steps. asked: whether a message waits for their answer.
    """

    def __init__(self) -> None:
        self.done: set[str] = set()
        self.asked = False
        self._last: Pose | None = None
        self._walked = self._turned = self._least = self._most = 0.0
        self._switched: set[tuple[str, bool]] = set()

    @property
    def steps(self) -> tuple[Step, ...]:
        """All steps."""
        return tuple(msgspec.structs.replace(step, done=step.name in self.done) for step in STEPS)

    def move(self, pose: Pose) -> None:
        """Take where the person is now, and where they look."""
        last, self._last = self._last or pose, pose
        self._walked += math.hypot(pose.x - last.x, pose.y - last.y)
        self._turned += math.remainder(pose.gaze - last.gaze, math.tau)
        self._least, self._most = min(self._least, self._turned), max(self._most, self._turned)
        if self._walked >= WALK_M:
            self.done.add("walk")
        if self._most - self._least >= LOOK_RAD:
            self.done.add("look")

    def take(self, event: Event) -> None:
        """Take something that the person did."""
        match event:
            case Picked():
                self.done.add("pick")
            case Opened(thing=thing) if thing == FRIDGE:
                self.done.add("open")
            case Placed(on=thing) if thing == FRIDGE:
                self.done.add("place")
            case Closed(thing=thing) if thing == FRIDGE:
                self.done.add("close")
            case Dropped():
                self.done.add("drop")
            case Displayed(what=what, on=on):
                self._switched.add((what, on))
                if (what, not on) in self._switched:
                    self.done.add(what)
            case Accepted() | Declined():
                self.asked = False
                self.done.add("confirm" if isinstance(event, Accepted) else "decline")


class Practice:
    """One practice of the people in these seats; shows each the steps that are left.

    Attributes:
        guide: the robot's mind. progress: of each person, by seat.
    """

    def __init__(self, seats: Mapping[str, LiveSeat]) -> None:
        self._seats = dict(seats)
        self._shown: dict[str, wire.Steps] = {}
        self.progress = {name: Progress() for name in seats}
        self.guide = Guide(self.progress)

    @property
    def over(self) -> bool:
        """Whether everybody has tried everything, or does not want to."""
        return all(seat.skips or len(self.progress[name].done) == len(STEPS) for name, seat in self._seats.items())

    def show(self) -> None:
        """Show everybody their steps, where they have changed."""
        for name, seat in self._seats.items():
            steps = wire.Steps(steps=self.progress[name].steps, skipped=seat.skips)
            if steps != self._shown.get(name):
                self._shown[name] = steps
                seat.show(steps)

    def watch(self, episode: Episode, events: Sequence[Event]) -> None:
        """See what everybody does; an observer of the episode."""
        for event in events:
            if event.seat in self.progress:
                self.progress[event.seat].take(event)
            elif isinstance(event, Sent) and event.to in self.progress:
                self.progress[event.to].asked = True
        for name, progress in self.progress.items():
            progress.move(episode.world.pose(name))
        self.show()


class Guide:
    """The robot of a practice: it sends each person a message to confirm, and one to decline, each after the last was
    answered. It knows what people have tried, which no robot of a trial does.
    """

    def __init__(self, progress: Mapping[str, Progress]) -> None:
        self._progress = progress

    def begin(self, briefing: Briefing) -> None:
        """Look where the table is, which stays where it is."""
        assert briefing.house is not None
        self._table = next(thing.centre for thing in briefing.house.things if thing.id == TABLE)

    def act(self, observation: Observation) -> Action:
        """Stand still, and write to somebody who has no message to answer."""
        if not observation.idle:
            return Action()
        for seat, progress in self._progress.items():
            left = [step for step in ("confirm", "decline") if step not in progress.done]
            if left and not progress.asked:
                text = f"There is a table. Please {left[0]} this message."
                send = Send(text=text, object=TABLE, position=self._table, to=seat)
                return Action(motion=Wait(seconds=_LULL_S), say=send)
        return Action(motion=Wait(seconds=_LULL_S))
