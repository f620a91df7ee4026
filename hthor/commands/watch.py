"""`hthor watch`: one logged trial in three dimensions."""

from __future__ import annotations

import contextlib
from pathlib import Path
from typing import Annotated

import typer

from hthor import activity
from hthor.commands.options import AgentArgs, AgentFiles, HumansFile, Json, KindFile, Readable, RobotFiles, Run, Trial
from hthor.console import output


def watch(
    run: Run,
    trial: Trial,
    out: Annotated[
        Path | None,
        typer.Option(
            help="Write the page into this folder, as index.html, instead of serving it.",
            metavar="FOLDER",
            show_default=False,
        ),
    ] = None,
    port: Annotated[int, typer.Option(min=0, max=65535, help="The port of the page; 0 for any that is free.")] = 0,
    agent: AgentFiles = None,
    agent_args: AgentArgs = None,
    readable: Readable = None,
    robot: RobotFiles = None,
    kind: KindFile = "",
    humans: HumansFile = "",
    json: Json = False,
) -> None:
    """Walk through a trial in 3-D: free camera, everybody's eyes, a timeline, messages; in your browser.

    The session is played again up to the trial, and must equal the log. The page is one file that needs nothing else:
    with --out it can be opened from its folder, sent by mail, or put on any web server.
    """
    from hthor.errors import HthorError
    from hthor.eval.records import find
    from hthor.eval.records.run_folder import RunFolder
    from hthor.eval.replay.session_history import RunFiles
    from hthor.guest.agent import inputs
    from hthor.live import server as live_server
    from hthor.watch import page, page_server, record_trial

    live_server.check_built()
    if out is not None and out.exists() and not out.is_dir():
        raise HthorError(f"{out} is a file; --out takes a folder, in which the page is called index.html.")
    record = find.find_trial(RunFolder(run), trial)
    files = RunFiles(agents=tuple(agent or ()), robots=tuple(robot or ()), kind=kind, humans=humans)
    given = inputs.parse_inputs(agent_args or (), readable or ())
    made = page.make_page(record_trial.record_trial(run, record, files, given))
    if out is not None:
        output.put_files([page.write_page(out, made)], json, key=record.key, task=record.spec.task.id)
        return
    activity.wait_for_people()
    with page_server.PageServer(made, port) as server, contextlib.suppress(KeyboardInterrupt):
        if json:
            output.put_json({"address": server.address, "key": record.key, "task": record.spec.task.id})
        else:
            output.say(f"open {server.address}")
            output.say("Ctrl-C ends it.")
        server.serve_forever()
