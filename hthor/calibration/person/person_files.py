"""Writes each person's numbers and page into a run's folder."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from hthor import jsonio
from hthor.calibration.person import profile, row_words
from hthor.calibration.person.profile import PersonProfile
from hthor.eval.records.run_folder import RunFolder
from hthor.humans.population.resolve import PROXY
from hthor.report.html import elements
from hthor.report.person import person_page


def write(run: Path, population: str = PROXY, person: int | None = None) -> list[tuple[PersonProfile, list[Path]]]:
    """Measure the people of a run, and write the numbers of each and the pages of those at pages.

    Args:
        run: the run's folder. population: to compare with. person: only the person of this number.

    Returns:
        each profile with the files that were written about that person.

    Raises:
        RunError, HthorError: as in `profile.profiles`, also when the folder holds no run.
    """
    folder = RunFolder(run)
    _ = folder.config  # raises an error for a folder without a run
    found = profile.profiles(run, population, person)
    pages = person_page.write_pages(folder, {one.participant: section(one) for one in found}, person)
    written = []
    for one in found:
        path = run / person_page.FOLDER / f"participant-{one.participant}.json"
        jsonio.write(path, jsonio.pretty(one))
        page = pages.get(one.participant)
        written.append((one, [path, *([page] if page else [])]))
    return written


def sections(run: Path) -> Mapping[int, str]:
    """Write the people's numbers, and return what their pages show of them, by the person's number."""
    for one in (found := profile.profiles(run)):
        jsonio.write(run / person_page.FOLDER / f"participant-{one.participant}.json", jsonio.pretty(one))
    return {one.participant: section(one) for one in found}


def section(one: PersonProfile) -> str:
    """What a person's page shows of their numbers."""
    rows = [
        (row.title, row_words.value_words(row.measure), row_words.people_words(row), row_words.place_words(row))
        for row in one.known
    ]
    others = [
        (row.title, row_words.value_words(row.measure), row.measure.how)
        for row in one.others
        if row.measure.value is not None
    ]
    parts = [
        "<h2>You, beside others</h2>",
        elements.paragraph(
            f"This is how you walked, handled things and answered, beside {one.people} simulated people who differ "
            "from each other as people are thought to. There is no better or worse in it. In brackets is the range "
            f"in which your own value probably lies ({100.0 * one.level:.0f} %): one session leaves much open."
        ),
        person_page.table(
            ("what", "you", "others", "you among them"),
            rows,
            "What could be measured of you; of others, the mean and the standard deviation.",
        ),
    ]
    if others:
        caption = "What else was measured; there are no such numbers of others."
        parts.append(person_page.table(("what", "you", "how"), others, caption))
    if one.reasons:
        items = [f"{', '.join(titles)}: {reason}." for reason, titles in one.reasons.items()]
        parts.append(elements.folded("What this session does not tell of you, and why", elements.bullets(items)))
    return "\n".join(parts)
