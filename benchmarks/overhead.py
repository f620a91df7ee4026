"""What `hthor eval` costs beside the trials: `python -m benchmarks.overhead RUN`, a finished run with its control.

The run's command is given again, in a folder of its own, and workers take the trials from RUN's log instead of
simulating them. What the supervising process then spends is the harness: resolving, handing out sessions, writing
records, progress, scoring with intervals, storing. It is set against the CPU time that RUN's trials took.
"""

from __future__ import annotations

import functools
import io
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path

from rich.console import Console

from hthor.eval.config.options import EvalOptions
from hthor.eval.planning.resolve import resolve
from hthor.eval.records import trial_log, trial_record
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.records.trial_record import TrialRecord
from hthor.eval.results import baseline, result_file
from hthor.eval.runner import collector, experiment, progress, run, session_runner
from hthor.eval.runner.messages import TrialOutcome
from hthor.trials.sessions import Session


def player(folder: Path, sources: object = None) -> Callable[[Session], Iterator[TrialRecord]]:
    """What a worker does: tells the trials of a run and of its control from their logs."""
    del sources  # nothing is made
    logs = (folder / "trials.jsonl", folder / baseline.FOLDER / "trials.jsonl")
    kept = {_seat(one): one.log for path in logs for _, one in trial_log.read(path)}

    def perform(session: Session) -> Iterator[TrialRecord]:
        for trial in session.trials:
            log = kept[bool(trial.robots), trial.session, trial.index]
            yield TrialOutcome(record=trial_record.make_record(trial, log))

    return perform


def main(folder: Path) -> None:
    """Give the run's command again, and print what the harness took."""
    plan = RunFolder(folder).config
    results = [result_file.load_result(path) for path in (folder, folder / baseline.FOLDER)]
    trials_s = sum(one.effort.cpu_s for one in results if one is not None and one.effort is not None)
    spent: dict[str, float] = {}
    for place, name in ((collector.Collector, "collect"), (run, "_score")):
        setattr(place, name, _timed(getattr(place, name), name, spent))
    session_runner.make_runner = functools.partial(player, folder.resolve())  # type: ignore[assignment]
    with tempfile.TemporaryDirectory() as scratch:
        options = EvalOptions(
            agent=tuple(robot.agent.name for robot in plan.robots),
            humans=(plan.humans.source,),
            suite=plan.suite.name,
            seed=plan.seed,
            participants=plan.participants,
            out=Path(scratch) / "run",
        )
        console = Console(file=io.StringIO())
        count = sum(
            one.result.counts.trials
            for one in experiment.run_experiment(resolve(options), lambda n: progress.Plain(console, n))
        )
    whole = time.process_time()
    rows = {
        "imports, resolving, sessions": whole - sum(spent.values()),
        "handing out, writing, progress": spent["play"],
        "scores, intervals, storing": spent["_finish"],
        "the harness": whole,
        "the trials that RUN simulated": trials_s,
    }
    for what, seconds in rows.items():
        print(f"{what:<32} {seconds:8.2f} s of CPU time")
    print(f"{count} trials and their control: the harness is {100.0 * whole / (whole + trials_s):.1f} % of it all")


def _timed(work: Callable[..., object], name: str, spent: dict[str, float]) -> Callable[..., object]:
    def timed(*words: object, **named: object) -> object:
        began = time.process_time()
        try:
            return work(*words, **named)
        finally:
            spent[name] = spent.get(name, 0.0) + time.process_time() - began

    return timed


def _seat(one: TrialRecord) -> tuple[bool, int, int]:
    return bool(one.spec.robots), one.spec.session, one.spec.index


if __name__ == "__main__":
    from benchmarks import overhead  # workers must find its functions under this name, not under __main__

    overhead.main(Path(sys.argv[1]))
