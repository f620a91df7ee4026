"""Single trials that a report shows: the best, the worst, and those in which a robot failed; chooses none."""

from typing import Literal

from msgspec import Struct


class ExampleTrial(Struct, frozen=True, kw_only=True):
    """A trial worth a map. ``gain_s`` is the time saved [s] against the same person without a robot, None without one.

    ``replay`` is the command that draws it whole.
    """

    arm: str
    rank: Literal["best", "worst"]
    key: str
    task: str
    instruction: str
    house: str
    participant: int
    index: int
    met: bool
    time_s: float
    t_star: float
    alone_met: bool | None
    alone_s: float | None
    gain_s: float | None
    replay: str


class FaultGroup(Struct, frozen=True, kw_only=True):
    """One way in which a run's robots failed: in how many ``trials`` out of ``whole``, and the first of them.

    ``detail`` is the traceback or what the robot's mind did, ``output`` what it printed last, empty where nothing was
    kept; ``again`` the command that plays the trial once more, ``replay`` the one that draws it.
    """

    run: str
    seat: str
    agent: str
    kind: str
    trials: int
    whole: int
    key: str
    task: str
    participant: int
    index: int
    after_s: float
    detail: str
    output: str
    again: str
    replay: str
