"""A robot's messages about a landmark to the person who has to go there."""

from hthor import rules
from hthor.agents.skills.message_timing import MessageTiming, kind_title
from hthor.types import WALKERS, Briefing, Detection, Observation, Send

_MOST = 2


class LandmarkMessages:
    """Tells the walker where the landmark is, when it is in view and a message is due.

    Attributes:
        seat: who has to go there. landmark: the landmark as detected last, None before.
    """

    def __init__(self, briefing: Briefing) -> None:
        self.briefing, self.seat = briefing, WALKERS[briefing.target]
        self.landmark: Detection | None = None
        self._timing = MessageTiming(briefing, most=_MOST)

    @property
    def walks_itself(self) -> bool:
        """Whether this robot is the walker."""
        return self.seat == self.briefing.seat

    def see(self, observation: Observation) -> None:
        """Note the landmark if it is in view."""
        kind = self.briefing.destination
        seen = [one for one in observation.detections if one.family == "furniture" and one.kind == kind]
        self.landmark = seen[0] if seen else self.landmark

    def is_due(self, observation: Observation) -> bool:
        """Whether the walker is another seat, which should be told now."""
        return not self.walks_itself and self._timing.due(observation.tick, observation.receipt)

    def say(self, observation: Observation) -> Send | None:
        """The message that is due, if the landmark is in view from close by."""
        seen = next((one for one in observation.detections if self.landmark and one.id == self.landmark.id), None)
        if seen is None or seen.distance > rules.DETECTOR_RANGE_M + max(seen.size) or not self.is_due(observation):
            return None
        self._timing.note(observation.tick)
        text = f"I found {kind_title(seen.kind)} in front of me."
        return Send(text=text, object=seen.id, position=seen.position, to=self.seat if self._has_company() else "")

    def unfinished(self) -> list[str]:
        """The landmark, once it is known: what people may ask for."""
        return [self.landmark.id] if self.landmark is not None else []

    def _has_company(self) -> bool:
        """Whether there are other people than the walker."""
        return sum(seat.startswith("human") for seat in self.briefing.teammates) > 1
