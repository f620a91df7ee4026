"""A run's folder: one object that opens each of the run's files where it is first needed."""

import difflib
import fnmatch
from collections.abc import Iterable, Sequence
from functools import cached_property
from pathlib import Path
from typing import TypeVar

import msgspec

from hthor import documents, jsonio, log_corrections
from hthor.errors import RunError
from hthor.eval.config.run_config import OLD_SCHEMA, SCHEMA, RunConfig, differences
from hthor.eval.records import attempts, corrected_log, platform, run_isolation, session_restarts, trial_log
from hthor.eval.records.attempts import VoidedTrial
from hthor.eval.records.platform import Platform
from hthor.eval.records.scored_trial import ScoredTrial
from hthor.eval.records.trial_log import Place, TrialLog
from hthor.eval.records.trial_record import TrialRecord
from hthor.guest import Isolation
from hthor.log_corrections import Corrections

_Part = TypeVar("_Part")
_WRITTEN_FIRST = (".lock", trial_log.NAME, ".run.json.*", "control")
"""Files that a command may leave if it is killed before it writes `run.json`."""


class RunFolder:
    """The files of one run, whose folder need not exist yet. Each file is read when it is first needed."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.config_file, self.log_file = path / "run.json", path / trial_log.NAME
        self.result_file = path / "result.json"  # only whole runs have it
        self.effort_file = path / "effort.json"  # the cost of a shard, which has no result

    def __str__(self) -> str:
        return str(self.path)

    @property
    def houses(self) -> Path | None:
        """The folder with the houses that the suite brought with it; None where the suite is hthor's own."""
        houses = self.path / "houses"
        return houses.resolve() if houses.is_dir() else None

    @property
    def holds_run(self) -> bool:
        """Whether a run was begun here."""
        return self.config_file.exists()

    @cached_property
    def config(self) -> RunConfig:
        """The run's configuration; raises RunError when the folder holds no run, or its `run.json` is damaged."""
        if not self.config_file.is_file():
            raise RunError(f"{self} is not a run's folder: it has no run.json.{self._guess()} 'hthor eval' makes one.")
        if documents.schema_of(self.config_file) == OLD_SCHEMA:
            raise RunError(f"{self} was played by an older version of hthor; 'hthor migrate {self}' converts it.")
        hint = "evaluate it again, into another folder"
        return documents.read(self.config_file, RunConfig, RunError, schema=SCHEMA, hint=hint)

    @property
    def isolation(self) -> Isolation | None:
        """The weakest isolation that any command ran this run's agents at; None when all agents are built in."""
        return run_isolation.load_isolation(self.path)

    @property
    def platforms(self) -> tuple[Platform, ...]:
        """The platforms that ran trials; empty where that was not noted."""
        return platform.load(self.path)

    @property
    def restarts(self) -> int:
        """How many sessions were run again because an agent's process was killed."""
        return len(session_restarts.load(self.path).sessions)

    def open_log(self) -> TrialLog:
        """The one writer of the run's log; see `TrialLog` for its errors."""
        return TrialLog(self.path)

    def lines(self) -> tuple[list[bytes], list[ScoredTrial]]:
        """The line and the record of every trial, in the order of sessions and their trials.

        Of several attempts at a trial the one that counts is here; `attempts` has all. Lines are as in the log, records
        with the run's corrections.

        Raises:
            RunError: when a line is damaged, belongs to another run, or occurs twice; also for a line of corrections.
        """
        pairs = self._counting(corrected_log.read(self.log_file))
        return [line for line, _ in pairs], [record for _, record in pairs]

    def records(self) -> list[ScoredTrial]:
        """The record of every trial, in the order of sessions and their trials; errors as in `lines`."""
        return self.lines()[1]

    def attempts(self) -> list[ScoredTrial]:
        """Every record of the log, of voided attempts too, in the order of sessions, their trials, and attempts."""
        records = sorted((record for _, record in corrected_log.read(self.log_file)), key=_order)
        self._check(records)
        return records

    def played(self) -> list[ScoredTrial]:
        """As `records`, and the trials that a correction voided, unless they were repeated: one record for every trial.

        The place of a trial in this list is its number on the command line, which corrections do not change.
        """
        held = [(None, record) for record in self.attempts()]
        return [record for _, record in attempts.select(held, self.corrections.given_up | self.corrections.repeated)]

    @cached_property
    def corrections(self) -> Corrections:
        """The corrections of the run's trials."""
        return log_corrections.load(self.path)

    def corrected(self, record: TrialRecord) -> ScoredTrial:
        """A record of one of the run's trials that was played again, with the corrections of that trial."""
        return corrected_log.corrected(record, self.corrections)

    @property
    def given_up(self) -> int:
        """How many of the run's trials a correction voided for good: they are over, and not missing."""
        keys = self.corrections.given_up
        return sum(one.key in keys for one in self.voided)

    @cached_property
    def voided(self) -> tuple[VoidedTrial, ...]:
        """The attempts that were voided and do not count; known without reading again after `lines` or `digest`."""
        return attempts.voided_trials(self.attempts(), self.corrections)

    def digest(self) -> tuple[list[Place], list[ScoredTrial]]:
        """As `lines`, for runs of any length: lines stay on the disk, and records lack paths and journal."""
        slim = (
            (place, msgspec.structs.replace(record, paths={}, journal=()))
            for place, _, record in corrected_log.places(self.log_file)
        )
        pairs = self._counting(slim)
        return [place for place, _ in pairs], [record for _, record in pairs]

    def check_origin(self, record: TrialRecord) -> None:
        """Check that a record of the log is one of this run.

        Raises:
            RunError: names the field in which it differs from `run.json`.
        """
        spec, config = record.spec, self.config
        pairs = {
            "seed": (spec.seed, config.seed),
            "humans": (tuple(one.sha256 for one in spec.humans), tuple(one.sha256 for one in config.humans.members)),
            "suite_sha256": (spec.suite_sha256, config.suite.sha256),
            "rules_sha256": (spec.rules_sha256, config.rules_sha256),
            "code_sha256": (spec.code_sha256, config.code_sha256),
            "robots": (spec.robots, config.seats),
            "kind_sha256": (spec.kind_sha256, config.kind.sha256 if config.kind else ""),
            "assets_sha256": (spec.assets_sha256 or config.assets.sha256, config.assets.sha256),  # empty: no pictures
            "clock": (spec.clock, config.clock),
            "step_limit_s": (spec.step_limit_s, config.step_limit_s),
        }
        for field, (here, there) in pairs.items():
            if here != there:
                raise RunError(
                    f"{self.log_file}: trial {record.key}: spec.{field} is not the one in run.json. "
                    "The line belongs to another run; delete it."
                )

    def check_free(self, config: RunConfig) -> None:
        """Check that a run can be written here: the folder is absent, empty, or holds a part of the same run.

        Raises:
            RunError: when the folder holds other files or another run; names the differences.
        """
        if not self.path.exists():
            return
        if not self.path.is_dir():
            raise RunError(f"{self} is a file; a run needs a folder. Choose another with --out.")
        if not self.holds_run:
            self._check_empty()
            return
        stored = self.config
        if stored.untitled != config.untitled:
            raise RunError(
                f"{self} holds another run: {'; '.join(differences(stored.untitled, config.untitled))}. "
                "Choose another folder with --out or --name, or delete this one."
            )
        if config.title and stored.title != config.title:
            title = f"is called '{stored.title}'" if stored.title else "has no name"
            raise RunError(f"the run in {self} {title}; a run keeps the name that it began with. Leave out --name.")

    def write_config(self, config: RunConfig) -> RunConfig:
        """Write `run.json` unless it exists, and return its configuration: a stored run keeps its own title.

        Remains of an earlier write that was killed are removed.
        """
        for torn in self.path.glob(".run.json.*"):
            torn.unlink(missing_ok=True)
        if not self.holds_run:
            jsonio.write(self.config_file, jsonio.pretty(config))
            self.__dict__.pop("config", None)
        return msgspec.structs.replace(config, title=self.config.title)

    def write(self, name: str, data: bytes) -> None:
        """Write another file of the run, in one step; ``name`` is relative to the folder."""
        jsonio.write(self.path / name, data)

    def _check_empty(self) -> None:
        names = [entry.name for entry in self.path.iterdir()]
        others = [name for name in names if not any(fnmatch.fnmatchcase(name, pattern) for pattern in _WRITTEN_FIRST)]
        if not others and self.log_file.exists() and self.log_file.stat().st_size > 0:
            others = [self.log_file.name]
        if others:
            raise RunError(f"{self} is not empty and holds no run ({min(others)}). Choose another folder with --out.")

    def _counting(self, pairs: Iterable[tuple[_Part, ScoredTrial]]) -> list[tuple[_Part, ScoredTrial]]:
        """The pairs whose record counts, in order; checks all."""
        held = sorted(pairs, key=lambda pair: _order(pair[1]))
        records = [record for _, record in held]
        self._check(records)
        self.__dict__["voided"] = attempts.voided_trials(records, self.corrections)
        return attempts.select(held)

    def _check(self, records: Sequence[TrialRecord]) -> None:
        for record in records:
            self.check_origin(record)
        keys = [record.key for record in records]
        twice = next((key for key in keys if keys.count(key) > 1), "") if len(set(keys)) < len(keys) else ""
        if twice:
            raise RunError(f"{self.log_file}: trial {twice} is there twice. Delete one of the two lines.")

    def _guess(self) -> str:
        """The run in the same folder that the user probably meant."""
        names = sorted(path.parent.name for path in self.path.parent.glob("*/run.json"))
        near = difflib.get_close_matches(self.path.name, names, n=1, cutoff=0.5)
        return f" Did you mean '{self.path.parent / near[0]}'?" if near else ""


def _order(record: TrialRecord) -> tuple[int, int, int]:
    return record.spec.session, record.spec.index, record.spec.attempt or 0
