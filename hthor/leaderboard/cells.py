"""What stands in the cells of the page's tables, in words; knows nothing of HTML but how text is escaped."""

from __future__ import annotations

from html import escape

from msgspec import Struct

from hthor.eval.contrast import Difference
from hthor.eval.report import least
from hthor.eval.stats import Estimate
from hthor.leaderboard.board import Row, Section, Standing

NOTHING = "–"
_TIERS = {"V1": "byte for byte", "V2": "by outcomes", "V3": "statistically"}
_LAST = 1e9


class Cell(Struct, frozen=True):
    """HTML, and the number that a column is sorted by."""

    html: str
    order: float = 0.0


def rank(one: Row, metric: str = "sr") -> Cell:
    """The place, with the places that are not excluded; a reference has none, nor what was refuted."""
    if one.ranks is None:
        return Cell(f'<span class="soft">{"ref." if one.reference else NOTHING}</span>', _LAST)
    found: Standing = getattr(one.ranks, metric)
    low, high = found.interval
    shared = "=" if found.ties else ""
    return Cell(f'<b>{found.rank}{shared}</b><small class="soft">{low}–{high}</small>', found.rank)


def who(one: Row) -> str:
    """The agent's name, and under it who made it and what it is told beyond its senses."""
    about = one.agent
    name = escape(one.name)
    if about.url.startswith(("https://", "http://")):
        name = f'<a href="{escape(about.url)}" rel="nofollow">{name}</a>'
    if about.version:
        name += f' <span class="soft">{escape(about.version)}</span>'
    parts = [", ".join(about.authors), about.licence]
    if one.privileges:
        parts.append("knows " + ", ".join(word.replace("_", " ") for word in one.privileges))
    small = " · ".join(escape(part) for part in parts if part)
    return f"{name}<small class='soft'>{small}</small>" if small else name


def share(one: Estimate) -> Cell:
    """A percentage with its interval."""
    if one.mean is None:
        return Cell(NOTHING, -1.0)
    low, high = (f"{100 * end:.1f}" for end in one.ci95 or (one.mean, one.mean))
    return Cell(f"{100 * one.mean:.1f}{_small(f'{low}–{high}', one, 100.0)}", one.mean)


def amount(one: Estimate, digits: int = 1) -> Cell:
    """A number with its interval."""
    if one.mean is None:
        return Cell(NOTHING, -1.0)
    low, high = (f"{end:.{digits}f}" for end in one.ci95 or (one.mean, one.mean))
    return Cell(f"{one.mean:.{digits}f}{_small(f'{low}–{high}', one, 1.0)}", one.mean)


def gain(one: Difference | None) -> Cell:
    """Points more than without a robot, with the interval."""
    if one is None:
        return Cell(NOTHING, -_LAST)
    low, high = (f"{100 * end:+.1f}" for end in one.ci95 or (one.difference, one.difference))
    ends = f"{_minus(low)} to {_minus(high)}"
    return Cell(f"{_signed(100 * one.difference)}{_small(ends, one, 100.0)}", one.difference)


def checked(one: Row) -> Cell:
    """The tier of the verification, in its colour."""
    found = one.verification
    if found is None:
        return Cell('<span class="soft">not yet</span>', 0.0)
    if not found.passed:
        return Cell(f'<b class="bad">refuted</b><small class="soft">{found.tier}</small>', -1.0)
    told = f"{found.equal} of {found.compared} trials the same, {_TIERS[found.tier]}"
    return Cell(f'<b class="good" title="{told}">{found.tier}</b><small class="soft">{_TIERS[found.tier]}</small>', 1.0)


def held(one: Row) -> Cell:
    """How the agent was held: our own are not."""
    return Cell(escape(one.isolation) or "<span class='soft'>built in</span>", float(one.isolation[1:] or 0))


def ties(section: Section) -> str:
    """Which agents cannot be told apart, as a sentence; empty for none."""
    names = {row.id: row.name for row in section.rows}
    pairs = [
        f"{row.name} and {names[id]}"
        for place, row in enumerate(section.rows)
        if row.ranks is not None
        for id in row.ranks.sr.ties
        if id in {later.id for later in section.rows[place + 1 :]}
    ]
    return f"These data cannot tell apart in success: {'; '.join(pairs)}." if pairs else ""


def _small(ends: str, one: Estimate | Difference, scale: float) -> str:
    """The interval; pointing at it tells how many trials it is of, and what they could have seen."""
    told = f"n {one.n}, could have seen {least(one.mde80, scale, room=scale > 1.0)}"
    return f"<small class='soft' title='{told}'>{ends}</small>"


def _signed(value: float) -> str:
    return _minus(f"{value:+.1f}")


def _minus(text: str) -> str:
    return text.replace("-", "−")
