"""Arguments and options that several commands share."""

from pathlib import Path
from typing import Annotated, Literal

import typer

AgentArgs = Annotated[
    list[str] | None,
    typer.Option(
        metavar="KEY=VALUE",
        help="An argument for your own agents, passed to the constructor of the class, or to a program as "
        "--KEY=VALUE. If it names a file, the agent may read it. It is part of the agent's identity. Repeat the "
        "option for several.",
        show_default=False,
    ),
]
Readable = Annotated[
    list[Path] | None,
    typer.Option(
        metavar="PATH",
        help="A file or folder outside the agent's own folder that the agent may read, such as weights. It is part "
        "of the agent's identity. Repeat the option for several.",
        show_default=False,
    ),
]

Run = Annotated[Path, typer.Argument(metavar="RUN", help="The folder of a run, such as runs/demo/frontier.")]
Trial = Annotated[
    str,
    typer.Argument(
        metavar="TRIAL",
        help="The trial: its key or the start of it, a task id, or a number counted from 0. A trial that was repeated "
        "has several attempts; 12@0 is the first at trial 12.",
    ),
]
RobotFiles = Annotated[
    list[str] | None, typer.Option(help="The file of your own robot, if the run used one.", show_default=False)
]
KindFile = Annotated[str, typer.Option(help="The file of your own task kind, if the run used one.", show_default=False)]
HumansFile = Annotated[str, typer.Option(help="The file of the people, if the run used one.", show_default=False)]
Json = Annotated[bool, typer.Option("--json", help="Write JSON to standard output and messages to standard error.")]

Camera = Annotated[
    str,
    typer.Option(
        help="The robot's camera: own (as its body defines it), square, thor, habitat or realsense; docs/robots.md "
        "lists their fields of view and sizes. The camera does not change what the robot detects."
    ),
]
CameraSize = Annotated[
    str,
    typer.Option(
        metavar="WxH",
        help="Size of the camera's images [pixels], such as 320x240. Pixels are square, so an image of another shape "
        "than the field of view is cropped to its middle.",
        show_default="the camera's own",
    ),
]

Design = Annotated[
    Literal["paired", "between"],
    typer.Option(
        help="Who meets which robot. paired: every robot meets the same people, each time as if it were the first. "
        "between: everybody meets one robot; the people are divided at random and evenly among the agents and, unless "
        "--no-control is given, no robot. --participants is then the number of people in all groups."
    ),
]
