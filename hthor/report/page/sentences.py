"""Puts a report's numbers into sentences."""

import re
from collections.abc import Mapping, Sequence

from hthor.eval.comparison.comparison import Comparison
from hthor.eval.results.paired_difference import Difference
from hthor.report.analysis.document import Arm, ExampleTrial, Findings, IncomparablePair, Split, TimeSpent, TrustCurve
from hthor.report.html.number_format import listed, plain, signed

_NAMED = 4
"""How many robots the title names at most."""
_CLEAR = 2.0
"""A slope of at least this many standard errors is called a trend."""
_APART = {
    "": "they have no trial in common yet; finish both",
    "suite.sha256": "they have different tasks",
    "kind.sha256": "their kind of task comes from different files",
    "humans.sha256": "they have different human models",
    "design.study": "they are not of the same study, so other groups of people took part",
    "seed": "their seeds differ, so the participants and tasks do",
    "rules_sha256": "they were played under different rules",
    "code_sha256": "they were played by different versions of the code",
}


def page_title(found: Findings) -> str:
    """The page's title."""
    robots = [arm.label for arm in found.arms if arm.label != found.baseline]
    against = " against no robot" if found.baseline and robots else ""
    named = listed(robots or [found.baseline]) if len(robots) <= _NAMED else f"{len(robots)} robots"
    return f"{_upper(named)}{against}, on the suite {found.suite.name}"


def page_facts(found: Findings) -> str:
    """How many runs, trials, tasks and people the page is about."""
    trials = sum(one.trials for one in found.origins)
    tasks, people = max(arm.tasks for arm in found.arms), max(arm.people for arm in found.arms)
    if any(pair.groups_of for pair in found.comparisons):
        people = sum(arm.people for arm in found.arms)
    runs = "1 run" if len(found.origins) == 1 else f"{len(found.origins)} runs"
    who = found.people if found.by_people is None else f"{found.people}; by kind of person others too"
    return f"{runs}, {trials} trials: {tasks} tasks, {people} {'person' if people == 1 else 'people'} ({who})."


def without_baseline(found: Findings) -> str:
    """Say that it is unknown whether the robots help, and give the command that would show it."""
    return (
        "There is no run without a robot among these or next to them, so it is unknown whether the robots "
        f"help. This makes one: {found.origins[0].alone}"
    )


def not_comparable(one: IncomparablePair) -> str:
    """Say why two runs are not compared."""
    return f"{_upper(one.first)} and {one.second} are not compared trial by trial: {_APART.get(one.field, one.field)}."


def comparison_sentence(pair: Comparison) -> str:
    """The sentence of `hthor compare` about two runs."""
    return _upper(re.sub(r"(?<=[ (])-(?=\d)", "−", pair.sentence))


def published_figures(found: Findings) -> str:
    """Say where the article's figures come from, and whether these runs can be compared with them."""
    study = found.published
    if study is None:
        return ""
    text = f"Published figures: {study.source}; intervals are Wilson's, from its counts"
    text += (
        ", inferred where it prints only percentages. " if any(one.inferred for one in study.counts.values()) else ". "
    )
    if found.suite.name == study.suite:
        return text + "These runs are of its tasks."
    return (
        text + f"Its tasks are the suite '{study.suite}'; these runs are of '{found.suite.name}', so the order of the "
        "robots may be compared, absolute figures may not."
    )


def time_spent(parts: Sequence[TimeSpent]) -> str:
    """Say how much the times of the runs differ."""
    each = listed(f"{one.arm} {one.median:.1f} s [{one.lower:.1f}, {one.upper:.1f}]" for one in parts)
    text = f"Median [quartiles]: {each}."
    if len(parts) > 1:
        lowers, medians = [one.lower for one in parts], [one.median for one in parts]
        text += (
            f" The lower quartiles lie within {max(lowers) - min(lowers):.1f} s of one another, the medians within "
            f"{max(medians) - min(medians):.1f} s."
        )
    return text


def trust_trend(curves: Sequence[TrustCurve]) -> str:
    """Say whether trust rises or falls over a session."""
    return " ".join(_trend(curve) for curve in curves)


def _trend(curve: TrustCurve) -> str:
    if curve.slope is None or curve.slope_se is None:
        return f"Trust in {curve.arm}: too few sessions for a trend."
    size = f"{signed(curve.slope, 3)} points a trial, standard error {plain(curve.slope_se, 3)}"
    if abs(curve.slope) < _CLEAR * curve.slope_se or curve.slope == 0.0:
        return f"Trust in {curve.arm} shows no clear trend ({size})."
    return f"Trust in {curve.arm} {'rises' if curve.slope > 0 else 'falls'} ({size})."


def messages(arms: Sequence[Arm]) -> str:
    """Say how many messages robots sent, and how many of them were accepted."""
    said = []
    for arm in arms:
        sent, taken, useful = (arm.scores[name] for name in ("sent", "accepted", "first_useful_s"))
        if not sent.mean:
            said.append(f"{_upper(arm.label)} sent no message.")
            continue
        share = 100.0 * (taken.mean or 0.0) / sent.mean
        when = f", the first useful one after {useful.mean:.1f} s" if useful.mean is not None else ""
        said.append(f"Of {sent.mean:.2f} messages a trial from {arm.label} participants accepted {share:.0f} %{when}.")
    return " ".join(said)


def extreme_gains(word: str, gains: Mapping[str, Mapping[str, Difference]]) -> str:
    """Name the groups with the largest and the smallest gain from robots."""
    each = [(one.difference, label, name, one) for name, by in gains.items() for label, one in by.items()]
    if not each:
        return ""
    most, least = max(each, key=lambda one: one[:3]), min(each, key=lambda one: one[:3])
    return (
        f"By {word}, the largest gain over no robot is {_points(most[3])} ({most[1]}, {most[2]}), the smallest "
        f"{_points(least[3])} ({least[1]}, {least[2]}). With so many parts, extremes are partly chance."
    )


def worst_population(split: Split) -> str:
    """Name the people with which each robot does worst."""
    said = []
    for label in dict.fromkeys(label for group in split.groups for label in group.sr):
        rates = [
            (one.mean, group.name) for group in split.groups if (one := group.sr.get(label)) and one.mean is not None
        ]
        if len(rates) > 1:
            said.append(f"{label} {min(rates)[1]} ({100.0 * min(rates)[0]:.1f} %)")
    return f"The people who do worst: with {listed(said)}." if said else ""


def example_trial(one: ExampleTrial) -> str:
    """The outcome of a trial that is drawn."""
    end = f"done in {one.time_s:.1f} s" if one.met else f"not done in {one.time_s:.0f} s"
    text = f"“{one.instruction}” {_upper(end)}"
    if one.alone_s is not None:
        text += f"; alone {f'done in {one.alone_s:.1f} s' if one.alone_met else f'not done in {one.alone_s:.0f} s'}"
    return f"{text}; T*\u00a0{one.t_star:.1f} s. {one.task}, session {one.session}, trial {one.index + 1}."


def time_gained(one: ExampleTrial) -> str:
    """The time that the robots saved in a trial."""
    if one.gain_s is None:
        return "Done." if one.met else "Not done."
    if one.gain_s == 0.0:
        return "No time saved."
    return f"{'Saved' if one.gain_s > 0.0 else 'Lost'} {abs(one.gain_s):.1f} s."


def _points(one: Difference) -> str:
    ends = "" if one.ci95 is None else f" [{', '.join(signed(100.0 * end) for end in one.ci95)}]"
    return f"{signed(100.0 * one.difference)} points{ends}"


def _upper(text: str) -> str:
    return text[:1].upper() + text[1:]


def warnings(found: Findings) -> list[str]:
    """Each warning as one sentence."""
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
    whose = [pair.second for pair in found.uplift if alone is not None and pair.n < alone.trials and not pair.groups_of]
    if whose:
        said.append(f"Not every trial of {listed(whose)} has its partner without a robot; only pairs are compared.")
    return said
