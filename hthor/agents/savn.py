"""The robot of the paper that learns: SAVN, whose network adapts to the house during the trial.

Self-adaptive visual navigation (Wortsman et al., CVPR 2019). Needs the extra ``torch``.
"""

from __future__ import annotations

import importlib.util
import math
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from hthor import seeds
from hthor.agents.skills.conversation.answers import kind_of
from hthor.agents.skills.conversation.conversation import Conversation
from hthor.agents.skills.message_timing import AGAIN_S, ASIDE_M, kind_title
from hthor.errors import AgentError, MissingExtra
from hthor.types import Action, Adapt, Briefing, Motion, Observation, Ready, Send, Signal, Vec3, Wait

if TYPE_CHECKING:
    from hthor.agents.skills.network_search import NetworkSearch

if importlib.util.find_spec("torch") is None:  # said at once, not in each trial
    raise MissingExtra("SAVN", "torch")

CHECKPOINTS = Path(__file__).with_name("checkpoints")
SAME_M = 1.0
"""[m] Two places that are nearer to each other than this are the same, for one message."""


class Wanted(NamedTuple):
    """Something to find: its kind, and for messages the id of the object, or the kind of a destination."""

    kind: str
    name: str


class Agent:
    """Searches with a network that sees a class and a range in each of 7 x 7 cells of its picture, and has no map.

    "Here it is" becomes a message with the place where it believes the thing to be. If that is declined, or nobody
    answers for ten seconds, it goes on, and does not tell of this place again. If it is accepted, it goes on to what
    comes next: the object, then its destination, for one job after another. In the end it waits out of the way.

    Args:
        checkpoint: the folder of a training; the one that ships with hthor if empty.
        detector: "noisy", as in training, or "ideal".
    """

    privileges = ("ideal_detector", "pixel_labels")
    robots = ("scout",)
    shipped = "savn"
    ingredients: tuple[str, ...] = ("checkpoints/savn/config.json", "checkpoints/savn/model.safetensors")
    adapts = True
    """Whether its network adapts during the trial."""

    def __init__(self, checkpoint: str = "", detector: str = "noisy") -> None:
        if detector not in ("noisy", "ideal"):
            raise AgentError(f"detector is noisy or ideal, got {detector!r}")
        self._folder = Path(checkpoint) if checkpoint else CHECKPOINTS / self.shipped
        self._noisy = detector == "noisy"

    def begin(self, briefing: Briefing) -> None:
        """Load the network, and begin with the first thing to find."""
        from hthor.agents.skills import savn_checkpoint
        from hthor.agents.skills.explorer import Explorer
        from hthor.agents.skills.network_search import NetworkSearch
        from hthor.navigation.path_follower import Courtesy

        self._briefing = briefing
        self._conversation = Conversation(briefing, self._unfinished)
        self._map = Explorer(briefing.body)  # only to get out of people's way
        self._courtesy = Courtesy(briefing.body, self._map.fits)
        self._search: NetworkSearch = NetworkSearch(
            savn_checkpoint.load(self._folder),
            briefing,
            adapts=self.adapts,
            noisy=self._noisy,
            seed=seeds.derive(0, "savn", briefing.seat, briefing.instruction),
        )
        self._wanted = _wanted(briefing)
        self._told: list[Vec3] = []
        self._asked: int | None = None  # the tick of a message that has no answer yet
        self._has_left = False
        self._next()

    def act(self, observation: Observation) -> Action:
        """Answer people's questions, and go on with the search."""
        if observation.phase:
            return Action(motion=Wait(seconds=1.0), signals=(Ready(),))
        heard = self._conversation.hear(observation)
        return self._conversation.speak(heard, self._act(heard))

    def _unfinished(self) -> list[str]:
        return [one.name for one in self._wanted]

    def _act(self, observation: Observation) -> Action:
        self._map.see(observation)
        self._hear(observation)
        if not observation.idle:
            return Action()
        aside = self._courtesy.motion(observation, observation.tick * self._briefing.tick_s)
        if aside is not None:
            return Action(motion=aside)
        if not self._wanted:
            return Action(motion=self._out_of_the_way(observation))
        if self._asked is not None:
            return Action(motion=Wait(seconds=0.5))
        return self._go_on(observation)

    def _hear(self, observation: Observation) -> None:
        """What became of the last message."""
        if self._asked is None:
            return
        receipt, asked = observation.receipt, self._asked
        status = receipt.status if receipt is not None and receipt.tick > asked else ""
        if status == "accepted":
            self._wanted = self._wanted[1:]
            self._next()
        late = (observation.tick - asked) * self._briefing.tick_s > AGAIN_S
        if late or status in ("accepted", "declined", "covered"):
            self._asked = None

    def _next(self) -> None:
        """Begin to search for what is wanted first; what the network does not know is left to the people."""
        self._told = []
        while self._wanted and not self._search.begin(self._wanted[0].kind):
            self._wanted = self._wanted[1:]

    def _go_on(self, observation: Observation) -> Action:
        """One action of the network."""
        from hthor.agents.skills.network_search import align

        turn = align(observation.pose)
        if turn is not None:
            return Action(motion=turn)
        motion, position, divergence = self._search.decide(observation)
        signals: tuple[Signal, ...] = () if divergence is None else (Adapt(divergence=divergence),)
        if motion is not None:
            return Action(motion=motion, signals=signals)
        if any(math.dist(place, position) < SAME_M for place in self._told):
            return Action(signals=signals)
        self._told.append(position)
        self._asked = observation.tick
        one = self._wanted[0]
        said = Send(text=f"I found {kind_title(one.kind)} in front of me.", object=one.name, position=position)
        return Action(motion=Wait(seconds=0.5), say=said, signals=signals)

    def _out_of_the_way(self, observation: Observation) -> Motion:
        """Go, once, to a spot nearby where it blocks nobody."""
        pose = observation.pose
        if not self._has_left:
            self._has_left = True
            self._map.retreat(pose, (pose.x, pose.y), ASIDE_M)
        return self._map.follower.next(pose) or Wait(seconds=1.0)


def _wanted(briefing: Briefing) -> tuple[Wanted, ...]:
    """What there is to find, in order: of each job the object, then the kind of thing that it is brought to."""
    found: list[Wanted] = []
    for job in briefing.todo:
        if job.relation != "go":
            found.append(Wanted(kind_of(job.target), job.target))
        found += [Wanted(kind_of(place), place) for place in job.destinations[:1]]
    return tuple(found)
