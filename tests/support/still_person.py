"""A person who stands where they begin, says nothing and answers nothing: for laws of several people."""

from __future__ import annotations

from hthor.types import Action, Briefing, Observation, Wait


class StillPerson:
    """Neither moves nor speaks, so that others can only see them or walk into them."""

    def begin(self, briefing: Briefing) -> None:
        """There is nothing to prepare."""

    def act(self, observation: Observation) -> Action:
        """Wait."""
        return Action(motion=Wait(seconds=1.0))

    def rate(self, met: bool, tick: int) -> int | None:
        """No rating."""
        return None

    def state(self) -> dict[str, int]:
        """Nothing carries over."""
        return {}
