"""The benchmark's own numbers; (P) marks those of the HumanTHOR paper (arXiv 2406.06498), the rest are our choice.
Changing any of them changes `sha256`, which is part of every trial's key.
"""

from __future__ import annotations

import math

from hthor import jsonio

SIMULATION = 1
"""Version of the world: raised when the same bodies, doing the same, would fare otherwise than before."""
TICK_S = 0.1
"""Seconds a tick. Time is counted in ticks and only ever multiplied out for people to read."""
TIME_LIMIT_S = 90.0
"""Seconds a task (P)."""
MOVE_MAX_M = 0.5
"""Longest move of one action (P)."""
PITCH_LIMIT_RAD = math.radians(30.0)
"""A robot's camera pitch, either way (P)."""
DETECTOR_RANGE_M = 1.5
"""Range of the ideal detector (P)."""
FIND_RANGE_M = 1.5
"""A search succeeds when the person has the target in view within this distance; AI2-THOR's visibility distance."""
SESSION_TASKS = 10
"""Tasks that one participant does (P)."""
TRUST_MIN, TRUST_MAX = 1, 7
"""The trust scale (P)."""
TEXT_MAX = 280
"""Characters of a message that are kept: what a panel in a headset can show at once."""
GRID_M = 0.05
"""Cell of the free-space grid."""
LOG_EVERY_TICKS = 2
"""Poses are logged at 5 Hz."""

HANDLE_STRENGTH = 4.0
"""By a handle close to the body, a body lifts so many times what it lifts with an outstretched arm."""
HANDLE_PACE = 0.7
"""Those who carry something together go at this share of the pace of the slowest."""

PACE_M_S = 1.0
"""A person's full stick speed. The least time of a task is worked out at it, so that nobody can be faster."""
HANDLING_S = 0.5
"""Least time of one pick, place or open."""
T_STAR_BASE_S = 14.0
"""T* of the paper's kinds of task is this and `T_STAR_SLOWNESS` times the least time: see docs/metrics.md for why."""
T_STAR_SLOWNESS = 2.5
"""How much slower than at full stick somebody goes whose time is called good: 0.40 m/s."""


def as_dict() -> dict[str, float | int]:
    """Every constant by name, in order of definition."""
    return {name: value for name, value in globals().items() if name.isupper() and isinstance(value, (int, float))}


def sha256() -> str:
    """Hash of all constants."""
    return jsonio.sha256(as_dict())
