"""The seats that take part in a trial; one whose agent fails leaves it."""

import traceback
from collections.abc import Sequence

from msgspec import Struct

from hthor.episode.recording.episode_log import Fault
from hthor.types import Action, Observation, merge_actions
from hthor.types.events import AgentFault


class ParticipantsState(Struct, frozen=True, kw_only=True):
    """A copy of what a `Participants` knows."""

    active: tuple[str, ...]
    failed: dict[str, Fault]
    actions: dict[str, tuple[Action, Observation | None]]


class Participants:
    """The seats that still take part.

    Attributes:
        active: these seats, in order. failed: the faults of those that leave at the next tick.
        actions: what seats do in the next tick, with the observation on which they decided.
    """

    def __init__(self, seats: Sequence[str]) -> None:
        self.active = tuple(seats)
        self.failed: dict[str, Fault] = {}
        self.actions: dict[str, tuple[Action, Observation | None]] = {}

    def submit(self, seat: str, action: Action, observation: Observation | None) -> None:
        """Take a seat's action for the next tick; words and signals of one that was taken before are kept."""
        if seat in self.actions:
            action = merge_actions(self.actions[seat][0], action)
        self.actions[seat] = (action, observation)

    def retire(self, tick: int, seat: str, error: Exception) -> None:
        """Note that a seat's agent has failed; only its first fault counts."""
        kind = str(getattr(error, "kind", type(error).__name__))
        detail = str(getattr(error, "detail", "")) or "".join(traceback.format_exception(error, limit=-4))
        self.failed.setdefault(seat, Fault(seat=seat, kind=kind, tick=tick, detail=detail))

    def dismiss_failed(self, tick: int) -> tuple[tuple[Fault, ...], tuple[AgentFault, ...]]:
        """Let those that have failed leave; their faults and events."""
        faults = tuple(self.failed[seat] for seat in self.active if seat in self.failed)
        self.active = tuple(seat for seat in self.active if seat not in self.failed)
        self.failed = {}
        return faults, tuple(AgentFault(tick=tick, seat=fault.seat, fault=fault.kind) for fault in faults)

    def save_state(self) -> ParticipantsState:
        """A copy of what is known."""
        return ParticipantsState(active=self.active, failed=dict(self.failed), actions=dict(self.actions))

    def load_state(self, state: ParticipantsState) -> None:
        """Continue from a copy."""
        self.active, self.failed, self.actions = state.active, dict(state.failed), dict(state.actions)
