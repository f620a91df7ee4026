"""The list out of the entries: sections, ranks, rows; the same entries give the same bytes. Reads no files."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hthor.eval import ranking
from hthor.leaderboard import outcomes, worth
from hthor.leaderboard.board import Board, Checked, Gain, Ranks, Row, Section, Standing
from hthor.leaderboard.entry import Entry

_NO_ROBOT = "no robot"
Key = tuple[str, str, str, str, int, str, str, str]


def key(entry: Entry) -> Key:
    """What entries must have in common to be compared."""
    run = entry.run
    people = (run.humans.name, run.humans.sha256, run.seed)
    return (run.suite.name, run.suite.sha256, *people, entry.mode, run.code_sha256, run.rules_sha256)


def board(entries: Sequence[Entry]) -> Board:
    """The list."""
    keys = sorted({key(entry) for entry in entries})
    return Board(sections=tuple(_section([entry for entry in entries if key(entry) == one]) for one in keys))


def name(entry: Entry) -> str:
    """What to call an entry's agent."""
    return _NO_ROBOT if entry.reference and entry.alone else entry.agent.name


def _section(entries: Sequence[Entry]) -> Section:
    ranked = sorted((entry for entry in entries if not entry.reference and not _refuted(entry)), key=lambda one: one.id)
    ranks = _ranks(ranked)
    rows = [_row(entry, ranks.get(entry.id)) for entry in entries]
    run = entries[0].run
    return Section(
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
        rows=tuple(sorted(rows, key=lambda row: (-(row.sr.mean or 0.0), -(row.twsr.mean or 0.0), row.id))),
    )


def _refuted(entry: Entry) -> bool:
    return entry.verification is not None and not entry.verification.passed


def _ranks(entries: Sequence[Entry]) -> dict[str, Ranks]:
    """Places of the agents that have one, by the entry's id."""
    if not entries:
        return {}
    held = [outcomes.unpack(entry.trials) for entry in entries]
    whose = np.array(worth.people(entries[0].trials.count, entries[0].run.participants), dtype=np.int64)
    tasks = np.arange(len(whose), dtype=np.int64)
    ids = [entry.id for entry in entries]
    by_metric = {}
    for metric in ("sr", "twsr"):
        rows = np.stack([worth.values(one, metric, alone=False) for one in held])
        by_metric[metric] = [
            Standing(rank=one.rank, interval=one.interval, ties=tuple(ids[other] for other in one.ties))
            for one in ranking.standings(rows, tasks, whose)
        ]
    return {id: Ranks(sr=by_metric["sr"][place], twsr=by_metric["twsr"][place]) for place, id in enumerate(ids)}


def _row(entry: Entry, ranks: Ranks | None) -> Row:
    metrics = {metric: getattr(entry.metrics, metric) for metric in worth.MEASURED}
    seats = entry.run.seats
    gain = entry.uplift
    return Row(
        id=entry.id,
        name=name(entry),
        agent=entry.agent,
        bodies=tuple(seat.robot for seat in seats),
        privileges=tuple(dict.fromkeys(word for seat in seats for word in seat.agent.privileges)),
        code=tuple(dict.fromkeys(seat.agent.sha256 for seat in entry.run.robots)),
        reference=entry.reference,
        ranks=ranks,
        **metrics,
        uplift=None if gain is None else Gain(sr=gain.sr, twsr=gain.twsr, time_s=gain.time_s),
        splits=entry.splits,
        faults=entry.counts.faults,
        isolation=entry.isolation.level if entry.isolation else "",
        harness=entry.harness,
        verification=_checked(entry),
    )


def _checked(entry: Entry) -> Checked | None:
    found = entry.verification
    if found is None:
        return None
    return Checked(tier=found.tier, passed=found.passed, compared=found.compared, equal=found.equal)
