"""Messages, pipes and shared memory between host and guest. Begin with `wire`."""

from typing import Any

from hthor.errors import MissingExtra


def load_websockets() -> Any:
    """The optional library that speaks WebSocket, for agents served elsewhere.

    Raises:
        MissingExtra: when it is not installed.
    """
    try:
        import websockets.sync.client
        import websockets.sync.server
    except ImportError:
        raise MissingExtra("an agent that is served", "served") from None
    return websockets
