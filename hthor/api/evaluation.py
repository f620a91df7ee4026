"""What `hthor.evaluate` returns: the results of its runs, which a notebook shows as a table."""

from __future__ import annotations

import io
import shlex
from collections.abc import Iterable, Iterator
from html import escape
from typing import TYPE_CHECKING

from hthor.console import formats
from hthor.errors import HthorError
from hthor.eval.comparison import population_matrix
from hthor.eval.results.result_file import RunResult
from hthor.report.terminal import result_tables

if TYPE_CHECKING:
    from rich.table import Table

_WIDTH = 120


class Evaluation(population_matrix.Evaluation, frozen=True, kw_only=True):
    """The runs of a call of `hthor.evaluate`, with the fields of the document that `hthor eval --json` prints.

    ``runs`` has the folder and the result of every run, by population and then by agent in the order of the call;
    ``peoples`` compares the populations if there were several.
    """

    @classmethod
    def of(cls, done: Iterable[tuple[str, RunResult]]) -> Evaluation:
        """The evaluation of whole runs, each by its folder."""
        found = population_matrix.make_evaluation(done)
        return cls(runs=found.runs, peoples=found.peoples)

    @property
    def result(self) -> RunResult:
        """The result of the only run.

        Raises:
            HthorError: when there are several.
        """
        if len(self.runs) != 1:
            names = ", ".join(f"{place}: {run.result.name}" for place, run in enumerate(self.runs))
            raise HthorError(f"this evaluation has {len(self.runs)} runs ({names}); take one, as in .runs[0].result.")
        return self.runs[0].result

    def __repr__(self) -> str:
        """The table of results, and what is behind it, as the command line prints them."""
        from hthor.console.table_fitting import FittingConsole

        paper = io.StringIO()
        FittingConsole(file=paper, width=_WIDTH, emoji=False, force_jupyter=False).print(self._table)
        text = "\n".join(line.rstrip() for line in paper.getvalue().splitlines()).strip("\n")
        return "\n".join([text, *self._lines])

    def _repr_html_(self) -> str:
        """The table of results for a notebook, and what is behind it."""
        parts = []
        for title, headings, rows in formats.tables(self._table):
            head = "".join(f"<th>{escape(one)}</th>" for one in headings)
            body = "".join(f"<tr>{''.join(map(_cell, range(len(row)), row))}</tr>" for row in rows)
            above = f'<caption style="text-align: left; font-weight: bold">{escape(title)}</caption>' if title else ""
            parts.append(f"<table>{above}<thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>")
        parts += [f"<div>{escape(line)}</div>" for line in self._lines]
        return "".join(parts)

    @property
    def _table(self) -> Table:
        if self.peoples is not None:
            return result_tables.population_table(self.peoples)
        results = [run.result for run in self.runs]
        return result_tables.result_table(results[0]) if len(results) == 1 else result_tables.comparison_table(results)

    @property
    def _lines(self) -> Iterator[str]:
        """Where the runs are, and what a reader of the table has to know."""
        for run in self.runs:
            people = f", {run.result.humans.name} people" if self.peoples is not None else ""
            name = f"{run.result.label}{people}: " if len(self.runs) > 1 else "files: "
            yield f"{name}{run.folder}/"
            counts = run.result.counts
            if counts.faults:
                kinds = ", ".join(f"{count} {kind}" for kind, count in counts.faults_by_kind.items())
                yield (
                    f"{run.result.label}: an agent failed in {counts.faults} of {counts.trials} trials: {kinds}; see "
                    f"'hthor runs view {shlex.quote(run.folder)}'"
                )
        yield from result_tables.result_notes(run.result for run in self.runs)


def _cell(column: int, text: str) -> str:
    """A cell of a table; the first column has words, the others numbers."""
    inner = "<br>".join(map(escape, text.splitlines()))
    return f'<td style="text-align: {"right" if column else "left"}">{inner}</td>'
