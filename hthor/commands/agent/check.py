"""`hthor agent run` and `check`: authors examine an agent of their own."""

from __future__ import annotations

import shlex
from typing import TYPE_CHECKING, Annotated

import typer

from hthor.commands.options import (
    AgentArgs,
    Camera,
    CameraSize,
    HumansFile,
    Json,
    KindFile,
    Readable,
    RobotFiles,
    Run,
    Trial,
)
from hthor.console import output

if TYPE_CHECKING:
    from rich.console import Console

    from hthor.eval.agent_check.checks import AgentCheckReport
    from hthor.eval.replay.session_history import Rerun
    from hthor.eval.runner.fault_report import Failure

_FAULTS_EXIT, _BROKEN_EXIT = 3, 4
_LOOKS = 5
Isolation = Annotated[
    str, typer.Option(help="Isolation of the agent: L1, L2, L3, or auto, the strongest that this machine supports.")
]


def run(
    run: Run,
    trial: Trial,
    agent: Annotated[
        list[str] | None,
        typer.Option(
            help="The file of an agent that is not built in; it may have changed since the run.", show_default=False
        ),
    ] = None,
    agent_args: AgentArgs = None,
    readable: Readable = None,
    robot: RobotFiles = None,
    kind: KindFile = "",
    humans: HumansFile = "",
    isolation: Isolation = "auto",
    json: Json = False,
) -> None:
    """Play one trial of a run again with the current version of your agent, and show what happened.

    The trials before it in the session are played too, as they shape what people do. Exit code 3 when the agent fails.
    """
    from hthor.eval.records import find
    from hthor.eval.records.run_folder import RunFolder
    from hthor.eval.replay import session_history
    from hthor.guest.agent import inputs

    folder = RunFolder(run)
    wanted = find.find_trial(folder, trial)
    files = session_history.RunFiles(agents=tuple(agent or ()), robots=tuple(robot or ()), kind=kind, humans=humans)
    done = session_history.rerun_trial(
        folder, wanted, files, isolation, inputs.parse_inputs(agent_args or (), readable or ())
    )
    if json:
        output.put_json(done)
    else:
        _tell(output.console(), done)
    if done.record.faults:
        raise typer.Exit(_FAULTS_EXIT)


def check(
    agent: Annotated[
        str,
        typer.Argument(
            metavar="AGENT",
            help="A Python file or module, my_agent.py, my_agent.py:MyClass, package.module:MyClass; a program, "
            "'cmd:node my_agent.js'; or a served agent, ws://host:port.",
        ),
    ],
    agent_args: AgentArgs = None,
    readable: Readable = None,
    robot: Annotated[
        str,
        typer.Option(help="The robot body to try it with.", show_default="the first that the agent declares, or scout"),
    ] = "",
    camera: Camera = "own",
    camera_size: CameraSize = "",
    isolation: Isolation = "auto",
    json: Json = False,
) -> None:
    """Check in a few short trials that your agent keeps the contract: it loads, acts, is reproducible, keeps no state.

    Exit code 4 when something is broken; warnings cost nothing.
    """
    from hthor.eval.agent_check import checks
    from hthor.guest.agent import inputs
    from hthor.types import cameras

    more = inputs.parse_inputs(agent_args or (), readable or ())
    seen = cameras.canonical_name(camera, camera_size)
    report = checks.check_agent(agent, robot=robot, camera=seen, isolation=isolation, given=more)
    if json:
        output.put_json(report)
    else:
        _show_check(report)
    if not report.sound:
        raise typer.Exit(_BROKEN_EXIT)


def _show_check(report: AgentCheckReport) -> None:
    rows: list[tuple[str, str, str]] = []
    for one in report.findings:
        rows.append((one.check, one.status, one.told))
        if one.advice:
            rows.append(("", "", f"-> {one.advice}"))
    output.put_table(("check", "", "found"), rows)
    broken = sum(one.status == "broken" for one in report.findings)
    if broken:
        output.put_line(f"{report.agent}: {broken} broken")
    else:
        words = ["hthor", "eval", "--agent", report.agent, "--humans", "proxy"]
        output.put_line(f"{report.agent}: sound    next:  {shlex.join(words)}")


def _tell(paper: Console, done: Rerun) -> None:
    """Print what happened in the trial, what failed, and whether it equals the log."""
    from hthor import rules

    spec, ended = done.record.spec, done.record.ticks * rules.TICK_S
    how = "the goal was met" if done.record.met else "the time was up"
    lines = [
        f"{spec.task.id}, trial {spec.index + 1} of session {spec.session}: {spec.task.instruction}",
        f"after {ended:.1f} s {how}; {len(done.record.faults) or 'no'} fault{'s' * (len(done.record.faults) != 1)}",
    ]
    for failure in done.left.failures if done.left else ():
        lines += ["", *failure_lines(failure)]
    if done.changed:
        lines += ["", "the agent's files have changed since the run, so this may differ from what was logged."]
    else:
        lines += ["", "this is what was logged." if done.same else "this differs from what was logged."]
    for line in lines:
        output.say(line, paper)


def failure_lines(failure: Failure) -> list[str]:
    """Lines that describe a failure to the agent's author: when, what, the last observations and the last output."""
    when = f"after {failure.time_s:.1f} s (tick {failure.tick})"
    lines = [f"{failure.seat} ({failure.agent}) failed {when}: {failure.kind}", *_indented(failure.detail)]
    if failure.looks:
        lines.append("what it did last:")
    for look in failure.looks[-_LOOKS:]:
        pose = look.observation["pose"]
        where = f"tick {look.tick:4d} at ({pose['x']:.2f}, {pose['y']:.2f})"
        said = f", {look.action.say}" if look.action is not None and look.action.say else ""
        done = "failed" if look.action is None else f"{look.action.motion}{said}"
        lines.append(f"    {where}: {done}")
    if failure.output.strip():
        lines += ["what it printed last:", *_indented("\n".join(failure.output.splitlines()[-10:]))]
    return lines


def _indented(text: str) -> list[str]:
    return [f"    {line}" for line in text.strip().splitlines()]
