"""What is wrong with a house, in words: one record a finding."""

from collections.abc import Iterable
from typing import Literal

from msgspec import Struct

CODE_PART = "tools"


class Finding(Struct, frozen=True, kw_only=True):
    """Something wrong with a house: which ``rule``, ``where`` (an id), what the ``problem`` is, in words."""

    severity: Literal["error", "warning"]
    rule: str
    where: str
    problem: str

    def __str__(self) -> str:
        return f"{self.severity}: {self.where}: {self.problem} ({self.rule})"


def error(rule: str, where: str, problem: str) -> Finding:
    """A finding that makes a house unsound."""
    return Finding(severity="error", rule=rule, where=where, problem=problem)


def warning(rule: str, where: str, problem: str) -> Finding:
    """A finding that a house may have and still be lived in."""
    return Finding(severity="warning", rule=rule, where=where, problem=problem)


def is_sound(findings: Iterable[Finding]) -> bool:
    """Whether no finding is an error."""
    return not any(finding.severity == "error" for finding in findings)


def readable_kind(kind: str) -> str:
    """A kind's name as people write it."""
    return kind.replace("_", " ")
