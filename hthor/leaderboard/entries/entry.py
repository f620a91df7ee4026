"""What an entry holds; works nothing out. Its schema is made from these records, see `hthor.leaderboard.schema`."""

from __future__ import annotations

from typing import Annotated, Final, Literal

from msgspec import UNSET, Meta, Struct, UnsetType

from hthor import jsonio
from hthor.eval.config.run_config import RunConfig
from hthor.eval.records.platform import Platform
from hthor.eval.results.uplift import Uplift
from hthor.eval.statistics.intervals import Estimate
from hthor.guest import File, Isolation, Manifest

SCHEMA: Final = "hthor.entry/6"
LOCKSTEP: Final = "lockstep"
REALTIME: Final = "realtime"
_FOLLOW = ("metrics", "splits", "uplift")

Sha256 = Annotated[str, Meta(pattern="^[0-9a-f]{64}$")]
Word = Annotated[str, Meta(min_length=1, max_length=120, pattern=r"^[^\x00-\x1f\x7f]*$(?!\n)")]
Text = Annotated[str, Meta(max_length=2000, pattern=r"^[^\x00-\x08\x0b-\x1f\x7f]*$")]
Url = Annotated[str, Meta(max_length=500, pattern=r"^(https?://[^\s<>\"'`\\]+)?$(?!\n)")]
Version = Annotated[str, Meta(pattern=r"^[0-9A-Za-z][0-9A-Za-z.+!_-]{0,39}$(?!\n)")]
Label = Annotated[str, Meta(pattern=r"^[a-z][a-z0-9_]{0,39}$(?!\n)")]
Base64 = Annotated[str, Meta(pattern="^[A-Za-z0-9+/]*={0,2}$")]
Count = Annotated[int, Meta(ge=0)]
Columns = Annotated[str, Meta(pattern="^[0-9a-z]*$")]


class Agent(Struct, frozen=True, kw_only=True):
    """Who it is, in its authors' words. Only the name is asked for.

    ``team`` is who hands it in; without one its authors are the team. ``deterministic`` says that it repeats itself.
    """

    name: Word
    version: Text = ""
    team: Text = ""
    authors: tuple[Word, ...] = ()
    url: Url = ""
    licence: Text = ""
    description: Text = ""
    deterministic: bool = True


class Harness(Struct, frozen=True, kw_only=True):
    """What played: hthor's version, the last commit that changed it, and whether it had changes beyond that commit.

    Nothing in an entry bears this out: it is a claim until an official run made the entry. ``commit`` is empty where
    hthor did not lie in a repository.
    """

    version: Version
    commit: Annotated[str, Meta(pattern="^([0-9a-f]{40})?$")]
    dirty: bool


class Hashes(Struct, frozen=True, kw_only=True):
    """Of the configuration, of all lines of the log, and the Merkle root of what `Trials` holds."""

    run: Sha256
    trials: Sha256
    merkle: Sha256


class Labels(Struct, frozen=True, kw_only=True):
    """A property of each trial: the values that there are, and each trial's as a character, 0 for the first."""

    names: tuple[Label, ...]
    of: Columns


class Trials(Struct, frozen=True, kw_only=True):
    """What became of each trial, in the order of people and their trials, in columns as `packing` makes them.

    Bits: ``met`` the goal was met, ``adopted`` a message was confirmed, ``faulty`` an agent failed. Numbers: ``twsr``
    in millionths (3 bytes), ``time`` in tenths of a second (2 bytes), ``trust`` (1 byte, 0 for none). Of the
    robots' messages: how many were ``sent`` (2 bytes), ``accepted`` by the person, and ``useful``, which is accepted,
    true and new to them (1 byte each, 255 for as many or more). ``leaves`` are the first 8 bytes of the SHA-256 of each
    line of the log. ``time_limit_s`` is the mean time limit of the tasks [s].
    """

    count: Annotated[int, Meta(ge=1)]
    met: Base64
    adopted: Base64
    faulty: Base64
    twsr: Base64
    time: Base64
    trust: Base64
    sent: Base64
    accepted: Base64
    useful: Base64
    leaves: Base64
    labels: dict[str, Labels]
    time_limit_s: Annotated[float, Meta(gt=0)] | UnsetType = UNSET


class Group(Struct, frozen=True, kw_only=True):
    """The trials that have a property in common."""

    sr: Estimate
    twsr: Estimate


class Metrics(Struct, frozen=True, kw_only=True):
    """What follows from `Trials`, as `hthor.eval.metrics.trial_metrics` defines it; everything else of a run is in its
    own result.
    """

    sr: Estimate
    twsr: Estimate
    adoption: Estimate
    usefulness: Estimate
    time_s: Estimate
    trust: Estimate


class Counts(Struct, frozen=True, kw_only=True):
    """How many trials there were, with the goal met, and with an agent that failed; and messages of robots.

    ``faults_by_kind`` counts faults by what they were, ``replays`` the sessions that began again: both are claims, for
    nothing in an entry bears them out.
    """

    trials: Count
    successes: Count
    messages: Count
    faults: Count
    faults_by_kind: dict[Word, Count] = {}
    replays: Count = 0


class Entry(Struct, frozen=True, kw_only=True):
    """A whole run on the board. ``id`` is its file's name without the ending.

    What came of playing trials again is the keeper's to say, in files of their own:
    `hthor.leaderboard.entries.verification`.

    Attributes:
        reference: whether it is one of hthor's own agents, which are there to be measured against and have no rank.
        submission: the folder under submissions/ that the agent came from, empty for none.
        files: everything that was handed in with it.
        agents: what its agents consist of, with what they opened only in play; none for hthor's own.
        run: the run's configuration, as its run.json.
        mode: whether the world waited for the agent (lockstep) or its thinking took time (realtime).
        overrides: settings that depart from the benchmark's; there are none in an entry that is taken.
        platforms: where it was played; empty where that was not noted. isolation: what held the agent. Both are claims
            until an official run made the entry.
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
    run: RunConfig
    hashes: Hashes
    harness: Harness
    mode: Literal["lockstep", "realtime"] = LOCKSTEP
    overrides: Annotated[dict[str, str], Meta(max_length=0)] = {}
    platforms: tuple[Platform, ...] = ()
    isolation: Isolation | None = None
    counts: Counts
    metrics: Metrics
    splits: dict[str, dict[str, Group]]
    uplift: Uplift | None = None
    trials: Trials

    @property
    def digest(self) -> str:
        """Hash of all that was handed in; numbers that follow from it are left out, as later statistics may differ."""
        held = {name: getattr(self, name) for name in self.__struct_fields__ if name not in _FOLLOW}
        return jsonio.sha256({**held, "control": self.uplift.control if self.uplift else ""})

    @property
    def code(self) -> tuple[str, ...]:
        """Hashes of its agents' code."""
        return tuple(dict.fromkeys(robot.agent.sha256 for robot in self.run.robots))

    @property
    def team(self) -> str:
        """Who handed it in, as ranks count them: the team, without one the authors, without those the agent's name."""
        about = self.agent
        return about.team or ", ".join(sorted(about.authors)) or about.name

    @property
    def alone(self) -> bool:
        """Whether there was no robot."""
        return not self.run.seats
