"""Writes the table of all metrics from their records: `python scripts/metrics_reference.py docs/metrics.md`.

The table stands between two markers of the page.
"""

import math
import sys
from collections.abc import Sequence
from pathlib import Path

from hthor import jsonio
from hthor.eval.metrics import registry
from hthor.eval.metrics.metric import Metric

BEGIN = "<!-- written by: python scripts/metrics_reference.py docs/metrics.md -->\n"
END = "<!-- end -->\n"
_COLUMNS = ("name in `result.json`", "in tables", "of one trial", "over trials", "range", "better")


def page(text: str) -> str:
    """The page with its table made again.

    Raises:
        ValueError: when a marker is missing.
    """
    before, begin, rest = text.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not begin or not end:
        raise ValueError(f"the page lacks the line '{(END if begin else BEGIN).strip()}'")
    table = _line(_COLUMNS) + "|---" * len(_COLUMNS) + "|\n" + "".join(map(_row, registry.METRICS))
    return before + BEGIN + table + END + after


def _row(metric: Metric) -> str:
    low, high = metric.bounds
    most = "to the time limit" if metric.timed else "or more" if math.isinf(high) else f"to {high:g}"
    title = metric.title + (f" ({metric.abbreviation})" if metric.abbreviation else "")
    over = "mean of each" if metric.by_seat else "mean"
    return _line((f"`{metric.name}`", title, " ".join(metric.doc.split()), over, f"{low:g} {most}", metric.better))


def _line(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |\n"


if __name__ == "__main__":
    place = Path(sys.argv[1])
    jsonio.write(place, page(place.read_text(encoding="utf-8")).encode())
