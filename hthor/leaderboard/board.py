"""What the list holds: entries in sections of those that can be compared, with their ranks; works nothing out."""

from __future__ import annotations

from typing import Final, Literal

from msgspec import Struct

from hthor.eval.contrast import Difference
from hthor.eval.setup import SuiteRef
from hthor.eval.stats import Estimate
from hthor.leaderboard.entry import Agent, Count, Group, Harness, Sha256

SCHEMA: Final = "hthor.leaderboard/5"


class Standing(Struct, frozen=True, kw_only=True):
    """A place among the agents of a section: 1 is the best.

    ``interval`` holds the ranks that are not excluded at 95 %; ``ties`` the ids of the agents that cannot be told apart
    from this one.
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
    """What came of playing trials of the entry again."""

    tier: Literal["V1", "V2", "V3"]
    passed: bool
    compared: Count
    equal: Count


class Row(Struct, frozen=True, kw_only=True):
    """An entry in short. ``ranks`` is None for a reference, and for what a verifier refuted."""

    id: str
    name: str
    agent: Agent
    bodies: tuple[str, ...]
    privileges: tuple[str, ...]
    code: tuple[str, ...]
    reference: bool
    ranks: Ranks | None
    sr: Estimate
    twsr: Estimate
    adoption: Estimate
    time_s: Estimate
    trust: Estimate
    uplift: Gain | None
    splits: dict[str, dict[str, Group]]
    faults: Count
    isolation: str
    harness: Harness
    verification: Checked | None


class Section(Struct, frozen=True, kw_only=True):
    """Entries that played the same trials under the same code, best first; only these can be compared.

    Attributes:
        humans: who the people are, and the hash of all that makes them. calibrated: whether they are known to fit.
        rules, code: hashes of the benchmark's constants and of the code that can move a score.
        mode: as in the entries. trials, people: how many.
    """

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


class Board(Struct, frozen=True, kw_only=True):
    """Every entry. Sections are in order of suites, people, mode and code."""

    schema: Literal["hthor.leaderboard/5"] = SCHEMA
    sections: tuple[Section, ...]
