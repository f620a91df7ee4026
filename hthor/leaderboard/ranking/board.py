"""What the list holds: entries in sections of those that can be compared, with their ranks."""

from typing import Final, Literal

from msgspec import Struct

from hthor.eval.config.run_config import SuiteRef
from hthor.eval.results.paired_difference import Difference
from hthor.eval.statistics.intervals import Estimate
from hthor.leaderboard.entries.entry import Agent, Count, Group, Harness, Sha256
from hthor.leaderboard.entries.verification import Fresh, Replayed

SCHEMA: Final = "hthor.leaderboard/6"


class Standing(Struct, frozen=True, kw_only=True):
    """A place among the agents of a section: 1 is the best.

    ``interval`` holds the ranks that are not excluded at 95 %; ``ties`` the ids of the agents that cannot be
    distinguished from this one.
    """

    rank: int
    interval: tuple[int, int]
    ties: tuple[str, ...]


class Ranks(Struct, frozen=True, kw_only=True):
    """By success rate, and by time-weighted success."""

    sr: Standing
    twsr: Standing


class Gain(Struct, frozen=True, kw_only=True):
    """Over no robot."""

    sr: Difference
    twsr: Difference
    time_s: Difference


class Checked(Struct, frozen=True, kw_only=True):
    """The result of replaying the entry, from its `Verification`."""

    trials: Replayed
    control: Replayed | None
    fresh: Fresh | None
    official: bool


class Row(Struct, frozen=True, kw_only=True):
    """An entry in short.

    Attributes:
        ranks: None where there is none; ``unranked`` says why.
        same_as: the id of the entry that is counted in this one's place, as both are one agent; empty for none.
        faults: trials in which the agent failed. replays: sessions that were restarted, as the run claims.
        isolation: how the agent was isolated, empty for one that is built in. It and ``harness`` are claims unless the
            official workflow made the entry.
    """

    id: str
    name: str
    agent: Agent
    team: str
    bodies: tuple[str, ...]
    privileges: tuple[str, ...]
    code: tuple[str, ...]
    reference: bool
    ranks: Ranks | None
    unranked: str
    same_as: str
    sr: Estimate
    twsr: Estimate
    adoption: Estimate
    usefulness: Estimate
    time_s: Estimate
    trust: Estimate
    uplift: Gain | None
    splits: dict[str, dict[str, Group]]
    faults: Count
    replays: Count
    isolation: str
    harness: Harness
    verification: Checked | None

    @property
    def official(self) -> bool:
        """Whether the official workflow made the entry."""
        return self.verification is not None and self.verification.official


class Section(Struct, frozen=True, kw_only=True):
    """Entries that played the same trials under the same code, best first; only these can be compared.

    Attributes:
        standing: "ranked", or "development" where the tasks are public and no agent has a rank.
        humans: who the people are, and the hash of all that makes them. calibrated: whether they are known to fit.
        rules, code: hashes of the benchmark's constants and of the code that can move a score.
        mode: as in the entries. trials, people: how many.
    """

    standing: Literal["ranked", "development"]
    suite: SuiteRef
    humans: str
    humans_sha256: Sha256
    calibrated: bool
    seed: int
    mode: Literal["lockstep", "realtime"]
    trials: int
    people: int
    rules: Sha256
    code: Sha256
    rows: tuple[Row, ...]


class Struck(Struct, frozen=True, kw_only=True):
    """An entry that was refuted and does not stand: its id, the agent's name, and why."""

    id: str
    name: str
    why: str


class Board(Struct, frozen=True, kw_only=True):
    """Every entry. Sections are in order: ranked ones first, then of suites, people, mode and code."""

    schema: Literal["hthor.leaderboard/6"] = SCHEMA
    sections: tuple[Section, ...]
    refuted: tuple[Struck, ...] = ()
