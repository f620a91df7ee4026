"""The conclusions of a validation: a verdict on each criterion, and the model's misfits to the published study."""

from collections.abc import Sequence

import msgspec

from hthor.calibration.diagnostics.acceptance import CLOSE, FULL
from hthor.calibration.evidence import Evidence
from hthor.calibration.validation.report import phrases
from hthor.calibration.validation.report.findings import (
    QUARTILE_S,
    FigurePrediction,
    Findings,
    Gate,
    TrustFindings,
    Verdict,
)

ORDER = 0.95
"""Least share of posterior draws that rank the robots oracle > frontier > none."""
_TAIL = 0.10
"""A published figure in the outer tenth of the predicted distribution is reported as a misfit."""


def judge_findings(found: Findings) -> tuple[Gate, ...]:
    """Every gate's verdict. A gate that a short run or a missing calibration cannot decide is not judged."""
    short = found.setting.quick
    return (*_table(found.table, short), _trust(found.trust, short), *judge_evidence(found.evidence))


def judge_evidence(found: Evidence | None) -> tuple[Gate, ...]:
    """The criteria for a calibration. The criteria of a quick calibration are shown but not judged."""
    gates = (*_held_out(found), _coverage(found), _emulator(found), _abc(found), _ranking(found))
    if found is None or not found.origin.quick:
        return gates
    return tuple(msgspec.structs.replace(gate, verdict="not judged") for gate in gates)


def failed_gates(gates: Sequence[Gate]) -> list[Gate]:
    """The criteria that were not met."""
    return [gate for gate in gates if gate.verdict == "failed"]


def _gate(name: str, asks: str, found: str, passed: bool | None) -> Gate:
    verdict: Verdict = "not judged" if passed is None else "passed" if passed else "failed"
    return Gate(name=name, asks=asks, found=found, verdict=verdict)


def _table(rows: Sequence[FigurePrediction], short: bool) -> tuple[Gate, ...]:
    out = [phrases.figure(row.figure) for row in rows if not row.inside]
    far = [phrases.figure(row.figure) for row in rows if not row.close]
    total = len(rows)
    return (
        _gate(
            "published figures covered",
            f"all {total} inside the 90 % intervals of simulated study groups",
            f"{total - len(out)} of {total}" + (f"; outside: {phrases.listed(out)}" if out else ""),
            None if short else not out,
        ),
        _gate(
            "medians close",
            CLOSE,
            f"{total - len(far)} of {total}" + (f"; too far: {phrases.listed(far)}" if far else ""),
            None if short else not far,
        ),
    )


def _trust(found: TrustFindings | None, short: bool) -> Gate:
    name, asks = "trust", "higher in the oracle than in the frontier robot over the session, and rising"
    if found is None:
        return _gate(name, asks, "nobody rated both robots", None)
    slope = next(curve.slope for curve in found.curves if curve.condition == "oracle")
    said = f"{phrases.signed(found.gap, 2)} above, {phrases.signed(slope, 3)} per trial"
    return _gate(name, asks, said, None if short else found.gap > 0.0 and slope > 0.0)


def _absent(found: Evidence | None) -> str:
    return "there is no calibration" if found is None else "not computed in this calibration"


def _held_out(found: Evidence | None) -> tuple[Gate, ...]:
    inside = ("held-out figures", "every existing figure inside its 80 % interval")
    better = ("held-out log scores", "above the prior's in every condition")
    if found is None or not found.held_out:
        return (_gate(*inside, _absent(found), None), _gate(*better, _absent(found), None))
    rows = [row for part in found.held_out for row in part.figures]
    out = [phrases.figure(row.figure) for row in rows if not row.inside]
    gains = {phrases.CONDITION[part.condition]: part.log_score - part.log_score_prior for part in found.held_out}
    said = f"{len(rows) - len(out)} of {len(rows)}" + (f"; outside: {phrases.listed(out)}" if out else "")
    scores = phrases.listed(f"{name} {phrases.signed(gain, 2)}" for name, gain in gains.items()) + " nats"
    return (_gate(*inside, said, not out), _gate(*better, scores, min(gains.values()) > 0.0))


def _coverage(found: Evidence | None) -> Gate:
    low, high = FULL.coverage
    ask = (
        "coverage",
        f"90 % intervals contain {low:.2f} to {high:.2f} of the truths, over {FULL.studies} studies or more",
    )
    if found is None or found.coverage is None:
        return _gate(*ask, _absent(found), None)
    said = f"{found.coverage.mean:.3f} over {found.coverage.studies} studies"
    return _gate(*ask, said, found.coverage.studies >= FULL.studies and low <= found.coverage.mean <= high)


def _emulator(found: Evidence | None) -> Gate:
    low, high = FULL.z_sd
    ask = ("emulator", f"standard deviation of its standardised errors from {low} to {high}")
    if found is None or found.emulator_z is None:
        return _gate(*ask, _absent(found), None)
    return _gate(*ask, f"{found.emulator_z:.2f}", low <= found.emulator_z <= high)


def _abc(found: Evidence | None) -> Gate:
    ask = ("ABC cross-check", f"medians of the fitted parameters within {FULL.shift} posterior standard deviations")
    if found is None or not found.abc:
        return _gate(*ask, _absent(found), None)
    worst = max(found.abc, key=lambda one: abs(one.shift))
    return _gate(*ask, f"at most {abs(worst.shift):.2f} ({worst.name})", abs(worst.shift) < FULL.shift)


def _ranking(found: Evidence | None) -> Gate:
    ask = (
        "order of the robots",
        f"oracle > frontier > none, SR and TWSR, in {100 * ORDER:.0f} % of the posterior draws",
    )
    home = next((one for one in found.rankings if one.suite == found.origin.suite), None) if found else None
    if home is None:
        return _gate(*ask, _absent(found), None)
    share = min(home.sr, home.twsr)
    said = f"SR {phrases.percent(home.sr)} %, TWSR {phrases.percent(home.twsr)} %, at {home.trials} trials per robot"
    return _gate(*ask, said, share >= ORDER)


def find_misfits(found: Findings) -> tuple[str, ...]:
    """Every misfit that the numbers show, the eight figures first, and the model's general limits."""
    return (*_figures(found), *_held_out_misfits(found), *_time(found), *_trust_misfits(found), *_standing(found))


def _figures(found: Findings) -> list[str]:
    sentences = []
    for row in found.table:
        off = 100.0 * (row.band.median - row.published)
        if not row.inside or not _TAIL <= row.percentile <= 1.0 - _TAIL:
            where = "outside the 90 % interval" if not row.inside else "in the outer tenth of the predictions"
            high = "too high" if off > 0 else "too low"
            sentences.append(
                f"{phrases.figure(row.figure)} is predicted {high} by {abs(off):.1f} points: "
                f"the published {phrases.percent(row.published)} % lies {where}."
            )
        elif not row.close:
            sentences.append(
                f"The median {phrases.figure(row.figure)} is {phrases.signed(off)} points from the published figure, "
                f"more than the {100.0 * row.tolerance:.0f} allowed, though the interval contains it."
            )
    return sentences


def _held_out_misfits(found: Findings) -> list[str]:
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


def _trust_misfits(found: Findings) -> list[str]:
    if found.trust is None:
        return []
    sentences = []
    oracle = next(curve for curve in found.trust.curves if curve.condition == "oracle")
    trials = len(oracle.mean)
    if found.trust.above < trials:
        sentences.append(
            f"Mean trust in the oracle is above that in the frontier robot at {found.trust.above} of {trials} trials; "
            "in the article it is above at every trial."
        )
    if oracle.slope <= 0.0:
        sentences.append(f"Trust in the oracle does not rise ({phrases.signed(oracle.slope, 3)} points per trial).")
    return sentences


def _standing(found: Findings) -> list[str]:
    sentences = [
        "“Gradually converging” trust in the frontier robot is neither fitted nor claimed: the article says so "
        "in words and prints no number to compare a model with."
    ]
    inferred = [count for count in found.published.counts if count.inferred]
    if inferred:
        named = phrases.listed(f"{count.k} of {count.n} ({phrases.figure(count.figure)})" for count in inferred)
        sentences.append(f"Counts that the article does not print and that were inferred: {named}.")
    return sentences
