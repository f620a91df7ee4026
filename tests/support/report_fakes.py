"""Runs for reports, written without playing them."""

from __future__ import annotations

from pathlib import Path

import eval_fakes as fakes
import msgspec

from hthor import jsonio
from hthor.eval.records import trial_record
from hthor.report.analysis.document import Published, Share

PUBLISHED = Published(
    name="study",
    source="A study",
    sha256="12" * 32,
    suite="paper",
    figures={"sr none": 0.638, "sr oracle": 0.914},
    counts={"sr none": Share(k=37, n=58), "sr oracle": Share(k=53, n=58)},
)


def run(folder: Path, name: str, *, absent: bool = False, seed: int = 0, count: int = 20, people: str = "") -> Path:
    """A whole run's folder without playing it."""
    plan, dealt = fakes.run_of(count, name=name, absent=absent, seed=seed)
    plan = msgspec.structs.replace(plan, humans=msgspec.structs.replace(plan.humans, name=people or plan.humans.name))
    jsonio.write(folder / "run.json", jsonio.pretty(plan))
    made = [trial_record.make_record(trial, fakes.episode(trial)) for session in dealt for trial in session.trials]
    jsonio.write(folder / "trials.jsonl", b"".join(trial_record.encode(one) for one in made))
    return folder
