"""Runs and trials as lists."""

from __future__ import annotations

from pathlib import Path

import eval_fakes as fakes

from hthor import jsonio
from hthor.eval import browse
from hthor.eval.browse import TrialFilter
from hthor.eval.records import scored_trial, trial_record


def test_a_view_counts_messages_as_the_metrics_do(tmp_path: Path) -> None:
    plan, dealt = fakes.run_of(20, name="helper")
    jsonio.write(tmp_path / "run.json", jsonio.pretty(plan))
    made = [trial_record.make_record(trial, fakes.episode(trial)) for one in dealt for trial in one.trials]
    jsonio.write(tmp_path / "trials.jsonl", b"".join(map(trial_record.encode, made)))
    view, _ = browse.view_run(tmp_path, TrialFilter())
    accepted = {record.key: scored_trial.score(record).metrics["accepted"] for record in made}
    assert {line.key: line.accepted for line in view.trials} == accepted
    assert sum(line.accepted for line in view.trials) > 0
