"""The leaderboard as one page that needs nothing else: no network, and a script that only sorts; computes nothing."""

from __future__ import annotations

from html import escape

from hthor.eval.pages import html, style
from hthor.leaderboard import cells, marks, tables
from hthor.leaderboard.board import Board, Row, Section
from hthor.leaderboard.cells import Cell

_RULES = """
main{max-width:76rem}
table{font-size:.84rem;width:100%}
td,th{vertical-align:middle;padding:.34rem .9rem .34rem 0}
small{display:block;font-size:.74rem;line-height:1.25;font-weight:normal;white-space:nowrap}
td b{font-size:1rem}
td svg,th svg{display:block}
tbody th{white-space:normal;min-width:9rem;font-size:.95rem}
tbody th a{color:inherit;text-decoration-color:var(--soft);text-underline-offset:.15em}
tbody th small{white-space:normal}
tr.ref th,tr.ref .n{font-style:italic}
tr.ref{background:var(--shade)}
tr.ref td:first-child,tr.ref th:first-child{padding-left:.4rem}
td:first-child,thead th:first-child{padding-left:.4rem}
th[data-k]{cursor:pointer;user-select:none}
th[data-k]:hover,th[data-k]:focus-visible{color:var(--oracle)}
th[aria-sort=ascending] span:after{content:" ↑"}
th[aria-sort=descending] span:after{content:" ↓"}
details{margin:1rem 0}
summary{cursor:pointer;color:var(--soft);font-size:.9rem}
code{overflow-wrap:anywhere}
"""
_COLOURS = {"no robot": "none", "frontier": "frontier", "oracle": "oracle"}
_LEAD = (
    "How much a robot's mind helps a person at household tasks: every agent meets the same simulated people at the "
    "same tasks on the same days, and is measured against the same people without a robot."
)
_HOW = (
    "A rank is one more than the number of agents that are significantly better (paired trial by trial, over tasks and "
    "people, adjusted by Holm for all pairs); under it stand the ranks that are not excluded at 95 %. With =, an agent "
    "cannot be told from at least one other. References (ref.) are hthor's own agents; they are there to be measured "
    "against and have no rank.",
    "Intervals are 95 %, for new tasks and new people of the same population. Points are percentage points over the "
    "same people at the same tasks without a robot. Point at an interval for n, the number of trials, and the smallest "
    "difference that these could have seen in four of five cases; leaderboard.json has both.",
    "Verified says what came of playing trials again that were drawn after the entry was handed in: V1 byte for byte "
    "on the same platform, V2 by outcomes on another, V3 statistically. An entry that was refuted has no rank.",
)


def render(found: Board) -> str:
    """The page, the same bytes for the same list."""
    many = sum(len(one.rows) for one in found.sections)
    body = [_section(number, one) for number, one in enumerate(found.sections, 1)]
    title = "hthor leaderboard"
    return (
        f'<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        f'<meta name="viewport" content="width=device-width, initial-scale=1">\n<title>{title}</title>\n'
        f'<link rel="icon" href="data:,">\n<style>{style.css(_RULES)}</style>\n</head>\n<body>\n<main>\n'
        f"<h1>{title}</h1>\n{html.paragraph(_LEAD, 'lead')}\n"
        + ("\n".join(body) if many else html.paragraph("There is no entry yet.", "note"))
        + f"\n{html.section(len(body) + 1, 'how', 'How to read this', *map(html.paragraph, _HOW))}"
        f"\n<footer>Made by hthor leaderboard build from the entries alone; every number is in leaderboard.json beside "
        f"this page, schema {escape(found.schema)}.</footer>\n</main>\n"
        f"<script>{tables.SORT}</script>\n</body>\n</html>\n"
    )


def _section(number: int, one: Section) -> str:
    suite = one.suite
    title = f"{suite.name}: {one.trials} tasks, {one.people} {one.humans} people"
    facts = {
        "suite": f"version {suite.version}, {suite.sha256[:10]}",
        "people": f"{one.humans}, {one.humans_sha256[:10]}, seed {one.seed}",
        "clock": "the world waits for the agent" if one.mode == "lockstep" else "thinking takes time",
        "code": f"{one.code[:10]}, rules {one.rules[:10]}",
    }
    listed = "".join(f"<dt>{escape(name)}</dt><dd>{escape(value)}</dd>" for name, value in facts.items())
    note = "The people are not calibrated for this suite: compare agents, and take no score for a forecast."
    said = cells.ties(one)
    return html.section(
        number,
        f"s{number}",
        title,
        f"<dl>{listed}</dl>",
        "" if one.calibrated else html.paragraph(note, "note"),
        _ranking(one),
        html.paragraph(said, "soft") if said else "",
        tables.fold("By difficulty and kind of task", _splits(one)),
        tables.fold("What was played", _origins(one)),
    )


def _ranking(one: Section) -> str:
    on = marks.scale(row.sr for row in one.rows)
    head = (
        ("rank", 1, ""),
        ("agent", 0, ""),
        ("success %", -1, ""),
        ("", 0, marks.axis(on)),
        ("time-weighted %", -1, ""),
        ("points over no robot", -1, ""),
        ("adoption %", -1, ""),
        ("time s", 1, ""),
        ("trust", -1, ""),
        ("faults", 1, ""),
        ("held", -1, ""),
        ("verified", -1, ""),
    )
    lines = []
    for row in one.rows:
        parts = [
            cells.rank(row),
            Cell(cells.who(row)),
            cells.share(row.sr),
            Cell(marks.mark(row.sr, on, _COLOURS.get(row.name, "ink") if row.reference else "ink")),
            cells.share(row.twsr),
            cells.gain(row.uplift.sr if row.uplift else None),
            cells.share(row.adoption),
            cells.amount(row.time_s),
            cells.amount(row.trust),
            Cell(str(row.faults), row.faults),
            cells.held(row),
            cells.checked(row),
        ]
        lines.append((' class="ref"' if row.reference else "", parts))
    return tables.table(head, lines, words=(0, 1, 3, 10, 11))


def _splits(one: Section) -> str:
    """Success by property, a column each value."""
    columns = [(name, value) for name, values in one.rows[0].splits.items() for value in values]
    head = [("agent", 0, ""), *((value.replace("_", " "), -1, "") for _, value in columns)]
    lines = [
        (
            ' class="ref"' if row.reference else "",
            [Cell(escape(row.name)), *(cells.share(row.splits[name][value].sr) for name, value in columns)],
        )
        for row in one.rows
    ]
    return tables.table(head, lines, words=(0,), named=0)


def _origins(one: Section) -> str:
    head = [(word, 0, "") for word in ("entry", "body", "agent's code", "hthor", "commit")]
    lines = [("", [Cell(text) for text in _origin(row)]) for row in one.rows]
    return tables.table(head, lines, words=range(5), named=0)


def _origin(row: Row) -> tuple[str, ...]:
    used = row.harness
    commit = (used.commit[:10] or cells.NOTHING) + (", changed" if used.dirty else "")
    codes = " ".join(digest[:10] for digest in row.code)
    return (
        f"<code>{escape(row.id)}</code>",
        escape(", ".join(row.bodies)) or cells.NOTHING,
        codes,
        used.version,
        commit,
    )
