"""Checks that a reference trial gives the same bytes here; run as a script, it runs that trial.

The course of the trial is compared, not the hash of the code: only a change of the course needs a new reference, which
`hthor doctor --write-reference` writes.
"""

import sys
from pathlib import Path
from typing import Any

import msgspec
from msgspec import Struct

from hthor import jsonio
from hthor.eval.doctor.check_result import CheckResult
from hthor.eval.records import platform

REFERENCE = Path(__file__).with_name("reference.json")
_SUITE, _AGENT, _PEOPLE, _SEED = "smoke", "frontier", "proxy", 0


class TrialFingerprint(Struct, frozen=True, kw_only=True):
    """The result of the trial: the hash of its whole course, its outcome, and the platform that it was played on."""

    trial: str
    sha256: str
    outcome: dict[str, Any]
    platform: dict[str, str]


def run_reference_trial() -> TrialFingerprint:
    """The first trial of the first person of the suite, with the frontier robot."""
    from hthor import tasks
    from hthor.eval.records import trial_record
    from hthor.eval.runner import session_runner
    from hthor.trials import sessions

    first = sessions.make_sessions(tasks.load_suite(_SUITE), agent=_AGENT, humans=_PEOPLE, seed=_SEED)[0]
    done = next(iter(session_runner.make_runner()(msgspec.structs.replace(first, trials=first.trials[:1])))).record
    course = msgspec.json.decode(trial_record.encode(done))
    for name in ("schema", "key", "spec", "check"):  # not part of the course of the trial
        del course[name]
    return TrialFingerprint(
        trial=done.spec.task.id,
        sha256=jsonio.sha256(course),
        outcome={"met": done.met, "ticks": done.ticks, "trust": done.ratings["human"], "events": len(done.events)},
        platform=platform.this_platform(),
    )


def load_reference() -> TrialFingerprint:
    """The stored fingerprint of the reference trial."""
    return msgspec.json.decode(REFERENCE.read_bytes(), type=TrialFingerprint)


def check_reproducibility(here: TrialFingerprint | str) -> list[CheckResult]:
    """Compare the trial that the process played with the reference."""
    name = "determinism"
    if isinstance(here, str):
        says = f"the process that plays a trial failed: {here}"
        return [
            CheckResult(name=name, status="fail", says=says, fix="hthor eval --agent none --participants 1 --jobs 1")
        ]
    there = load_reference()
    if here.sha256 == there.sha256:
        return [CheckResult(name=name, says=f"{here.trial} goes as in the reference, byte for byte")]
    other = platform.platform_differences(there.platform, here.platform)
    same = here.outcome == there.outcome and here.trial == there.trial
    if not other:
        says = f"on the platform of the reference, {here.trial} differs from the reference, outcome {_verdict(same)}"
        cure = "git status, and undo what changes trials; if the change is meant: hthor doctor --write-reference"
        return [CheckResult(name=name, status="fail", says=says, fix=cure)]
    says = f"outcome {_verdict(same)}, bytes not: this is another platform than the reference's ({'; '.join(other)})"
    cure = "" if same else "compare only runs that were played on one platform"
    return [CheckResult(name=name, status="ok" if same else "warn", says=says, fix=cure)]


def _verdict(same: bool) -> str:
    return "equal" if same else "different"


if __name__ == "__main__":
    sys.stdout.write(jsonio.canonical(run_reference_trial()).decode() + "\n")
