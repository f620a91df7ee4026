"""The constants of the benchmark; (P) marks those of the HumanTHOR paper (arXiv 2406.06498), the rest are our choice.

Changing any of them changes `sha256`, which is part of every trial's key.
"""

import math

from hthor import jsonio

SIMULATION = 5
"""Version of the world: increased when the same motions would have other outcomes than before."""
TICK_S = 0.1
"""Length of a tick [s]. Time is counted in ticks, and in seconds only where people read it."""
TIME_LIMIT_S = 90.0
"""Time limit of a task [s] (P)."""
MOVE_MAX_M = 0.5
"""Longest move of one action [m] (P)."""
PITCH_LIMIT_RAD = math.radians(30.0)
"""Largest pitch of a robot's camera, up or down [rad] (P)."""
DETECTOR_RANGE_M = 1.5
"""Range of the ideal detector [m] (P)."""
FIND_RANGE_M = 1.5
"""A search succeeds when the person has the target in view within this distance [m]; AI2-THOR's visibility distance."""
SESSION_TASKS = 10
"""How many tasks a participant does (P)."""
TRUST_MIN, TRUST_MAX = 1, 7
"""The trust scale (P)."""
TEXT_MAX = 280
"""How many characters of a message are kept: what a panel in a headset can show at once."""
GRID_M = 0.05
"""Cell size of the free-space grid [m]."""
LOG_EVERY_TICKS = 2
"""Poses are logged every so many ticks, at 5 Hz."""

HANDLE_STRENGTH = 4.0
"""How many times more a body lifts by a handle close to it than with an outstretched arm."""
HANDLE_PACE = 0.7
"""Bodies that carry something together go at this share of the pace of the slowest body."""

PACE_M_S = 1.0
"""A person's speed at full stick [m/s]. The least time of a task assumes it, so that nobody can be faster."""
HANDLING_S = 0.5
"""Least time of one pick, place or open [s]."""
T_STAR_BASE_S = 14.0
"""T* [s] of the paper's task kinds is this plus `T_STAR_SLOWNESS` times the least time; docs/metrics.md says why."""
T_STAR_SLOWNESS = 2.5
"""How much slower than full stick a good time is: 0.40 m/s."""


def as_dict() -> dict[str, float | int]:
    """Every constant by name, in order of definition."""
    return {name: value for name, value in globals().items() if name.isupper() and isinstance(value, (int, float))}


def sha256() -> str:
    """Hash of all constants."""
    return jsonio.sha256(as_dict())
