"""Findings as rows of words and numbers for the page's tables; knows nothing of how they look."""

from __future__ import annotations

from collections.abc import Sequence

from hthor.eval.pages.findings import Curve, Failure, Findings, Origin, Published, Spent, Split, Uplift
from hthor.eval.pages.html import Cell, Mark
from hthor.eval.pages.numbers import listed, percent, plain, signed
from hthor.eval.stats import Estimate

Rows = list[list[Cell]]
_METRICS = (
    ("sr", "success rate [%]", 100.0),
    ("twsr", "time-weighted success [%]", 100.0),
    ("adoption", "adoption [%]", 100.0),
    ("progress", "progress [%]", 100.0),
    ("time_s", "time spent [s]", 1.0),
    ("trust", "trust, 1 to 7", 1.0),
    ("sent", "messages a trial", 1.0),
    ("accepted", "of these accepted", 1.0),
    ("idle_s", "person idle [s]", 1.0),
    ("hindered_s", "person hindered [s]", 1.0),
)
_ONLY_WHERE_KNOWN = ("progress",)
UPLIFT = ("against no robot", "pairs", "success [points]", "time-weighted [points]", "time saved [s]", "won", "lost")
SPENT = ("robot", "trials", "minimum", "lower quartile", "median", "upper quartile", "maximum", "unsolved")
CURVES = ("robot", "people", "first trial", "last trial", "slope a trial")
FAILURES = ("run", "whose", "fault", "trials", "first in", "after", "it said")
ORIGINS = (
    *("run", "robots", "people", "population", "seed", "trials", "with a fault"),
    *("configuration", "code", "rules", "log"),
)


def scores_head(found: Findings) -> tuple[str, ...]:
    """The robots, and the paper's columns where there are such."""
    return ("mean [95 % interval]", *(arm.label for arm in found.arms), *(f"{name} (P)" for name in _published(found)))


def scores(found: Findings) -> Rows:
    """Every main metric of every run, with the published figures of its condition at the right."""
    rows: Rows = []
    for metric, title, scale in _METRICS:
        held = [getattr(arm.scores, metric) for arm in found.arms]
        if metric in _ONLY_WHERE_KNOWN and not any(one.n for one in held):
            continue
        printed = [_figure(found.published, metric, condition) for condition in _published(found).values()]
        rows.append([title, *(estimate(one, scale) for one in held), *printed])
    return rows


def _published(found: Findings) -> dict[str, str]:
    """The conditions of the study that have a run here, in the study's order, by name."""
    if found.published is None:
        return {}
    here = {arm.condition for arm in found.arms}
    words = {"no robot": "none", "frontier": "frontier", "oracle": "oracle"}
    return {word: name for word, name in words.items() if name in here}


def _figure(published: Published | None, metric: str, condition: str) -> str:
    value = published.figures.get(f"{metric} {condition}") if published is not None else None
    return percent(value)


def estimate(one: Estimate, scale: float = 100.0, *, sign: bool = False) -> str:
    """A mean with its interval: "66.7 [45.1 … 85.0]"."""
    if one.mean is None or one.ci95 is None:
        return "–"
    low, high = (scale * end for end in one.ci95)
    if sign:
        return f"{signed(scale * one.mean)} [{signed(low)} … {signed(high)}]"
    return f"{plain(scale * one.mean, 1)} [{plain(low, 1)} … {plain(high, 1)}]"


def uplift(parts: Sequence[Uplift]) -> Rows:
    """Paired differences, and how many trials were solved only with the robots, and only without."""
    return [
        [
            one.arm,
            str(one.pairs),
            estimate(one.sr, sign=True),
            estimate(one.twsr, sign=True),
            estimate(one.saved_s, 1.0, sign=True),
            str(one.wins),
            str(one.losses),
        ]
        for one in parts
    ]


def spent(parts: Sequence[Spent]) -> Rows:
    """Time spent [s]."""
    return [
        [
            one.arm,
            str(one.trials),
            *(f"{value:.1f}" for value in (one.least, one.lower, one.median, one.upper, one.most)),
            str(one.unsolved),
        ]
        for one in parts
    ]


def curves(parts: Sequence[Curve]) -> Rows:
    """Trust in a session, 1 to 7, with standard errors."""
    return [
        [
            one.arm,
            str(max(one.people)),
            _with_error(one.mean[0], one.se[0]),
            _with_error(one.mean[-1], one.se[-1]),
            "–" if one.slope is None else f"{signed(one.slope, 3)} ± {plain(one.slope_se, 3)}",
        ]
        for one in parts
    ]


def _with_error(mean: float, error: float | None) -> str:
    return plain(mean) if error is None else f"{plain(mean)} ± {plain(error)}"


def split_head(one: Split) -> tuple[str, ...]:
    """The thing that trials are parted by, and the robots."""
    return (one.word, "trials", *dict.fromkeys(label for group in one.groups for label in group.sr))


def split(one: Split) -> Rows:
    """Success rates [%] within each part."""
    labels = split_head(one)[2:]
    rows: Rows = []
    for group in one.groups:
        counts = sorted({held.n for held in group.sr.values()})
        rates = [estimate(group.sr[label]) if label in group.sr else "–" for label in labels]
        rows.append([group.name, " to ".join(str(count) for count in dict.fromkeys((counts[0], counts[-1]))), *rates])
    return rows


def failures(parts: Sequence[Failure]) -> Rows:
    """Every sort of fault, worst first."""
    return [
        [
            one.run,
            f"{one.seat}: {one.agent}",
            Mark(one.kind, "bad"),
            str(one.trials),
            f"{one.task} ({one.key})",
            f"{one.after_s:.1f} s",
            one.last or "–",
        ]
        for one in sorted(parts, key=lambda one: -one.trials)
    ]


def origins(parts: Sequence[Origin]) -> Rows:
    """Where every run came from, hashes by their first ten digits; the document has them whole."""
    return [
        [
            one.name,
            "; ".join(_robot(robot.robot, robot.agent.name, robot.agent.sha256) for robot in one.robots),
            f"{one.humans.name} ({one.humans.sha256[:10]})",
            f"{one.humans.population} ({one.humans.population_sha256[:10]})" if one.humans.population else "none",
            str(one.seed),
            str(one.trials) if one.trials == one.whole else f"{one.trials} of {one.whole}",
            str(one.faulty),
            *(sha[:10] for sha in (one.run_sha256, one.code_sha256, one.rules_sha256, one.trials_sha256)),
        ]
        for one in parts
    ]


def _robot(body: str, agent: str, sha256: str) -> str:
    return f"{body} with {agent} ({sha256[:10]})" if body else f"{agent} ({sha256[:10]})"


def notes(found: Findings) -> list[str]:
    """What a reader has to know before comparing: unfinished runs, people out of their range, unequal code."""
    said = [
        f"{one.name} is not finished: {one.whole - one.trials} of {one.whole} trials are missing."
        for one in found.origins
        if one.trials < one.whole
    ]
    said += dict.fromkeys(
        f"People not calibrated for this: {note}." for one in found.origins for note in one.humans.notes
    )
    if len({one.code_sha256 for one in found.origins}) > 1:
        said.append("These runs were played by different versions of the code; differences may come from that.")
    alone = next((arm for arm in found.arms if arm.label == found.baseline), None)
    whose = [one.arm for one in found.uplift if alone is not None and one.pairs < alone.trials]
    if whose:
        said.append(f"Not every trial of {listed(whose)} has its pair without a robot; pairs are counted.")
    return said
