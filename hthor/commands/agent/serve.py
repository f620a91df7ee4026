"""`hthor agent serve`."""

import os
import signal
import sys
from typing import Annotated

import typer

from hthor.commands.options import AgentArgs, Readable


def serve(
    agent: Annotated[
        str,
        typer.Argument(metavar="AGENT", help="A Python agent: my_agent.py, my_agent.py:Class, package.module:Class."),
    ],
    agent_args: AgentArgs = None,
    readable: Readable = None,
    port: Annotated[int, typer.Option(min=0, max=65535, help="The port to listen on; 0 picks a free one.")] = 8765,
    host: Annotated[str, typer.Option(help="The address to listen on; 0.0.0.0 accepts other machines.")] = "127.0.0.1",
) -> None:
    """Serve an agent to evaluations on other machines ('hthor eval --agent ws://HOST:PORT') until interrupted.

    It runs in this process with full access to this machine: nothing isolates it.
    """
    from hthor.errors import HthorError
    from hthor.guest.agent import inputs
    from hthor.guest.client import websocket_server

    try:
        server = websocket_server.serve(agent, host, port, inputs.parse_inputs(agent_args or (), readable or ()))
    except OSError as error:
        words = os.strerror(error.errno) if error.errno else str(error)
        raise HthorError(f"cannot listen at {host}:{port}: {words}. Give another --port, or 0 for any.") from None
    sys.stdout.write(f"{websocket_server.address(server)}\n")
    sys.stdout.flush()
    sys.stderr.write(f"serving {agent}; stop with Ctrl-C\n")
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # like Ctrl-C, for scripts that stop it
    with server:
        server.serve_forever()
