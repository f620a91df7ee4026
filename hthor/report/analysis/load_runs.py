"""Reads several runs from their folders and checks that they belong together."""

import hashlib
from collections.abc import Sequence
from pathlib import Path

import msgspec
from msgspec import Struct

from hthor.errors import RunError
from hthor.eval.config.run_config import RunConfig
from hthor.eval.records.attempts import VoidedTrial
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.records.scored_trial import ScoredTrial
from hthor.eval.results import baseline
from hthor.log_corrections import CorrectAdoption, VoidTrial
from hthor.trials.robot_team import NO_ROBOT

NONE = NO_ROBOT
Pair = tuple[int, int, int, str]
"""Seed, session, place in the session and task of a trial. Trials of two runs with an equal key form a pair."""


class Run(Struct, frozen=True, kw_only=True, eq=False):
    """One run: its configuration, its trials in order with newly computed metrics, and its names in the report.

    ``name`` is the name of its folder, preceded by the parent folder's if needed to tell runs apart. ``sha256`` is the
    hash of its log as in `hthor.eval.results.aggregate`. ``voided`` has the attempts that do not count, ``given_up`` is
    the number of trials that a correction voided for good, and ``corrections`` has all corrections in effect.
    ``beside`` is true if the user did not name the run: the report found it next to another run, as its baseline.
    """

    folder: Path
    name: str
    plan: RunConfig
    records: tuple[ScoredTrial, ...]
    sha256: str
    label: str
    condition: str
    voided: tuple[VoidedTrial, ...] = ()
    given_up: int = 0
    corrections: tuple[VoidTrial | CorrectAdoption, ...] = ()
    beside: bool = False

    @property
    def planned(self) -> int:
        """How many trials the run has when it is finished, those left out that a correction voided for good."""
        return self.plan.trials - self.given_up

    @property
    def by_pair(self) -> dict[Pair, ScoredTrial]:
        """The trials by the key that pairs them with trials of other runs."""
        return {pairing_key(record): record for record in self.records}


def pairing_key(record: ScoredTrial) -> Pair:
    """The key by which a trial is paired with that of the same people at the same task with other robots."""
    spec = record.spec
    return (spec.seed, spec.session, spec.index, spec.task.id)


def load_runs(folders: Sequence[Path]) -> list[Run]:
    """Read every run, in the order of ``folders``.

    Raises:
        RunError: if a folder holds no run, one of its files is damaged, or the runs do not belong together.
    """
    found = [_read(folder) for folder in folders]
    for one in found[1:]:
        _together(found[0], one)
    _distinct(found)
    return _named(found)


def with_baselines(found: Sequence[Run]) -> list[Run]:
    """The runs; each human population that has no baseline gets one in front, if one lies next to its runs."""
    whole: list[Run] = []
    for one in found:
        people = one.plan.humans.name
        if not any(not other.plan.seats and other.plan.humans.name == people for other in (*found, *whole)):
            place = baseline.baseline_folder(one.folder, one.plan)
            whole += [msgspec.structs.replace(_read(place), beside=True)] if place is not None else []
        whole.append(one)
    return _named(whole) if len(whole) > len(found) else whole


def _read(folder: Path) -> Run:
    run = RunFolder(folder)
    plan = run.config
    lines, records = run.lines()
    if not records:
        raise RunError(f"{folder / 'trials.jsonl'} has no trials yet. Finish the run with 'hthor eval' first.")
    return Run(
        folder=folder,
        name=folder.resolve().name,
        plan=plan,
        records=tuple(records),
        sha256=hashlib.sha256(b"".join(lines)).hexdigest(),
        label=plan.name if plan.seats else NONE,
        condition=_condition(plan),
        voided=run.voided,
        given_up=run.given_up,
        corrections=run.corrections.in_effect,
    )


def _condition(plan: RunConfig) -> str:
    """The condition of the published study that had this robot; empty if there is none."""
    if not plan.seats:
        return "none"
    agent = plan.seats[0].agent
    published = len(plan.seats) == 1 and agent.source == f"hthor.agents.{agent.name}"
    return agent.name if published and agent.name in ("frontier", "oracle") else ""


def _together(first: Run, other: Run) -> None:
    """Check that two runs have the same tasks and rules."""
    here, there = other.plan, first.plan
    fields = {
        "suite.sha256": (here.suite.sha256, there.suite.sha256, f"suite '{here.suite.name}', not '{there.suite.name}'"),
        "kind": (here.kind, there.kind, "other kinds of task"),
        "rules_sha256": (here.rules_sha256, there.rules_sha256, "other constants of the benchmark"),
    }
    for field, (one, two, words) in fields.items():
        if one != two:
            raise RunError(
                f"{other.folder / 'run.json'}: {field} differs from {first.folder / 'run.json'}: {words}. "
                "A report covers one suite under one set of rules; make one report for each."
            )


def _distinct(found: Sequence[Run]) -> None:
    seen: dict[str, Run] = {}
    for one in found:
        twin = seen.setdefault(one.plan.sha256, one)
        if twin is not one:
            raise RunError(
                f"{twin.folder} and {one.folder} are the same run: their run.json files are equal. Give it once."
            )


def _named(found: Sequence[Run]) -> list[Run]:
    """The runs with names and labels that differ: to equal labels with the same people, the run's name is added."""
    names = [_name(one, found) for one in found]
    whole: list[Run] = []
    for one, name in zip(found, names, strict=True):
        plain = _plain(one)
        same = [two for two in found if (_plain(two), two.plan.humans.name) == (plain, one.plan.humans.name)]
        label = plain if len(same) == 1 else f"{plain} ({name})"
        whole.append(msgspec.structs.replace(one, name=name, label=label))
    return whole


def _plain(one: Run) -> str:
    return one.plan.name if one.plan.seats else NONE


def _name(one: Run, found: Sequence[Run]) -> str:
    folder = one.folder.resolve()
    alike = sum(other.folder.resolve().name == folder.name for other in found)
    return folder.name if alike == 1 and folder.name != baseline.FOLDER else f"{folder.parent.name}/{folder.name}"
