"""What an entry holds; works nothing out. Its schema is made from these records, see `hthor.leaderboard.schema`."""

from __future__ import annotations

from typing import Annotated, Final, Literal

import msgspec
from msgspec import UNSET, Meta, Struct, UnsetType

from hthor import jsonio
from hthor.eval.machine import Platform
from hthor.eval.result_file import Counts, Scores
from hthor.eval.setup import Setup
from hthor.eval.stats import Estimate
from hthor.eval.uplift import Uplift
from hthor.guest import File, Isolation, Manifest

SCHEMA: Final = "hthor.entry/6"
LOCKSTEP: Final = "lockstep"
REALTIME: Final = "realtime"

Sha256 = Annotated[str, Meta(pattern="^[0-9a-f]{64}$")]
Word = Annotated[str, Meta(min_length=1, max_length=120)]
Text = Annotated[str, Meta(max_length=2000)]
Base64 = Annotated[str, Meta(pattern="^[A-Za-z0-9+/]*={0,2}$")]
Count = Annotated[int, Meta(ge=0)]
Columns = Annotated[str, Meta(pattern="^[0-9a-z]*$")]


class Agent(Struct, frozen=True, kw_only=True):
    """Who it is, in its authors' words. Only the name is asked for."""

    name: Word
    version: Text = ""
    authors: tuple[Word, ...] = ()
    url: Text = ""
    licence: Text = ""
    description: Text = ""
    deterministic: bool = True


class Harness(Struct, frozen=True, kw_only=True):
    """What played: hthor's version, the last commit that changed it, and whether it had changes beyond that commit.

    ``commit`` is empty where hthor did not lie in a repository.
    """

    version: Word
    commit: Annotated[str, Meta(pattern="^([0-9a-f]{40})?$")]
    dirty: bool


class Hashes(Struct, frozen=True, kw_only=True):
    """Of the configuration, of all lines of the log, and the Merkle root of what `Trials` holds."""

    run: Sha256
    trials: Sha256
    merkle: Sha256


class Labels(Struct, frozen=True, kw_only=True):
    """A property of each trial: the values that there are, and each trial's as a character, 0 for the first."""

    names: tuple[Word, ...]
    of: Columns


class Trials(Struct, frozen=True, kw_only=True):
    """What became of each trial, in the order of people and their trials, in columns as `packing` makes them.

    Bits: ``met`` the goal was met, ``adopted`` a message was confirmed, ``faulty`` an agent failed. Numbers: ``twsr``
    in millionths (3 bytes), ``time`` in tenths of a second (2 bytes), ``trust`` (1 byte, 0 for none). ``leaves`` are
    the first 8 bytes of the SHA-256 of each line of the log. ``time_limit_s`` is the mean time limit of the tasks [s],
    the largest mean that the time spent can have.
    """

    count: Annotated[int, Meta(ge=1)]
    met: Base64
    adopted: Base64
    faulty: Base64
    twsr: Base64
    time: Base64
    trust: Base64
    leaves: Base64
    labels: dict[str, Labels]
    time_limit_s: Annotated[float, Meta(gt=0)] | UnsetType = UNSET


class Group(Struct, frozen=True, kw_only=True):
    """The trials that have a property in common."""

    sr: Estimate
    twsr: Estimate


class Verification(Struct, frozen=True, kw_only=True):
    """What came of playing trials again that were drawn after the entry was handed in.

    Attributes:
        tier: V1 byte for byte on the same platform, V2 by outcomes on another, V3 statistical.
        passed: whether the entry stands.
        entry: digest of the entry that was verified, without this.
        draw: the public word that the sample was drawn with. drawn: trials in it. compared: these, and those before
            them in the same sessions. equal: of the compared, those with the same outcome; same_bytes: the same record.
        platform: hash of the verifier's.
        by, date: as the verifier gave them. why: the verdict in words.
    """

    tier: Literal["V1", "V2", "V3"]
    passed: bool
    entry: Sha256
    draw: Word
    drawn: Count
    compared: Count
    equal: Count
    same_bytes: Count
    platform: Sha256
    by: Text = ""
    date: Text = ""
    why: Text


class Entry(Struct, frozen=True, kw_only=True):
    """A whole run on the board. ``id`` is its file's name without the ending.

    Attributes:
        reference: whether it is one of hthor's own agents, which are there to be measured against and have no rank.
        submission: the folder under submissions/ that the agent came from, empty for none.
        files: everything that was handed in with it.
        agents: what its agents consist of, with what they opened only in play; none for hthor's own.
        run: the run's configuration, as its run.json.
        mode: whether the world waited for the agent (lockstep) or its thinking took time (realtime).
        overrides: settings that depart from the benchmark's; there are none in an entry that is taken.
        platforms: where it was played; empty where that was not noted.
        splits: by property and value, such as "difficulty" and "hard".
        uplift: over no robot, the same people at the same tasks; None where there is no robot.
    """

    schema: Literal["hthor.entry/6"] = SCHEMA
    id: Annotated[str, Meta(pattern="^[A-Za-z0-9_+.-]+-[0-9a-f]{10}$")]
    reference: bool
    agent: Agent
    submission: Annotated[str, Meta(pattern="^([a-z0-9][a-z0-9_-]{0,39})?$")] = ""
    files: tuple[File, ...] = ()
    agents: tuple[Manifest, ...] = ()
    run: Setup
    hashes: Hashes
    harness: Harness
    mode: Literal["lockstep", "realtime"] = LOCKSTEP
    overrides: Annotated[dict[str, str], Meta(max_length=0)] = {}
    platforms: tuple[Platform, ...] = ()
    isolation: Isolation | None = None
    counts: Counts
    metrics: Scores
    splits: dict[str, dict[str, Group]]
    uplift: Uplift | None = None
    trials: Trials
    verification: Verification | None = None

    @property
    def digest(self) -> str:
        """Hash of all that was handed in: everything but what a verifier added later."""
        return jsonio.sha256(msgspec.structs.replace(self, verification=None))

    @property
    def alone(self) -> bool:
        """Whether there was no robot."""
        return not self.run.seats
