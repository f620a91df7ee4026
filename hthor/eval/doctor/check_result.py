"""What was found of one thing, and all of it together; looks at nothing itself."""

from __future__ import annotations

from typing import Literal

from msgspec import Struct

SCHEMA = "hthor.doctor/1"


class CheckResult(Struct, frozen=True, kw_only=True):
    """One thing: ``fail`` where evaluations do not work or cannot be trusted, ``warn`` where something is amiss.

    ``fix`` is what to do about it, a command wherever there is one; empty where all is well.
    """

    name: str
    status: Literal["ok", "warn", "fail"] = "ok"
    says: str
    fix: str = ""


class DoctorReport(Struct, frozen=True, kw_only=True):
    """All that was found; ``well`` when nothing failed."""

    schema: str = SCHEMA
    well: bool
    findings: tuple[CheckResult, ...]
