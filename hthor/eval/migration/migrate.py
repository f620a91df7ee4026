"""Converts runs and logs of the last release in place, and keeps the old files beside the new ones.

Every file is replaced in one step, and a file that is in the new format already is left alone. So a command that was
interrupted is finished by the same command.
"""

import filecmp
import os
import shutil
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import msgspec
from msgspec import Struct

from hthor import documents, jsonio
from hthor.errors import RunError
from hthor.eval.config import run_config
from hthor.eval.config.run_config import RunConfig
from hthor.eval.migration import log_file, old_format
from hthor.eval.records import session_restarts, trial_log
from hthor.eval.results import aggregate, result_file
from hthor.eval.runner import fault_report

SCHEMA = "hthor.migrate/1"
_KEPT = "before-1.0"
"""Part of the names under which old files are kept."""


class Migrated(Struct, frozen=True, kw_only=True):
    """What was done for one run or one log.

    Attributes:
        path: the run's folder, or the log. trials: lines of the log; converted: how many of them were old.
        kept: the old files, under their new names.
        result: "scored" if `result.json` was computed again; "incomplete" if it was taken away, because trials are
            missing; else empty.
    """

    path: str
    trials: int
    converted: int
    kept: tuple[str, ...] = ()
    result: str = ""


class Migration(Struct, frozen=True, kw_only=True):
    """The document of `hthor migrate`; with ``dry``, what it would do."""

    schema: str = SCHEMA
    dry: bool
    done: tuple[Migrated, ...]


def migrate(paths: Sequence[Path], *, dry: bool = False) -> Migration:
    """Convert runs and logs.

    Args:
        paths: folders of runs, folders with such folders below them, or logs such as `trials.jsonl`.
        dry: whether to only read everything, and write nothing.

    Raises:
        RunError: when something is no run and no log, or cannot be converted; names the file, the line and the field.
        RunLocked: when another process is writing a run.
    """
    targets = list(dict.fromkeys(target for path in paths for target in _targets(path)))
    plans = [_make_plan(target) for target in targets]  # before anything is written, everything is read
    if dry:
        return Migration(dry=True, done=tuple(plan.report() for plan in plans))
    done = [_migrate_run(plan) if plan.log != plan.path else _migrate_log(plan) for plan in plans]
    # results come last, because an uplift needs the log of the run without a robot
    return Migration(dry=False, done=tuple(_score(one) for one in done))


class _Plan(Struct, frozen=True, kw_only=True):
    """What is to be done.

    Attributes:
        path: the run's folder, or the log. log: the log.
        trials: how many trials the log has. keys: the new keys of the old ones, by their old keys.
        config: the run's configuration in the new format; None if nothing is to be done there.
    """

    path: Path
    log: Path
    trials: int
    keys: dict[str, str]
    config: RunConfig | None = None

    def report(self, kept: Sequence[str] = ()) -> Migrated:
        """What was done, with the old files that were kept."""
        return Migrated(path=str(self.path), trials=self.trials, converted=len(self.keys), kept=tuple(kept))


def _make_plan(path: Path) -> _Plan:
    """Read a run or a log; raises RunError when something in it cannot be converted."""
    config, log = (_new_config(path / "run.json"), path / trial_log.NAME) if path.is_dir() else (None, path)
    count, keys = 0, {}
    for one in log_file.converted_lines(log) if log.is_file() else ():
        count += 1
        if one.old_key:
            keys[one.old_key] = one.key
    return _Plan(path=path, log=log, trials=count, keys=keys, config=config)


def _targets(path: Path) -> Iterator[Path]:
    """The runs and logs that a path stands for; a run may have its baseline in its folder."""
    runs = sorted(file.parent for file in path.rglob("run.json")) if path.is_dir() else []
    yield from runs
    log = path / trial_log.NAME if path.is_dir() else path
    if log.is_file() and path not in runs:
        yield log
    elif not runs:
        problem = "holds no run and no log" if path.is_dir() else "is not there"
        raise RunError(f"{path} {problem}. Name the folder of a run, a folder of runs, or a log such as trials.jsonl.")


def _migrate_log(plan: _Plan) -> Migrated:
    """Convert a log."""
    lines = (one.line for one in log_file.converted_lines(plan.log))
    return plan.report([_replace(plan.log, lines)] if plan.keys else ())


def _migrate_run(plan: _Plan) -> Migrated:
    """Convert the files of a run, its configuration last."""
    folder = plan.path
    lock = trial_log.lock(folder)
    try:
        kept = [*_migrate_faults(folder, plan.keys), *_migrate_restarts(folder), *_migrate_log(plan).kept]
        if plan.config is not None:
            kept += _migrate_configuration(folder, plan.config)
    finally:
        os.close(lock)
    return plan.report(kept)


def _new_config(path: Path) -> RunConfig | None:
    """The run's configuration in the new format; None if the file has it already."""
    schema = documents.schema_of(path)
    if schema == run_config.SCHEMA:
        return None
    document = documents.read(path, dict[str, Any], RunError)
    if schema != run_config.OLD_SCHEMA:
        problem = f"is '{schema}', 'hthor migrate' converts '{run_config.OLD_SCHEMA}'"
        raise RunError.in_file(str(path), "schema", problem)
    realtime = document.pop("realtime", False)
    document |= {"schema": run_config.SCHEMA, **({"clock": "charged"} if realtime is True else {})}
    return documents.parse(jsonio.canonical(document), RunConfig, RunError, shown=str(path))


def _migrate_configuration(folder: Path, config: RunConfig) -> list[str]:
    """Write the new `run.json`; a stored result then belongs to the run as it is now called."""
    kept, result = [], folder / "result.json"
    if result.is_file():
        document = documents.read(result, dict[str, Any], RunError)
        new = document | {"mode": config.mode, "hashes": {**document.get("hashes", {}), "run": config.sha256}}
        if document.get("schema") == result_file.OLD_SCHEMA:
            new["schema"] = result_file.SCHEMA
        kept += [_replace(result, [jsonio.pretty(new)])] if new != document else []
    kept.append(_replace(folder / "run.json", [jsonio.pretty(config)]))
    return kept


def _migrate_faults(folder: Path, keys: Mapping[str, str]) -> list[str]:
    """Give the reports of faults the trials' new keys."""
    kept = []
    for path in sorted((folder / fault_report.FOLDER).glob("*.json")):
        if documents.schema_of(path) != old_format.FAULTS_SCHEMA or path.stem not in keys:
            continue
        document = documents.read(path, dict[str, Any], RunError)
        key, session = keys[path.stem], document.pop("participant", 0)
        again = str(document.get("again", "")).replace(path.stem, key)
        document |= {"schema": fault_report.SCHEMA, "key": key, "session": session, "again": again}
        jsonio.write(path.with_name(f"{key}.json"), jsonio.pretty(document))
        old = folder / f"{fault_report.FOLDER}.{_KEPT}" / path.name
        jsonio.make_folder(old.parent)
        os.replace(path, old)
        kept.append(str(old))
    return kept


def _migrate_restarts(folder: Path) -> list[str]:
    path = folder / session_restarts.NAME
    document = documents.read_or_none(path, dict[str, Any], RunError) or {}
    if "participants" not in document:
        return []
    return [_replace(path, [jsonio.pretty({"sessions": document["participants"]})])]


def _score(one: Migrated) -> Migrated:
    """Compute a converted run's stored result again."""
    folder = Path(one.path)
    if not (folder / f"result.{_KEPT}.json").is_file() or not (folder / "result.json").is_file():
        return one
    plan, result, stored = aggregate.rescore(folder)
    if result == stored:
        return one
    if result.counts.trials < plan.expected_trials:
        (folder / "result.json").unlink()
        return msgspec.structs.replace(one, result="incomplete")
    result_file.store_result(folder, result)
    return msgspec.structs.replace(one, result="scored")


def _replace(path: Path, parts: Iterable[bytes]) -> str:
    """Replace a file in one step, and keep the old one beside it; returns the name that the old one has then."""
    kept = path.with_name(f"{path.stem}.{_KEPT}{path.suffix}")
    if not kept.exists():
        try:
            os.link(path, kept)
        except OSError:  # a file system without links
            shutil.copy2(path, kept)
    elif not filecmp.cmp(path, kept, shallow=False):
        raise RunError(f"{kept} is there already and is not a copy of {path.name}. Move it away.")
    jsonio.write_parts(path, parts)
    return str(kept)
