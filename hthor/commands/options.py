"""Arguments and options that several commands share."""

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

Run = Annotated[Path, typer.Argument(metavar="RUN", help="A run's folder, such as runs/demo/frontier.")]
Json = Annotated[bool, typer.Option("--json", help="Write JSON to standard output; words go to standard error.")]

Camera = Annotated[
    str,
    typer.Option(
        help="The robot's camera: own (as its body says), square, thor, habitat or realsense; docs/robots.md lists "
        "their fields of view and sizes. What the robot detects does not depend on it."
    ),
]
CameraSize = Annotated[
    str,
    typer.Option(
        metavar="WxH",
        help="The size of its pictures in pixels, such as 320x240. Pixels are square, so another shape than the field "
        "of view's shows the middle of it.",
        show_default="the camera's own",
    ),
]
