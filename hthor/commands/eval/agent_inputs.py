"""The options by which a user gives an agent more than its own folder; every command that runs agents takes them."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

AgentArgs = Annotated[
    list[str] | None,
    typer.Option(
        metavar="KEY=VALUE",
        help="An argument for agents of your own: of the class's constructor, or --KEY=VALUE behind a command. A file "
        "that it names may be read. Part of the agent's identity. Repeat it for several.",
        show_default=False,
    ),
]
Readable = Annotated[
    list[Path] | None,
    typer.Option(
        metavar="PATH",
        help="A file or folder outside the agent's own that it may read, such as weights; its files are part of the "
        "agent's identity. Repeat it for several.",
        show_default=False,
    ),
]
