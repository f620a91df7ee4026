"""What all parts of a human model share in one trial: traits, body, current observation, random numbers and journal."""

from collections.abc import Callable, Generator, Iterator

from hthor import seeds
from hthor.humans.core.other_people import OtherPeople
from hthor.humans.core.policy import Policy
from hthor.humans.core.thoughts import HumanThought
from hthor.humans.population.parameters import Parameters
from hthor.navigation.path_follower import face
from hthor.types import Briefing, Motion, Observation, Rotate, Vec2, Vec3, Wait
from hthor.types.events import JournalEntry

Behaviour = Generator[Motion, None, bool]
"""An activity, one motion after the other; it returns whether it succeeded."""

GAZE_PITCH = -0.25
"""[rad] Pitch of the head while people walk, a little downwards. Our choice."""
_WAIT_S = 0.3
"""[s] Longest single wait, so that perception goes on. Our choice."""
_AIMED_RAD = 0.05
"""[rad] Direction error at which a turn is complete. Our choice."""
_MAX_TURNS = 100
"""[count] Ticks after which people stop turning towards a point. Our choice."""
_LEVEL_RAD = 0.5
"""[rad] The head returns to `GAZE_PITCH` while more than this angle of a look round is left. Our choice."""
_LEFT_CHANCE = 0.5
"""[chance] Probability that a look round goes to the left. Our choice: no side is preferred."""


class HumanContext:
    """One participant in one trial; ``now`` is the latest observation, replaced before each decision.

    Attributes:
        policy: decides in the participant's place; None for the model's own way of deciding.
        seat: where the participant sits. others: the other people, as far as they were seen.
        task: what the participant knows about the task. began: the tick at which the present phase of it began.
        journal: what a headset's recorder would store of this trial.
        listener: called with beliefs and choices; None when nobody asks for them.
    """

    now: Observation

    def __init__(self, traits: Parameters, root: int, briefing: Briefing, policy: Policy | None = None) -> None:
        self.traits, self.root, self.task, self.body = traits, root, briefing, briefing.body
        self.seat = briefing.seat
        self.tick_s = briefing.tick_s
        self.began = 0
        self.others = OtherPeople(briefing.teammates, briefing.tick_s)
        self.policy = policy
        self.journal: list[JournalEntry] = []
        self.listener: Callable[[HumanThought], None] | None = None

    def record(self, entry: JournalEntry) -> int:
        """Append an entry to the journal; returns its place there, so that its outcome can be added later."""
        self.journal.append(entry)
        return len(self.journal) - 1

    @property
    def here(self) -> Vec2:
        """Where the participant stands [m]."""
        return self.now.pose.x, self.now.pose.y

    @property
    def seconds_left(self) -> float:
        """Time until the trial ends [s]."""
        return max(0.0, self.task.time_limit - self.seconds)

    @property
    def seconds(self) -> float:
        """Time since the present phase of the task began [s]."""
        return (self.now.tick - self.began) * self.tick_s

    def draw(self, *names: seeds.Name) -> float:
        """Uniform random number of this trial, by name."""
        return seeds.draw(self.root, *names)

    def normal(self, *names: seeds.Name) -> float:
        """Standard normal random number of this trial, by name."""
        return seeds.normal(self.root, *names)

    def rest(self, seconds: float) -> Iterator[Motion]:
        """Stand still, in short waits, so that perception goes on."""
        left = round(seconds / self.tick_s)
        piece = round(_WAIT_S / self.tick_s)
        while left > 0:
            ticks = min(piece, left)
            left -= ticks
            yield Wait(seconds=ticks * self.tick_s)

    def turn(self, yaw: float, pitch: float = 0.0) -> Rotate:
        """The part of a turn that fits into one tick; both angles [rad] are completed at the same time."""
        most = min(self.traits.omega, self.body.turn_rate) * self.tick_s
        share = min(1.0, most / max(abs(yaw), abs(pitch), 1e-9))
        return Rotate(yaw=yaw * share, pitch=pitch * share)

    def look_at(self, point: Vec3) -> Iterator[Motion]:
        """Turn until ``point`` [m] is in the middle of the view."""
        for _ in range(_MAX_TURNS):
            error = face(self.now.pose, point, self.body.eye, self.body.pitch_limit)
            if error is None or max(abs(error.yaw), abs(error.pitch)) < _AIMED_RAD:
                return
            yield self.turn(error.yaw, error.pitch)

    def look_round(self, angle: float, name: str, number: int) -> Iterator[Motion]:
        """Turn by ``angle`` [rad] without stopping, to a random side."""
        left = angle if self.draw("side", name, number) < _LEFT_CHANCE else -angle
        while abs(left) > _AIMED_RAD:
            step = self.turn(left, GAZE_PITCH - self.now.pose.pitch if abs(left) > _LEVEL_RAD else 0.0)
            left -= step.yaw
            yield step
