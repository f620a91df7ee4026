"""What `hthor humans profile` and `hthor live --calibrate` print about a person."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hthor.console import output

if TYPE_CHECKING:
    from hthor.calibration.person.profile import PersonProfile


def put_profile(one: PersonProfile) -> None:
    """Write one person's table to standard output, and what is not known of them."""
    from hthor.calibration.person import row_words

    known = [*one.known, *(row for row in one.others if row.measure.value is not None)]
    output.put_line(f"participant {one.participant}, {one.trials} trials; people: {one.people} of '{one.population}'")
    output.put_table(
        ("what", "name", "this person", "people", "among them", "z", "data"),
        [
            (
                row.title,
                row.measure.name,
                row_words.value_words(row.measure),
                row_words.people_words(row),
                row_words.place_words(row),
                row_words.z_words(row),
                row.measure.n,
            )
            for row in known
        ],
    )
    for reason, titles in one.reasons.items():
        output.put_line(f"not known: {', '.join(titles)}: {reason}.")
