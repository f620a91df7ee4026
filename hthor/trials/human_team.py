"""The people of a trial: for each seat, the population that its people are drawn from."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from msgspec import Struct

from hthor import jsonio
from hthor.errors import HthorError
from hthor.humans.model import HumanModel, State
from hthor.humans.population import resolve
from hthor.humans.population.resolve import ParticipantSource
from hthor.types import HUMAN, HumanSeat

COMMA = ","
"""Joins the people of one trial in a word of `--humans`, in the order of their seats."""


class HumanTeam(Struct, frozen=True, kw_only=True, eq=False):
    """The people who are together in every trial of a run; ``members`` are in the order of their seats."""

    members: tuple[ParticipantSource, ...]

    @property
    def name(self) -> str:
        """A name for tables and files, such as "proxy", or "greedy+proxy" for two people."""
        return "+".join(member.name for member in self.members)

    @property
    def word(self) -> str:
        """A word of `--humans` that means the same in any process and from any folder."""
        return COMMA.join(member.word for member in self.members)

    @property
    def models(self) -> tuple[str, ...]:
        """The human model of each person: its name, or the path of its file."""
        return tuple(member.model for member in self.members)

    @property
    def sha256(self) -> str:
        """Hash of everything that decides how these people behave, except hthor's own code."""
        hashes = [member.sha256 for member in self.members]
        return hashes[0] if len(hashes) == 1 else jsonio.sha256(hashes)

    def seats(self, session: int) -> tuple[HumanSeat, ...]:
        """The people of a session, which is counted from 0: those with the next numbers in the study."""
        first = session * len(self.members)
        return tuple(
            HumanSeat(
                seat=HUMAN if place == 0 else f"{HUMAN}{place + 1}",
                model=member.name,
                sha256=member.sha256,
                participant=first + place,
            )
            for place, member in enumerate(self.members)
        )

    def make_models(
        self, seed: int, seats: Sequence[HumanSeat], states: Mapping[str, State] | None = None
    ) -> dict[str, HumanModel]:
        """The human model of each of these people of the study with this seed, by seat.

        Args:
            states: what they remember of earlier trials, by seat; without it, they are before their first.
        """
        known = states or {}
        pairs = zip(seats, self.members, strict=True)
        return {seat.seat: member.make_model(seed, seat.participant, known.get(seat.seat)) for seat, member in pairs}


def split_word(word: str) -> tuple[str, ...]:
    """The word of each person in a word of `--humans`.

    Raises:
        HthorError: when a comma has nothing before or after it.
    """
    if COMMA not in word or Path(word).exists():
        return (word,)
    parts = tuple(part.strip() for part in word.split(COMMA))
    if not all(parts):
        raise HthorError(
            f"--humans '{word}': a comma joins the people of one trial, so name a population on both sides of it, "
            "as in proxy,proxy."
        )
    return parts


def find_team(word: str) -> HumanTeam:
    """The people that a word of `--humans` stands for; errors as in `split_word` and `resolve.resolve_humans`.

    Raises:
        HthorError: also when two different populations have the same name.
    """
    return form_team([resolve.resolve_humans(part) for part in split_word(word)])


def form_team(members: Sequence[ParticipantSource]) -> HumanTeam:
    """The people of a trial, one of each population; raises HthorError when two of these have the same name."""
    hashes: dict[str, str] = {}
    for member in members:
        if hashes.setdefault(member.name, member.sha256) != member.sha256:
            raise HthorError(f"two different populations are called '{member.name}'. Rename one of the files.")
    return HumanTeam(members=tuple(members))
