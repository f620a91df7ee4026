"""The JSON document of one `hthor eval` command, the same for one run and for many."""

from msgspec import Struct

from hthor.eval.comparison.population_matrix import PopulationMatrix
from hthor.eval.results.result_file import RunResult

SCHEMA = "hthor.eval/1"


class EvaluatedRun(Struct, frozen=True, kw_only=True):
    """A whole run: its folder, and its result as `result.json` has it."""

    folder: str
    result: RunResult


class Evaluation(Struct, frozen=True, kw_only=True):
    """All runs of a command, by population and then by agent in the order of the command line.

    ``peoples`` compares the human populations if there were several, else it is null.
    """

    schema: str = SCHEMA
    runs: tuple[EvaluatedRun, ...]
    peoples: PopulationMatrix | None = None
