"""Two or more runs compared trial by trial: which is better, by how much, and in which kinds of trials."""

import contextlib
import itertools
from collections.abc import Callable, Sequence
from pathlib import Path

import msgspec
from msgspec import Struct

from hthor.errors import RunError
from hthor.eval.config.run_config import RunConfig, SuiteRef
from hthor.eval.metrics import registry, trial_metrics
from hthor.eval.records.trial_record import TrialRecord
from hthor.eval.results import aggregate, paired_difference, pairing
from hthor.eval.results.paired_difference import Difference, McNemar
from hthor.eval.results.pairing import Pair
from hthor.eval.statistics import power
from hthor.eval.statistics.intervals import LEVEL

SCHEMA = "hthor.compare/1"
_BY: dict[str, Callable[[TrialRecord], str]] = {
    "kind": lambda found: found.spec.task.kind,
    "split": lambda found: found.spec.task.split,
    "difficulty": lambda found: found.spec.task.difficulty,
    "scene": lambda found: found.spec.task.house,
}
_ORDER = ("seen", "new", "easy", "medium", "hard")


class WinCounts(Struct, frozen=True, kw_only=True):
    """Trials in which the second robot's time-weighted success was higher, the same, and lower."""

    wins: int
    ties: int
    losses: int


class ComparedRun(Struct, frozen=True, kw_only=True):
    """One of the runs: its name, its folder's name, its trials so far and planned, and its configuration's hash.

    ``voided`` counts attempts at trials that were voided and do not count; it is absent if there were none.
    """

    name: str
    folder: str
    trials: int
    planned: int
    run: str
    voided: int | msgspec.UnsetType = msgspec.UNSET


class Comparison(Struct, frozen=True, kw_only=True):
    """The second run compared with the first.

    Attributes:
        n: how many trials both runs have; ``dropped``: how many of the first and of the second have no partner.
        tasks, people, sessions: how many different tasks, people and sessions these trials have.
        differences: the difference in each metric, by its name.
        groups: differences in success by "kind", "split", "difficulty" and "scene", where there are several of these.
        among: how many pairs of runs are compared at once; the verdict is adjusted for this number.
        p_holm: the p-value of the difference in success, adjusted for these comparisons by Holm's method.
        level, interval: the interval of the difference in success that belongs to the verdict, and its level: 0.95 for
            one pair, higher for several pairs. It excludes 0 exactly when one run is better.
        better: the name of the run that is better in success; empty when these data cannot tell.
        sentence: the verdict in words.
    """

    first: str
    second: str
    n: int
    dropped: tuple[int, int]
    tasks: int
    people: int
    sessions: int
    differences: dict[str, Difference]
    mcnemar: McNemar
    tally: WinCounts
    groups: dict[str, dict[str, Difference]]
    among: int = 1
    p_holm: float | None
    level: float = LEVEL
    interval: tuple[float, float] | None = None
    better: str
    sentence: str

    @property
    def success(self) -> Difference:
        """The difference in success with the p-value and the interval of the verdict."""
        return msgspec.structs.replace(self.differences["sr"], ci95=self.interval, p=self.p_holm)


class Comparisons(Struct, frozen=True, kw_only=True):
    """The document that `hthor compare` gives: every pair of runs, in the order in which they were named."""

    schema: str = SCHEMA
    suite: SuiteRef
    seed: int
    runs: tuple[ComparedRun, ...]
    pairs: tuple[Comparison, ...]

    @property
    def worse(self) -> tuple[Comparison, ...]:
        """The comparisons in which a run is worse than the first run."""
        baseline = self.runs[0].name
        return tuple(pair for pair in self.pairs if pair.first == pair.better == baseline)


class LoadedRun(Struct, frozen=True, kw_only=True):
    """A run read from its folder, with a name that no other run here has."""

    name: str
    folder: Path
    plan: RunConfig
    records: tuple[TrialRecord, ...]
    voided: int = 0


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
                planned=one.plan.trials,
                run=one.plan.sha256,
                voided=one.voided or msgspec.UNSET,
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
    """The runs in these folders, with metrics measured again from their events, and a distinct name each."""
    held = [aggregate.load_measured(folder) for folder in folders]
    names = _names([plan.label for plan, _, _ in held], folders)
    return tuple(
        LoadedRun(name=name, folder=folder, plan=plan, records=tuple(records), voided=voided)
        for name, folder, (plan, records, voided) in zip(names, folders, held, strict=True)
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


def _tally(pairs: Sequence[Pair]) -> WinCounts:
    first = trial_metrics.column((pair.one.metrics for pair in pairs), "twsr")
    second = trial_metrics.column((pair.other.metrics for pair in pairs), "twsr")
    return WinCounts(
        wins=int((second > first).sum()), ties=int((second == first).sum()), losses=int((second < first).sum())
    )


def _grouped(pairs: Sequence[Pair], value: Callable[[TrialRecord], str]) -> dict[str, Difference]:
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
    verdicts = paired_difference.verdicts([(success.difference, success.p) for success in successes])
    judged = []
    for (pair, one, other), own in zip(found, verdicts, strict=True):
        pairs = pairing.pair_trials(one.records, other.records).pairs
        wide = paired_difference.paired_difference(pairs, "sr", level=own.level)
        fair = msgspec.structs.replace(
            pair,
            among=own.among,
            p_holm=own.p,
            level=own.level,
            interval=wide.ci95 if wide is not None else None,
            better={1: pair.second, -1: pair.first}.get(own.sign, ""),
        )
        judged.append(msgspec.structs.replace(fair, sentence=verdict_sentence(fair)))
    return tuple(judged)


def verdict_sentence(pair: Comparison) -> str:
    """Which run is better and by how much, or that these data cannot tell and how many more tasks would."""
    found = pair.differences["sr"]
    points = 100.0 * found.difference
    if pair.interval is None:
        return f"One trial cannot separate {pair.second} from {pair.first}."
    low, high = (100.0 * end for end in pair.interval)
    if pair.better:
        sign, worse = (1.0, pair.first) if pair.better == pair.second else (-1.0, pair.second)
        ends = sorted((sign * low, sign * high))
        return (
            f"{pair.better} is better than {worse} by {sign * points:.1f} points of success "
            f"({_evidence(pair, f'{ends[0]:.1f} to {ends[1]:.1f}')})."
        )
    told = (
        f"These data cannot separate {pair.second} from {pair.first}: {points:+z.1f} points of success "
        f"({_evidence(pair, f'{low:+z.1f} to {high:+z.1f}')})"
    )
    if not pair.mcnemar.only_first + pair.mcnemar.only_second:
        return f"{told}; success was the same in every trial."
    if found.separated:
        return f"{told}; it would count alone ({_chance(found.p)}), but not among {pair.among} comparisons."
    if found.difference == 0.0 or found.more_tasks is None:
        return f"{told}; a difference of {100.0 * (found.mde80 or 0.0):.1f} points would have shown."
    if found.more_tasks == 0:
        return f"{told}; {pair.sessions} sessions are too few to tell, however many tasks they have."
    alone = " to a comparison of these two alone" if pair.among > 1 else ""
    return f"{told}; if it is real, about {power.rounded_count(found.more_tasks)} more tasks would show it{alone}."


def _evidence(pair: Comparison, ends: str) -> str:
    """The verdict's interval, p and number of trials; for several comparisons it says that they are adjusted."""
    trials = f"{pair.n} shared trial{'' if pair.n == 1 else 's'}"
    if pair.among == 1:
        return f"95 % interval {ends}, {_chance(pair.p_holm)}, {trials}"
    return f"interval {ends} and {_chance(pair.p_holm)} are adjusted for {pair.among} comparisons; {trials}"


def _chance(p: float | None) -> str:
    """A p-value in words, with no more digits than are useful."""
    p = 1.0 if p is None else p
    return "p < 0.001" if p < 0.001 else f"p = {p:.3f}"
