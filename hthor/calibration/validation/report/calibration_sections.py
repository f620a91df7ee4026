"""The page's sections on a calibration; without a calibration, each section has a sentence that says so."""

import msgspec

from hthor.calibration.evidence import Evidence
from hthor.calibration.targets import CONDITIONS
from hthor.calibration.validation.report import phrases, tables
from hthor.calibration.validation.report.figures import diagnostics, predictions
from hthor.calibration.validation.report.findings import Findings
from hthor.report.html import elements, matplotlib_svg


def predictive(found: Findings) -> list[str]:
    """Section 3: prior and posterior predictive."""
    evidence = found.evidence
    if evidence is None or not evidence.predictive:
        return _without(found, "there is no comparison before and after a fit")
    return [
        elements.paragraph(
            "The figures of study groups of six whose population is drawn from the prior, and from the posterior. "
            "Unlike the groups of section 2, each group here has a population of its own, so that the intervals "
            "include the uncertainty of the population."
        ),
        elements.paragraph(phrases.simulated(evidence)) if evidence.simulated_studies else "",
        elements.table(tables.PREDICTIVE, tables.predictive(evidence.predictive, found.published.figures)),
        elements.figure(
            matplotlib_svg.to_svg(
                predictions.before_after(evidence.predictive, found.published.figures),
                "predictive",
                "Prior and posterior predictive intervals of the published figures",
            ),
            "Grey: prior predictive. Colour: posterior predictive. Diamonds: published.",
        ),
    ]


def held_out(found: Findings) -> list[str]:
    """Section 4: each condition left out of the fit."""
    evidence = found.evidence
    own = {found.own.played.name: found.own, **{one.played.name: one for one in found.rivals}}
    if evidence is None or not evidence.held_out:
        known = [name for name in CONDITIONS if name in found.own.log_score]
        scores = [[name, *(phrases.signed(one.log_score[where], 2) for where in known)] for name, one in own.items()]
        heads = ("human model", *(phrases.CONDITION[name] for name in known))
        return [
            *_without(found, "no condition can be left out of a fit"),
            elements.table(heads, scores, "Log score of the published counts and ratios [nats], higher is better"),
        ]
    rivals = sorted({name for part in evidence.held_out for name in part.rivals})
    return [
        elements.paragraphs(phrases.held_out(evidence.held_out)),
        elements.table(tables.HELD_OUT, tables.held_out(evidence.held_out), "All nine numbers [%]", words=(0, 1, 5)),
        elements.figure(
            matplotlib_svg.to_svg(
                predictions.held_out(evidence.held_out), "heldout", "Held-out conditions and their predictions"
            ),
            "Each condition as predicted from the other two: median and 80 % interval. Diamonds: published.",
        ),
        elements.table(
            (*tables.SCORES, *(f"over {name}" for name in rivals)),
            tables.scores(evidence.held_out, rivals),
            "Log predictive density of the published counts and ratio [nats]",
            words=(0, 1),
        ),
        elements.figure(
            matplotlib_svg.to_svg(predictions.scores(found), "scores", "Log scores of held-out conditions"),
            "Log scores by condition. A gain of one nat makes the published data 2.7 times as likely.",
        ),
    ]


def parameters(found: Findings) -> list[str]:
    """Section 5: contraction and recovery."""
    evidence = found.evidence
    if evidence is None or not evidence.parameters:
        return _without(found, "no parameter was fitted")
    return [
        elements.paragraphs(phrases.parameters(evidence.parameters)),
        elements.paragraph(
            f"A parameter counts as {phrases.IDENTIFIED} when its posterior contracts by {phrases.CONTRACTS} or more "
            "(1 − posterior variance / prior variance, on the prior's own scale) and simulated studies recover it with "
            f"r of {phrases.RECOVERS} or more; as {phrases.WEAKLY} from {phrases.CONTRACTS_WEAKLY} and "
            f"{phrases.RECOVERS_WEAKLY}.",
            "soft",
        ),
        elements.figure(
            matplotlib_svg.to_svg(
                diagnostics.contraction(evidence.parameters), "contraction", "Contraction and recovery"
            ),
            "Bars: contraction. Rings: correlation of true values and posterior means over simulated studies.",
        ),
        elements.table(tables.PARAMETERS, tables.parameters(evidence.parameters), words=(0, 1, 2)),
    ]


def coverage(found: Findings) -> list[str]:
    """Section 6: coverage and ranks in simulated studies."""
    evidence = found.evidence
    if evidence is None or evidence.coverage is None:
        return _without(found, "there are no intervals to check")
    ranked = [one for one in evidence.parameters if one.ranks]
    drawn = elements.figure(
        matplotlib_svg.to_svg(diagnostics.ranks(ranked), "ranks", "Ranks of the true values among posterior draws"),
        "Simulation-based calibration: ranks of the truth among posterior draws. They should be flat; 95 of 100 bars "
        "of a correct posterior end in the shaded band. Peak inside: intervals too wide; at the ends: too narrow.",
    )
    return [elements.paragraph(phrases.coverage(evidence.coverage)), drawn if ranked else ""]


def emulator(found: Findings) -> list[str]:
    """Section 7: emulator and ABC."""
    evidence = found.evidence
    if evidence is None or not evidence.emulated:
        return _without(found, "no emulator was needed")
    drawn = elements.figure(
        matplotlib_svg.to_svg(
            diagnostics.reliability(evidence.emulated), "reliability", "Predicted and observed frequency"
        ),
        "Trials that the emulators were not trained on, by predicted probability. The dashed line is perfect.",
    )
    return [
        elements.paragraph(phrases.emulator(evidence)),
        elements.table(
            tables.EMULATED,
            tables.emulated(evidence.emulated),
            "z sd: sd of errors on whole studies. Log score: per held-out trial [nats]; baseline: predicting the mean",
            words=(0, 1),
        ),
        drawn if any(one.bins for one in evidence.emulated) else "",
        elements.paragraph(phrases.cross_check(evidence.abc)) if evidence.abc else "",
        elements.table(
            ("parameter", "shift of the median [posterior sd]", "standard error"),
            [[one.name, phrases.signed(one.shift, 2), phrases.plain(one.error)] for one in evidence.abc],
        )
        if evidence.abc
        else "",
    ]


def ranking(found: Findings) -> list[str]:
    """Section 9: rankings over draws, parameters, suites and kinds of people."""
    return [*_draws(found, found.evidence), *_suites(found), *_kinds(found)]


def _draws(found: Findings, evidence: Evidence | None) -> list[str]:
    if evidence is None or not evidence.rankings:
        return _without(found, "there are no draws to rank the robots by")
    parts = [
        elements.paragraphs(phrases.ranking(one) for one in evidence.rankings),
        elements.table(tables.RANKINGS, tables.rankings(evidence.rankings)),
    ]
    home = evidence.rankings[0]
    if home.swings:
        drawing = matplotlib_svg.to_svg(
            diagnostics.swings(home.swings), "swings", "What each parameter does to the gaps"
        )
        parts += [
            elements.paragraphs(phrases.swings(home, evidence.parameters)),
            elements.figure(
                drawing,
                "Mean gap in success between two robots with one parameter at the low and at the high end of its prior "
                "and the others at posterior draws.",
            ),
            elements.table(
                ("parameter", "", *(f"SR {a} minus {b}" for a, b in tables.pairs(home.swings)), "worst order [%]"),
                tables.swings(home.swings, evidence.parameters),
                "From the low to the high end of the prior [points]; share of draws in order at the worst end",
                words=(0, 1),
            ),
        ]
    return parts


def _suites(found: Findings) -> list[str]:
    if not found.suites:
        return []
    return [
        "<h3>By suite</h3>",
        elements.paragraph(phrases.suites(found)),
        elements.table(
            ("suite", *tables.MODELS[1:]),
            tables.models((msgspec.structs.replace(found.own.played, name=found.setting.suite), *found.suites)),
            "Means [%]",
        ),
    ]


def _kinds(found: Findings) -> list[str]:
    if not found.kinds:
        return []
    return [
        "<h3>By kind of people</h3>",
        elements.paragraph(phrases.kinds(found)),
        elements.table(tables.MODELS, tables.models(found.kinds), "Means [%]"),
    ]


def _without(found: Findings, so: str) -> list[str]:
    why = found.evidence_missing or "The calibration has no evidence on this."
    return [elements.paragraph(f"{why} So {so}.", "note")]
