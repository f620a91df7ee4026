"""Sentences made from the numbers of a validation."""

from collections.abc import Sequence

from hthor.calibration.evidence import (
    AbcShift,
    Band,
    CoverageFinding,
    Evidence,
    HeldOutCondition,
    ParameterFinding,
    RobotRanking,
)
from hthor.calibration.validation.report.findings import (
    QUARTILE_S,
    Findings,
    MessageReach,
    ModelFigures,
    TimeDifference,
    TimeSpent,
    TrustFindings,
)
from hthor.eval.metrics import registry
from hthor.report.html.number_format import listed as listed
from hthor.report.html.number_format import percent as percent
from hthor.report.html.number_format import plain as plain
from hthor.report.html.number_format import signed as signed

IDENTIFIED, WEAKLY, NOT = "identified", "weakly identified", "not identified"
CONTRACTS, CONTRACTS_WEAKLY = 0.4, 0.1
"""Least contraction of a parameter that is identified, and of one that is weakly identified."""
RECOVERS, RECOVERS_WEAKLY = 0.6, 0.45
"""Least recovery that is needed too, if it was computed."""
METRIC = {name: registry.get(name).symbol for name in ("sr", "twsr", "adoption")}
CONDITION = {"none": "no robot", "frontier": "frontier", "oracle": "oracle"}
_ROBOT = {"frontier": "the frontier robot", "oracle": "the oracle"}
SCOPE = (
    "Populations that pass are consistent with the 175 published trials; they support relative comparison of "
    "assistants on the same suite. They are not evidence about individual people, trust mechanisms or memory."
)


def identified(one: ParameterFinding) -> str:
    """Whether the published numbers identify the parameter, in two words at most."""
    recovery = 1.0 if one.recovery is None else one.recovery
    if one.contraction >= CONTRACTS and recovery >= RECOVERS:
        return IDENTIFIED
    return WEAKLY if one.contraction >= CONTRACTS_WEAKLY and recovery >= RECOVERS_WEAKLY else NOT


def figure(name: str) -> str:
    """A figure's title: ``sr none`` is "SR no robot"."""
    metric, condition = name.split()
    return f"{METRIC[metric]} {CONDITION[condition]}"


def span(band: Band, scale: float = 1.0, digits: int = 1) -> str:
    """An interval: "47.1 … 81.0"."""
    return " … ".join(signed(scale * end, digits).lstrip("+") for end in (band.low, band.high))


def verdict(found: Findings) -> str:
    """The result of the table of figures."""
    covered = [row for row in found.table if row.inside]
    close = [row for row in found.table if row.close]
    total = len(found.table)
    text = (
        f"{len(covered)} of {total} published figures lie inside the 90 % intervals of simulated study groups, "
        f"and {len(close)} of {total} medians are within the tolerance."
    )
    if len(covered) < total:
        text += f" Outside: {listed(figure(row.figure) for row in found.table if not row.inside)}."
    if len(close) < total:
        off = (
            f"{figure(row.figure)} by {signed(100.0 * (row.band.median - row.published))} points"
            for row in found.table
            if not row.close
        )
        text += f" Too far: {listed(off)}."
    return text


def held_out(parts: Sequence[HeldOutCondition]) -> list[str]:
    """The result of leaving conditions out."""
    rows = [row for part in parts for row in part.figures]
    inside = sum(row.inside for row in rows)
    missing = 9 - len(rows)
    sentences = [f"{inside} of {len(rows)} held-out figures lie inside their 80 % intervals."]
    if missing == 1:
        sentences.append("One of the nine figures does not exist: without a robot there is no adoption.")
    out = [figure(row.figure) for row in rows if not row.inside]
    if out:
        sentences.append(f"Outside: {listed(out)}.")
    for part in parts:
        gains = [f"{signed(part.log_score - part.log_score_prior, 2)} nats over the prior"]
        gains += [f"{signed(part.log_score - score, 2)} over {name}" for name, score in sorted(part.rivals.items())]
        sentences.append(f"{_upper(CONDITION[part.condition])}: {listed(gains)}.")
    return sentences


def parameters(parts: Sequence[ParameterFinding]) -> list[str]:
    """Which parameters the published numbers identify."""
    by_word = {word: [one.name for one in parts if identified(one) == word] for word in (IDENTIFIED, WEAKLY, NOT)}
    counts = {word: f"{len(names)}{f' ({listed(names)})' if names else ''}" for word, names in by_word.items()}
    return [
        f"Of {len(parts)} parameters {counts[IDENTIFIED]} are identified and {counts[WEAKLY]} weakly identified. "
        f"The other {len(by_word[NOT])} are not identified: their values come from the literature or are our own "
        "choice, not from the published study."
    ]


def coverage(found: CoverageFinding) -> str:
    """How often the intervals contain the truth."""
    return (
        f"Over {found.studies} simulated studies the 90 % intervals had the true value in {percent(found.mean)} % "
        f"of the cases; the parameters range from {percent(found.low)} to {percent(found.high)} %."
    )


def emulator(found: Evidence) -> str:
    """How good the emulator is."""
    if found.emulator_z is None:
        return "The emulator's errors on whole studies were not computed."
    return (
        f"On whole simulated studies the emulator's standardised errors have a standard deviation of "
        f"{found.emulator_z:.2f} (it should be 1; above 1 the emulator is overconfident)."
    )


def cross_check(parts: Sequence[AbcShift]) -> str:
    """How well ABC agrees."""
    worst = max(parts, key=lambda one: abs(one.shift))
    return (
        f"Approximate Bayesian computation on whole simulated studies moves no posterior median by more than "
        f"{abs(worst.shift):.2f} of our posterior standard deviations ({worst.name})"
        + ("." if worst.error is None else f", known to ± {worst.error:.2f}.")
    )


def ranking(one: RobotRanking) -> str:
    """How firm the order of the robots is."""
    return (
        f"On {one.suite}, judged at {one.trials} trials per robot, oracle > frontier > none holds in success for "
        f"{percent(one.sr)} %, in time-weighted success for {percent(one.twsr)} % and in both for "
        f"{percent(one.both)} % of {one.draws} posterior draws."
        + (f" The true rates are in that order in {percent(one.expected['both'])} %." if "both" in one.expected else "")
    )


def swings(one: RobotRanking, known: Sequence[ParameterFinding]) -> list[str]:
    """How the parameters that are not identified change the gaps between robots."""
    free = {part.name for part in known if identified(part) == NOT}
    rows = [swing for swing in one.swings if swing.name in free]
    if not rows:
        return []
    worst = max(rows, key=lambda swing: abs(swing.high - swing.low))
    turned = [swing.name for swing in rows if min(swing.low, swing.high) <= 0.0]
    text = (
        f"Of the parameters that are not identified, {worst.name} moves a gap most: SR of {CONDITION[worst.better]} "
        f"minus {CONDITION[worst.worse]} goes from {signed(100.0 * worst.low)} to {signed(100.0 * worst.high)} points "
        "over its prior. "
    )
    if turned:
        return [text + f"The mean gap is zero or negative at an end of the prior of {listed(dict.fromkeys(turned))}."]
    return [text + "None of these parameters changes the sign of a mean gap at either end of its prior."]


def order(one: ModelFigures) -> str:
    """The robots' order by success and by time-weighted success, in words."""
    kept = [metric for metric in ("sr", "twsr") if _kept(one, metric)]
    if len(kept) == 2:
        return "keeps oracle > frontier > none in SR and TWSR"
    return f"keeps it in {METRIC[kept[0]]} only" if kept else "keeps it in neither"


def _kept(one: ModelFigures, metric: str) -> bool:
    values = [one.figures.get(f"{metric} {condition}") for condition in ("oracle", "frontier", "none")]
    known = [value for value in values if value is not None]
    return len(known) == 3 and known[0] > known[1] > known[2]


def suites(found: Findings) -> str:
    """Whether the order of the robots carries over to other suites."""
    said = listed(f"{one.name} {order(one)}" for one in found.suites)
    return f"The same people on other suites: {said}. Do not compare absolute figures of different suites."


def kinds(found: Findings) -> str:
    """Which kind of people succeeds least, and whether the order of the robots holds for all kinds."""
    worst = min(found.kinds, key=lambda one: one.figures.get("sr oracle") or 0.0)
    turned = [one.name for one in found.kinds if not (_kept(one, "sr") and _kept(one, "twsr"))]
    text = (
        f"With the oracle, {worst.name} people fare worst: they succeed in "
        f"{percent(worst.figures.get('sr oracle'))} % of the trials. "
    )
    if turned:
        return text + f"The order oracle > frontier > none does not hold in both SR and TWSR for {listed(turned)}."
    return text + "The order oracle > frontier > none holds in SR and TWSR for every kind."


def quartiles(parts: Sequence[TimeSpent], pairs: Sequence[TimeDifference]) -> str:
    """Whether help moves the lower quartile of the time spent."""
    each = listed(f"{CONDITION[one.condition]} {one.lower:.1f} s" for one in parts)
    rows = [one for one in pairs if one.statistic == "lower quartile"]
    worst = max(rows, key=lambda one: abs(one.value))
    size = f"{abs(worst.value):.1f} s ({CONDITION[worst.a]} minus {CONDITION[worst.b]}: {signed(worst.value)} s)"
    within = abs(worst.value) <= QUARTILE_S
    far = (
        "they are within 7 s of one another" if within else f"that is {abs(worst.value) - QUARTILE_S:.1f} s beyond 7 s"
    )
    seen = "would hardly see it" if _holds_zero(worst.group) else "would tend to see it"
    return (
        f"Lower quartiles: {each}. The largest difference is {size}; {far}. The article reports no significant "
        f"difference. Between groups of six that difference is {signed(worst.group.median)} s [{span(worst.group)}] "
        f"here, so that a study of that size {seen}."
    )


def minima(pairs: Sequence[TimeDifference]) -> str:
    """Whether the shortest times are similar."""
    each = (
        f"{CONDITION[one.a]} minus {CONDITION[one.b]} {signed(one.value)} s (groups of six {span(one.group)} s)"
        for one in pairs
        if one.statistic == "minimum"
    )
    return f"Shortest times: {listed(each)}. The article calls those of the two robots about equal."


def reach(parts: Sequence[MessageReach]) -> str:
    """How often messages are shown and accepted."""
    each = "; ".join(
        f"with {_ROBOT[one.condition]}, a message was shown in {percent(one.shown)} % of the trials"
        + ("" if one.accepted is None else f", and accepted in {percent(one.accepted)} % of those")
        for one in parts
    )
    return f"Adoption is the share of trials with a message times the share of acceptance. {_upper(each)}."


def trust(found: TrustFindings) -> list[str]:
    """How trust changes over a session, and what the report does not claim about it."""
    curves = {curve.condition: curve for curve in found.curves}
    oracle, frontier = curves["oracle"], curves["frontier"]
    where = "above" if found.gap > 0 else "not above"
    rises = "rises" if oracle.slope > 0 else "does not rise"
    steps = [abs(b - a) for a, b in zip(frontier.mean, frontier.mean[1:], strict=False)]
    half = len(steps) // 2
    return [
        f"Mean trust in the oracle is {where} that in the frontier robot over the session: by {signed(found.gap, 2)} "
        f"(standard error {found.gap_se:.2f}), and at {found.above} of {len(oracle.mean)} trials.",
        f"It {rises}: {signed(oracle.slope, 3)} points per trial (standard error {oracle.slope_se:.3f}); "
        f"trust in the frontier robot {signed(frontier.slope, 3)} ({frontier.slope_se:.3f}).",
        f"Of simulated groups of six, {percent(found.groups_above, 0)} % show the oracle above the frontier robot at "
        f"every trial, and {percent(found.groups_rising, 0)} % a rising trust in the oracle.",
        f"That trust in the frontier robot converges is not claimed: its mean moves by {_mean(steps[:half]):.2f} per "
        f"trial in the first half of the session and by {_mean(steps[half:]):.2f} in the second.",
    ]


def simulated(found: Evidence) -> str:
    """An explanation of the columns of section 3."""
    return (
        f"Prior and posterior are predicted by the emulator; simulated values are medians and intervals of "
        f"{found.simulated_studies} whole studies simulated with people of the posterior."
    )


def _holds_zero(band: Band) -> bool:
    return band.low <= 0.0 <= band.high


def _mean(values: Sequence[float]) -> float:
    return sum(values) / len(values) if values else 0.0


def _upper(text: str) -> str:
    return text[:1].upper() + text[1:]
