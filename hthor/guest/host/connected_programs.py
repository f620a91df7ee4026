"""Programs that connect to this process: the other direction of `hthor.guest.host.websocket_client`.

Who listens is above this package: a live session has a server (`hthor.live.robot_programs`). It travels in the
`GuestConfig` of its run to every guest, and only inside this process.
"""

from typing import Protocol

from hthor.guest.host.channel import Transport


class ConnectedPrograms(Protocol):
    """Where programs connect."""

    def take(self, agent: str, seconds: float) -> Transport:
        """The connection of the program of an agent ``socket`` or ``socket:NAME``; its first message is ``ready``.

        It stays the program's own between trials, so it may be taken again as long as it lasts. Waits for a program
        that was never there until it comes, and for one that has left until ``seconds`` after that.

        Raises:
            Unreachable: when the program did not come back.
        """
