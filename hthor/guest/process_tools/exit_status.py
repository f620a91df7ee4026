"""How a process ended, as a fault's kind and description."""

import signal

from hthor.errors import KILLED
from hthor.guest.confinement.calls import FROM_OUTSIDE

_SHELLS = 128


def describe_exit(code: int) -> tuple[str, str]:
    """A fault's kind and description for an exit code as `subprocess` reports it.

    Some signals are sent only by a person or by a machine that runs out of memory or shuts down. What they end is
    "killed" and may be tried again. From L2 on an agent cannot send itself such a signal.
    """
    if code >= 0:
        return "died", f"exited with status {code}"
    return KILLED if -code in FROM_OUTSIDE else "died", f"killed by {_name(-code)}"


def unwrap_bwrap(code: int) -> int:
    """The exit code of what bubblewrap ran; bubblewrap reports a signal as shells do."""
    return _SHELLS - code if code > _SHELLS else code


def _name(number: int) -> str:
    try:
        return signal.Signals(number).name
    except ValueError:  # those of real time have none
        return f"signal {number}"
