"""Sums up how people used their displays in some logs."""

import statistics
from collections.abc import Sequence

from msgspec import Struct

from hthor.calibration.from_logs.trial_features import TrialFeatures


class DisplayHabits(Struct, frozen=True, kw_only=True):
    """How people used panel and map.

    Attributes:
        answers: messages and questions that were answered.
        panel_s: [s] for how long the panel was shown before an answer, the median; None without an answer.
        follows: confirmed messages whose place somebody set out for.
        map_share: share of that time for which the map was shown; None without such a message.
        shown_again: how often a hidden map was shown again on the way, a message; None without such a message.
    """

    answers: int
    panel_s: float | None
    follows: int
    map_share: float | None
    shown_again: float | None

    @property
    def words(self) -> str:
        """The habits in a sentence or two."""
        said = (
            [] if self.panel_s is None else [f"Before an answer the panel was shown for {self.panel_s:.1f} s (median)."]
        )
        if self.map_share is not None and self.shown_again is not None:
            said.append(
                f"While {self.follows} messages were followed, the map was shown for {100.0 * self.map_share:.0f} % of "
                f"the time, and {self.shown_again:.2f} times again a message."
            )
        return " ".join(said) or "Nobody answered a message."


def display_habits(trials: Sequence[TrialFeatures]) -> DisplayHabits:
    """The habits of all people together."""
    panels = [seconds for one in trials for seconds in one.panels]
    follows = [follow for one in trials for follow in one.follows]
    under_way = sum(follow.seconds for follow in follows)
    return DisplayHabits(
        answers=len(panels),
        panel_s=round(statistics.median(panels), 3) if panels else None,
        follows=len(follows),
        map_share=round(sum(follow.shown for follow in follows) / under_way, 4) if follows else None,
        shown_again=round(sum(follow.shown_again for follow in follows) / len(follows), 4) if follows else None,
    )
