"""Uniting the corrections of a run's shards: each shard corrects its own trials, so they only have to be renumbered."""

from collections.abc import Iterable, Sequence
from pathlib import Path

import msgspec

from hthor import log_corrections
from hthor.errors import RunError
from hthor.log_corrections import AnyCorrection, Corrections, Withdraw

_Source = tuple[Path, Corrections]


def new_lines(whole: Corrections, folder: Path, shards: Iterable[_Source]) -> tuple[AnyCorrection, ...]:
    """The corrections of shards that the whole run in ``folder`` lacks, numbered to follow its own.

    A trial's corrections may be in several folders, if one continues the other.

    Raises:
        RunError: when two folders correct the same trial in different ways.
    """
    lines = list(whole.lines)
    origin = {line.trial: folder for line in lines}
    for path, known in shards:
        for trial in dict.fromkeys(line.trial for line in known.lines):
            there = [line for line in known.lines if line.trial == trial]
            here = [line for line in lines if line.trial == trial]
            shared = min(len(here), len(there))
            if _plain(here)[:shared] != _plain(there)[:shared]:
                raise RunError(
                    f"the corrections of trial {trial} are not the same in {origin[trial] / log_corrections.NAME} and "
                    f"in {path / log_corrections.NAME}. Decide which are right, and leave the other folder out."
                )
            for line in there[shared:]:
                lines.append(_renumbered(line, there, [one for one in lines if one.trial == trial], len(lines) + 1))
                origin[trial] = path
    return tuple(lines[len(whole.lines) :])


def _plain(lines: Sequence[AnyCorrection]) -> list[AnyCorrection]:
    """The corrections of one trial, numbered among themselves."""
    return [_renumbered(line, lines, (), place) for place, line in enumerate(lines, 1)]


def _renumbered(
    line: AnyCorrection, before: Sequence[AnyCorrection], after: Sequence[AnyCorrection], number: int
) -> AnyCorrection:
    """A correction under another number; what it withdraws is found by its place among those of the same trial."""
    if not isinstance(line, Withdraw):
        return msgspec.structs.replace(line, number=number)
    place = [one.number for one in before].index(line.withdraws)
    return msgspec.structs.replace(line, number=number, withdraws=after[place].number if after else place + 1)
