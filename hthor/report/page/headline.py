"""The page's first sentence: what was compared, and which robot is better by how much, if the data can tell."""

from collections.abc import Sequence

from hthor.eval.comparison.comparison import Comparison
from hthor.report.analysis.document import Findings
from hthor.report.html.number_format import listed, signed
from hthor.report.page import sentences

_MANY = 6
"""If there are more pairs, the sentence has only those of the best robot."""


def headline(found: Findings) -> str:
    """Say which robot is better."""
    if not found.comparisons:
        return _alone(found)
    many = len(found.comparisons) > _MANY
    pairs = _of_the_best(found) if many else found.comparisons
    counts = {pair.n for pair in pairs}
    over = f"the same {counts.pop()} trials" if len(counts) == 1 else "the trials that they share"
    if any(pair.groups_of for pair in pairs):
        over = "groups of different people at the same tasks"
    said = [f"Over {over}, {'; '.join((*_better(found, pairs), *_unsure(pairs)))}."]
    among = max(pair.among for pair in found.comparisons)
    said += [f"These intervals are adjusted for {among} comparisons."] if among > 1 else []
    if many and found.uplift:
        better = sum(pair.better == pair.second for pair in found.uplift)
        said.append(f"{better or 'None'} of {len(found.uplift)} robots are better than no robot.")
    said += ["Section 2 has all pairs."] if many else []
    said += [] if found.baseline else [sentences.without_baseline(found)]
    return " ".join(said)


def _alone(found: Findings) -> str:
    rates = listed(
        f"{arm.label} in {100.0 * one.mean:.1f} %" + ("" if one.ci95 is None else _between(one.ci95))
        for arm in found.arms
        if (one := arm.scores["sr"]).mean is not None
    )
    if found.baseline and len(found.arms) == 1:
        return f"There is only a run without a robot: people succeed in {rates} of its trials."
    text = f"People succeed with {rates} of the trials."
    return text if found.apart and found.baseline else f"{text} {sentences.without_baseline(found)}"


def notable_comparisons(found: Findings) -> Sequence[Comparison]:
    """The comparisons that the results section puts into words."""
    if len(found.comparisons) <= _MANY:
        return found.comparisons
    best = _of_the_best(found)
    return [pair for pair in found.comparisons if pair in found.uplift or pair in best]


def _of_the_best(found: Findings) -> list[Comparison]:
    """The comparisons of the most successful robot with the second and with no robot."""
    ranked = sorted(found.arms, key=lambda arm: -(arm.scores["sr"].mean or 0.0))
    robots = [arm.label for arm in ranked if arm.label != found.baseline]
    others = {*robots[1:2], found.baseline}
    return [
        pair
        for pair in found.comparisons
        if robots[0] in (pair.first, pair.second) and _other(pair, robots[0]) in others
    ]


def _better(found: Findings, pairs: Sequence[Comparison]) -> list[str]:
    """Say which robots are better than which others, the best first."""
    rates = {arm.label: arm.scores["sr"].mean or 0.0 for arm in found.arms}
    said = []
    for name in sorted(rates, key=lambda label: -rates[label]):
        won = [pair for pair in pairs if pair.better == name]
        won.sort(key=lambda pair: -rates[_other(pair, name)])
        each = [f"than {_other(pair, name)} by {_points(pair, name, first=k == 0)}" for k, pair in enumerate(won)]
        said += [f"{name} is better {listed(each)}"] if each else []
    return said


def _unsure(pairs: Sequence[Comparison]) -> list[str]:
    """Say which robots the data cannot tell apart."""
    each: list[str] = []
    for pair in pairs:
        if not pair.better:
            one = pair.differences["sr"]
            ends = "" if pair.interval is None else _between(pair.interval, sign=True)
            unit = "" if each else " points of success"
            each.append(f"{pair.second} from {pair.first} ({signed(100.0 * one.difference)}{unit}{ends})")
    return [f"these data cannot tell {listed(each, last='or')}"] if each else []


def _other(pair: Comparison, name: str) -> str:
    return pair.first if pair.second == name else pair.second


def _points(pair: Comparison, name: str, *, first: bool) -> str:
    one = pair.differences["sr"]
    sign = 1.0 if pair.second == name else -1.0
    ends = sorted(sign * end for end in pair.interval) if pair.interval is not None else None
    unit = " points of success" if first else ""
    return f"{100.0 * sign * one.difference:.1f}{unit}{_between(ends) if ends else ''}"


def _between(ends: Sequence[float], *, sign: bool = False) -> str:
    low, high = (signed(100.0 * end) if sign else f"{100.0 * end:.1f}".replace("-", "−") for end in ends)
    return f" [{low}, {high}]"
