"""In what ways a run's robots failed, and how often; knows nothing of how it is shown."""

from __future__ import annotations

from hthor import rules
from hthor.eval.pages import chosen
from hthor.eval.pages.findings import Failure
from hthor.eval.pages.gather import Run
from hthor.eval.record import Record

_LAST_MAX = 160


def of(run: Run) -> list[Failure]:
    """One entry for each seat and sort of fault, by the first trial that it came in."""
    agents = {robot.seat: robot.agent.name for robot in run.plan.seats}
    cases: dict[tuple[str, str], list[Record]] = {}
    for record in run.records:
        for seat, kind in dict.fromkeys((fault.seat, fault.kind) for fault in record.faults):
            cases.setdefault((seat, kind), []).append(record)
    return [_failure(run, seat, agents.get(seat, ""), kind, held) for (seat, kind), held in cases.items()]


def _failure(run: Run, seat: str, agent: str, kind: str, held: list[Record]) -> Failure:
    first = held[0]
    fault = next(one for one in first.faults if (one.seat, one.kind) == (seat, kind))
    lines = fault.detail.strip().splitlines()
    return Failure(
        run=run.folder.resolve().name,
        seat=seat,
        agent=agent,
        kind=kind,
        trials=len(held),
        key=first.key,
        task=first.spec.task.id,
        after_s=round(fault.tick * rules.TICK_S, 1),
        last=lines[-1][:_LAST_MAX] if lines else "",
        replay=chosen.replay(run, first),
    )
