"""The page's tables: cells with numbers and intervals, in words and as small drawings, and headers that sort."""

import math
from collections.abc import Iterable, Sequence

from msgspec import Struct

from hthor.eval.metrics.metric import NUMBER, SHARE, Unit
from hthor.eval.results.paired_difference import Difference
from hthor.eval.statistics.intervals import Estimate
from hthor.leaderboard.entries.verification import MIN_DETECTION, Replayed
from hthor.leaderboard.ranking.board import Row, Section, Standing
from hthor.report.html import markup
from hthor.report.html.markup import NOTHING, Markup, Piece, join, link, tag
from hthor.report.terminal.result_tables import format_detectable

DASH = "–"
_TIERS = {"V1": "byte for byte", "V2": "by outcomes", "V3": "statistically"}
_LAST = 1e9
_WIDE, _HIGH, _EDGE = 150.0, 16.0, 6.0
SORT = """
for(const th of document.querySelectorAll("th[data-k]")){
 const go=()=>{
  const first=th.dataset.k==="-1"?"descending":"ascending";
  const way=Number(th.dataset.k)*(th.getAttribute("aria-sort")===first?-1:1);
  const body=th.closest("table").tBodies[0],at=th.cellIndex,value=row=>Number(row.cells[at].dataset.v);
  const rows=[...body.rows].sort((one,other)=>way*(value(one)-value(other)));
  for(const other of th.parentNode.cells)other.removeAttribute("aria-sort");
  th.setAttribute("aria-sort",way===1?"ascending":"descending");
  body.append(...rows);
 };
 th.tabIndex=0;th.addEventListener("click",go);
 th.addEventListener("keydown",key=>{if(key.key==="Enter"||key.key===" "){key.preventDefault();go();}});
}
"""


class Cell(Struct, frozen=True):
    """The content of a cell, and the number by which its column is sorted."""

    shown: Piece
    order: float = 0.0


def rank(one: Row, metric: str = "sr") -> Cell:
    """The rank, the ranks that are not excluded and the tier of verification; or the reason why there is no rank."""
    if one.ranks is None:
        return Cell(_soft("ref." if one.reference else DASH, "" if one.reference else one.unranked), _LAST)
    found: Standing = getattr(one.ranks, metric)
    low, high = found.interval
    checked = f" · {one.verification.trials.tier}" if one.verification else ""
    return Cell(
        join([tag("b", f"{found.rank}{'=' if found.ties else ''}"), _small(f"{low}–{high}{checked}")]), found.rank
    )


def agent(one: Row, watch: str = "") -> Cell:
    """The agent's name, and below it its authors and its privileges; ``watch`` is the address of a trial in 3-D."""
    about = one.agent
    name = link(about.url, one.name)
    parts = [one.team if one.team != one.name else "", about.licence]
    if one.privileges:
        parts.append("knows " + ", ".join(word.replace("_", " ") for word in one.privileges))
    if one.same_as:
        parts.append(f"the same agent as {one.same_as}")
    small = " · ".join(part for part in parts if part)
    version: list[Piece] = [" ", tag("span", about.version, class_="soft")] if about.version else []
    seen = [tag("small", tag("a", "watch a trial", href=watch))] if watch else []
    return Cell(join([name, *version, *([_small(small)] if small else []), *seen]))


def share(one: Estimate) -> Cell:
    """A percentage with its interval."""
    if one.mean is None:
        return Cell(DASH, -1.0)
    low, high = (f"{100 * end:.1f}" for end in one.ci95 or (one.mean, one.mean))
    return Cell(join([f"{100 * one.mean:.1f}", _interval(f"{low}–{high}", one, SHARE)]), one.mean)


def amount(one: Estimate, digits: int = 1) -> Cell:
    """A number with its interval."""
    if one.mean is None:
        return Cell(DASH, -1.0)
    low, high = (f"{end:.{digits}f}" for end in one.ci95 or (one.mean, one.mean))
    return Cell(join([f"{one.mean:.{digits}f}", _interval(f"{low}–{high}", one, NUMBER)]), one.mean)


def gain(one: Difference | None, unit: Unit = SHARE) -> Cell:
    """The difference to no robot, with its interval."""
    if one is None:
        return Cell(DASH, -_LAST)
    low, high = (f"{unit.scale * end:+z.1f}" for end in one.ci95 or (one.difference, one.difference))
    ends = _minus(f"{low} to {high}")
    return Cell(join([_minus(f"{unit.scale * one.difference:+z.1f}"), _interval(ends, one, unit)]), one.difference)


def fresh(one: Row) -> Cell:
    """Success at tasks that were drawn after the agent's submission, and whether it dropped."""
    found = one.verification.fresh if one.verification else None
    if found is None:
        return Cell(_soft("not yet"), -1.0)
    shown = share(found.sr)
    seen = "no fall" if found.detectable is None else f"a fall by {100 * found.detectable:.0f} points"
    note = tag(
        "small", tag("b", "fell", class_="bad") if found.fell else f"{found.n} tasks", title=f"{seen} would be seen"
    )
    return Cell(join([shown.shown, note]), shown.order)


def checked(one: Row) -> Cell:
    """How the entry was verified, and the probability that a forged one would have been caught."""
    found = one.verification
    if found is None:
        return Cell(_soft("not yet"), 0.0)
    weakest = min((part for part in (found.trials, found.control) if part is not None), key=lambda part: part.caught)
    power = f"catches {100 * weakest.caught:.0f} %"
    shown = "; ".join(_told(part) for part in (found.trials, found.control) if part is not None)
    mood = "good" if weakest.caught >= MIN_DETECTION else "quiet"
    return Cell(join([tag("b", found.trials.tier, class_=mood, title=shown), _small(power)]), weakest.caught)


def isolation(one: Row) -> Cell:
    """How the agent was isolated; empty for hthor's own. It is a claim unless the official workflow made the run."""
    if not one.isolation:
        return Cell(_soft("built in"))
    level = float(one.isolation[1:]) if one.isolation[1:].isdigit() else 0.0
    return Cell(one.isolation if one.official else join([one.isolation, _small("claimed")]), level)


def faults(one: Row) -> Cell:
    """Trials in which the agent failed, and sessions that were restarted."""
    if not one.replays:
        return Cell(str(one.faults), float(one.faults))
    again = f"{one.replays} replayed" if one.official else f"{one.replays} replayed, claimed"
    return Cell(join([str(one.faults), _small(again)]), float(one.faults))


def ties(section: Section) -> str:
    """A sentence that names the agents that the data cannot tell apart; empty if there are none."""
    names = {row.id: row.name for row in section.rows}
    pairs = [
        f"{row.name} and {names[id]}"
        for place, row in enumerate(section.rows)
        if row.ranks is not None
        for id in row.ranks.sr.ties
        if id in {later.id for later in section.rows[place + 1 :]}
    ]
    return f"These data cannot tell apart in success: {'; '.join(pairs)}." if pairs else ""


def _told(found: Replayed) -> str:
    return f"{found.equal} of {found.compared} trials the same, {_TIERS[found.tier]}"


def _soft(text: str, more: str = "") -> Markup:
    return join([tag("span", text, class_="soft"), *([_small(more)] if more else [])])


def _small(text: str) -> Markup:
    return tag("small", text, class_="soft")


def _interval(ends: str, one: Estimate | Difference, unit: Unit) -> Markup:
    """The interval; its tooltip gives the number of trials and the smallest detectable difference."""
    shown = f"n {one.n}, could have seen {format_detectable(one.mde80, unit)}"
    return tag("small", ends, class_="soft", title=shown)


def _minus(text: str) -> str:
    return text.replace("-", "−")


class Scale(Struct, frozen=True, kw_only=True):
    """The range of a column of drawn intervals [%]."""

    low: int
    high: int

    def at(self, share: float) -> float:
        """The horizontal position of a share [px]."""
        part = (100.0 * share - self.low) / (self.high - self.low)
        return round(_EDGE + (_WIDE - 2 * _EDGE) * min(max(part, 0.0), 1.0), 1)


def common_scale(some: Iterable[Estimate]) -> Scale:
    """The range of all intervals, rounded outwards to tens."""
    ends = [end for one in some for end in (one.ci95 or ())] or [0.0, 1.0]
    low, high = 10 * math.floor(10 * min(ends)), 10 * math.ceil(10 * max(ends))
    return Scale(low=max(0, low), high=min(100, max(high, low + 10)))


def draw_axis(on: Scale) -> Markup:
    """The header of a column of drawn intervals: the ends of its range as numbers."""
    look: dict[str, str | int] = {"y": 11, "font_size": 10, "fill": "var(--soft)"}
    ends = (
        tag("text", str(on.low), x=on.at(on.low / 100.0) - 4, **look),
        tag("text", str(on.high), x=on.at(on.high / 100.0) + 4, text_anchor="end", **look),
    )
    return _drawing("scale", *ends)


def draw_interval(one: Estimate, on: Scale, colour: str) -> Markup:
    """A dot for the mean, a line for the interval, and thin lines at each tenth."""
    if one.mean is None:
        return NOTHING
    low, high = one.ci95 or (one.mean, one.mean)
    step = 10 if on.high - on.low <= 60 else 20
    grid = (
        tag("line", x1=on.at(tenth / 100), x2=on.at(tenth / 100), y1=0, y2=_HIGH, stroke="var(--line)")
        for tenth in range(on.low, on.high + 1, step)
    )
    middle, ink = _HIGH / 2, f"var(--{colour})"
    bar = tag("line", x1=on.at(low), x2=on.at(high), y1=middle, y2=middle, stroke_width="2.5")
    dot = tag("circle", cx=on.at(one.mean), cy=middle, r="3.6")
    words = f"{100 * one.mean:.1f} %, 95 % interval {100 * low:.1f} to {100 * high:.1f}"
    return _drawing(words, *grid, tag("g", bar, dot, stroke=ink, fill=ink, stroke_linecap="round"))


def _drawing(words: str, *parts: Piece) -> Markup:
    box = f"0 0 {_WIDE:g} {_HIGH:g}"
    return tag("svg", tag("title", words), *parts, role="img", width=_WIDE, height=_HIGH, viewBox=box)


def table(
    head: Iterable[tuple[Piece, int]],
    lines: Sequence[tuple[str, Sequence[Cell]]],
    *,
    words: Iterable[int],
    named: int = 1,
) -> Markup:
    """A table whose headers sort it.

    Args:
        head: each column's title and its first sorting direction: 1 up, -1 down, 0 not sortable.
        lines: each row's class and cells.
        words: columns without numbers. named: the column with the row's name.
    """
    wordy = set(words)
    tops = [
        tag("th", tag("span", title), scope="col", class_=None if place in wordy else "n", data_k=way or None)
        for place, (title, way) in enumerate(head)
    ]
    body = (
        tag(
            "tr",
            *(_table_cell(part, place == named, place in wordy) for place, part in enumerate(parts)),
            class_=kind or None,
        )
        for kind, parts in lines
    )
    return markup.table(tops, body)


def _table_cell(part: Cell, named: bool, wordy: bool) -> Markup:
    kind = {"scope": "row"} if named else {"class_": None if wordy else "n"}
    return tag("th" if named else "td", part.shown, **kind, data_v=float(part.order))


def fold(title: str, *inside: Piece) -> Markup:
    """Content that is shown after a click on its title."""
    return tag("details", tag("summary", title), *inside)
