"""The leaderboard as one page that loads nothing: no network, and a script that only sorts tables."""

from collections.abc import Mapping

from hthor.eval.metrics.metric import SECONDS
from hthor.leaderboard.page import cells
from hthor.leaderboard.page.cells import Cell
from hthor.leaderboard.ranking.board import Board, Row, Section, Struck
from hthor.report.html import markup as m
from hthor.report.html import style
from hthor.report.html.markup import Markup, Piece, tag

_RULES = """
main{max-width:76rem}
table{font-size:.84rem;width:100%}
td,th{vertical-align:middle;padding:.34rem .9rem .34rem 0}
small{display:block;font-size:.74rem;line-height:1.25;font-weight:normal;white-space:nowrap}
td b{font-size:1rem}
td svg,th svg{display:block}
tbody th{white-space:normal;overflow-wrap:anywhere;min-width:9rem;font-size:.95rem}
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
    "How much a robot's agent helps a person at household tasks: every agent meets the same simulated people at the "
    "same tasks, and is compared with the same people without a robot."
)
_RANKED = "Ranked: tasks that no agent can have known when it was submitted."
_DEVELOPMENT = (
    "Development, unranked: these tasks are public. An agent can have been tuned on them or have memorised "
    "them, so there are no ranks here. The column 'fresh tasks' has the same agent's success at tasks that were drawn "
    "by the same recipe after it had been submitted."
)
_NONE = "There is no ranked entry yet. 'How to get a ranked entry' below says what it takes."
_UNFITTED = "The people are not calibrated for this suite: compare agents, but do not take a score as a prediction."
_SCORED = (
    "Other entries at the same trials were scored by another version, and stand in a section of their own: they are "
    "not compared until 'hthor leaderboard rescore' brings them together."
)
_HOW = (
    "A rank is one more than the number of agents that are significantly better in success (paired trial by trial, "
    "over tasks and people, adjusted by Holm for all pairs); below it are the ranks that are not excluded at 95 %, "
    "and how the entry was verified. With =, an agent cannot be distinguished from at least one other. An agent that "
    "was submitted under several names or by several teams counts once. References (ref.) are hthor's own agents; "
    "others are compared with them, and they have no rank.",
    "Intervals are 95 %, for new tasks and new people of the same population. Points are percentage points over the "
    "same people at the same tasks without a robot. Point at an interval for n, the number of trials, and the "
    "smallest difference that they detect with a power of 80 %; leaderboard.json has both.",
    "Adoption is the share of trials in which a message was accepted. People can be talked into that: read it with "
    "the next column, the share of the accepted messages that were true and new to the person, and with the points "
    "over no robot. Nothing is ranked by adoption.",
    "Verified: trials of the agent and of its control, drawn after the entry was submitted, were replayed and "
    "compared: V1 byte for byte on the same platform, V2 by outcomes on another, V3 statistically; with the "
    "probability that an entry with three false outcomes in sixty would have been caught. Below 95 % there is no rank.",
    "What nothing in an entry proves is marked as claimed: how the agent was isolated, how often sessions were "
    "restarted, and which version of hthor ran, unless the official workflow made the entry.",
)
_TO_RANK = (
    "Submit a folder submissions/NAME as a pull request; leaderboard/README.md describes its contents.",
    "When it is merged, a maintainer starts the official evaluation on the season's secret suite, which nobody has "
    "seen before.",
    "The entry, verified, is proposed by a bot, and stands in the season's section with a rank. An entry on a public "
    "suite stands in a development section and has no rank.",
)
_HEAD: tuple[tuple[str, int], ...] = (
    ("rank", 1),
    ("agent", 0),
    ("success %", -1),
    ("", 0),
    ("fresh tasks %", -1),
    ("time-weighted %", -1),
    ("points over no robot", -1),
    ("seconds over no robot", 1),
    ("adoption %", -1),
    ("of it true and new %", -1),
    ("trust", -1),
    ("faults", 1),
    ("held", -1),
    ("verified", -1),
)


def render(found: Board, watched: Mapping[str, str] | None = None) -> str:
    """The page; the same list gives the same bytes.

    Args:
        watched: by the ids of entries, addresses of pages that show a trial in 3-D, relative to this page.
    """
    ranked = any(row.ranks for one in found.sections for row in one.rows)
    body = [
        _section(
            number, one, watched or {}, several=sum(_trials(one) == _trials(other) for other in found.sections) > 1
        )
        for number, one in enumerate(found.sections, 1)
    ]
    title = "hthor leaderboard"
    made = (
        "Made by hthor leaderboard build from the entries and the keeper's verifications alone; every number is in "
        f"leaderboard.json beside this page, schema {found.schema}."
    )
    if found.refuted:
        body.append(_refuted(len(body) + 1, found.refuted))
    steps = tag("ol", *(tag("li", one) for one in _TO_RANK))
    body.append(_titled(len(body) + 1, "rank", "How to get a ranked entry", steps))
    body.append(_titled(len(body) + 1, "how", "How to read this", *(tag("p", one) for one in _HOW)))
    main = (
        tag("h1", title),
        tag("p", _LEAD, class_="lead"),
        m.NOTHING if ranked else tag("p", _NONE, class_="note"),
        *body,
        tag("footer", made),
    )
    return m.page(title, main, style.css(_RULES), code=cells.SORT, sealed=True)


def _trials(one: Section) -> tuple[object, ...]:
    """What decides the trials of a section, apart from how they are scored."""
    return one.suite, one.humans, one.humans_sha256, one.seed, one.mode, one.code, one.rules


def _section(number: int, one: Section, watched: Mapping[str, str], *, several: bool) -> Markup:
    suite = one.suite
    ranked = one.standing == "ranked"
    title = f"{suite.name}: {one.trials} tasks, {one.people} {one.humans} people"
    facts = {
        "suite": f"version {suite.version}, {suite.sha256[:10]}",
        "people": f"{one.humans}, {one.humans_sha256[:10]}, seed {one.seed}",
        "clock": "the world waits for the agent" if one.mode == "lockstep" else "thinking takes time",
        "code of the trials": f"{one.code[:10]}, rules {one.rules[:10]}",
        "scoring": one.scoring[:10] or "not noted",
    }
    said = cells.ties(one)
    return _titled(
        number,
        f"s{number}",
        title if ranked else f"{title} (development, unranked)",
        tag("p", _RANKED if ranked else _DEVELOPMENT, class_="note"),
        tag("dl", *(part for name, value in facts.items() for part in (tag("dt", name), tag("dd", value)))),
        m.NOTHING if one.calibrated else tag("p", _UNFITTED, class_="note"),
        tag("p", _SCORED, class_="note") if several else m.NOTHING,
        _ranking(one, watched),
        tag("p", said, class_="soft") if said else m.NOTHING,
        cells.fold("By difficulty and kind of task", _splits(one)),
        cells.fold("What was run", _origins(one)),
    )


def _ranking(one: Section, watched: Mapping[str, str]) -> Markup:
    on = cells.common_scale(row.sr for row in one.rows)
    head: list[tuple[Piece, int]] = [(title or cells.draw_axis(on), way) for title, way in _HEAD]
    lines = [("ref" if row.reference else "", _cells(row, on, watched.get(row.id, ""))) for row in one.rows]
    return cells.table(head, lines, words=(0, 1, 3, 12, 13))


def _cells(row: Row, on: cells.Scale, watch: str) -> list[Cell]:
    colour = _COLOURS.get(row.name, "ink") if row.reference else "ink"
    return [
        cells.rank(row),
        cells.agent(row, watch),
        cells.share(row.sr),
        Cell(cells.draw_interval(row.sr, on, colour)),
        cells.fresh(row),
        cells.share(row.twsr),
        cells.gain(row.uplift.sr if row.uplift else None),
        cells.gain(row.uplift.time_s if row.uplift else None, SECONDS),
        cells.share(row.adoption),
        cells.share(row.usefulness),
        cells.amount(row.trust),
        cells.faults(row),
        cells.isolation(row),
        cells.checked(row),
    ]


def _splits(one: Section) -> Markup:
    """Success by property: one column for each value that any entry has."""
    columns = dict.fromkeys(
        (name, value) for row in one.rows for name, values in row.splits.items() for value in values
    )
    head: list[tuple[Piece, int]] = [("agent", 0), *((value.replace("_", " "), -1) for _, value in columns)]
    lines = [
        ("ref" if row.reference else "", [Cell(row.name), *(_split(row, name, value) for name, value in columns)])
        for row in one.rows
    ]
    return cells.table(head, lines, words=(0,), named=0)


def _split(row: Row, name: str, value: str) -> Cell:
    found = row.splits.get(name, {}).get(value)
    return Cell(cells.DASH, -1.0) if found is None else cells.share(found.sr)


def _origins(one: Section) -> Markup:
    head: list[tuple[Piece, int]] = [(word, 0) for word in ("entry", "body", "agent's code", "hthor", "commit")]
    lines = [("", [Cell(part) for part in _origin(row)]) for row in one.rows]
    return cells.table(head, lines, words=range(5), named=0)


def _origin(row: Row) -> tuple[Piece, ...]:
    used = row.harness
    commit = (used.commit[:10] or cells.DASH) + (", changed" if used.dirty else "")
    return (
        tag("code", row.id),
        ", ".join(row.bodies) or cells.DASH,
        " ".join(digest[:10] for digest in row.code),
        used.version,
        commit if row.official or row.reference else f"{commit} (claimed)",
    )


def _refuted(number: int, some: tuple[Struck, ...]) -> Markup:
    """Entries that were refuted."""
    listed = (tag("li", one.name, " (", tag("code", one.id), f"): {one.why}") for one in some)
    return _titled(number, "refuted", "Refuted, and taken off", tag("ul", *listed))


def _titled(number: int, name: str, title: str, *parts: Piece) -> Markup:
    return tag("section", tag("h2", tag("span", str(number)), " ", title), m.join(parts, "\n"), id=name)
