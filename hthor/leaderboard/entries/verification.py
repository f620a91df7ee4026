"""Files that the keeper of a board writes: verifications and refutations of entries.

They are separate from the entries, and no submission may change them. An entry does not contain its own verification.
So nobody can submit a verification, and editing an entry does not bring a refuted run back.
"""

from pathlib import Path
from typing import Annotated, Final, Literal, TypeVar

from msgspec import Meta, Struct

from hthor.eval.statistics.intervals import Estimate
from hthor.leaderboard.entries import files
from hthor.leaderboard.entries.entry import Count, Entry, Sha256, Text, Word

VERIFICATIONS: Final = "verifications"
REFUTATIONS: Final = "refutations"
MIN_DETECTION: Final = 0.95
"""The probability of catching three false outcomes in sixty that an entry needs at least to be ranked."""
Tier = Literal["V1", "V2", "V3"]
_T = TypeVar("_T")
Share = Annotated[float, Meta(ge=0.0, le=1.0)]


class Replayed(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The result of replaying trials.

    Attributes:
        tier: V1 byte for byte on the same platform, V2 by outcomes on another platform, V3 statistical.
        passed: whether the replayed trials confirm the entry.
        drawn: trials in the sample. compared: these, and the trials before them in the same sessions. equal: compared
        trials with the same outcome. same_bytes: compared trials with the same record.
        caught: the probability that such a sample refutes an entry in which one outcome in twenty is false.
        why: the verdict in words.
    """

    tier: Tier
    passed: bool
    drawn: Count
    compared: Count
    equal: Count
    same_bytes: Count
    caught: Share
    why: Text


class Fresh(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The agent's results at tasks drawn after its submission, by the same recipe as the entry's suite.

    Attributes:
        suite: hash of the fresh tasks. n: how many tasks.
        sr, twsr: the results. claimed_sr, claimed_twsr: the entry's means.
        fell: whether the results are lower than chance explains, at the 1 % level.
        detectable: the drop of success that this many tasks detect with a power of 80 %, by simulation; None if they
        detect no drop.
        why: the verdict in words.
    """

    suite: Sha256
    n: Count
    sr: Estimate
    twsr: Estimate
    claimed_sr: Share
    claimed_twsr: Share
    fell: bool
    detectable: Share | None
    why: Text


class Verification(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The result of verifying an entry, in ``verifications/ID.json``.

    Attributes:
        id: of the entry. entry: hash of the entry's contents at that time.
        draw: the public random word from which all samples were drawn.
        trials: those of the agent. control: those of people without a robot, None if the entry is the control itself.
        fresh: results at unseen tasks, None if none were played.
        official: whether the official workflow made the entry; then isolation, platform and commit are not mere claims.
        platform: hash of the verifier's platform. by, date: who verified and when, as the verifier stated.
    """

    schema: Literal["hthor.verification/1"] = "hthor.verification/1"
    id: Word
    entry: Sha256
    draw: Word
    trials: Replayed
    control: Replayed | None = None
    fresh: Fresh | None = None
    official: bool = False
    platform: Sha256
    by: Text = ""
    date: Text = ""

    @property
    def refuted(self) -> bool:
        """Whether claims about the agent or its control are false."""
        return not all(one.passed for one in self._played)

    @property
    def fell(self) -> bool:
        """Whether the agent did worse at tasks that it could not know before."""
        return self.fresh is not None and self.fresh.fell

    @property
    def caught(self) -> float:
        """The probability that a forged entry would have been caught: the lower one of agent and control."""
        return min(one.caught for one in self._played)

    @property
    def _played(self) -> tuple[Replayed, ...]:
        return (self.trials, *([self.control] if self.control else []))


class Refutation(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A refuted run, in ``refutations/MERKLE.json``; the file stays when the entry's file is removed.

    ``merkle`` and ``run`` are as in `Hashes`; ``code`` are the agents' hashes, ``entry`` is the whole entry's.
    """

    schema: Literal["hthor.refutation/1"] = "hthor.refutation/1"
    id: Word
    name: Word
    entry: Sha256
    merkle: Sha256
    run: Sha256
    code: tuple[Sha256 | Literal[""], ...]
    draw: Word
    why: Text
    by: Text = ""
    date: Text = ""

    def applies_to(self, entry: Entry, verified: Verification | None) -> bool:
        """Whether it applies to this entry: the same outcomes under any name, or the same run until that is verified.

        So the agent's true results can be submitted later and are valid once verified; the false results never are.
        """
        if self.merkle == entry.hashes.merkle:
            return True
        sound = verified is not None and not verified.refuted
        return self.run == entry.hashes.run and not sound


class KeeperRecords(Struct, frozen=True, kw_only=True):
    """Everything that a board's keeper wrote: verifications by the entries' ids, and refutations."""

    verifications: dict[str, Verification]
    refutations: tuple[Refutation, ...]

    def verification_of(self, entry: Entry) -> Verification | None:
        """The verification of exactly this entry, not of an earlier file with the same name; None if there is none."""
        found = self.verifications.get(entry.id)
        return found if found is not None and found.entry == entry.digest else None

    def refutation_of(self, entry: Entry) -> Refutation | None:
        """The refutation that applies to an entry; None if there is none."""
        verified = self.verification_of(entry)
        return next((one for one in self.refutations if one.applies_to(entry, verified)), None)


NO_RECORDS = KeeperRecords(verifications={}, refutations=())


def load_records(board: Path) -> KeeperRecords:
    """Read everything that the keeper of a board wrote.

    Raises:
        BoardError: if a file cannot be read, or its name does not agree with its contents.
    """
    verified = [_read(path, Verification, "id") for path in sorted((board / VERIFICATIONS).glob("*.json"))]
    refuted = [_read(path, Refutation, "merkle") for path in sorted((board / REFUTATIONS).glob("*.json"))]
    return KeeperRecords(verifications={one.id: one for one in verified}, refutations=tuple(refuted))


def read_verification(path: Path) -> Verification:
    """Read a verification from its file.

    Raises:
        BoardError: if it cannot be read.
    """
    return files.parse_document(path.read_bytes(), str(path), Verification)


def entry_path(board: Path, found: Verification) -> Path:
    """The file of the entry to which a verification belongs.

    Raises:
        BoardError: if the board has no such entry.
    """
    path = board / files.ENTRIES / f"{found.id}.json"
    if path not in files.entry_paths(board):
        raise files.BoardError(f"{path}: there is no such entry, but this verification belongs to it.")
    return path


def write_verification(board: Path, entry: Entry, found: Verification) -> list[Path]:
    """Write a verification, and a refutation if the entry or its control failed; return the paths.

    Raises:
        BoardError: if the verification does not belong to the entry's present contents.
    """
    if found.id != entry.id or found.entry != entry.digest:
        there = f"{found.id} with the hash {found.entry[:10]}"
        raise files.BoardError(f"{entry.id}: this verification is of {there}; the entry's is {entry.digest[:10]}.")
    written = [board / VERIFICATIONS / f"{entry.id}.json"]
    files.write_document(written[0], found)
    for one, played in ((entry, found.trials), (find_control(board, entry), found.control)):
        if one is not None and played is not None and not played.passed:
            struck = _refutation(one, found, played.why)
            written.append(board / REFUTATIONS / f"{struck.merkle}.json")
            files.write_document(written[-1], struck)
    return written


def find_control(board: Path, entry: Entry) -> Entry | None:
    """The entry on the board that is the control of this one; None if the board has no such entry."""
    if entry.uplift is None:
        return None
    others = (files.read_entry(path) for path in files.entry_paths(board))
    return next((one for one in others if one.alone and one.hashes.run == entry.uplift.control), None)


def _refutation(entry: Entry, found: Verification, why: str) -> Refutation:
    return Refutation(
        id=entry.id,
        name=entry.agent.name,
        entry=entry.digest,
        merkle=entry.hashes.merkle,
        run=entry.hashes.run,
        code=entry.code,
        draw=found.draw,
        why=why,
        by=found.by,
        date=found.date,
    )


def _read(path: Path, sort: type[_T], name: str) -> _T:
    found = files.parse_document(path.read_bytes(), str(path), sort)
    if (called := getattr(found, name)) != path.stem:
        raise files.BoardError(f"{path}: {name}: is '{called}', but must be the file's name, '{path.stem}'")
    return found
