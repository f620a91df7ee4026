"""`hthor calibrate --target LOGS...`."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from hthor.console import output

if TYPE_CHECKING:
    from hthor.calibration.from_logs.run import EstimateRow, LogEstimates

OUT = Path("calibration") / "logs"


def run(targets: Sequence[str], prior: str, out: Path | None, json: bool) -> None:
    """Estimate parameters from logs, and update a population with them."""
    from hthor.calibration.from_logs import run

    talk, folder = output.console(talk=True), out or OUT

    def tell(what: str) -> None:
        if not json:
            talk.print(f"estimating: {what}" if what not in ("reading", "updating") else f"{what} ...", highlight=False)

    found, _ = run.estimate_from_logs([Path(word) for word in targets], prior, folder, tell)
    if json:
        output.put_json(found)
        return
    output.put_table(("parameter", "before", "after", "estimate", "data", "how"), [_cells(row) for row in found.rows])
    _say_rest(found, folder)


def _cells(row: EstimateRow) -> tuple[str, ...]:
    one = row.estimate
    name = f"{row.name} [{row.unit}]" if row.unit else row.name
    before, after = (
        f"{middle:.3g} ({low:.3g} … {high:.3g})"
        for middle, low, high in (
            (row.before, row.before_low, row.before_high),
            (row.after, row.after_low, row.after_high),
        )
    )
    if one is None:
        return name, before, after, "–", "–", "no direct measure; weighted by the others"
    return (
        name,
        before,
        after,
        f"{one.value:.3g} ({one.low:.3g} … {one.high:.3g})",
        str(one.n),
        _how(one.words, one.method),
    )


def _how(words: str, method: str) -> str:
    return method if words == "estimated" else f"{words}; {method}"


def _say_rest(found: LogEstimates, folder: Path) -> None:
    output.put_line(f"{found.trials} trials, {found.sessions} sessions, {found.people} people; before: {found.prior}.")
    for note in found.notes:
        output.put_line(note)
    output.put_line(f"files: {folder}/population.json, population.npz, estimates.json")
    output.put_line(f"next:  hthor eval --humans {shlex.quote(str(folder))}/population.npz --agent frontier")
