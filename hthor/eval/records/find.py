"""Finding one trial of a run by the user's name for it, and describing its first fault."""

import difflib
from collections.abc import Sequence

from hthor import rules
from hthor.errors import RunError, UnknownName
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.records.scored_trial import ScoredTrial
from hthor.eval.records.trial_record import TrialRecord

_SHOWN = 10
_TRACEBACK_LINES = 12


def find_trial(folder: RunFolder, name: str) -> ScoredTrial:
    """The trial of a run that ``name`` stands for.

    Args:
        name: the start of a key, a task's id, or a number: the trial's place among all trials that are over, counted
            from 0. After an @ the number of an attempt may follow, such as 12@0 for the first at trial 12, which may
            have been voided; without it, the attempt that counts is meant. A key names an attempt by itself.

    Raises:
        UnknownName: when no trial fits.
        RunError: when several trials fit, or the run cannot be read.
    """
    trial, at, number = name.rpartition("@")
    if at and number.isdecimal():
        return _attempt(folder, trial, int(number))
    records = folder.played()
    by_task = [record for record in records if record.spec.task.id == name]
    if by_task:
        return _only(by_task, name)
    if name.isdecimal() and int(name) < len(records):
        return records[int(name)]
    tried = folder.attempts() if folder.voided else records
    by_key = [record for record in tried if name and record.key.startswith(name)]
    if by_key:
        return _only(by_key, name)
    if not records:
        _ = folder.config  # says so if this is no run's folder at all
    ids = sorted({record.spec.task.id for record in records})
    near = difflib.get_close_matches(name, ids, n=_SHOWN, cutoff=0.4) or ids[:_SHOWN]
    more = (
        f"The run's log has {len(ids)} tasks; a number from 0 to {len(records) - 1} or the start of a key does as well."
    )
    raise UnknownName("trial", name, near, more if records else "The run has no trials yet.")


def _attempt(folder: RunFolder, name: str, number: int) -> ScoredTrial:
    """The attempt with this number at the trial that ``name`` stands for, which may have no attempt that counts."""
    tried = folder.attempts()
    mine = [record for record in tried if record.spec.task.id == name]
    if not mine:
        spec = find_trial(folder, name).spec
        mine = [record for record in tried if (record.spec.session, record.spec.index) == (spec.session, spec.index)]
    found = [record for record in mine if (record.spec.attempt or 0) == number]
    if not found:
        known = sorted({str(record.spec.attempt or 0) for record in mine})
        raise UnknownName("attempt", str(number), known, f"These are the attempts at '{name}'.")
    return _only(found, name)


def _only(records: Sequence[ScoredTrial], name: str) -> ScoredTrial:
    if len(records) > 1:
        listed = ", ".join(f"{record.key} (session {record.spec.session})" for record in records[:_SHOWN])
        raise RunError(f"'{name}' stands for {len(records)} trials: {listed}. Give a key, or more of it.")
    return records[0]


def first_fault(folder: RunFolder) -> ScoredTrial:
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
