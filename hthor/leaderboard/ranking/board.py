"""The list of a board: entries in sections that can be compared, with their ranks."""

from typing import Final, Literal

from msgspec import Struct

from hthor.eval.config.run_config import SuiteRef
from hthor.eval.results.paired_difference import Difference
from hthor.eval.statistics.intervals import Estimate
from hthor.leaderboard.entries.entry import Agent, Count, Group, Harness, Sha256
from hthor.leaderboard.entries.verification import Fresh, Replayed
from hthor.types.specs import Clock

SCHEMA: Final = "hthor.leaderboard/7"


class Standing(Struct, frozen=True, kw_only=True):
    """A rank among the agents of a section; 1 is the best.

    ``interval`` has the ranks that are not excluded at 95 %; ``ties`` has the ids of the agents that cannot be
    distinguished from this agent.
    """

    rank: int
    interval: tuple[int, int]
    ties: tuple[str, ...]


class Ranks(Struct, frozen=True, kw_only=True):
    """Ranks by success rate and by time-weighted success."""

    sr: Standing
    twsr: Standing


class Gain(Struct, frozen=True, kw_only=True):
    """Differences from the same people at the same tasks without a robot."""

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
    """A summary of an entry.

    Attributes:
        ranks: None if the entry has no rank; ``unranked`` says why.
        same_as: the id of the entry that is ranked instead, because both are one agent; empty if there is none.
        faults: trials in which the agent failed. replays: restarted sessions, as the run claims.
        isolation: how the agent was isolated; empty for hthor's own agents. Isolation and ``harness`` are claims unless
        the official workflow made the entry.
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
    """Entries that played the same trials with the same code and were scored by one version, best first.

    Only entries of one section can be compared.

    Attributes:
        standing: "ranked", or "development" if the tasks are public, so that no agent has a rank.
        humans: name and hash of the human population. calibrated: whether it is calibrated for the suite.
        rules, code: hashes of the benchmark's constants and of the code that can change a trial.
        scoring: hash of the code that judged the trials; empty if it was not noted.
        mode: as in the entries. trials, people: how many of them.
    """

    standing: Literal["ranked", "development"]
    suite: SuiteRef
    humans: str
    humans_sha256: Sha256
    calibrated: bool
    seed: int
    mode: Clock
    trials: int
    people: int
    rules: Sha256
    code: Sha256
    scoring: str = ""
    rows: tuple[Row, ...]


class Struck(Struct, frozen=True, kw_only=True):
    """An entry that was refuted and is not listed: its id, the agent's name, and the reason."""

    id: str
    name: str
    why: str


class Board(Struct, frozen=True, kw_only=True):
    """All entries. Ranked sections come first; then sections are sorted by suite, people, mode and code."""

    schema: Literal["hthor.leaderboard/7"] = SCHEMA
    sections: tuple[Section, ...]
    refuted: tuple[Struck, ...] = ()
