"""The result of one check, and of all checks."""

from pathlib import Path
from typing import Literal

from msgspec import Struct

SCHEMA = "hthor.doctor/1"


class CheckResult(Struct, frozen=True, kw_only=True):
    """One check: ``fail`` if evaluations do not work or cannot be trusted, ``warn`` if something is unusual.

    ``fix`` says what to do about it, if possible as a command; it is empty where all is well.
    """

    name: str
    status: Literal["ok", "warn", "fail"] = "ok"
    says: str
    fix: str = ""


class DoctorReport(Struct, frozen=True, kw_only=True):
    """All checks; ``well`` if none failed."""

    schema: str = SCHEMA
    well: bool
    findings: tuple[CheckResult, ...]


def read_system_file(path: str) -> str:
    """The text of a file of the kernel; empty if there is no such file."""
    try:
        return Path(path).read_text(encoding="utf-8").strip()
    except OSError:
        return ""
