"""Reads logs as people with their trials in order, and extracts the features that the estimators use."""

import math
from collections import Counter
from collections.abc import Iterable, Sequence
from pathlib import Path

from msgspec import UNSET, Struct

from hthor import log_corrections, log_format, rules
from hthor.calibration.from_logs import one_person
from hthor.calibration.from_logs.features import display_use, hands, locomotion, messages
from hthor.calibration.from_logs.features.display_use import Follow
from hthor.calibration.from_logs.features.locomotion import Walk
from hthor.calibration.from_logs.features.messages import Offer, Reading
from hthor.calibration.from_logs.models.search_models import Choice, Exposure
from hthor.calibration.from_logs.models.trust_model import Experience
from hthor.comms.claims import is_false
from hthor.errors import RunError
from hthor.eval.records import attempts, corrected_log, trial_record
from hthor.eval.records.trial_record import TrialRecord
from hthor.humans.population.parameters import Parameters
from hthor.types import HUMAN, events


class Trial(Struct, frozen=True, kw_only=True):
    """A trial of one person, and the numbers of that person and of their session within a `Sessions`, from 0."""

    record: TrialRecord
    person: int
    session: int


class Sessions(Struct, frozen=True, kw_only=True):
    """All trials, ordered by person, session and index.

    Trials with the same human model, seed and participant number are of the same person, with any robots; each robot
    team that a person met is a session of its own. Records have one person, see `one_person`.
    """

    trials: tuple[Trial, ...]
    people: int
    sessions: int


def read_sessions(paths: Sequence[Path]) -> Sessions:
    """The trials in some logs that count, each trial once, with the corrections beside the logs.

    Args:
        paths: folders of runs, or log files such as their ``trials.jsonl``.

    Raises:
        RunError: when a log cannot be read; it names file, line and field.
    """
    records_by_key: dict[str, TrialRecord] = {}
    for path in paths:
        for one in attempts.select_records(_records(path)):
            records_by_key.setdefault(one.key, one)
    return sessions_of(records_by_key.values())


def sessions_of(records: Iterable[TrialRecord]) -> Sessions:
    """The sessions that these records belong to; a trial of several people is a trial of each of them."""
    own = (part for record in records for part in one_person.split_by_person(record))
    ordered = sorted(own, key=lambda one: (*_person(one), _team(one), one.spec.index, one.key))
    people: dict[object, int] = {}
    sessions: dict[object, int] = {}
    trials = tuple(
        Trial(
            record=one,
            person=people.setdefault(_person(one), len(people)),
            session=sessions.setdefault((_person(one), _team(one)), len(sessions)),
        )
        for one in ordered
    )
    return Sessions(trials=trials, people=len(people), sessions=len(sessions))


def _person(one: TrialRecord) -> tuple[str, str, int, int]:
    human = one.spec.humans[0]
    return human.model, human.sha256, one.spec.seed, human.participant


def _team(one: TrialRecord) -> tuple[str, ...]:
    return tuple(f"{robot.seat} {robot.robot} {robot.agent.name} {robot.agent.sha256}" for robot in one.spec.robots)


def _records(path: Path) -> list[TrialRecord]:
    file = path / "trials.jsonl" if path.is_dir() else path
    if not file.is_file():
        what = "a folder without trials.jsonl" if path.is_dir() else "not there"
        raise RunError(f"{path} is {what}. --target takes run folders of 'hthor eval', or their logs.")
    lines = file.read_bytes().split(b"\n")
    if lines[-1]:
        raise RunError(
            f"{file}, line {len(lines)} is cut off: it has no end. Finish the run with the 'hthor eval' command that "
            "began it, or delete that line."
        )
    skipped = Counter[str]()
    records = [_record(file, number, line + b"\n", skipped) for number, line in enumerate(lines[:-1], 1)]
    log_format.note_skipped(file, skipped)
    known = log_corrections.beside(file)
    corrected_log.check_trials(file, known, {one.key for one in records})
    return [corrected_log.corrected(one, known) for one in records] if known.lines else records


def _record(file: Path, number: int, line: bytes, skipped: Counter[str]) -> TrialRecord:
    try:
        return trial_record.decode(line, skipped)
    except trial_record.OtherVersion as other:
        raise RunError(other.sentence(file)) from None
    except trial_record.Damaged as damage:
        raise RunError(
            f"{file}, line {number} is not a trial that 'hthor eval' logged: {damage.field}: {damage.problem}. "
            "Give the "
            "log of a run, or delete that line."
        ) from None


class Attempt(Struct, frozen=True, kw_only=True):
    """One manipulation attempt: its duration [s], whether it ``missed``, and whether it was ``cut`` short.

    ``seen``: measured from outside, as `hthor.calibration.from_logs.features.hands` does, so that misses are not known.
    """

    seconds: float
    missed: bool
    cut: bool
    seen: bool = False


class TrialFeatures(Struct, frozen=True, kw_only=True):
    """The features of a trial; ``walk`` is None when the log has no joystick data.

    ``panels`` are the times [s] for which the panel was shown until each answer.
    """

    person: int
    session: int
    index: int
    walk: Walk | None
    attempts: tuple[Attempt, ...]
    readings: tuple[Reading, ...]
    noticings: tuple[tuple[float, bool], ...]
    offers: tuple[Offer, ...]
    choices: tuple[Choice, ...]
    exposures: tuple[Exposure, ...]
    experience: Experience
    follows: tuple[Follow, ...] = ()
    panels: tuple[float, ...] = ()


def extract_features(sessions: Sessions) -> tuple[TrialFeatures, ...]:
    """The features of every trial of some sessions, in their order."""
    return tuple(_reduced(one) for one in sessions.trials)


def _reduced(trial: Trial) -> TrialFeatures:
    record = trial.record
    walk = locomotion.walk_features(record)
    pace = walk.pace if walk is not None and not math.isnan(walk.pace) else Parameters().v_pace
    return TrialFeatures(
        person=trial.person,
        session=trial.session,
        index=record.spec.index,
        walk=walk,
        attempts=manipulation_attempts(record),
        readings=messages.message_readings(record),
        noticings=messages.message_noticings(record),
        offers=messages.message_offers(record),
        choices=tuple(
            Choice(options=entry.options, chosen=entry.chosen, pace=pace)
            for entry in record.journal
            if isinstance(entry, events.Choice) and entry.aim == "target" and len(entry.options) > 1
        ),
        exposures=tuple(
            Exposure(rows=entry.gathered, noticed=entry.noticed)
            for entry in record.journal
            if isinstance(entry, events.Exposure)
        ),
        experience=_experience(record),
        follows=display_use.message_follows(record),
        panels=display_use.panel_times(record),
    )


def _experience(record: TrialRecord) -> Experience:
    if _has(record, events.Offer) or not _has(record, events.Inputs):
        offers = [entry for entry in record.journal if isinstance(entry, events.Offer)]
        accepted = [offer.tick for offer in offers if offer.relevant and offer.answer == "accept"]
        misled = sum(isinstance(entry, events.Misled) for entry in record.journal)
    else:
        accepted, misled = _followed(record)
    helped = accepted[0] * rules.TICK_S if accepted and not misled else math.nan
    return Experience(
        offered=any(isinstance(event, events.Shown) for event in record.events),
        helped=helped,
        misled=misled,
        met=record.met,
        rating=record.ratings[HUMAN] or 0,
    )


def _followed(record: TrialRecord) -> tuple[list[int], int]:
    """When messages were accepted by a person without a journal of offers, and how many of these misled them.

    Somebody was misled who was near the place of a wrong message before they accepted the next.
    """
    sent = {event.message: event for event in record.events if isinstance(event, events.Sent)}
    accepted = [event for event in record.events if isinstance(event, events.Accepted) and event.message in sent]
    misled = 0
    for number, event in enumerate(accepted):
        end = accepted[number + 1].tick if number + 1 < len(accepted) else record.ticks
        claim = sent[event.message]
        if is_false(claim) and claim.position is not None:
            misled += next(display_use.arrival(record, event.tick, claim), end) < end
    return [event.tick for event in accepted], misled


def _has(record: TrialRecord, kind: type[events.JournalEntry]) -> bool:
    """Whether the journal has an entry of a kind."""
    return any(isinstance(entry, kind) for entry in record.journal)


def manipulation_attempts(record: TrialRecord) -> tuple[Attempt, ...]:
    """The attempts of a trial in order; an attempt without outcome was cut short by walking on or by the end.

    People at pages have no journal of attempts: theirs are measured from outside.
    """
    if any(isinstance(entry, events.Inputs) for entry in record.journal) and not _has(record, events.Attempt):
        times = hands.handling_times(record)
        return tuple(Attempt(seconds=seconds, missed=False, cut=False, seen=True) for seconds in times)
    walked = [
        tick
        for entry in record.journal
        if isinstance(entry, events.Stick)
        for tick, deflection in zip(entry.runs[::2], entry.runs[1::2], strict=True)
        if deflection > 0
    ]
    found = []
    for entry in record.journal:
        if isinstance(entry, events.Attempt):
            until = min((tick for tick in walked if tick > entry.tick), default=record.ticks)
            cut = entry.seconds is UNSET
            seconds = (until - entry.tick) * rules.TICK_S if entry.seconds is UNSET else entry.seconds
            found.append(Attempt(seconds=seconds, missed=entry.why == "missed", cut=cut))
    return tuple(found)
