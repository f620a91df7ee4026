"""`hthor replay --mind`; knows what the user typed, not how a mind is looked into."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from hthor.console import output

if TYPE_CHECKING:
    from hthor.guest import Given


def replay(
    run: Path, trial: str, out: Path | None, agents: Sequence[str], humans: str, given: Given, json: bool
) -> None:
    """Play a person's session again up to one trial, and draw or print what went on in their mind."""
    from hthor import houses
    from hthor.eval.records import find
    from hthor.eval.replay import human_trace
    from hthor.report.drawing import human_trace_figure, lettering, render_trial

    houses.shelve(run / "houses")  # where the suite brought its own
    record = find.find_trial(run, trial)
    house = render_trial.house(record)
    stream = human_trace.trace_human(run, record, agents=agents, humans=humans, given=given)
    if not stream.same:
        talk = output.console(talk=True)
        talk.print(
            "the trial went otherwise than it was logged: something here does not repeat itself. What follows is what "
            "the person thought this time.",
            soft_wrap=True,
        )
    if json:
        output.put_json(stream)
        return
    path = out or run / "replays" / f"{record.spec.task.id.replace('/', '-')}-{record.key}-mind.png"
    path.parent.mkdir(parents=True, exist_ok=True)
    render_trial.check_name(path, video=False)
    lettering.save(human_trace_figure.figure(record, house, stream), path)
    sys.stdout.write(f"{path}\n")
