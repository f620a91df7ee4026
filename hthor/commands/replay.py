"""`hthor replay`: one logged trial as a picture or a film."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NamedTuple

import typer

from hthor.commands.options import AgentArgs, AgentFiles, HumansFile, KindFile, Readable, RobotFiles, Run, Trial
from hthor.console import output
from hthor.errors import HthorError

if TYPE_CHECKING:
    from hthor.eval.records.trial_record import TrialRecord
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
    eyes: Annotated[
        str,
        typer.Option(
            metavar="SEAT",
            help="Show what this seat saw, such as human, human2 or robot: a strip of pictures, or a video with "
            "--video; the session is played again.",
            show_default=False,
        ),
    ] = "",
    nice: Annotated[
        bool,
        typer.Option(
            "--nice",
            help="With --eyes, render with textures and shadows; needs OpenGL, and the pixels depend on it.",
        ),
    ] = False,
    agent: AgentFiles = None,
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
    """Draw one trial from above: paths, messages and their outcomes; or through the eyes of a person or a robot.

    Only --mind and --eyes need the files of your own agents, robots, task kinds and people.
    """
    if mind or eyes:
        from hthor.eval.replay.session_history import RunFiles
        from hthor.guest.agent import inputs

        files = RunFiles(agents=tuple(agent or ()), robots=tuple(robot or ()), kind=kind, humans=humans)
        given = inputs.parse_inputs(agent_args or (), readable or ())
        if mind and (eyes or video):
            raise HthorError("--mind is a figure of its own; leave out --eyes and --video.")
        if mind:
            _replay_mind(run, trial, seat, out, files, given, json)
        else:
            _replay_eyes(run, trial, eyes, out, files, given, _Look(video=video, nice=nice, json=json))
        return
    from hthor.eval.records import find
    from hthor.eval.records.run_folder import RunFolder
    from hthor.report.drawing import render_trial

    record = find.find_trial(RunFolder(run), trial)
    path = out or _default_path(run, record, "", video=video)
    if record.log.voided:
        output.say(f"trial {record.key} is void and does not count: {record.log.voided}")
    render_trial.draw_trial(run, record, path, video=video)
    output.put_files([path], json, key=record.key, task=record.spec.task.id)


class _Look(NamedTuple):
    """How views are written: as a video or as a strip, in which profile, and the answer as JSON."""

    video: bool
    nice: bool
    json: bool


def _replay_eyes(
    run: Path, trial: str, seat: str, out: Path | None, files: RunFiles, given: AgentInputs, look: _Look
) -> None:
    """Play a session again up to one trial, and draw what one seat saw."""
    from hthor.eval.records import find
    from hthor.eval.records.run_folder import RunFolder
    from hthor.report.drawing import figure_file, render_trial
    from hthor.report.first_person import film, seat_views, strip

    record = find.find_trial(RunFolder(run), trial)
    seat_views.check_seat(record, seat)
    path = out or _default_path(run, record, f"-eyes-{seat}", video=look.video)
    render_trial.check_file_name(path, video=look.video)
    moments = strip.strip_moments(record, render_trial.load_house(run, record), seat)
    ticks = film.film_ticks(record) if look.video else [moment.tick for moment in moments]
    views = seat_views.see_trial(run, record, seat, ticks, files, profile="nice" if look.nice else "fast", given=given)
    if look.video:
        film.write_film(path, views)
    else:
        figure_file.write_figure(strip.strip_figure(views, moments), path)
    output.put_files([path], look.json, key=record.key, task=record.spec.task.id, seat=seat)


def _default_path(run: Path, record: TrialRecord, end: str, *, video: bool) -> Path:
    """Where a drawing of a trial is written unless the user names a file."""
    suffix = "webm" if video else "png"
    return run / "replays" / f"{record.spec.task.id.replace('/', '-')}-{record.key}{end}.{suffix}"


def _replay_mind(
    run: Path, trial: str, seat: str, out: Path | None, files: RunFiles, given: AgentInputs, json: bool
) -> None:
    """Play a session again up to one trial, and draw or print the trace of the human model."""
    from hthor.eval.records import find
    from hthor.eval.records.run_folder import RunFolder
    from hthor.eval.replay import human_trace
    from hthor.report.drawing import figure_file, human_trace_figure, render_trial

    record = find.find_trial(RunFolder(run), trial)
    path = out or _default_path(run, record, f"-mind-{seat}" if seat else "-mind", video=False)
    if not json:
        figure_file.check_name(path)
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
    figure_file.write_figure(human_trace_figure.figure(record, house, stream), path)
    sys.stdout.write(f"{path}\n")
