"""Runs an evaluation: every robot team with every human population, each pair in its own run."""

import functools
from collections.abc import Callable, Iterator
from pathlib import Path

from msgspec import Struct

from hthor import jsonio
from hthor.eval.config.run_config import RunConfig
from hthor.eval.records import opened_files, run_isolation
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.results.result_file import RunResult
from hthor.eval.runner import run
from hthor.eval.runner.collector import InternalFailure, Unfinished
from hthor.eval.runner.progress import Watcher
from hthor.eval.runner.run_job import ResolvedRuns, ScheduledRun
from hthor.guest import Isolation


class FinishedRun(Struct, frozen=True, kw_only=True):
    """A complete run."""

    config: RunConfig
    folder: RunFolder
    result: RunResult


def run_experiment(resolved: ResolvedRuns, make_watcher: Callable[[str], Watcher]) -> Iterator[FinishedRun]:
    """Run every robot team with every human population; yield each run as soon as it is complete.

    The folders of all runs are checked before the first trial. The other runs are run even if one ends incomplete.

    Args:
        make_watcher: makes the watcher that follows the progress of a run, given the run's title.

    Raises:
        HthorError: when a run cannot be written where it should be, before the first trial.
        Unfinished, InternalFailure: when a run ended incomplete; the others were run.
    """
    check_folders(resolved)
    yield from _Experiment(make_watcher).run(resolved)


def check_folders(resolved: ResolvedRuns) -> None:
    """Check that every run can be written to its folder, which is free or holds a part of it at the required isolation.

    Raises:
        HthorError: when one cannot.
    """
    for scheduled in (*resolved.runs, *resolved.baseline_of.values()):
        scheduled.folder.check_free(scheduled.config)
        _weakest_isolation(scheduled)


class _Experiment:
    """Plays runs; remembers which notes were given and which runs ended incomplete."""

    def __init__(self, make_watcher: Callable[[str], Watcher]) -> None:
        self._make_watcher = make_watcher
        self._notes: set[str] = set()
        self._errors: list[Unfinished | InternalFailure] = []
        self._results: dict[Path, RunResult | None] = {}

    def run(self, resolved: ResolvedRuns) -> Iterator[FinishedRun]:
        """Run each run after its baseline."""
        for scheduled in resolved.runs:
            baseline = resolved.baseline_of.get(scheduled.folder.path)
            if baseline is not None:
                self._result(baseline)
            if (result := self._result(scheduled)) is not None:
                yield FinishedRun(config=scheduled.config, folder=scheduled.folder, result=result)
        if self._errors:
            raise self._errors[0] if len(self._errors) == 1 else Unfinished(" ".join(map(str, self._errors)))

    def _result(self, scheduled: ScheduledRun) -> RunResult | None:
        """The result of a run, which is run once; None where it ended incomplete."""
        place = scheduled.folder.path
        if place not in self._results:
            watcher = self._make_watcher(scheduled.title)
            try:
                self._results[place] = self._evaluate(scheduled, watcher)
            except (Unfinished, InternalFailure) as error:  # the other runs go on
                self._errors.append(error)
                self._results[place] = None
            finally:
                watcher.close()
        return self._results[place]

    def _evaluate(self, scheduled: ScheduledRun, watcher: Watcher) -> RunResult:
        for note in scheduled.tasks.notes:
            if note not in self._notes:
                self._notes.add(note)
                watcher.note(note)
        check = functools.partial(opened_files.check_opened_files, scheduled.team.agent_paths, scheduled.sources.guests)
        return run.run_evaluation(
            scheduled.config,
            scheduled.sessions,
            scheduled.runner or scheduled.make_runner,
            folder=scheduled.folder,
            watcher=watcher,
            engine=scheduled.engine,
            extra=_files(scheduled),
            rerun_command=scheduled.rerun_command,
            check=check if scheduled.config.agents else None,
        )


def _files(scheduled: ScheduledRun) -> dict[str, bytes]:
    """Files that make the run's folder complete in itself, by name."""
    if scheduled.isolation is None:
        return scheduled.files
    return {**scheduled.files, run_isolation.NAME: jsonio.pretty(_weakest_isolation(scheduled))}


def _weakest_isolation(scheduled: ScheduledRun) -> Isolation | None:
    return run_isolation.weakest_isolation(scheduled.folder.path, scheduled.isolation, scheduled.required_isolation)
