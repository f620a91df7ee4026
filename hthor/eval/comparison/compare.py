"""Two or more runs compared trial by trial: which is better, by how much, and in which kinds of trials."""

import contextlib
import itertools
from collections.abc import Callable, Sequence
from pathlib import Path

import msgspec

from hthor.errors import RunError
from hthor.eval.comparison import verdict
from hthor.eval.comparison.comparison import ComparedRun, Comparison, Comparisons, GroupSize, LoadedRun, WinCounts
from hthor.eval.metrics import registry, trial_metrics
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.records.scored_trial import ScoredTrial
from hthor.eval.results import group_difference, paired_difference, pairing
from hthor.eval.results.paired_difference import Difference
from hthor.eval.results.pairing import Pair

_BY: dict[str, Callable[[ScoredTrial], str]] = {
    "kind": lambda found: found.spec.task.kind,
    "split": lambda found: found.spec.task.split,
    "difficulty": lambda found: found.spec.task.difficulty,
    "scene": lambda found: found.spec.task.house,
}
_ORDER = ("seen", "new", "easy", "medium", "hard")


def compare_runs(folders: Sequence[Path]) -> Comparisons:
    """Compare the runs in these folders, every pair of them.

    Raises:
        RunError: when a folder holds no run, or two runs cannot be compared, naming the field.
    """
    if len(folders) < 2:
        raise RunError("a comparison needs two runs or more: hthor compare RUN RUN.")
    read_ = load_runs(folders)
    for one, other in itertools.combinations(read_, 2):
        pairing.check_comparable((one.folder, one.plan), (other.folder, other.plan))
    found = [(_pair(one, other), one, other) for one, other in itertools.combinations(read_, 2)]
    return Comparisons(
        suite=read_[0].plan.suite,
        seed=read_[0].plan.seed,
        runs=tuple(
            ComparedRun(
                name=one.name,
                folder=one.folder.name,
                trials=len(one.records),
                planned=one.plan.trials - one.given_up,
                run=one.plan.sha256,
                voided=one.voided or msgspec.UNSET,
                corrections=one.corrections or msgspec.UNSET,
            )
            for one in read_
        ),
        pairs=_judged(found),
    )


def compare_pairs(read_: Sequence[LoadedRun]) -> tuple[Comparison, ...]:
    """Every comparable pair of these runs that has trials in common, with verdicts adjusted for their number."""
    found = []
    for one, other in itertools.combinations(read_, 2):
        if not pairing.differing_field(one.plan, other.plan):
            with contextlib.suppress(RunError):  # no trial in common yet
                found.append((_pair(one, other), one, other))
    return _judged(found)


def load_runs(folders: Sequence[Path]) -> tuple[LoadedRun, ...]:
    """The runs in these folders, and a distinct name each."""
    runs = [RunFolder(folder) for folder in folders]
    names = _names([run.config.label for run in runs], folders)
    return tuple(
        LoadedRun(
            name=name,
            folder=run.path,
            plan=run.config,
            records=tuple(run.records()),
            voided=len(run.voided),
            corrections=len(run.corrections.in_effect),
            given_up=run.given_up,
        )
        for name, run in zip(names, runs, strict=True)
    )


def _names(names: Sequence[str], folders: Sequence[Path]) -> list[str]:
    """The agents' names; equal names get their folders added, and a number if the folders have equal names too."""
    if len(set(names)) == len(names):
        return list(names)
    longer = [
        f"{name} ({folder.resolve().name})" if names.count(name) > 1 else name
        for name, folder in zip(names, folders, strict=True)
    ]
    return [f"{name} #{number}" if longer.count(name) > 1 else name for number, name in enumerate(longer, 1)]


def _pair(one: LoadedRun, other: LoadedRun) -> Comparison:
    if group_difference.are_groups(one.plan, other.plan):
        return _groups(one, other)
    joined = pairing.pair_trials(one.records, other.records)
    pairs = joined.pairs
    if not pairs:
        raise RunError(f"{one.folder} and {other.folder} have no trial in common yet. Finish both runs.")
    found = {metric.name: paired_difference.paired_difference(pairs, metric.name) for metric in registry.MAIN}
    return Comparison(
        first=one.name,
        second=other.name,
        n=len(pairs),
        dropped=(joined.only_one, joined.only_other),
        tasks=len({pair.one.spec.task.id for pair in pairs}),
        people=len({human.participant for pair in pairs for human in pair.one.spec.humans}),
        sessions=len({pair.one.spec.session for pair in pairs}),
        differences={metric: difference for metric, difference in found.items() if difference is not None},
        mcnemar=paired_difference.mcnemar(pairs),
        tally=_tally(pairs),
        groups={by: held for by, value in _BY.items() if len(held := _grouped(pairs, value)) > 1},
        p_holm=None,
        better="",
        sentence="",
    )


def _groups(one: LoadedRun, other: LoadedRun) -> Comparison:
    """Two groups of a between-subjects study."""
    if not one.records or not other.records:
        raise RunError(f"{one.folder} and {other.folder} are not both begun yet. Finish both runs.")
    both = (*one.records, *other.records)
    found = {
        metric.name: group_difference.group_difference(one.records, other.records, metric.name)
        for metric in registry.MAIN
    }
    first, second = (GroupSize(trials=len(run.records), people=_people(run.records)) for run in (one, other))
    return Comparison(
        first=one.name,
        second=other.name,
        n=len(both),
        dropped=(0, 0),
        tasks=len({record.spec.task.id for record in both}),
        people=first.people + second.people,
        sessions=len({record.spec.session for record in both}),
        differences={metric: difference for metric, difference in found.items() if difference is not None},
        groups_of=(first, second),
        mcnemar=None,
        tally=None,
        groups={by: held for by, value in _BY.items() if len(held := _group_parts(one, other, value)) > 1},
        p_holm=None,
        better="",
        sentence="",
    )


def _people(records: Sequence[ScoredTrial]) -> int:
    return len({human.participant for record in records for human in record.spec.humans})


def _group_parts(one: LoadedRun, other: LoadedRun, value: Callable[[ScoredTrial], str]) -> dict[str, Difference]:
    """Differences in success between two groups, by a property of their trials."""
    names = sorted({value(record) for record in (*one.records, *other.records)}, key=_rank)
    parts = {
        name: [[record for record in run.records if value(record) == name] for run in (one, other)] for name in names
    }
    found = {name: group_difference.group_difference(held[0], held[1], "sr") for name, held in parts.items()}
    return {name or "unknown": difference for name, difference in found.items() if difference is not None}


def _success(one: LoadedRun, other: LoadedRun, level: float) -> Difference | None:
    """The difference in success, with an interval of this level."""
    if group_difference.are_groups(one.plan, other.plan):
        return group_difference.group_difference(one.records, other.records, "sr", level=level)
    return paired_difference.paired_difference(pairing.pair_trials(one.records, other.records).pairs, "sr", level=level)


def _tally(pairs: Sequence[Pair]) -> WinCounts:
    first = trial_metrics.column((pair.one.metrics for pair in pairs), "twsr")
    second = trial_metrics.column((pair.other.metrics for pair in pairs), "twsr")
    return WinCounts(
        wins=int((second > first).sum()), ties=int((second == first).sum()), losses=int((second < first).sum())
    )


def _grouped(pairs: Sequence[Pair], value: Callable[[ScoredTrial], str]) -> dict[str, Difference]:
    found = {
        name: paired_difference.paired_difference([pair for pair in pairs if value(pair.one) == name], "sr")
        for name in sorted({value(pair.one) for pair in pairs}, key=_rank)
    }
    return {name or "unknown": difference for name, difference in found.items() if difference is not None}


def _rank(name: str) -> tuple[int, str]:
    return _ORDER.index(name) if name in _ORDER else len(_ORDER), name


def _judged(found: Sequence[tuple[Comparison, LoadedRun, LoadedRun]]) -> tuple[Comparison, ...]:
    """These comparisons, completed by verdicts that are adjusted for their number."""
    successes = [pair.differences["sr"] for pair, _, _ in found]
    judgements = paired_difference.verdicts([(success.difference, success.p) for success in successes])
    judged = []
    for (pair, one, other), own in zip(found, judgements, strict=True):
        wide = _success(one, other, own.level)
        fair = msgspec.structs.replace(
            pair,
            among=own.among,
            p_holm=own.p,
            level=own.level,
            interval=wide.ci95 if wide is not None else None,
            better={1: pair.second, -1: pair.first}.get(own.sign, ""),
        )
        judged.append(msgspec.structs.replace(fair, sentence=verdict.verdict_sentence(fair)))
    return tuple(judged)
