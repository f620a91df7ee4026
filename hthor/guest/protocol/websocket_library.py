"""The optional library that speaks WebSocket, for agents served elsewhere."""

from typing import Any

from hthor.errors import MissingExtra

EXTRA = "served"


def load_websockets() -> Any:
    """The library that speaks WebSocket.

    Raises:
        MissingExtra: when it is not installed.
    """
    try:
        import websockets.sync.client
        import websockets.sync.server
    except ImportError:
        raise MissingExtra("an agent that is served", EXTRA) from None
    return websockets
