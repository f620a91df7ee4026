"""What a board accepts and what it ranks: lists of people, seeds and suites that its keeper wrote.

Without such lists anybody could open a section of their own: with a seed that suits an agent, with people of the same
name as ours, on hand-picked tasks. A board without the file accepts what `own` lists.
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
    """Something that is accepted: its name, for readers of the list, and the hash that decides."""

    name: Word
    sha256: Sha256


class AdmittedSuite(Admitted, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A suite that is accepted.

    ``standing`` is "ranked" for tasks that no agent can have known when it was submitted, and "development" for public
    ones, whose entries stand on the board without a rank.
    """

    standing: Standing


class Admission(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The lists. A run is accepted when its people, its seed and its suite are all on them."""

    schema: Literal["hthor.admission/1"] = _SCHEMA
    people: tuple[Admitted, ...]
    seeds: tuple[Annotated[int, Meta(ge=0)], ...]
    suites: tuple[AdmittedSuite, ...]

    def standing(self, entry: Entry) -> Standing | None:
        """The standing of an entry's suite; None when it is not on the list."""
        return next((one.standing for one in self.suites if one.sha256 == entry.run.suite.sha256), None)


@functools.cache
def default_admission() -> Admission:
    """What every board accepts: the people of the benchmark, seed 0, and hthor's own suites, which are public."""
    suites = (library.read_suite(name) for name in tasks.suite_names())
    return Admission(
        people=(Admitted(name=resolve.PROXY, sha256=resolve.resolve_humans(resolve.PROXY).sha256),),
        seeds=(0,),
        suites=tuple(AdmittedSuite(name=one.name, sha256=one.sha256, standing=DEVELOPMENT) for one in suites),
    )


def load_admission(board: Path) -> Admission:
    """The lists of a board.

    Raises:
        BoardError: when the file cannot be read, naming the field.
    """
    path = board / NAME
    return files.parse_document(path.read_bytes(), str(path), Admission) if path.is_file() else default_admission()


def extended_admission(board: Path, season: Commitment | None = None) -> Admission:
    """A board's lists with what this version of hthor brings, and with an official suite that is to be ranked."""
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
    """Why an entry is not accepted: fields, and what is wrong there."""
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
