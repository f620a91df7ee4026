"""Corrections of trials in words."""

from hthor.log_corrections import AnyCorrection, VoidTrial, Withdraw
from hthor.types import HUMAN

_JUDGED = {True: "adopted", False: "not adopted", None: "left out of adoption"}


def correction_words(line: AnyCorrection, *, in_effect: bool = True) -> str:
    """What a correction says about its trial; not ``in_effect`` if it was withdrawn, or replaced by a later one."""
    if isinstance(line, Withdraw):
        return f"withdraws {line.withdraws}"
    if isinstance(line, VoidTrial):
        words = "void, to be repeated" if line.again else "void"
    else:
        words = _JUDGED[line.adopted] + ("" if line.seat == HUMAN else f" ({line.seat})")
    return words if in_effect else f"{words}, not in effect"


def corrections_note(name: str, count: int) -> str:
    """How many corrections of a run's trials are in effect."""
    return f"{name}: {count} correction{' is' if count == 1 else 's are'} in effect; 'hthor correct' lists them"
