"""`hthor live`."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import msgspec
import typer
from msgspec import structs

from hthor import activity
from hthor.commands import person_table
from hthor.commands.eval import results
from hthor.commands.options import Json, takes_options
from hthor.console import output
from hthor.eval.config.option import Option, make_record
from hthor.eval.config.options import EvalOptions

if TYPE_CHECKING:
    from rich.console import Console

    from hthor.live.run import LiveRun

_AS_IN_EVAL = (
    *("agent", "agent_args", "readable", "humans", "suite", "kind", "robot", "robots", "detector", "camera"),
    *("camera_size", "seed", "participants", "house", "difficulty", "limit", "out", "name", "step_limit"),
    *("isolation", "require_isolation"),
)
_FIELDS = {one.name: (EvalOptions.__annotations__[one.name], one.default) for one in structs.fields(EvalOptions)}
_FIELDS["humans"] = (
    Annotated[
        tuple[str, ...],
        Option(
            help="Who the people of a trial are, joined by commas: 'live' is somebody at a page, and every other word "
            "of --humans in 'hthor eval' is a simulated person. For two people at pages: live,live.",
            default="live",
        ),
    ],
    ("live",),
)
_FIELDS["agent"] = (
    Annotated[
        tuple[str, ...],
        Option(
            help="The robot's agent, in the words of 'hthor eval', or 'socket': a program of yours that connects to "
            "this session and controls the robot. 'socket:NAME' tells several apart, in --robots.",
        ),
    ],
    (),
)
_FIELDS["participants"] = (
    Annotated[
        int | None,
        Option(
            least=1,
            help="How many people take part in all; those of a trial do ten tasks, and then the next come.",
            default="those of one trial",
        ),
    ],
    None,
)
LiveOptions = msgspec.defstruct(
    "LiveOptions", [(name, *_FIELDS[name]) for name in _AS_IN_EVAL], frozen=True, kw_only=True
)


@takes_options(LiveOptions)
def live(
    port: Annotated[int, typer.Option(min=0, max=65535, help="The port of the pages; 0 for any that is free.")] = 8765,
    lan: Annotated[
        bool,
        typer.Option(
            "--lan",
            help="Let other machines on the local network open the pages too, encrypted. Without it, only this machine "
            "can.",
        ),
    ] = False,
    experimenter_starts: Annotated[
        bool,
        typer.Option("--experimenter-starts", help="Each trial waits until the experimenter starts it on their page."),
    ] = False,
    practice: Annotated[
        bool,
        typer.Option(
            "--practice/--no-practice",
            help="Whether people try each control once, in a room of its own, before a session's first trial.",
        ),
    ] = True,
    calibrate: Annotated[
        bool,
        typer.Option(
            "--calibrate",
            help="A prescribed session of about ten minutes that measures each person: three walks, three searches "
            "and three deliveries, with a robot that is right about half of the time. At the end it says how far the "
            "person is from the population, as 'hthor humans profile' does.",
        ),
    ] = False,
    json: Json = False,
    **given: object,
) -> None:
    """Take part yourself: serve a page for each person, and play a session of trials with whoever opens it.

    Running the same command again goes on with the first trial that is missing. The run is a run like any other:
    'hthor score', 'report', 'compare' and 'replay' read it. When the session is over, each person is shown a page with
    their trials, which is also in the run's folder 'people'.
    """
    from hthor.eval.comparison import population_matrix
    from hthor.eval.runner import progress
    from hthor.live.run import LiveRun

    talk = output.console(talk=True)
    chosen = make_record(LiveOptions, given)
    options = EvalOptions(**{name: getattr(chosen, name) for name in _AS_IN_EVAL})
    sections: Callable[[Path], Mapping[int, str]] = _nothing_more
    if calibrate:
        from hthor.calibration.person import person_files, protocol

        options, sections = protocol.prescribed(options), person_files.sections
    tell = partial(output.say, to=talk)
    activity.wait_for_people()
    with LiveRun(
        options,
        port=port,
        lan=lan,
        experimenter_starts=experimenter_starts,
        practice=practice,
        tell=tell,
        sections=sections,
    ) as run:
        for line in _welcome(run):
            tell(line)
        for seat in run.seats if run.hosts else ():
            _put_code(run.server.url(seat, run.hosts[0]), talk)
        done = run.play(partial(progress.make_watcher, talk, quiet=False, live=output.live()))
    results.show_run(talk if json else output.console(), done)
    if calibrate and not json:
        _put_profiles(done.folder.path)
    if json:
        output.put_json(population_matrix.make_evaluation([(str(done.folder), done.result)]))


def _put_code(address: str, talk: Console) -> None:
    """Print an address for the camera of a headset or a telephone."""
    from rich.text import Text

    from hthor.live.qr_code import qr_code

    talk.print(Text(qr_code(address), style="bright_white on black"), soft_wrap=True)


def _nothing_more(_: Path) -> Mapping[int, str]:
    """No sections for people's own pages besides their trials."""
    return {}


def _put_profiles(folder: Path) -> None:
    """Write how far each person is from the population, and which files say it."""
    from hthor.calibration.person.profile import profiles
    from hthor.report.person import person_page

    for one in profiles(folder):
        person_table.put_profile(one)
    quoted = shlex.quote(str(folder))
    output.put_line(f"files: {quoted}/{person_page.FOLDER}/, a page and the numbers of each person")
    output.put_line(f"next:  hthor calibrate --target {quoted}")


def _welcome(run: LiveRun) -> list[str]:
    """What to open, a line for each address."""
    from hthor.live.server import LOCAL_HOSTS

    hosts, server = run.hosts or LOCAL_HOSTS[1:2], run.server
    lines = [
        f"open {server.url(seat, host)}" + (f" as {seat}" if len(run.seats) > 1 else "")
        for seat in run.seats
        for host in hosts
    ]
    lines += [f"the experimenter's page: {server.desk_url_at(host)}" for host in hosts]
    if run.certificate is not None:
        lines.append(
            "Browsers warn of this server, because its certificate was made on this machine: go on if the certificate "
            f"that they show has the SHA-256 fingerprint {run.certificate.fingerprint}."
        )
    return lines
