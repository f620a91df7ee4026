"""What failed: kinds of fault, and of each the first with its traceback, its last output and how to replay it."""

from collections.abc import Mapping

from hthor.report.analysis.document import Findings
from hthor.report.analysis.example_trials import FaultGroup
from hthor.report.html import elements
from hthor.report.html.elements import Code, Mark, Piece

TITLE = "Faults"
_HEAD = ("run", "whose", "fault", "trials", "share", "first in")


def parts(found: Findings, _: Mapping[str, str]) -> list[str]:
    """Of what the section is made."""
    trials = sum(one.trials for one in found.origins)
    if not found.failures:
        return [elements.paragraph(f"No robot failed in any of the {trials} trials.")]
    rows: list[list[Piece]] = [
        [
            one.run,
            f"{one.seat}: {one.agent}",
            Mark(one.kind, "bad"),
            str(one.trials),
            f"{100.0 * one.trials / one.whole:.1f} %",
            f"{one.task}, after {one.after_s:.1f} s",
        ]
        for one in found.failures
    ]
    return [
        elements.paragraph(
            "After a fault the person went on without that robot; the trial counts as it ended. No trial is left out."
        ),
        elements.table(_HEAD, rows, "Trials with a fault, by its kind.", words=(0, 1, 2, 5)),
        *(part for one in found.failures for part in _first(one)),
    ]


def _first(one: FaultGroup) -> list[str]:
    """What is known of the first of a kind."""
    where = f"{one.task}, person {one.participant}, trial {one.index + 1}, after {one.after_s:.1f} s"
    commands = [command for command in (one.again, one.replay) if command]
    return [
        f"<h3>{elements.inside(one.run)}, {elements.inside(Mark(one.kind, 'bad'))}: the first</h3>",
        elements.paragraph(f"{where}:"),
        elements.block(one.detail or "nothing was said"),
        *((elements.paragraph("It printed last:"), elements.block(one.output)) if one.output else ()),
        elements.listed(
            ["Play it again: " if command == one.again else "Draw it: ", Code(command)] for command in commands
        ),
    ]
