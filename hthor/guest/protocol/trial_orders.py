"""Orders from the host to the supervisor while a trial runs: on which CPU its process runs, or that it ends.

They use the supervisor's own socket. An order that comes after its trial has ended is skipped.
"""

import contextlib
import os

ANYWHERE = 0xFFFF
"""Let the trial's process run on every CPU again. Smaller numbers are CPUs to move it to, except `STOP`."""
STOP = 0xFFFE
"""End the trial's process."""
CLOSED = -1
"""The socket is closed: no order will follow."""
_BYTES = 2


def send_order(handle: int, order: int) -> None:
    """Send an order: `ANYWHERE`, `STOP` or the number of a CPU."""
    with contextlib.suppress(OSError):  # the supervisor has ended, which is noticed elsewhere
        os.write(handle, order.to_bytes(_BYTES, "little"))


def receive_order(handle: int) -> int:
    """The order that `send_order` sent, or `CLOSED`."""
    said = os.read(handle, _BYTES)
    return int.from_bytes(said, "little") if len(said) == _BYTES else CLOSED
