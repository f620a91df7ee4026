"""Arguments and options that several commands share, and the parameters of a command that takes a record of options."""

import inspect
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any, Literal, TypeVar

import typer
from msgspec import Struct

from hthor.eval.config import option
from hthor.eval.config.option import Field
from hthor.eval.config.options import EvalOptions

_Command = TypeVar("_Command", bound=Callable[..., None])


def takes_options(record: type[Struct]) -> Callable[[_Command], _Command]:
    """Decorator: the command takes every option of a record, before its own, in place of its ``**given``."""

    def decorate(command: _Command) -> _Command:
        own = inspect.signature(command, eval_str=True).parameters.values()
        taken = [_parameter(one) for one in option.fields(record).values()]
        parameters = [*taken, *(one for one in own if one.kind is not inspect.Parameter.VAR_KEYWORD)]
        named = {one.name: one.annotation for one in parameters}
        command.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
        command.__annotations__ = {**named, "return": None}
        return command

    return decorate


def _parameter(one: Field) -> inspect.Parameter:
    kind: Any = one.types[0]
    if one.choices:
        kind = Literal[one.choices]
    if one.repeated:
        kind = list[kind]
    empty = one.repeated or one.default is None
    return inspect.Parameter(
        one.name,
        inspect.Parameter.POSITIONAL_OR_KEYWORD,
        default=None if empty else one.default,
        annotation=Annotated[kind | None if empty else kind, declare(one)],
    )


def declare(one: Field) -> Any:
    """An option of the command line with the help, range and default of a record's field."""
    about, names = one.about, [one.flag]
    if about.short:
        names.append(f"-{about.short}")
    if about.negatable:
        names = [f"{one.flag}/--no-{one.flag[2:]}"]
    whole = int in one.types
    return typer.Option(
        *names,
        help=about.help,
        min=int(about.least) if whole and about.least is not None else about.least,
        max=int(about.most) if whole and about.most is not None else about.most,
        metavar=about.placeholder or None,
        show_default=about.default or (one.default not in (None, "", ()) and not one.repeated),
    )


def _as_in_eval(name: str) -> Any:
    """The option that `hthor eval` has under this name."""
    return declare(option.fields(EvalOptions)[name])


AgentArgs = Annotated[list[str] | None, _as_in_eval("agent_args")]
Readable = Annotated[list[Path] | None, _as_in_eval("readable")]
Camera = Annotated[str, _as_in_eval("camera")]
CameraSize = Annotated[str, _as_in_eval("camera_size")]

Run = Annotated[Path, typer.Argument(metavar="RUN", help="The folder of a run, such as runs/demo/frontier.")]
Trial = Annotated[
    str,
    typer.Argument(
        metavar="TRIAL",
        help="The trial: its key or the start of it, a task id, or a number counted from 0. A trial that was repeated "
        "has several attempts; 12@0 is the first at trial 12.",
    ),
]
AgentFiles = Annotated[
    list[str] | None, typer.Option(help="The file of an agent that is not built in.", show_default=False)
]
RobotFiles = Annotated[
    list[str] | None, typer.Option(help="The file of your own robot, if the run used one.", show_default=False)
]
KindFile = Annotated[str, typer.Option(help="The file of your own task kind, if the run used one.", show_default=False)]
HumansFile = Annotated[str, typer.Option(help="The file of the people, if the run used one.", show_default=False)]
Json = Annotated[bool, typer.Option("--json", help="Write JSON to standard output and messages to standard error.")]
