"""A validation as one HTML page that needs no other files, network or scripts.

The first and last sections are here, the sections on the calibration in
`hthor.calibration.validation.report.calibration_sections`.
"""

from html import escape

from hthor.calibration.targets import CONDITIONS
from hthor.calibration.validation.report import calibration_sections, phrases, tables
from hthor.calibration.validation.report.figures import predictions
from hthor.calibration.validation.report.findings import Findings
from hthor.report.html import elements, matplotlib_svg, style

_TITLES = {
    "data": "Data",
    "table": "Published and predicted",
    "predictive": "Before and after the fit",
    "held-out": "Each condition held out",
    "parameters": "What the data say about each parameter",
    "coverage": "Coverage",
    "emulator": "Emulator and cross-check",
    "sessions": "Time spent and trust",
    "ranking": "How firm the ranking of robots is",
    "misfits": "Known misfits",
    "scope": "Scope",
}


def render(found: Findings) -> str:
    """The page, the same bytes for the same findings."""
    bodies = (
        _data(found),
        _table(found),
        calibration_sections.predictive(found),
        calibration_sections.held_out(found),
        calibration_sections.parameters(found),
        calibration_sections.coverage(found),
        calibration_sections.emulator(found),
        _sessions(found),
        calibration_sections.ranking(found),
        [elements.bullets(found.misfits) if found.misfits else elements.paragraph("None that the numbers show.")],
        [elements.paragraph(found.scope, "lead")],
    )
    sections = (
        elements.section(number, name, title, *body)
        for number, ((name, title), body) in enumerate(zip(_TITLES.items(), bodies, strict=True), 1)
    )
    title = f"Validation of {found.subject.name}"
    return elements.page(
        title, (_head(found, title), elements.navigation(_TITLES), *sections, _foot(found)), style.css()
    )


def _head(found: Findings, title: str) -> str:
    subject, setting = found.subject, found.setting
    facts = {
        "people": f"{subject.name}: {subject.purpose}" if subject.purpose else subject.name,
        "human model": subject.model,
        "population": f"{subject.population} ({subject.population_sha256[:10]})" if subject.population else "none",
        "runs": f"{setting.participants} participants in each condition on {setting.suite} "
        f"({setting.suite_sha256[:10]}), {setting.trials} trials, seed {setting.seed}",
        "world": f"version {setting.simulation}, code {setting.code_sha256[:10]}",
    }
    listed = "".join(f"<dt>{escape(name)}</dt><dd>{escape(value)}</dd>" for name, value in facts.items())
    failed = [gate.name for gate in found.gates if gate.verdict == "failed"]
    judged = [gate for gate in found.gates if gate.verdict != "not judged"]
    said = f"{len(judged) - len(failed)} of {len(judged)} judged criteria are met."
    if failed:
        said += f" Failed: {phrases.listed(failed)}."
    notes = list(subject.notes)
    if setting.quick:
        notes.append("Too few people for a verdict. For one, leave out --quick and ask for 18 people or more.")
    return "\n".join(
        (
            f"<h1>{escape(title)}</h1>",
            elements.paragraph(found.scope, "soft"),
            f"<dl>{listed}</dl>",
            elements.paragraph(said, "lead"),
            *(elements.paragraph(note, "note") for note in notes),
            elements.table(tables.GATES, tables.gates(found.gates), words=range(4)),
        )
    )


def _data(found: Findings) -> list[str]:
    published = found.published
    ratios = phrases.listed(
        f"{phrases.CONDITION[name]} {published.ratio[name]:.3f}" for name in CONDITIONS if name in published.ratio
    )
    says = [f"{about}: {text}" for about, text in published.verbal]
    return [
        elements.paragraph(f"Source: {published.source}. Targets “{published.name}”, {published.sha256[:10]}."),
        elements.paragraph(f"Design: {published.design}") if published.design else "",
        elements.table(tables.COUNTS, tables.counts(published), words=(0, 3, 4)),
        elements.paragraph(
            f"TWSR is used as its ratio to SR ({ratios}), because the two are not independent. Each figure of the "
            "study comes from one group of six people, so a model's groups of six are compared with it, not only the "
            "model's mean."
        ),
        "<h3>What the article says in words</h3>" + elements.bullets(says) if says else "",
    ]


def _table(found: Findings) -> list[str]:
    drawing = matplotlib_svg.to_svg(
        predictions.table(found.table), "table", "Published figures and intervals of simulated study groups"
    )
    return [
        elements.paragraph(phrases.verdict(found), "lead"),
        elements.table(tables.TABLE, tables.table(found.table)),
        elements.figure(
            drawing,
            "Diamonds: the published figures, with the distance allowed to the median shaded. Dots and lines: median "
            "and 90 % interval of simulated study groups of six people, with as many trials as the study counted.",
        ),
        elements.paragraph(phrases.reach(found.reach)) if found.reach else "",
        "<h3>Comparison with simple human models</h3>"
        + elements.table(
            tables.MODELS, tables.models([found.own.played, *(one.played for one in found.rivals)]), "Means [%]"
        )
        if found.rivals
        else "",
    ]


def _sessions(found: Findings) -> list[str]:
    parts = [
        elements.paragraph(phrases.quartiles(found.spent, found.differences)),
        elements.paragraph(phrases.minima(found.differences)),
        elements.figure(
            matplotlib_svg.to_svg(
                predictions.spent(found.spent), "spent", "Box plots of the time spent in each condition"
            ),
            "Time spent: minimum, quartiles and maximum over all trials of each condition.",
        ),
        elements.table(tables.SPENT, tables.spent(found.spent), "Time spent [s]"),
        elements.table(tables.DIFFERENCES, tables.differences(found.differences)),
        "<h3>Trust</h3>",
    ]
    if found.trust is None:
        return [*parts, elements.paragraph("These people rate no robot, so there is nothing to report about trust.")]
    return [
        *parts,
        elements.paragraphs(phrases.trust(found.trust)),
        elements.figure(
            matplotlib_svg.to_svg(
                predictions.trust(found.trust), "trust", "Mean trust by trial in the frontier robot and in the oracle"
            ),
            "Mean rating by trial, 1 to 7, with bars of one standard error over people.",
        ),
        elements.table(tables.CURVES, tables.curves(found.trust.curves), "Mean ± standard error"),
    ]


def _foot(found: Findings) -> str:
    versions = ", ".join(f"{name} {version}" for name, version in sorted(found.setting.versions.items()))
    said = f"Every number on this page is in the JSON file next to it, schema {found.schema}. {versions}."
    return f"<footer>{escape(said)}</footer>"
