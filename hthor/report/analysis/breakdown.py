"""Success within parts of the trials: by difficulty, kind of task, split, scene and kind of person."""

from collections.abc import Callable, Sequence

from hthor.eval.metrics import registry
from hthor.eval.records.trial_record import TrialRecord
from hthor.eval.results import aggregate
from hthor.eval.statistics.intervals import Estimate
from hthor.report.analysis.document import Group, Split
from hthor.report.analysis.load_runs import Run

_LEVELS = ("easy", "medium", "hard")
_KINDS = "kind of task"


def all_splits(runs: Sequence[Run]) -> tuple[Split, ...]:
    """Every breakdown of the trials with more than one group, and more than a single trial in some group."""
    found = (
        _split("difficulty", runs, lambda one: one.spec.task.difficulty, _LEVELS),
        _split(_KINDS, runs, lambda one: one.spec.task.kind.replace("_", " ")),
        _split("split", runs, lambda one: one.spec.task.split, ("seen", "new")),
        _split("scene", runs, lambda one: one.spec.task.house),
    )
    return tuple(one for one in found if len(one.groups) > 1 and _tells(one))


def _tells(split: Split) -> bool:
    """Whether any group has more than a single trial."""
    return any(one.n > 1 for group in split.groups for one in group.sr.values())


def split_by_population(runs: Sequence[Run]) -> Split | None:
    """Success with each human population, in their order; None if there is only one."""
    names = list(dict.fromkeys(run.plan.humans.name for run in runs))
    groups = tuple(
        Group(name=name, sr={run.label: success_rate(run.records) for run in runs if run.plan.humans.name == name})
        for name in names
    )
    return Split(word="kind of person", groups=groups) if len(groups) > 1 else None


def _split(word: str, runs: Sequence[Run], part: Callable[[TrialRecord], str], order: Sequence[str] = ()) -> Split:
    names = sorted({part(record) for run in runs for record in run.records} - {""})
    names.sort(key=lambda name: order.index(name) if name in order else len(order))
    groups = (
        Group(
            name=name, sr={run.label: success_rate([one for one in run.records if part(one) == name]) for run in runs}
        )
        for name in names
    )
    return Split(word=word, groups=tuple(groups))


def success_rate(records: Sequence[TrialRecord]) -> Estimate:
    """Success rate with its interval."""
    return aggregate.estimate_metric(records, registry.get("sr"))
