"""Single trials: maps of each robot's best and worst trials, and the first trial with each kind of fault."""

from collections.abc import Mapping
from html import escape

from hthor.report.analysis.document import ExampleTrial, FaultGroup, Findings
from hthor.report.html import elements
from hthor.report.html.elements import Code, Mark, Piece
from hthor.report.page import sentences

_RANKS = {"best": "Best trials", "worst": "Worst trials"}
_FAULT_HEAD = ("run", "whose", "fault", "trials", "share", "first in")


def trials(found: Findings, drawings: Mapping[str, str]) -> list[str]:
    """The parts of the section on best and worst trials."""
    if not found.shown:
        return [elements.paragraph("There is no robot in these runs.")]
    by = "the time saved against the same people without a robot" if found.baseline else "time-weighted success"
    held = [elements.paragraph(f"Ranked by {by}: extremes of many trials, not typical ones.")]
    if "legend" in drawings:
        told = "The house from above. Lines darken with time, with a dot every ten seconds; a number stands where "
        held.append(elements.drawn(drawings, "legend", f"{told}a robot sent a message."))
    names = [name for name in drawings if name.startswith("map-")]
    drawn = {(one.arm, one.key): name for one, name in zip(found.shown, names, strict=False)}
    for arm in dict.fromkeys(one.arm for one in found.shown):
        for rank, word in _RANKS.items():
            mine = [one for one in found.shown if (one.arm, one.rank) == (arm, rank)]
            if mine:
                cards = "\n".join(_card(one, drawings.get(drawn.get((arm, one.key), ""), "")) for one in mine)
                held.append(f'<h3>{word}: {escape(arm)}</h3>\n<div class="maps">\n{cards}\n</div>')
    return held


def _card(one: ExampleTrial, drawing: str) -> str:
    caption: list[Piece] = [Mark(sentences.time_gained(one), "plain"), sentences.example_trial(one), Code(one.replay)]
    return elements.figure(drawing, caption, "map")


def faults(found: Findings, _: Mapping[str, str]) -> list[str]:
    """The parts of the section on faults."""
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
            "After a fault people went on without that robot; the trial counts as it ended. No trial is left out."
        ),
        elements.table(_FAULT_HEAD, rows, "Trials with a fault, by its kind.", words=(0, 1, 2, 5)),
        *(part for one in found.failures for part in _first(one)),
    ]


def _first(one: FaultGroup) -> list[str]:
    """The details of the first trial with one kind of fault."""
    where = f"{one.task}, session {one.session}, trial {one.index + 1}, after {one.after_s:.1f} s"
    commands = [command for command in (one.again, one.replay) if command]
    return [
        f"<h3>{elements.inside(one.run)}, {elements.inside(Mark(one.kind, 'bad'))}: the first</h3>",
        elements.paragraph(f"{where}:"),
        elements.block(one.detail or "no details were kept"),
        *((elements.paragraph("It printed last:"), elements.block(one.output)) if one.output else ()),
        elements.listed(
            ["Play it again: " if command == one.again else "Draw it: ", Code(command)] for command in commands
        ),
    ]
