"""The cells of the page's tables."""

from msgspec import Struct

from hthor.eval.metrics.metric import NUMBER, SHARE, Unit
from hthor.eval.results.paired_difference import Difference
from hthor.eval.statistics.intervals import Estimate
from hthor.leaderboard.entries.verification import MIN_DETECTION, Replayed
from hthor.leaderboard.ranking.board import Row, Section, Standing
from hthor.report.html.markup import Markup, Piece, join, link, tag
from hthor.report.terminal.result_tables import format_detectable

NOTHING = "–"
_TIERS = {"V1": "byte for byte", "V2": "by outcomes", "V3": "statistically"}
_LAST = 1e9


class Cell(Struct, frozen=True):
    """What is shown, and the number that a column is sorted by."""

    shown: Piece
    order: float = 0.0


def rank(one: Row, metric: str = "sr") -> Cell:
    """The rank, the ranks that are not excluded and the tier of verification; or why there is no rank."""
    if one.ranks is None:
        return Cell(_soft("ref." if one.reference else NOTHING, "" if one.reference else one.unranked), _LAST)
    found: Standing = getattr(one.ranks, metric)
    low, high = found.interval
    checked = f" · {one.verification.trials.tier}" if one.verification else ""
    return Cell(
        join([tag("b", f"{found.rank}{'=' if found.ties else ''}"), _small(f"{low}–{high}{checked}")]), found.rank
    )


def agent(one: Row) -> Cell:
    """The agent's name, and below it its authors and its privileges."""
    about = one.agent
    name = link(about.url, one.name)
    parts = [one.team if one.team != one.name else "", about.licence]
    if one.privileges:
        parts.append("knows " + ", ".join(word.replace("_", " ") for word in one.privileges))
    if one.same_as:
        parts.append(f"the same agent as {one.same_as}")
    small = " · ".join(part for part in parts if part)
    version: list[Piece] = [" ", tag("span", about.version, class_="soft")] if about.version else []
    return Cell(join([name, *version, *([_small(small)] if small else [])]))


def share(one: Estimate) -> Cell:
    """A percentage with its interval."""
    if one.mean is None:
        return Cell(NOTHING, -1.0)
    low, high = (f"{100 * end:.1f}" for end in one.ci95 or (one.mean, one.mean))
    return Cell(join([f"{100 * one.mean:.1f}", _interval(f"{low}–{high}", one, SHARE)]), one.mean)


def amount(one: Estimate, digits: int = 1) -> Cell:
    """A number with its interval."""
    if one.mean is None:
        return Cell(NOTHING, -1.0)
    low, high = (f"{end:.{digits}f}" for end in one.ci95 or (one.mean, one.mean))
    return Cell(join([f"{one.mean:.{digits}f}", _interval(f"{low}–{high}", one, NUMBER)]), one.mean)


def gain(one: Difference | None, unit: Unit = SHARE) -> Cell:
    """The difference to no robot, with its interval."""
    if one is None:
        return Cell(NOTHING, -_LAST)
    low, high = (f"{unit.scale * end:+z.1f}" for end in one.ci95 or (one.difference, one.difference))
    ends = _minus(f"{low} to {high}")
    return Cell(join([_minus(f"{unit.scale * one.difference:+z.1f}"), _interval(ends, one, unit)]), one.difference)


def fresh(one: Row) -> Cell:
    """Success at tasks that were drawn after the agent was submitted, and whether it dropped."""
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
    """How the agent was isolated: ours are not; for others it is a claim unless the official workflow made the run."""
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
    """Which agents cannot be shown apart, as a sentence; empty for none."""
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
    """The interval; pointing at it tells how many trials it is of, and what they could have seen."""
    shown = f"n {one.n}, could have seen {format_detectable(one.mde80, unit)}"
    return tag("small", ends, class_="soft", title=shown)


def _minus(text: str) -> str:
    return text.replace("-", "−")
