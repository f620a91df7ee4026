"""A report as one page that needs nothing else: no network, no script; computes and draws nothing."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape

from hthor.eval.pages import html, rows, style, words
from hthor.eval.pages.findings import Findings, Shown

_RULES = """
.maps{display:grid;grid-template-columns:repeat(auto-fill,minmax(20rem,1fr));gap:0 1.6rem}
.maps figure{margin:.8rem 0}
"""
_ALIKE = "A mark without a line: all trials ended alike, which says little where n is small."
_BEST, _WORST = "Best trials", "Worst trials"


def render(found: Findings, drawings: Mapping[str, str]) -> str:
    """The page, the same bytes for the same findings.

    Args:
        drawings: elements of the page by the names that `hthor.eval.pages.drawings` gives.
    """
    parts = (
        ("results", "Results", _results(found, drawings)),
        ("uplift", "Against no robot", _uplift(found, drawings)),
        ("time", "Time spent", _time(found, drawings)),
        ("trust", "Trust", _trust(found, drawings)),
        ("difficulty", "By difficulty and kind of task", _levels(found, drawings)),
        ("scenes", "By scene", _scenes(found, drawings)),
        ("people", "By kind of person", _people(found, drawings)),
        ("trials", "Best and worst trials", _trials(found, drawings)),
        ("faults", "Faults", _faults(found)),
        ("provenance", "Where the runs come from", _origins(found)),
    )
    sections = [html.section(number, name, title, *body) for number, (name, title, body) in enumerate(parts, 1)]
    links = " ".join(
        f'<a href="#{name}">{number} {escape(title)}</a>' for number, (name, title, _) in enumerate(parts, 1)
    )
    title = f"{found.suite.name}: {', '.join(arm.label for arm in found.arms)}"
    return (
        f'<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        f'<meta name="viewport" content="width=device-width, initial-scale=1">\n<title>{escape(title)}</title>\n'
        f'<link rel="icon" href="data:,">\n'
        f"<style>{style.css(_RULES)}</style>\n</head>\n<body>\n<main>\n{_head(found, title)}\n<nav>{links}</nav>\n"
        + "\n".join(sections)
        + f"\n{_foot(found)}\n</main>\n</body>\n</html>\n"
    )


def _head(found: Findings, title: str) -> str:
    trials = sum(one.trials for one in found.origins)
    facts = {
        "suite": f"{found.suite.name}, version {found.suite.version} ({found.suite.sha256[:10]})",
        "people": found.people if found.by_people is None else f"{found.people}; section 7 has all",
        "runs": f"{len(found.origins)}, {trials} trials",
    }
    listed = "".join(f"<dt>{escape(name)}</dt><dd>{escape(value)}</dd>" for name, value in facts.items())
    return "\n".join(
        (
            f"<h1>{escape(title)}</h1>",
            f"<dl>{listed}</dl>",
            html.paragraph(words.lead(found), "lead"),
            *(html.paragraph(note, "note") for note in rows.notes(found)),
        )
    )


def _results(found: Findings, drawings: Mapping[str, str]) -> list[str]:
    return [
        html.table(rows.scores_head(found), rows.scores(found)),
        html.paragraph(
            "Intervals are 95 %, for new tasks and new people of the same population (two-way bootstrap over both)."
        ),
        html.paragraph(words.published(found)),
        _figure(drawings, "scores", "Means with 95 % intervals; n is the number of trials."),
    ]


def _uplift(found: Findings, drawings: Mapping[str, str]) -> list[str]:
    if not found.uplift:
        return [html.paragraph(words.lead(found))]
    return [
        _figure(
            drawings,
            "uplift",
            "Differences trial by trial, same person, same task, with 95 % intervals; right of the line is better.",
        ),
        html.table(rows.UPLIFT, rows.uplift(found.uplift)),
        html.paragraph("Won: solved only with the robots. Lost: solved only without."),
    ]


def _time(found: Findings, drawings: Mapping[str, str]) -> list[str]:
    return [
        html.paragraph(words.spent(found.spent)),
        _figure(drawings, "time-spent", "Minimum, quartiles and maximum of the time spent."),
        html.table(rows.SPENT, rows.spent(found.spent), "Time spent [s]"),
    ]


def _trust(found: Findings, drawings: Mapping[str, str]) -> list[str]:
    if not found.trust:
        return [html.paragraph("Nobody rated a robot in these runs.")]
    return [
        html.paragraph(words.trust(found.trust)),
        _figure(drawings, "trust", "Mean rating after each trial, with bars of one standard error over people."),
        html.table(rows.CURVES, rows.curves(found.trust), "Mean ± standard error"),
    ]


def _levels(found: Findings, drawings: Mapping[str, str]) -> list[str]:
    held = [one for one in found.splits if one.word != "scene"]
    if not held:
        return [html.paragraph("The tasks of this suite name no difficulty, and are all of one kind.")]
    said = [words.widest(one, found.baseline) for one in held if one.word == "difficulty"]
    return [
        *(html.paragraph(text) for text in said if text),
        _figure(drawings, "difficulty", f"Success rates with 95 % intervals. {_ALIKE}"),
        *(html.table(rows.split_head(one), rows.split(one), "Success rate [%]") for one in held),
    ]


def _scenes(found: Findings, drawings: Mapping[str, str]) -> list[str]:
    held = [one for one in found.splits if one.word == "scene"]
    if not held:
        return [html.paragraph("All trials are in one scene.")]
    return [
        *(html.paragraph(text) for one in held if (text := words.widest(one, found.baseline))),
        _figure(drawings, "scenes", f"Success rates by scene, the hardest first, with 95 % intervals. {_ALIKE}"),
        *(html.table(rows.split_head(one), rows.split(one), "Success rate [%]") for one in held),
    ]


def _people(found: Findings, drawings: Mapping[str, str]) -> list[str]:
    if found.by_people is None:
        return [html.paragraph(f"All are {found.people}. 'hthor eval --humans kinds' plays every kind of people.")]
    text = words.widest(found.by_people, found.baseline)
    return [
        html.paragraph(text) if text else "",
        _figure(drawings, "people", f"Success rates with each kind of people, with 95 % intervals. {_ALIKE}"),
        html.table(rows.split_head(found.by_people), rows.split(found.by_people), "Success rate [%]"),
    ]


def _trials(found: Findings, drawings: Mapping[str, str]) -> list[str]:
    by = "the time saved against the same person without a robot" if found.baseline else "time-weighted success"
    parts = [html.paragraph(f"By {by}.")] if found.shown else [html.paragraph("There is no robot to tell of.")]
    names = [name for name in drawings if name.startswith("map-")]
    drawn = dict(zip((one.key for one in found.shown), names, strict=False))
    for arm in dict.fromkeys(one.arm for one in found.shown):
        for rank, word in (("best", _BEST), ("worst", _WORST)):
            held = [one for one in found.shown if (one.arm, one.rank) == (arm, rank)]
            if held:
                cards = "\n".join(_card(one, drawings.get(drawn.get(one.key, ""), "")) for one in held)
                parts.append(f'<h3>{word}: {escape(arm)}</h3>\n<div class="maps">\n{cards}\n</div>')
    if names:
        parts.append(
            html.paragraph(
                "Blue: the person's way, darkening with time; orange and others: the robots'. Dashed: the same person "
                "without a robot. Rings: starts; dots: every ten seconds; star: the target at the start; numbers: "
                "messages, strong when confirmed; green: where it belongs.",
                "soft",
            )
        )
    return parts


def _card(one: Shown, drawing: str) -> str:
    return html.figure(drawing, f"{words.shown(one)} {one.replay}")


def _faults(found: Findings) -> list[str]:
    if not found.failures:
        return [html.paragraph("No robot failed in any trial.")]
    commands = [f"{one.run}, {one.kind}: {one.replay}" for one in found.failures]
    return [
        html.paragraph("After a fault the person went on without that robot; the trial counts as it ended."),
        html.table(rows.FAILURES, rows.failures(found.failures), words=(0, 1, 2, 4, 6)),
        html.bullets(commands),
    ]


def _origins(found: Findings) -> list[str]:
    return [html.table(rows.ORIGINS, rows.origins(found.origins), words=(0, 1, 2, 3, 7, 8, 9, 10))]


def _figure(drawings: Mapping[str, str], name: str, caption: str) -> str:
    return html.figure(drawings[name], caption) if name in drawings else ""


def _foot(found: Findings) -> str:
    every = {f"{name} {version}" for one in found.origins for name, version in one.versions.items()}
    said = f"Every number on this page is in report.json beside it, schema {found.schema}. {', '.join(sorted(every))}."
    return f"<footer>{escape(said)}</footer>"
