"""The values of all metrics in each trial of a run, for programs that do their own statistics."""

from collections.abc import Iterator
from pathlib import Path

from msgspec import Struct

from hthor import code_identity
from hthor.eval.metrics import registry
from hthor.eval.metrics.trial_metrics import TrialMetrics
from hthor.eval.records.run_folder import RunFolder

SCHEMA = "hthor.trial-scores/1"


class TrialScores(Struct, frozen=True, kw_only=True):
    """The metrics of one trial: its key, its task, its session, and its place there from 0."""

    key: str
    task: str
    session: int
    index: int
    metrics: TrialMetrics

    def row(self) -> Iterator[tuple[str, object]]:
        """The trial as a spreadsheet row; metrics by seat have a column for each seat, such as "work: human"."""
        for name in ("key", "task", "session", "index"):
            yield name, getattr(self, name)
        for metric in registry.SINGLE:
            yield metric.name, self.metrics[metric.name]
        for metric in registry.BY_SEAT:
            yield from ((f"{metric.name}: {seat}", one) for seat, one in self.metrics.by_seat(metric.name).items())


class RunTrialScores(Struct, frozen=True, kw_only=True):
    """The metrics of all trials of a run that count, and the scoring version that measured them."""

    schema: str = SCHEMA
    scoring_sha256: str
    trials: tuple[TrialScores, ...]

    def rows(self) -> list[dict[str, object]]:
        """The trials as spreadsheet rows that all have the same columns; None where a trial has no value."""
        found = [dict(one.row()) for one in self.trials]
        columns = dict.fromkeys(name for row in found for name in row)
        return [{name: row.get(name) for name in columns} for row in found]


def score_trials(folder: Path) -> RunTrialScores:
    """The metrics of each trial of a run, measured now from its log.

    Raises:
        RunError: when the folder holds no run, or its log cannot be read.
    """
    return RunTrialScores(
        scoring_sha256=code_identity.scoring_sha256(),
        trials=tuple(
            TrialScores(
                key=one.key,
                task=one.spec.task.id,
                session=one.spec.session,
                index=one.spec.index,
                metrics=one.metrics,
            )
            for one in RunFolder(folder).records()
        ),
    )
