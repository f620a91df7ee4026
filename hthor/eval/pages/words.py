"""What the findings say, as sentences made from the numbers; holds no result, and claims none that they do not show."""

from __future__ import annotations

from collections.abc import Sequence

from hthor.eval.pages.findings import Curve, Findings, Shown, Spent, Split, Uplift
from hthor.eval.pages.numbers import listed, plain, signed

_CLEAR = 2.0
"""A slope of so many standard errors is called one."""


def lead(found: Findings) -> str:
    """Whether each robot helps, and by how much."""
    if not found.baseline:
        return (
            "There is no run without a robot among these, so whether the robots help cannot be said: "
            "'hthor eval --agent silent' on the same suite makes one."
        )
    if not found.uplift:
        return "There is only a run without a robot."
    return " ".join(_helps(one) for one in found.uplift)


def _helps(one: Uplift) -> str:
    if not one.pairs or one.sr.mean is None or one.sr.ci95 is None:
        return f"{_upper(one.arm)} shares no trial with the run without a robot."
    low, high = one.sr.ci95
    span = f"{signed(100.0 * one.sr.mean)} points [{signed(100.0 * low)} … {signed(100.0 * high)}], {one.pairs} pairs"
    if low > 0.0:
        return f"With {one.arm}, people succeed more often than alone: {span}."
    if high < 0.0:
        return f"With {one.arm}, people succeed less often than alone: {span}."
    return f"Whether people succeed more often with {one.arm} than alone, these data cannot tell: {span}."


def published(found: Findings) -> str:
    """What the paper's figures are, and whether these runs can be set against them."""
    study = found.published
    if study is None:
        return ""
    text = f"(P) and diamonds: {study.source}. "
    if found.suite.name == study.suite:
        return text + "These runs are of its tasks."
    return (
        text + f"Its tasks are the suite '{study.suite}'; these runs are of '{found.suite.name}', so the order of the "
        "robots may be compared, absolute figures may not."
    )


def spent(parts: Sequence[Spent]) -> str:
    """Where the boxes differ."""
    each = listed(f"{one.arm} {one.lower:.1f} / {one.median:.1f} / {one.upper:.1f} s" for one in parts)
    text = f"Quartiles: {each}."
    if len(parts) > 1:
        lowers, medians = [one.lower for one in parts], [one.median for one in parts]
        text += (
            f" The lower quartiles lie within {max(lowers) - min(lowers):.1f} s of one another, the medians within "
            f"{max(medians) - min(medians):.1f} s."
        )
    return text


def trust(curves: Sequence[Curve]) -> str:
    """Whether trust rises or falls over a session."""
    return " ".join(_trend(curve) for curve in curves)


def _trend(curve: Curve) -> str:
    if curve.slope is None or curve.slope_se is None:
        return f"Trust in {curve.arm}: too few people for a trend."
    size = f"{signed(curve.slope, 3)} points a trial, standard error {plain(curve.slope_se, 3)}"
    if abs(curve.slope) < _CLEAR * curve.slope_se or curve.slope == 0.0:
        return f"Trust in {curve.arm} shows no clear trend ({size})."
    return f"Trust in {curve.arm} {'rises' if curve.slope > 0 else 'falls'} ({size})."


def widest(split: Split, baseline: str) -> str:
    """In which part the robots make the largest difference, where as many trials without one stand against them."""
    gaps = [
        (one.mean - alone.mean, label, group.name)
        for group in split.groups
        if (alone := group.sr.get(baseline)) is not None and alone.mean is not None
        for label, one in group.sr.items()
        if label != baseline and one.mean is not None and one.n == alone.n
    ]
    if not gaps:
        return ""
    gap, label, name = max(gaps)
    least, other, where = min(gaps)
    return (
        f"By {split.word}, the largest gain over no robot is {signed(100.0 * gap)} points ({label}, {name}), the "
        f"smallest {signed(100.0 * least)} ({other}, {where}). With so many parts, extremes are partly chance."
    )


def shown(one: Shown) -> str:
    """What became of a trial that is drawn."""
    end = f"done in {one.time_s:.1f} s" if one.met else f"not done in {one.time_s:.0f} s"
    text = f"“{one.instruction}” ({one.task}, person {one.participant}, trial {one.index + 1}): {end}"
    if one.alone_s is not None:
        alone = f"done in {one.alone_s:.1f} s" if one.alone_met else f"not done in {one.alone_s:.0f} s"
        text += f"; alone, the same person: {alone}"
    text += f". T* {one.t_star:.1f} s."
    if one.gain_s is None:
        return text
    return text + (f" Saved {one.gain_s:.1f} s." if one.gain_s >= 0.0 else f" Lost {-one.gain_s:.1f} s.")


def _upper(text: str) -> str:
    return text[:1].upper() + text[1:]
