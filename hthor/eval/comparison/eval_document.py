"""The document of one `hthor eval` command, of the same shape however many agents and peoples it had."""

from __future__ import annotations

from msgspec import Struct

from hthor.eval.comparison.population_matrix import PopulationMatrix
from hthor.eval.results.result_file import RunResult

SCHEMA = "hthor.eval/1"


class EvaluatedRun(Struct, frozen=True, kw_only=True):
    """A whole run: its folder, and its result as `result.json` has it."""

    folder: str
    result: RunResult


class Evaluation(Struct, frozen=True, kw_only=True):
    """All runs of a command, peoples in turn and in these the agents in the order in which they were named.

    ``peoples`` compares them where there were several peoples, else it is null.
    """

    schema: str = SCHEMA
    runs: tuple[EvaluatedRun, ...]
    peoples: PopulationMatrix | None = None
