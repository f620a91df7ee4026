"""Houses from a seed, after ProcTHOR's published stages.

Rooms are grown on a grid, joined by doors and furnished in groups; things are hung on walls and put on surfaces, and
the house is checked by named rules. The same arguments give the same bytes. Begin with `attempt.build_document`.
"""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from hthor import jsonio, seeds
from hthor.errors import HthorError
from hthor.houses.generator.attempt import AttemptFailed, build_document
from hthor.houses.generator.draws import Dice
from hthor.houses.generator.floorplan.room_specs import SPECS, choose_spec
from hthor.houses.generator.furnishing.requirements import OPTIONAL, draw_requirements

CODE_ROOT = "makers"

CODE_PART = "tools"

__all__ = ["OPTIONAL", "SPECS", "VERSION", "GeneratorError", "generate", "write"]

VERSION = 1
"""Increased when the same seed gives a different house."""
TRIES = 20


class GeneratorError(HthorError):
    """No attempt gave a valid house. ``reasons`` are the broken rule and problem of each attempt."""

    def __init__(self, seed: int, rooms: int, reasons: tuple[tuple[str, str], ...]) -> None:
        self.reasons = reasons
        listed = "; ".join(f"attempt {number}: {problem} ({rule})" for number, (rule, problem) in enumerate(reasons))
        super().__init__(
            f"seed {seed} gave no valid house of {rooms} rooms in {len(reasons)} attempts: {listed}. "
            "Choose another seed, or allow more tries."
        )


def generate(
    seed: int,
    rooms: int,
    spec: str | None = None,
    tries: int = TRIES,
    needs: Iterable[str] | None = None,
    first: int = 0,
) -> dict[str, Any]:
    """A house file's document, ProcTHOR's JSON schema 1.0.0 with hthor's own assets.

    Every house has the benchmark's eight receptacles, a sink and a chair, and none of its targets.

    Args:
        seed: a whole number from 0.
        rooms: 4 to 7.
        spec: the name of one of `SPECS`; None draws a spec with this number of rooms.
        tries: how many attempts are made, each with its own draws; the metadata name the successful attempt.
        needs: the `OPTIONAL` kinds that the house has; it has no other optional kinds. None draws them.
        first: the number of the first attempt, to go on after an attempt that the caller rejected.

    Raises:
        HthorError: for a negative seed, or for a number of rooms, a spec or a need that does not exist.
        GeneratorError: when all attempts failed; names the rule that each attempt broke.
    """
    seed, reasons = seeds.check_seed(seed), []
    given = None if needs is None or isinstance(needs, str) else frozenset(needs)
    for attempt in range(first, first + tries):
        dice = Dice(seed).of("house", VERSION, rooms, attempt)
        chosen = choose_spec(rooms, dice, spec)
        record = {"version": VERSION, "seed": seed, "rooms": rooms, "attempt": attempt}
        try:
            return build_document(
                chosen, draw_requirements(needs if isinstance(needs, str) else given, dice.of("wants")), dice, record
            )
        except AttemptFailed as flaw:
            reasons.append((flaw.rule, flaw.problem))
    raise GeneratorError(seed, rooms, tuple(reasons))


def write(document: dict[str, Any], path: Path) -> None:
    """Write a document as a file of canonical bytes: sorted keys, two spaces, a newline at the end."""
    jsonio.write(path, jsonio.pretty(document))
