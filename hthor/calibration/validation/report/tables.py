"""Findings as rows of cells, for the page and for the terminal."""

from collections.abc import Sequence

from hthor.calibration.evidence import (
    FIGURES,
    Band,
    EmulatorFit,
    HeldOutCondition,
    ParameterFinding,
    ParameterSwing,
    PredictedFigure,
    RobotRanking,
)
from hthor.calibration.validation.report import phrases
from hthor.calibration.validation.report.findings import (
    FigurePrediction,
    Gate,
    ModelFigures,
    PublishedStudy,
    TimeDifference,
    TimeSpent,
    TrustCurve,
)
from hthor.report.html.elements import Cell, Mark, mark

Rows = list[list[Cell]]
GATES = ("criterion", "asks", "found", "verdict")
TABLE = ("figure [%]", "published", "median", "90 % interval", "all trials", "covered", "error", "allowed", "close")
COUNTS = ("count", "k / n", "%", "", "how it was found")
PREDICTIVE = ("figure [%]", "published", "prior", "90 %", "posterior", "90 %", "simulated", "90 %", "design effect")
HELD_OUT = ("held out", "figure", "published", "median", "80 % interval", "inside")
SCORES = ("held out", "fitted on", "log score", "prior", "gain over the prior")
PARAMETERS = (
    "parameter",
    "",
    "meaning",
    "prior 5 / 50 / 95 %",
    "posterior",
    "contraction",
    "recovery r",
    "coverage",
)
EMULATED = ("outcome", "condition", "z sd", "log score", "baseline", "gain")
SPENT = ("condition", "trials", "minimum", "lower quartile", "median", "upper quartile", "maximum")
DIFFERENCES = ("difference [s]", "all trials", "groups of six, median", "90 % interval")
CURVES = ("condition", "people", "first trial", "last trial", "slope per trial")
_MOODS = {phrases.IDENTIFIED: "good", phrases.WEAKLY: "quiet", phrases.NOT: "bad"}
_VERDICTS = {"passed": "good", "failed": "bad", "not judged": "quiet"}


def gates(found: Sequence[Gate]) -> Rows:
    """Every criterion and its verdict."""
    return [[gate.name, gate.asks, gate.found, Mark(gate.verdict, _VERDICTS[gate.verdict])] for gate in found]


def table(rows: Sequence[FigurePrediction]) -> Rows:
    """The eight published figures, each compared with simulated study groups [%]."""
    return [
        [
            phrases.figure(row.figure),
            phrases.percent(row.published),
            phrases.percent(row.band.median),
            phrases.span(row.band, 100.0),
            phrases.percent(row.mean),
            mark(row.inside),
            phrases.signed(100.0 * (row.band.median - row.published)),
            f"±{100.0 * row.tolerance:.0f}",
            mark(row.close),
        ]
        for row in rows
    ]


def counts(found: PublishedStudy) -> Rows:
    """Published counts, and which of them are inferred."""
    return [
        [
            phrases.figure(one.figure),
            f"{one.k} / {one.n}",
            phrases.percent(one.k / one.n),
            Mark("inferred", "bad") if one.inferred else Mark("derived", "quiet"),
            one.note,
        ]
        for one in found.counts
    ]


def predictive(rows: Sequence[PredictedFigure], published: dict[str, float]) -> Rows:
    """The figures before and after the fit [%]."""
    return [
        [
            phrases.figure(row.figure),
            phrases.percent(published.get(row.figure)),
            phrases.percent(row.prior.median),
            phrases.span(row.prior, 100.0),
            phrases.percent(row.posterior.median),
            phrases.span(row.posterior, 100.0),
            phrases.percent(row.simulated.median) if row.simulated else "–",
            phrases.span(row.simulated, 100.0) if row.simulated else "–",
            "–" if row.design_effect is None else f"{row.design_effect:.2f}",
        ]
        for row in rows
    ]


def held_out(parts: Sequence[HeldOutCondition]) -> Rows:
    """Each figure of each condition that was left out [%]; a missing figure is marked."""
    rows: Rows = []
    for part in parts:
        known = {row.figure: row for row in part.figures}
        for metric in ("sr", "twsr", "adoption"):
            row = known.get(f"{metric} {part.condition}")
            head: list[Cell] = [phrases.CONDITION[part.condition], phrases.METRIC[metric]]
            if row is None:
                rows.append([*head, "–", "–", "–", Mark("does not exist", "quiet")])
                continue
            numbers = [phrases.percent(row.published), phrases.percent(row.band.median), phrases.span(row.band, 100.0)]
            rows.append([*head, *numbers, mark(row.inside)])
    return rows


def scores(parts: Sequence[HeldOutCondition], rivals: Sequence[str]) -> Rows:
    """Log scores [nats] of each condition that was left out, and the gains over other models."""
    return [
        [
            phrases.CONDITION[part.condition],
            phrases.listed(phrases.CONDITION[name] for name in part.fitted),
            phrases.signed(part.log_score, 2),
            phrases.signed(part.log_score_prior, 2),
            phrases.signed(part.log_score - part.log_score_prior, 2),
            *(_gain(part, name) for name in rivals),
        ]
        for part in parts
    ]


def _gain(part: HeldOutCondition, rival: str) -> str:
    return phrases.signed(part.log_score - part.rivals[rival], 2) if rival in part.rivals else "–"


def parameters(parts: Sequence[ParameterFinding]) -> Rows:
    """What the published numbers say about each parameter."""
    return [
        [
            one.name,
            Mark(phrases.identified(one), _MOODS[phrases.identified(one)]),
            f"{one.meaning} [{one.unit}]" if one.unit else one.meaning,
            _three(one.prior),
            _three(one.posterior),
            f"{max(0.0, one.contraction):.2f}",
            "–" if one.recovery is None else phrases.signed(one.recovery, 2).lstrip("+"),
            "–" if one.coverage is None else f"{one.coverage:.2f}",
        ]
        for one in parts
    ]


def _three(band: Band) -> str:
    """Three quantiles with three digits each, never as powers of ten."""
    return " / ".join(_short(value) for value in (band.low, band.median, band.high))


def _short(value: float) -> str:
    digits = 0 if abs(value) >= 100.0 else 1 if abs(value) >= 10.0 else 2 if abs(value) >= 0.1 else 3
    return f"{value:.{digits}f}".replace("-", "−")


def emulated(parts: Sequence[EmulatorFit]) -> Rows:
    """How good each emulator is."""
    return [
        [
            one.outcome,
            phrases.CONDITION.get(one.condition, one.condition),
            phrases.plain(one.z_sd),
            phrases.plain(one.score, 3),
            phrases.plain(one.baseline, 3),
            "–" if one.score is None or one.baseline is None else phrases.signed(one.score - one.baseline, 3),
        ]
        for one in parts
    ]


def spent(parts: Sequence[TimeSpent]) -> Rows:
    """Time spent [s]."""
    return [
        [
            phrases.CONDITION[one.condition],
            str(one.trials),
            *(f"{value:.1f}" for value in (one.least, one.lower, one.median, one.upper, one.most)),
        ]
        for one in parts
    ]


def differences(parts: Sequence[TimeDifference]) -> Rows:
    """Differences of the time spent [s]."""
    return [
        [
            f"{one.statistic}, {phrases.CONDITION[one.a]} minus {phrases.CONDITION[one.b]}",
            phrases.signed(one.value),
            phrases.signed(one.group.median),
            phrases.span(one.group),
        ]
        for one in parts
    ]


def curves(parts: Sequence[TrustCurve]) -> Rows:
    """Trust in a session, 1 to 7, with standard errors."""
    return [
        [
            phrases.CONDITION[one.condition],
            str(one.people[0]),
            f"{one.mean[0]:.2f} ± {one.se[0]:.2f}",
            f"{one.mean[-1]:.2f} ± {one.se[-1]:.2f}",
            f"{phrases.signed(one.slope, 3)} ± {one.slope_se:.3f}",
        ]
        for one in parts
    ]


def models(parts: Sequence[ModelFigures]) -> Rows:
    """Several human models: the eight figures of each [%]."""
    return [[one.name, *(phrases.percent(one.figures.get(name)) for name in FIGURES), str(one.trials)] for one in parts]


MODELS = ("people", *(phrases.figure(name) for name in FIGURES), "trials")
RANKINGS = ("suite", "draws", "trials per robot", "SR order [%]", "TWSR order [%]", "both [%]")


def rankings(parts: Sequence[RobotRanking]) -> Rows:
    """The share of posterior draws that rank the robots oracle > frontier > none."""
    return [
        [
            one.suite,
            str(one.draws),
            str(one.trials),
            *(phrases.percent(value) for value in (one.sr, one.twsr, one.both)),
        ]
        for one in parts
    ]


def pairs(parts: Sequence[ParameterSwing]) -> list[tuple[str, str]]:
    """The pairs of robots of some swings, in words."""
    found = dict.fromkeys((one.better, one.worse) for one in parts)
    return [(phrases.CONDITION[better], phrases.CONDITION[worse]) for better, worse in found]


def swings(parts: Sequence[ParameterSwing], known: Sequence[ParameterFinding]) -> Rows:
    """How each parameter changes the gaps between robots [points]; parameters that are not identified come first."""
    said = {one.name: phrases.identified(one) for one in known}
    names = sorted(dict.fromkeys(one.name for one in parts), key=lambda name: said.get(name) != phrases.NOT)
    rows: Rows = []
    for name in names:
        own = [one for one in parts if one.name == name]
        worst = [one.ordered for one in own if one.ordered is not None]
        word = said.get(name, phrases.NOT)
        rows.append(
            [
                name,
                Mark(word, _MOODS[word]),
                *(f"{phrases.signed(100.0 * one.low)} → {phrases.signed(100.0 * one.high)}" for one in own),
                phrases.percent(min(worst)) if worst else "–",
            ]
        )
    return rows
