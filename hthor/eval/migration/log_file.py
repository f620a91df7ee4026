"""Converts the lines of a log file."""

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from hthor.documents import Unreadable
from hthor.errors import RunError
from hthor.eval.migration import conversion, old_format
from hthor.eval.records import trial_record


class ConvertedLine(NamedTuple):
    """A line of log 1.0, the trial's ``key``, and the key that it had in the old log; empty if the line is not old."""

    line: bytes
    key: str
    old_key: str


def converted_lines(path: Path) -> Iterator[ConvertedLine]:
    """Every whole line of a log, converted if it is old; a torn last line, which has no newline, is left out.

    Raises:
        RunError: for a line that cannot be converted; names the file, the line and the field.
    """
    with path.open("rb") as file:
        for number, line in enumerate(file, 1):
            if not line.endswith(b"\n"):
                return
            try:
                yield _convert(line)
            except trial_record.OtherVersion as other:
                raise RunError(f"{path}, line {number}: {other}. Use the version of hthor that wrote it.") from None
            except Unreadable as error:
                raise RunError(
                    f"{path}, line {number}: {error}. 'hthor migrate' converts logs of hthor 0.1 that were not changed "
                    "after they were written."
                ) from None


def _convert(line: bytes) -> ConvertedLine:
    try:
        return ConvertedLine(line, trial_record.decode(line).key, "")
    except trial_record.OtherVersion as other:
        if other.schema:
            raise
    old = old_format.decode(line)
    record = conversion.convert_record(old)
    return ConvertedLine(trial_record.encode(record), record.key, old.key)
