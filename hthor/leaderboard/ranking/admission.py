"""Which runs a board accepts and ranks: lists of human populations, seeds and suites, written by its keeper.

Without such lists anybody could open a section of their own: with a seed that suits an agent, with other people under
the same name, on hand-picked tasks. A board without such a file accepts the lists of `default_admission`.
"""

import functools
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Final, Literal

import msgspec
from msgspec import Meta, Struct

from hthor import tasks
from hthor.humans.population import resolve
from hthor.leaderboard.entries import files
from hthor.leaderboard.entries.entry import Entry, Sha256, Word
from hthor.tasks.suites import library
from hthor.tasks.suites.commitment import Commitment

NAME: Final = "admission.json"
RANKED: Final = "ranked"
DEVELOPMENT: Final = "development"
_SCHEMA: Final = "hthor.admission/1"
Standing = Literal["ranked", "development"]


class Admitted(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Something that is accepted: its name, for readers of the list, and its hash, which decides."""

    name: Word
    sha256: Sha256


class AdmittedSuite(Admitted, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A suite that is accepted.

    ``standing`` is "ranked" if no agent can have known the tasks when it was submitted, and "development" if the tasks
    are public; entries of development suites are on the board without a rank.
    """

    standing: Standing


class Admission(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The lists. A run is accepted if its people, its seed and its suite are all on them."""

    schema: Literal["hthor.admission/1"] = _SCHEMA
    people: tuple[Admitted, ...]
    seeds: tuple[Annotated[int, Meta(ge=0)], ...]
    suites: tuple[AdmittedSuite, ...]

    def standing(self, entry: Entry) -> Standing | None:
        """The standing of an entry's suite; None if the suite is not on the list."""
        return next((one.standing for one in self.suites if one.sha256 == entry.run.suite.sha256), None)


@functools.cache
def default_admission() -> Admission:
    """The lists of every board: the people of the benchmark, seed 0, and hthor's own suites, which are public."""
    suites = (library.read_suite(name) for name in tasks.suite_names())
    return Admission(
        people=(Admitted(name=resolve.PROXY, sha256=resolve.resolve_humans(resolve.PROXY).sha256),),
        seeds=(0,),
        suites=tuple(AdmittedSuite(name=one.name, sha256=one.sha256, standing=DEVELOPMENT) for one in suites),
    )


def load_admission(board: Path) -> Admission:
    """Read the lists of a board.

    Raises:
        BoardError: if the file cannot be read; names the field.
    """
    path = board / NAME
    return files.parse_document(path.read_bytes(), str(path), Admission) if path.is_file() else default_admission()


def extended_admission(board: Path, season: Commitment | None = None) -> Admission:
    """A board's lists, extended by those of this version of hthor and by an official suite that is to be ranked."""
    there, here = load_admission(board), default_admission()
    suites = {one.sha256: one for one in (*here.suites, *there.suites)}
    if season is not None:
        suites[season.suite_sha256] = AdmittedSuite(name=season.name, sha256=season.suite_sha256, standing=RANKED)
    return msgspec.structs.replace(
        there,
        people=tuple(dict.fromkeys((*there.people, *here.people))),
        seeds=tuple(sorted({*there.seeds, *here.seeds})),
        suites=tuple(sorted(suites.values(), key=lambda one: (one.standing, one.name, one.sha256))),
    )


def admission_problems(entry: Entry, taken: Admission) -> Iterator[tuple[str, str]]:
    """Reasons why an entry is not accepted, as pairs of a field and a description."""
    run, how = entry.run, f"see {NAME}, which the board's keeper writes"
    if run.humans.sha256 not in {one.sha256 for one in taken.people}:
        names = ", ".join(dict.fromkeys(one.name for one in taken.people))
        who = f"'{run.humans.name}' with the hash {run.humans.sha256[:10]}"
        yield "run.humans.sha256", f"is of people that this board does not take, {who}; it takes {names} ({how})"
    if run.seed not in taken.seeds:
        seeds = ", ".join(str(seed) for seed in taken.seeds)
        yield "run.seed", f"is {run.seed}, and this board takes {seeds}: chance is not to be chosen ({how})"
    if taken.standing(entry) is None:
        names = ", ".join(dict.fromkeys(one.name for one in taken.suites))
        which = f"'{run.suite.name}' with the hash {run.suite.sha256[:10]}"
        yield "run.suite.sha256", f"is of a suite that this board does not take, {which}; it takes {names} ({how})"
