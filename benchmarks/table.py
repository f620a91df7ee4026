"""The rows of the table and how they are printed; knows nothing of how anything is measured."""

from __future__ import annotations

import os
import platform
import statistics
import time
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

from msgspec import Struct

from hthor.console import output


class Row(Struct, frozen=True, kw_only=True):
    """One line: ``what`` took ``value``; None when it could not be measured, and then ``remark`` says why.

    ``bar`` is what it must not exceed, or with ``at_least`` what it must reach; None where nothing is promised.
    """

    part: str
    what: str
    value: float | None
    unit: str
    bar: float | None = None
    at_least: bool = False
    remark: str = ""

    @property
    def met(self) -> bool | None:
        """Whether the bar is met; None where there is none."""
        if self.bar is None or self.value is None:
            return None
        return self.value >= self.bar if self.at_least else self.value <= self.bar


class Clock:
    """CPU time of this process and its threads [ms] since this was made."""

    def __init__(self) -> None:
        self._begin = time.process_time()

    def __call__(self) -> float:
        return (time.process_time() - self._begin) * 1000.0


def median_ms(call: Callable[[], Any], repeats: int) -> float:
    """CPU time [ms] of a call, median of ``repeats``; the first call, which may compile, does not count."""
    call()
    costs = []
    for _ in range(repeats):
        clock = Clock()
        call()
        costs.append(clock())
    return statistics.median(costs)


def put(rows: Sequence[Row], as_json: bool) -> None:
    """Print all rows, as a table or as JSON."""
    if as_json:
        output.put_json({"machine": machine(), "rows": [_plain(row) for row in rows]})
        return
    print(machine())
    output.put_table(("part", "what", "value", "unit", "bar", "remark"), [_cells(row) for row in rows])


def machine() -> str:
    """The processor and the Python, in words."""
    return f"{_processor()}, {os.cpu_count()} cores; Python {platform.python_version()}; CPU time, medians"


def _cells(row: Row) -> Iterable[object]:
    value = "-" if row.value is None else f"{row.value:.3g}" if row.value < 100 else f"{row.value:,.0f}"
    sign = {None: "", True: ", met", False: ", MISSED"}[row.met]
    bar = "" if row.bar is None else f"{'≥' if row.at_least else '≤'} {row.bar:,g}{sign}"
    return row.part, row.what, value, row.unit, bar, row.remark


def _plain(row: Row) -> dict[str, Any]:
    return {
        "part": row.part,
        "what": row.what,
        "value": row.value,
        "unit": row.unit,
        "bar": row.bar,
        "at_least": row.at_least,
        "met": row.met,
        "remark": row.remark,
    }


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor() or platform.machine()
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.machine()
