"""The session that measures a person: which tasks it has, and with which robot. A run of it is a run like any other."""

from __future__ import annotations

import msgspec

from hthor.errors import HthorError
from hthor.eval.config.human_populations import LIVE
from hthor.eval.config.options import EvalOptions

SUITE, AGENT = "calibration", "unreliable"
"""Walks along a described way show pace and turns, searches and deliveries the use of messages and hands; the robot's
messages are short and long, true and false."""
_PRESCRIBED = {"agent": "the robot", "robots": "the robot", "suite": "the tasks", "kind": "the tasks"}
_WHOLE = ("house", "difficulty", "limit")


def prescribed(options: EvalOptions) -> EvalOptions:
    """The options of a session that measures people; what it does not prescribe is as in ``options``.

    Raises:
        HthorError: when an option says something else than the session prescribes.
    """
    usual = EvalOptions()
    for name, what in _PRESCRIBED.items():
        if getattr(options, name) != getattr(usual, name):
            raise HthorError(f"--calibrate prescribes {what}: leave out --{name}, or --calibrate.")
    for name in _WHOLE:
        if getattr(options, name) != getattr(usual, name):
            raise HthorError(f"--calibrate has all of its tasks: leave out --{name}, or --calibrate.")
    if options.humans != (LIVE,):
        raise HthorError("--calibrate measures one person at a time: leave out --humans. --participants takes several.")
    return msgspec.structs.replace(options, agent=(AGENT,), suite=SUITE)
