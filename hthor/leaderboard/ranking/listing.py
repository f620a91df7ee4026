"""Makes the list from the entries: sections, ranks and rows; the same entries give the same bytes."""

import itertools
from collections.abc import Mapping, Sequence

import numpy as np

from hthor import rules
from hthor.eval.comparison import ranking
from hthor.leaderboard.entries import entry_metrics, trial_outcomes, verification
from hthor.leaderboard.entries.entry import Entry
from hthor.leaderboard.entries.trial_outcomes import Outcomes
from hthor.leaderboard.entries.verification import MIN_DETECTION, KeeperRecords
from hthor.leaderboard.ranking import admission
from hthor.leaderboard.ranking.admission import Admission
from hthor.leaderboard.ranking.board import Board, Checked, Gain, Ranks, Row, Section, Standing, Struck

_NO_ROBOT = "no robot"
Key = tuple[str, str, str, str, int, str, str, str, str, str]
_SCORING = 2
"""How many parts at the end of a key are about scoring; the others are about the trials."""
ALIKE = 0.9
"""Two agents count as one if this share of their trials has the same success and nearly the same time. No robot and
the frontier robot, the most similar references, agree in about half of the trials of ``standard``; see
docs/leaderboard.md."""
NEAR_S = 1.0
"""Largest difference of two times that count as nearly the same [s]."""


def comparison_key(entry: Entry) -> Key:
    """The properties that entries must share to be compared."""
    run = entry.run
    people = (run.humans.name, run.humans.sha256, run.seed)
    scoring = (entry.scoring_sha256 or "", entry.trials.metrics_sha256 or "")
    return (run.suite.name, run.suite.sha256, *people, entry.mode, run.code_sha256, run.rules_sha256, *scoring)


def make_board(
    entries: Sequence[Entry], kept: KeeperRecords = verification.NO_RECORDS, taken: Admission | None = None
) -> Board:
    """Make the list.

    Args:
        kept: the files of the board's keeper; a refuted entry is not listed. taken: which suites are ranked; none if it
        is None.
    """
    struck = {entry.id: found for entry in entries if (found := kept.refutation_of(entry)) is not None}
    standing = [entry for entry in entries if entry.id not in struck]
    keys = sorted(
        {comparison_key(entry) for entry in standing}, key=lambda one: (_stands(one, taken) != admission.RANKED, one)
    )
    groups = {one: [entry for entry in standing if comparison_key(entry) == one] for one in keys}
    leading = _leading(groups)
    return Board(
        sections=tuple(
            _section(group, kept, _stands(one, taken), leading=one in leading) for one, group in groups.items()
        ),
        refuted=tuple(
            Struck(id=entry.id, name=display_name(entry), why=struck[entry.id].why)
            for entry in sorted(entries, key=lambda one: one.id)
            if entry.id in struck
        ),
    )


def _leading(groups: Mapping[Key, Sequence[Entry]]) -> set[Key]:
    """Of the groups at the same trials that were scored by different versions, the one with the most entries."""
    best: dict[Key | tuple[object, ...], Key] = {}
    for one in sorted(groups, key=lambda key: (len(groups[key]), key)):
        best[one[:-_SCORING]] = one
    return set(best.values())


def display_name(entry: Entry) -> str:
    """The name of an entry's agent on the page."""
    return _NO_ROBOT if entry.reference and entry.alone else entry.agent.name


def _stands(one: Key, taken: Admission | None) -> admission.Standing:
    suites = {} if taken is None else {suite.sha256: suite.standing for suite in taken.suites}
    return suites.get(one[1], "development")


def _section(entries: Sequence[Entry], kept: KeeperRecords, standing: admission.Standing, *, leading: bool) -> Section:
    controls = {entry.hashes.run for entry in entries if entry.alone}
    reasons = {entry.id: _unranked(entry, kept, standing, controls, leading=leading) for entry in entries}
    can = sorted((entry for entry in entries if not reasons[entry.id]), key=lambda one: one.id)
    same = representatives(can, [trial_outcomes.unpack(entry.trials) for entry in can])
    ranks = _ranks([entry for entry in can if same[entry.id] == entry.id])
    rows = [_row(entry, ranks, reasons[entry.id], same.get(entry.id, entry.id), kept, controls) for entry in entries]
    run = entries[0].run
    return Section(
        standing=standing,
        suite=run.suite,
        humans=run.humans.name,
        humans_sha256=run.humans.sha256,
        calibrated=all(entry.run.humans.valid for entry in entries),
        seed=run.seed,
        mode=entries[0].mode,
        trials=run.trials,
        people=run.participants,
        rules=run.rules_sha256,
        code=run.code_sha256,
        scoring=entries[0].scoring_sha256 or "",
        rows=tuple(sorted(rows, key=lambda row: (-(row.sr.mean or 0.0), -(row.twsr.mean or 0.0), row.id))),
    )


def _unranked(
    entry: Entry, kept: KeeperRecords, standing: admission.Standing, controls: set[str], *, leading: bool
) -> str:
    """The reason why an entry has no rank; empty if it can have a rank."""
    found = kept.verification_of(entry)
    if entry.reference:
        return "reference"
    if found is not None and found.refuted:
        return "refuted, or its control was"
    if standing != admission.RANKED:
        return "public tasks"
    if not leading or not entry.scoring_sha256:
        return "to be rescored"
    if found is None:
        return "not verified"
    if entry.uplift is None or entry.uplift.control not in controls:
        return "no control"
    if found.fell:
        return "fell on fresh tasks"
    return "" if found.caught >= MIN_DETECTION else "too few draws"


def _ranks(entries: Sequence[Entry]) -> dict[str, Ranks]:
    """The ranks of the agents that have one, by the entry's id."""
    if not entries:
        return {}
    held = [trial_outcomes.unpack(entry.trials) for entry in entries]
    participants = np.array(
        entry_metrics.trial_participants(entries[0].trials.count, entries[0].run.participants), dtype=np.int64
    )
    tasks = np.arange(len(participants), dtype=np.int64)
    ids = [entry.id for entry in entries]
    by_metric = {}
    for metric in ("sr", "twsr"):
        rows = np.stack([entry_metrics.metric_values(one, metric, alone=False) for one in held])
        by_metric[metric] = [
            Standing(rank=one.rank, interval=one.interval, ties=tuple(ids[other] for other in one.ties))
            for one in ranking.rank_agents(rows, tasks, participants)
        ]
    return {id: Ranks(sr=by_metric["sr"][place], twsr=by_metric["twsr"][place]) for place, id in enumerate(ids)}


def _row(
    entry: Entry, ranks: Mapping[str, Ranks], unranked: str, counted: str, kept: KeeperRecords, controls: set[str]
) -> Row:
    seats = entry.run.seats
    gain = entry.uplift if entry.uplift is not None and entry.uplift.control in controls else None
    return Row(
        id=entry.id,
        name=display_name(entry),
        agent=entry.agent,
        team=entry.team,
        bodies=tuple(seat.robot for seat in seats),
        privileges=tuple(dict.fromkeys(word for seat in seats for word in seat.agent.privileges)),
        code=entry.code,
        reference=entry.reference,
        ranks=ranks.get(entry.id),
        unranked=unranked or ("" if counted == entry.id else "counted as another entry"),
        same_as="" if counted == entry.id else counted,
        **{metric: getattr(entry.metrics, metric) for metric in entry_metrics.MEASURED},
        uplift=None if gain is None else Gain(sr=gain.sr, twsr=gain.twsr, time_s=gain.time_s),
        splits=entry.splits,
        faults=entry.counts.faults,
        replays=entry.counts.replays,
        isolation=entry.isolation.level if entry.isolation else "",
        harness=entry.harness,
        verification=_checked(entry, kept),
    )


def _checked(entry: Entry, kept: KeeperRecords) -> Checked | None:
    found = kept.verification_of(entry)
    if found is None:
        return None
    return Checked(trials=found.trials, control=found.control, fresh=found.fresh, official=found.official)


def group_duplicates(entries: Sequence[Entry], held: Sequence[Outcomes]) -> list[list[int]]:
    """Group entries that are one agent, by their indices; entries that are linked through others are in one group."""
    from scipy.sparse import csgraph

    alike = np.zeros((len(entries), len(entries)), dtype=bool)
    for one, other in itertools.combinations(range(len(entries)), 2):
        alike[one, other] = _is_one(entries[one], entries[other]) or similarity(held[one], held[other]) >= ALIKE
    count, groups = csgraph.connected_components(alike, directed=False) if entries else (0, alike)
    return [np.flatnonzero(groups == number).tolist() for number in range(count)]


def representatives(entries: Sequence[Entry], held: Sequence[Outcomes]) -> dict[str, str]:
    """For each entry's id, the id of the entry that is ranked for it: the best of its group, the first of equals."""
    found: dict[str, str] = {}
    for group in group_duplicates(entries, held):
        best = min(
            group, key=lambda place: (-int(held[place].met.sum()), -int(held[place].twsr.sum()), entries[place].id)
        )
        found |= {entries[place].id: entries[best].id for place in group}
    return found


def similarity(one: Outcomes, other: Outcomes) -> float:
    """The share of trials in which both had the same success, and the same time to within `NEAR_S`."""
    if len(one.met) != len(other.met):
        return 0.0
    near = np.abs(one.time - other.time) <= round(NEAR_S / rules.TICK_S)
    return float((near & (one.met == other.met)).mean())


def _is_one(one: Entry, other: Entry) -> bool:
    named = (one.team, one.agent.name) == (other.team, other.agent.name)
    return named or (bool(one.code) and set(one.code) == set(other.code))
