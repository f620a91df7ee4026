"""`hthor replay`: one logged trial as a picture or a film."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hthor.commands.options import AgentArgs, HumansFile, KindFile, Readable, RobotFiles, Run, Trial
from hthor.console import output

if TYPE_CHECKING:
    from hthor.eval.replay.session_history import RunFiles
    from hthor.guest import AgentInputs


def replay(
    run: Run,
    trial: Trial,
    out: Annotated[
        Path | None, typer.Option(help="The file to write.", show_default="RUN/replays/TASK-KEY.png, or .webm")
    ] = None,
    video: Annotated[bool, typer.Option("--video", help="Write a video instead of an image.")] = False,
    mind: Annotated[
        bool,
        typer.Option(
            "--mind", help="Show what the simulated person believed, saw and chose; the session is played again."
        ),
    ] = False,
    seat: Annotated[
        str,
        typer.Option(
            help="With --mind, in a trial of several people: whose mind, such as human2.",
            show_default="the first person's",
        ),
    ] = "",
    agent: Annotated[
        list[str] | None,
        typer.Option(help="The file of an agent that is not built in.", show_default=False),
    ] = None,
    agent_args: AgentArgs = None,
    readable: Readable = None,
    robot: RobotFiles = None,
    kind: KindFile = "",
    humans: HumansFile = "",
    json: Annotated[
        bool,
        typer.Option(
            "--json", help="Print the names of written files as JSON; with --mind, the trace itself, and no image."
        ),
    ] = False,
) -> None:
    """Draw one trial from above: paths, messages and their outcomes.

    Only --mind needs the files of your own agents, robots, task kinds and people.
    """
    if mind:
        from hthor.eval.replay.session_history import RunFiles
        from hthor.guest.agent import inputs

        files = RunFiles(agents=tuple(agent or ()), robots=tuple(robot or ()), kind=kind, humans=humans)
        given = inputs.parse_inputs(agent_args or (), readable or ())
        _replay_mind(run, trial, seat, out, files, given, json)
        return
    from hthor.eval.records import find
    from hthor.eval.records.run_folder import RunFolder
    from hthor.report.drawing import render_trial

    record = find.find_trial(RunFolder(run), trial)
    path = out or run / "replays" / f"{record.spec.task.id.replace('/', '-')}-{record.key}.{'webm' if video else 'png'}"
    render_trial.draw_trial(run, record, path, video=video)
    output.put_files([path], json, key=record.key, task=record.spec.task.id)


def _replay_mind(
    run: Path, trial: str, seat: str, out: Path | None, files: RunFiles, given: AgentInputs, json: bool
) -> None:
    """Play a session again up to one trial, and draw or print the trace of the human model."""
    from hthor.eval.records import find
    from hthor.eval.records.run_folder import RunFolder
    from hthor.eval.replay import human_trace
    from hthor.report.drawing import human_trace_figure, lettering, render_trial

    record = find.find_trial(RunFolder(run), trial)
    house = render_trial.load_house(run, record)
    stream = human_trace.trace_human(RunFolder(run), record, files, seat=seat, inputs=given)
    if not stream.same:
        output.say(
            "the replayed trial differs from the log, so something here is not reproducible. What follows is the "
            "trace of the replay."
        )
    if json:
        output.put_json(stream)
        return
    end = f"mind-{seat}" if seat else "mind"
    path = out or run / "replays" / f"{record.spec.task.id.replace('/', '-')}-{record.key}-{end}.png"
    path.parent.mkdir(parents=True, exist_ok=True)
    render_trial.check_file_name(path, video=False)
    lettering.save_figure(human_trace_figure.figure(record, house, stream), path)
    sys.stdout.write(f"{path}\n")
