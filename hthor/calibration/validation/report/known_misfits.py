"""Where a human model differs from the published study, as sentences made from the numbers."""

from hthor.calibration.validation.report import phrases
from hthor.calibration.validation.report.findings import QUARTILE_S, Findings

_TAIL = 0.10
"""A published figure in the outer tenth of the predicted distribution is a misfit worth watching."""


def find_misfits(found: Findings) -> tuple[str, ...]:
    """Every misfit that the numbers show, the eight figures first, and the model's general limits."""
    return (*_figures(found), *_held_out(found), *_time(found), *_trust(found), *_standing(found))


def _figures(found: Findings) -> list[str]:
    sentences = []
    for row in found.table:
        off = 100.0 * (row.band.median - row.published)
        if not row.covered or not _TAIL <= row.percentile <= 1.0 - _TAIL:
            where = "outside the 90 % interval" if not row.covered else "in the outer tenth of the predictions"
            high = "too high" if off > 0 else "too low"
            sentences.append(
                f"{phrases.figure(row.figure)} is predicted {high} by {abs(off):.1f} points: "
                f"the published {phrases.percent(row.published)} % lies {where}."
            )
        elif not row.close:
            sentences.append(
                f"The median {phrases.figure(row.figure)} is {phrases.signed(off)} points from the published figure, "
                f"more than the {100.0 * row.tolerance:.0f} allowed, though the interval holds it."
            )
    return sentences


def _held_out(found: Findings) -> list[str]:
    if found.evidence is None:
        return []
    return [
        f"Left out of the fit, {phrases.figure(row.figure)} is predicted as {phrases.percent(row.band.median)} % "
        f"[{phrases.span(row.band, 100.0)}], and the published {phrases.percent(row.published)} % is not in that "
        "interval."
        for part in found.evidence.held_out
        for row in part.figures
        if not row.inside
    ]


def _time(found: Findings) -> list[str]:
    return [
        f"The lower quartile of the time spent is {phrases.signed(one.value)} s with {phrases.CONDITION[one.a]} "
        f"against {phrases.CONDITION[one.b]}, where the article reports no significant difference."
        for one in found.differences
        if one.statistic == "lower quartile" and abs(one.value) > QUARTILE_S
    ]


def _trust(found: Findings) -> list[str]:
    if found.trust is None:
        return []
    sentences = []
    oracle = next(curve for curve in found.trust.curves if curve.condition == "oracle")
    trials = len(oracle.mean)
    if found.trust.above < trials:
        sentences.append(
            f"Mean trust in the oracle is above that in the frontier robot at {found.trust.above} of {trials} trials; "
            "in the article it is so at every one."
        )
    if oracle.slope <= 0.0:
        sentences.append(f"Trust in the oracle does not rise ({phrases.signed(oracle.slope, 3)} points a trial).")
    return sentences


def _standing(found: Findings) -> list[str]:
    sentences = [
        "“Gradually converging” trust in the frontier robot is neither fitted nor claimed: the article says so "
        "in words and prints no number that a model could be held to."
    ]
    inferred = [count for count in found.published.counts if count.inferred]
    if inferred:
        named = phrases.listed(f"{count.k} of {count.n} ({phrases.figure(count.figure)})" for count in inferred)
        sentences.append(f"Counts that the article does not print and that were inferred: {named}.")
    return sentences
