"""The record of an entry; `hthor.leaderboard.schema` makes the JSON schema from it."""

from typing import Annotated, Final, Literal

from msgspec import UNSET, Meta, Struct, UnsetType

from hthor import jsonio
from hthor.eval.config.run_config import RunConfig
from hthor.eval.records.platform import Platform
from hthor.eval.results.result_file import Uplift
from hthor.eval.statistics.intervals import Estimate
from hthor.guest import File, Isolation, Manifest
from hthor.types.specs import LOCKSTEP, Clock

SCHEMA: Final = "hthor.entry/7"
_FOLLOW = ("metrics", "splits", "uplift", "scoring_sha256")

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
    """The agent, described by its authors. Only the name is required.

    ``team`` submits the agent; if empty, the authors are the team. ``deterministic``: it repeats its actions exactly.
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
    """The hthor that ran: its version, the last commit that changed it, and whether it had uncommitted changes.

    An entry contains no proof of this: it is a claim unless an official run made the entry. ``commit`` is empty if
    hthor was not in a repository.
    """

    version: Version
    commit: Annotated[str, Meta(pattern="^([0-9a-f]{40})?$")]
    dirty: bool


class Hashes(Struct, frozen=True, kw_only=True):
    """Hashes of the run config and of all lines of the log, and the Merkle root of the rows of `Trials`."""

    run: Sha256
    trials: Sha256
    merkle: Sha256


class Labels(Struct, frozen=True, kw_only=True):
    """A property of each trial: its possible values, and each trial's value as a character, 0 for the first value."""

    names: tuple[Label, ...]
    of: Columns


class Trials(Struct, frozen=True, kw_only=True):
    """The outcome of each trial, ordered by participant and then by trial, in columns packed by `column_packing`.

    Bits: ``met`` the goal was met, ``adopted`` a message was accepted, ``faulty`` an agent failed. Numbers: ``twsr``
    in millionths (3 bytes), ``time`` in tenths of a second (2 bytes), ``trust`` (1 byte, 0 for none). Numbers of
    robots' messages: ``sent`` (2 bytes), ``accepted`` by the person, and ``useful``: accepted, true and new to the
    person (1 byte each, 255 for 255 or more). ``leaves`` are the first 8 bytes of the SHA-256 of each line of the log.
    ``time_limit_s`` is the mean time limit of the tasks [s]. ``metrics_sha256`` is the hash of the code of the metrics
    in the columns; older entries do not have it.
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
    metrics_sha256: Sha256 | UnsetType = UNSET


class Group(Struct, frozen=True, kw_only=True):
    """Scores of the trials that have a property in common."""

    sr: Estimate
    twsr: Estimate


class Metrics(Struct, frozen=True, kw_only=True):
    """The metrics that are computed from `Trials`; see `hthor.eval.metrics`."""

    sr: Estimate
    twsr: Estimate
    adoption: Estimate
    usefulness: Estimate
    time_s: Estimate
    trust: Estimate


class Counts(Struct, frozen=True, kw_only=True):
    """Numbers of trials, of trials with the goal met, of robots' messages, and of trials with an agent that failed.

    ``faults_by_kind`` counts faults by kind, ``replays`` counts restarted sessions: both are claims, which an entry
    does not prove.
    """

    trials: Count
    successes: Count
    messages: Count
    faults: Count
    faults_by_kind: dict[Word, Count] = {}
    replays: Count = 0


class Entry(Struct, frozen=True, kw_only=True):
    """A whole run on the board. ``id`` is the name of the entry's file without its ending.

    The results of replaying its trials are in separate files, see `hthor.leaderboard.entries.verification`.

    Attributes:
        reference: whether the agent is hthor's own; others are compared with it, and it has no rank.
        submission: the folder in submissions/ from which the agent came; empty if there is none.
        files: all files that were submitted with the agent.
        agents: the files of its agents, including those that they opened while running; none for hthor's own agents.
        run: the run's configuration, as in its run.json.
        mode: the decision clock: whether the world waited for the agent, charged its time, or went on meanwhile.
        overrides: settings other than the benchmark's; empty in a valid entry.
        platforms: where the run was played; empty if it did not record this. isolation: how the agent was isolated.
        Both are claims unless an official run made the entry.
        scoring_sha256: the scoring version that made all numbers of the entry from its log; absent if no single version
        did, or it was not noted. What can change a trial is in ``run.code_sha256``.
        splits: scores by property and value, such as "difficulty" and "hard".
        uplift: over the same people at the same tasks without a robot; None if the run has no robot.
    """

    schema: Literal["hthor.entry/7"] = SCHEMA
    id: Annotated[str, Meta(pattern="^[A-Za-z0-9_+.-]+-[0-9a-f]{10}$")]
    reference: bool
    agent: Agent
    submission: Annotated[str, Meta(pattern="^([a-z0-9][a-z0-9_-]{0,39})?$")] = ""
    files: tuple[File, ...] = ()
    agents: tuple[Manifest, ...] = ()
    run: RunConfig
    hashes: Hashes
    harness: Harness
    mode: Clock = LOCKSTEP
    overrides: Annotated[dict[str, str], Meta(max_length=0)] = {}
    platforms: tuple[Platform, ...] = ()
    isolation: Isolation | None = None
    counts: Counts
    scoring_sha256: Sha256 | UnsetType = UNSET
    metrics: Metrics
    splits: dict[str, dict[str, Group]]
    uplift: Uplift | None = None
    trials: Trials

    @property
    def digest(self) -> str:
        """Hash of everything submitted, without the numbers computed from it, because statistics may change."""
        held = {name: getattr(self, name) for name in self.__struct_fields__ if name not in _FOLLOW}
        return jsonio.sha256({**held, "control": self.uplift.control if self.uplift else ""})

    @property
    def code(self) -> tuple[str, ...]:
        """Hashes of the code of its agents."""
        return tuple(dict.fromkeys(robot.agent.sha256 for robot in self.run.robots))

    @property
    def team(self) -> str:
        """The name of the submitter for ranks: the team, else the authors, else the agent's name."""
        about = self.agent
        return about.team or ", ".join(sorted(about.authors)) or about.name

    @property
    def alone(self) -> bool:
        """Whether the run had no robot."""
        return not self.run.seats
