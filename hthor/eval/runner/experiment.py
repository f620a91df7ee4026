"""`hthor eval` as one function: every robot team with every human population, each pair in its own run."""

import functools
import os
import shlex
from collections.abc import Callable, Iterator
from pathlib import Path

from msgspec import Struct

from hthor import jsonio
from hthor.eval.config.run_config import RunConfig
from hthor.eval.records import opened_files, run_isolation
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.results.result_file import RunResult
from hthor.eval.runner import engines, run, run_options
from hthor.eval.runner.collector import InternalFailure, Unfinished
from hthor.eval.runner.progress import Watcher
from hthor.eval.runner.run_job import ScheduledRun
from hthor.eval.runner.run_options import ResolvedRuns, RunOptions
from hthor.guest import Isolation
from hthor.tasks.suite import encode_suite


class FinishedRun(Struct, frozen=True, kw_only=True):
    """A complete run."""

    config: RunConfig
    folder: RunFolder
    result: RunResult


def run_experiment(
    options: RunOptions,
    make_watcher: Callable[[str], Watcher],
    confirm: Callable[[ResolvedRuns], bool] = lambda _: True,
) -> Iterator[FinishedRun]:
    """Run every robot team with every human population; yield each run as soon as it is complete.

    All input is checked before the first trial. The other runs are run even if one ends incomplete.

    Args:
        make_watcher: makes the watcher that follows the progress of a run, given the run's title.
        confirm: called with the resolved runs before anything is done; if it returns False, nothing is done.

    Raises:
        HthorError: for any invalid input, before the first trial.
        Unfinished, InternalFailure: when a run ended incomplete; the others were run.
    """
    resolved = run_options.resolve_options(options)
    for scheduled in (*resolved.runs, *resolved.baseline_of.values()):
        scheduled.folder.check_free(scheduled.config)
        _engine(options, scheduled)  # raises if the engine does not exist
        _weakest_isolation(options, scheduled)
    if confirm(resolved):
        yield from _Experiment(options, make_watcher).run(resolved)


class _Experiment:
    """Plays the runs that some options stand for; remembers which notes were given and which runs ended incomplete."""

    def __init__(self, options: RunOptions, make_watcher: Callable[[str], Watcher]) -> None:
        self._options, self._make_watcher = options, make_watcher
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
            scheduled.make_runner,
            folder=scheduled.folder,
            watcher=watcher,
            engine=_engine(self._options, scheduled),
            extra=self._extra_files(scheduled),
            rerun_command=_rerun_command(self._options, scheduled),
            check=check if scheduled.config.agents else None,
        )

    def _extra_files(self, scheduled: ScheduledRun) -> dict[str, bytes]:
        """Files that make the run's folder complete in itself, by name."""
        files = {f"houses/{name}": data for name, data in run_options.own_houses(self._options).items()}
        if scheduled.tasks.generated:
            files["suite.json"] = encode_suite(scheduled.tasks.suite)
        if scheduled.isolation is not None:
            files[run_isolation.NAME] = jsonio.pretty(_weakest_isolation(self._options, scheduled))
        return files


def _engine(options: RunOptions, scheduled: ScheduledRun) -> engines.Engine:
    tasks, team = scheduled.tasks.suite.tasks, scheduled.team
    limit_s = options.trial_limit or engines.trial_limit_s(tasks, len(team.agent_paths), options.step_limit)
    return engines.find_engine(
        options.engine, jobs=options.jobs, address=options.address, gpus=team.gpus, limit_s=limit_s
    )


def _weakest_isolation(options: RunOptions, scheduled: ScheduledRun) -> Isolation | None:
    return run_isolation.weakest_isolation(scheduled.folder.path, scheduled.isolation, options.require_isolation)


def _rerun_command(options: RunOptions, scheduled: ScheduledRun) -> str:
    """The `hthor agent run` command that runs a trial of a run once more, without the trial's key."""
    team, people = scheduled.team, scheduled.people
    words = ["hthor", "agent", "run"]
    words += [word for path in dict.fromkeys(team.agent_paths.values()) for word in ("--agent", _relative(path))]
    words += [word for path in dict.fromkeys(team.robot_paths.values()) for word in ("--robot", _relative(path))]
    words += ["--kind", _relative(scheduled.tasks.kind_path)] if scheduled.tasks.kind_path else []
    if people.word != people.name:
        words += ["--humans", people.word]
    if options.isolation != "auto" and team.agent_paths:
        words += ["--isolation", options.isolation]
    if team.agent_paths:
        words += [word for argument in options.agent_args for word in ("--agent-args", argument)]
        words += [word for path in options.readable for word in ("--readable", str(path))]
    return shlex.join([*words, _relative(str(scheduled.folder))])


def _relative(path: str) -> str:
    """An absolute path relative to the current folder, if it is below it; any other text unchanged."""
    relative = os.path.relpath(path) if os.path.isabs(path) else path
    return path if relative.startswith("..") else relative
