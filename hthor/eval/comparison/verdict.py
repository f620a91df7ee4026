"""The verdict on two runs in words."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hthor.eval.statistics import power

if TYPE_CHECKING:
    from hthor.eval.comparison.comparison import Comparison


def verdict_sentence(pair: Comparison) -> str:
    """Which run is better and by how much, or that these data cannot tell and how many more tasks would."""
    found = pair.differences["sr"]
    points = 100.0 * found.difference
    if pair.interval is None:
        return f"One trial cannot separate {pair.second} from {pair.first}."
    low, high = (100.0 * end for end in pair.interval)
    if pair.better:
        sign, worse = (1.0, pair.first) if pair.better == pair.second else (-1.0, pair.second)
        ends = sorted((sign * low, sign * high))
        return (
            f"{pair.better} is better than {worse} by {sign * points:.1f} points of success "
            f"({_evidence(pair, f'{ends[0]:.1f} to {ends[1]:.1f}')})."
        )
    told = (
        f"These data cannot separate {pair.second} from {pair.first}: {points:+z.1f} points of success "
        f"({_evidence(pair, f'{low:+z.1f} to {high:+z.1f}')})"
    )
    if pair.mcnemar and not pair.mcnemar.only_first + pair.mcnemar.only_second:
        return f"{told}; success was the same in every trial."
    if found.separated:
        return f"{told}; it would count alone ({_chance(found.p)}), but not among {pair.among} comparisons."
    if found.difference == 0.0 or found.more_tasks is None:
        return f"{told}; a difference of {100.0 * (found.mde80 or 0.0):.1f} points would have shown."
    if found.more_tasks == 0:
        return f"{told}; {pair.sessions} sessions are too few to tell, however many tasks they have."
    alone = " to a comparison of these two alone" if pair.among > 1 else ""
    each = " in each group" if pair.groups_of else ""
    return (
        f"{told}; if it is real, about {power.rounded_count(found.more_tasks)} more tasks{each} would show it{alone}."
    )


def _evidence(pair: Comparison, ends: str) -> str:
    """The verdict's interval, p and number of trials; for several comparisons it says that they are adjusted."""
    trials = f"{pair.n} shared trial{'' if pair.n == 1 else 's'}"
    if pair.groups_of:
        one, other = pair.groups_of
        trials = f"{other.trials} trials of {other.people} people against {one.trials} of {one.people} other people"
    if pair.among == 1:
        return f"95 % interval {ends}, {_chance(pair.p_holm)}, {trials}"
    return f"interval {ends} and {_chance(pair.p_holm)} are adjusted for {pair.among} comparisons; {trials}"


def _chance(p: float | None) -> str:
    """A p-value in words, with no more digits than are useful."""
    p = 1.0 if p is None else p
    return "p < 0.001" if p < 0.001 else f"p = {p:.3f}"
