"""What a reader has to know before comparing: unfinished runs, people out of their range, unequal code; no results."""

from hthor.report.analysis.document import Findings
from hthor.report.html.number_format import listed


def warnings(found: Findings) -> list[str]:
    """A sentence each."""
    said = [
        f"{one.name} is not finished: {one.whole - one.trials} of {one.whole} trials are missing."
        for one in found.origins
        if one.trials < one.whole
    ]
    outside = list(dict.fromkeys(note for one in found.origins for note in one.humans.notes))
    if outside:
        said.append(
            f"The people are used outside of what they were calibrated for: {'; '.join(outside)}. Robots can be "
            "compared with each other; absolute figures are less certain than their intervals."
        )
    if len({one.code_sha256 for one in found.origins}) > 1:
        said.append("These runs were played by different versions of the code, so their trials are not paired.")
    alone = next((arm for arm in found.arms if arm.label == found.baseline), None)
    whose = [pair.second for pair in found.uplift if alone is not None and pair.n < alone.trials]
    if whose:
        said.append(f"Not every trial of {listed(whose)} has its partner without a robot; only pairs are compared.")
    return said
