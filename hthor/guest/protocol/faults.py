"""How a submitted agent's failure is told."""

from __future__ import annotations


class GuestFault(Exception):
    """A submitted agent failed; its process is gone.

    Attributes:
        kind: raised, timeout, died, killed (from outside, as it seems), memory, disk, garbage, wrong_type, oversized
            or not_finite.
        detail: what happened; for "raised" the traceback of the agent's own frames.
        traceback: the same traceback, empty for the other kinds.
        log: the end of what the agent printed.
    """

    def __init__(self, kind: str, detail: str, traceback: str = "", log: str = "") -> None:
        self.kind, self.traceback, self.log = kind, traceback, log
        self.detail = traceback or detail
        super().__init__(f"{kind}: {detail}")
