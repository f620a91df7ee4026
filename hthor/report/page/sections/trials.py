"""The best and the worst trials of each robot, on maps."""

from collections.abc import Mapping
from html import escape

from hthor.report.analysis.document import Findings
from hthor.report.analysis.example_trials import ExampleTrial
from hthor.report.html import elements
from hthor.report.html.elements import Code, Mark, Piece
from hthor.report.page import sentences

TITLE = "Best and worst trials"
_RANKS = {"best": "Best trials", "worst": "Worst trials"}


def parts(found: Findings, drawings: Mapping[str, str]) -> list[str]:
    """Of what the section is made."""
    if not found.shown:
        return [elements.paragraph("There is no robot to tell of.")]
    by = "the time saved against the same person without a robot" if found.baseline else "time-weighted success"
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
