"""Finding one trial of a run by the user's name for it, and describing its first fault."""

import difflib
from collections.abc import Sequence

from hthor import rules
from hthor.errors import RunError, UnknownName
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.records.trial_record import TrialRecord

_SHOWN = 10
_TRACEBACK_LINES = 12


def find_trial(folder: RunFolder, name: str) -> TrialRecord:
    """The trial of a run that ``name`` stands for.

    Args:
        name: the start of a key, a task's id, or a number: the trial's place among all trials, counted from 0.

    Raises:
        UnknownName: when no trial fits.
        RunError: when several trials fit, or the run cannot be read.
    """
    records = folder.records()
    by_task = [record for record in records if record.spec.task.id == name]
    if by_task:
        return _only(by_task, name)
    if name.isdecimal() and int(name) < len(records):
        return records[int(name)]
    by_key = [record for record in records if name and record.key.startswith(name)]
    if by_key:
        return _only(by_key, name)
    ids = sorted({record.spec.task.id for record in records})
    near = difflib.get_close_matches(name, ids, n=_SHOWN, cutoff=0.4) or ids[:_SHOWN]
    more = (
        f"The run's log has {len(ids)} tasks; a number from 0 to {len(records) - 1} or the start of a key does as well."
    )
    raise UnknownName("trial", name, near, more if records else "The run has no trials yet.")


def _only(records: Sequence[TrialRecord], name: str) -> TrialRecord:
    if len(records) > 1:
        listed = ", ".join(f"{record.key} (session {record.spec.session})" for record in records[:_SHOWN])
        raise RunError(f"'{name}' stands for {len(records)} trials: {listed}. Give a key, or more of it.")
    return records[0]


def first_fault(folder: RunFolder) -> TrialRecord:
    """The first trial of a run in which an agent failed; raises LookupError when none did."""
    _, records = folder.digest()
    return next(record for record in records if record.faults)


def fault_lines(record: TrialRecord) -> list[str]:
    """The end of the traceback of a trial's first fault; empty where it was not an exception."""
    lines = record.faults[0].detail.strip().splitlines()
    return lines[-_TRACEBACK_LINES:] if len(lines) > 1 else []


def fault_words(record: TrialRecord) -> str:
    """A trial's first fault in words: which robot (of several), when, what, and the last line of its detail."""
    fault = record.faults[0]
    last = fault.detail.strip().splitlines()[-1] if fault.detail.strip() else ""
    names = {robot.seat: robot.agent.name for robot in record.spec.robots}
    robot = f"{fault.seat} ({names[fault.seat]}), " if len(names) > 1 else ""
    return f"{robot}after {fault.tick * rules.TICK_S:.1f} s: {fault.kind}" + (f": {last}" if last else "")
