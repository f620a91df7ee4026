"""Finds the baseline of a run: the run of the same participants at the same tasks without a robot."""

import glob
import itertools
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

import msgspec

from hthor import code_identity, log_corrections
from hthor.errors import RunError
from hthor.eval.config.run_config import RunConfig
from hthor.eval.records import attempts, corrected_log
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.records.scored_trial import ScoredTrial
from hthor.eval.results import group_difference, paired_difference, pairing, result_file
from hthor.eval.results.result_file import StoredUplift, Uplift

FOLDER = "control"
"""The folder in which a run keeps its own baseline."""
RECORDED = "the log of the run without a robot was not found; these numbers were recorded when it was there"
_OTHER_SCORING = "by another scoring version than the other numbers"


def uplift_or_stored(folder: Path, plan: RunConfig, records: Sequence[ScoredTrial]) -> StoredUplift | None:
    """The uplift of the run in a folder over its baseline.

    If no baseline is found, as in a folder that was copied elsewhere, the uplift in the run's stored result is used,
    with a note. None if that result has no uplift either, or the run has no robot.
    """
    return result_file.to_stored(measure_uplift(folder, plan, records)) or _recorded(folder, plan)


def measure_uplift(folder: Path, plan: RunConfig, records: Sequence[ScoredTrial]) -> Uplift | None:
    """The uplift from the baseline's log; None if the run has no robot or no complete baseline is found."""
    found = next(_whole(folder, plan, _anywhere(folder)), None)
    if found is None:
        return None
    return make_uplift(found[2], records, run=found[1].sha256, groups=group_difference.are_groups(found[1], plan))


def make_uplift(
    control: Sequence[ScoredTrial], records: Sequence[ScoredTrial], *, run: str, groups: bool = False
) -> Uplift | None:
    """The uplift of ``records`` over a baseline whose hash is ``run``; None without a trial in common.

    ``groups`` says that the two had different people, as conditions of a between-subjects study.
    """
    pairs = pairing.pair_trials(control, records).pairs
    sr, twsr, time_s = (
        group_difference.group_difference(control, records, metric)
        if groups
        else paired_difference.paired_difference(pairs, metric)
        for metric in result_file.UPLIFT_METRICS
    )
    if sr is None or twsr is None or time_s is None:
        return None
    return Uplift(control=run, sr=sr, twsr=twsr, time_s=time_s)


def find_baseline(folder: Path, plan: RunConfig) -> tuple[RunConfig, list[ScoredTrial]] | None:
    """The configuration and records of a run's baseline: in the run's folder, or the first by name next to it.

    It must be complete.
    """
    return next(((there, kept) for _, there, kept in _whole(folder, plan, _near(folder))), None)


def baseline_folder(folder: Path, plan: RunConfig) -> Path | None:
    """The folder of a run's baseline: in the run's folder, next to it, or in the usual places of runs."""
    return next((candidate for candidate, _, _ in _whole(folder, plan, _anywhere(folder))), None)


def _recorded(folder: Path, plan: RunConfig) -> StoredUplift | None:
    """The uplift in the run's stored result."""
    if not plan.seats:
        return None
    known = result_file.stored_uplift(folder, run=plan.sha256)
    if known is None:
        return None
    other = result_file.stored_scoring(folder) != code_identity.scoring_sha256()
    other = other or (known.note or "").endswith(_OTHER_SCORING)
    return msgspec.structs.replace(known, note=f"{RECORDED}, {_OTHER_SCORING}" if other else RECORDED)


def _whole(
    folder: Path, plan: RunConfig, candidates: Iterable[Path]
) -> Iterator[tuple[Path, RunConfig, list[ScoredTrial]]]:
    """Every complete baseline of a run among these folders, the one named in its result first."""
    if not plan.seats:
        return
    fitting = [(candidate, there) for candidate in candidates if (there := _fits(candidate, plan)) is not None]
    known = result_file.stored_uplift(folder, run=plan.sha256)
    named = known.control if known is not None else ""
    for candidate, there in sorted(fitting, key=lambda one: one[1].sha256 != named):
        kept, over = _records(candidate)
        if over >= there.trials:
            yield candidate, there, kept


def _fits(candidate: Path, plan: RunConfig) -> RunConfig | None:
    """The configuration of a folder's run if it is a baseline: no robot, same humans, suite, seed, rules and code."""
    try:
        there = RunFolder(candidate).config
    except RunError:  # of another version, or damaged
        return None
    enough = bool(plan.design) or there.participants >= plan.participants
    return there if enough and not there.seats and not pairing.differing_field(plan, there) else None


def _near(folder: Path) -> Iterator[Path]:
    """Folders of runs in this folder and next to it."""
    yield from (path for path in (folder / FOLDER,) if (path / "run.json").is_file())
    yield from _runs_in(folder.resolve().parent, ("*",), but=folder.resolve())


def _anywhere(folder: Path) -> Iterator[Path]:
    """The folders of `_near`, baselines of runs next to it, runs around its folder, and runs in the usual places."""
    above, seen = folder.resolve().parent, set()
    places = (
        _near(folder),
        _runs_in(above, (f"*/{FOLDER}",), but=folder.resolve()),
        _runs_in(above.parent, ("*", f"*/{FOLDER}", "*/*"), but=folder.resolve()),
        *(_runs_in(usual, ("*", f"*/{FOLDER}", "*/*"), but=folder.resolve()) for usual in (Path(), Path("runs"))),
    )
    for candidate in itertools.chain.from_iterable(places):
        if (real := candidate.resolve()) not in seen:
            seen.add(real)
            yield candidate


def _runs_in(place: Path, patterns: Sequence[str], *, but: Path) -> Iterator[Path]:
    """Folders below a place that hold runs, sorted by name; folders that vanish during the search are left out."""
    for pattern in patterns:
        found = glob.glob(f"{pattern}/run.json", root_dir=place, include_hidden=True)  # Path.glob would raise
        runs = sorted((place / path).parent for path in found)
        yield from (run for run in runs if run.resolve() != but)


def _records(folder: Path) -> tuple[list[ScoredTrial], int]:
    """The records of a run that count, and how many of its trials are over; none if they cannot be read."""
    try:
        given_up = log_corrections.load(folder).given_up
        known = [
            msgspec.structs.replace(one, paths={}, journal=()) for _, one in corrected_log.read(folder / "trials.jsonl")
        ]
    except RunError:
        return [], 0
    kept = sorted(attempts.select_records(known), key=lambda record: (record.spec.session, record.spec.index))
    return kept, len(kept) + len({record.key for record in known} & given_up)
