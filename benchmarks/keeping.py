"""``python -m benchmarks.keeping RUN``: what it costs to keep a run's records, without playing a trial.

Workers take the records of a finished run from its log and send them as if they had just played them. The parent does
what it always does: hands out, writes, syncs, scores.
"""

from __future__ import annotations

import argparse
import functools
import itertools
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path

from hthor.eval.records import trial_log
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.records.trial_record import TrialRecord
from hthor.eval.results import aggregate, result_file
from hthor.eval.runner import engines, progress, run
from hthor.trials.sessions import Session


def player(path: Path) -> Callable[[Session], Iterator[TrialRecord]]:
    """Gives sessions as this log has them."""
    there = {found.key: place for place, _, found in trial_log.places(path)}

    def perform(session: Session) -> Iterator[TrialRecord]:
        from hthor.eval.records import trial_record

        for line in trial_log.fetch(there[trial_record.key(trial)] for trial in session.trials):
            yield trial_record.decode(line)

    return perform


def sessions(folder: Path) -> list[Session]:
    """The sessions of a finished run, from its log."""
    _, records = RunFolder(folder).digest()
    people = itertools.groupby(records, key=lambda one: one.spec.session)
    return [Session(number=who, trials=tuple(one.spec for one in mine)) for who, mine in people]


def main() -> None:
    """Print what the parts cost."""
    options = argparse.ArgumentParser(prog="python -m benchmarks.keeping", description=__doc__.split("\n\n")[0])
    options.add_argument("run", type=Path, help="the folder of a finished run")
    folder = options.parse_args().run
    plan, dealt, stored = RunFolder(folder).config, sessions(folder), result_file.load_result(folder)
    engine = engines.find_engine("local", jobs=2)
    scoring = 0.0
    real = aggregate.make_result

    def summarise(*words, **more):  # type: ignore[no-untyped-def]
        nonlocal scoring
        began = time.process_time()
        result = real(*words, **more)
        scoring += time.process_time() - began
        return result

    aggregate.make_result = summarise
    with tempfile.TemporaryDirectory(prefix="hthor-keeping-") as name:
        began = time.process_time()
        make = functools.partial(player, folder / "trials.jsonl")
        run.run_evaluation(
            plan, dealt, make, folder=RunFolder(Path(name, "again")), engine=engine, watcher=progress.Silent()
        )
        spent = time.process_time() - began
    began = os.times().children_user + os.times().children_system
    subprocess.run([sys.executable, "-m", "hthor", "--help"], check=True, stdout=subprocess.DEVNULL)
    start = os.times().children_user + os.times().children_system - began
    count = sum(len(one.trials) for one in dealt)
    kept = spent - scoring
    print(f"{count} trials, {(folder / 'trials.jsonl').stat().st_size / count / 1000:.1f} kB each")
    print(f"CPU time of the parent: {1e3 * kept / count:.2f} ms a trial, and {scoring:.2f} s for scores and intervals")
    print(f"CPU time of 'hthor --help': {start:.2f} s")
    if stored and stored.effort:
        trials = stored.effort
        print(
            f"the run itself took {trials.wall_s:.0f} s for {trials.trials} trials; "
            f"of which the parent {100 * (spent + start) / trials.wall_s:.1f} %, were it to wait for it"
        )


if __name__ == "__main__":
    main()
