"""The errors of hthor: each says what was wrong, what was given, what is valid, and what to do next."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

_LISTED = 24
"""How many names an error message lists; the others are only counted."""


class HthorError(Exception):
    """Root of all errors that the user can fix: the CLI prints no traceback and exits with ``exit_code``."""

    exit_code = 2

    @classmethod
    def in_file(cls, file: str, field: str, problem: str) -> HthorError:
        """The error of this class about a field of a file."""
        return cls(f"{file}: {field}: {problem}")


class FileError(HthorError):
    """A file that cannot be used: names the file and the field.

    Args:
        file: the file's name as the user gave it.
        field: path of the field, such as ``walls[3].polygon[0].x``; ``$`` for the file as a whole.
        problem: what is wrong there, what was found, what is expected.
    """

    def __init__(self, file: str, field: str, problem: str) -> None:
        self.file, self.field, self.problem = file, field, problem
        super().__init__(f"{file}: {field}: {problem}")

    @classmethod
    def in_file(cls, file: str, field: str, problem: str) -> HthorError:
        """This error, about a field of a file."""
        return cls(file, field, problem)


class UnknownName(HthorError):
    """A name that does not exist.

    Args:
        what: the sort of thing that the name should be of, such as "suite".
        given: what the user wrote.
        valid: all names that exist.
        hint: what to do next, a sentence; optional.
    """

    def __init__(self, what: str, given: str, valid: Iterable[str], hint: str = "") -> None:
        self.what, self.given, self.valid, self.hint = what, given, tuple(valid), hint
        near = difflib.get_close_matches(str(given), self.valid, n=1, cutoff=0.5)
        guess = f" Did you mean '{near[0]}'?" if near else ""
        listed = ", ".join(self.valid[:_LISTED]) or "none"
        if len(self.valid) > _LISTED:
            listed += f" and {len(self.valid) - _LISTED} more"
        super().__init__(f"unknown {what} '{given}'.{guess} Valid: {listed}.{' ' + hint if hint else ''}")


class HouseError(FileError):
    """A house file that cannot be used."""


class TaskError(FileError):
    """A suite or task file that cannot be used."""


class PopulationError(FileError):
    """A file of a human population, or of a kind of people, that cannot be used."""


class AgentError(HthorError):
    """An agent file that cannot be loaded or does not follow the contract."""

    exit_code = 4


KILLED = "killed"
"""The fault of an agent whose process was killed from outside; the first time in a run, the session is run again."""


class AgentKilled(AgentError):
    """An agent's process was killed from outside before the agent could say what it is."""

    kind = KILLED


class RunError(HthorError):
    """A run's folder that cannot be used: it is damaged, or holds another run."""


class RunLocked(HthorError):
    """Another process is writing this run."""

    exit_code = 75


class MissingExtra(HthorError):
    """An optional dependency is absent; the message names the extra."""

    def __init__(self, feature: str, extra: str) -> None:
        super().__init__(f"{feature} needs an optional dependency: pip install 'hthor[{extra}]'.")


class RenderingUnavailable(HthorError):
    """No OpenGL back end can draw a frame in this process."""


class WorldClosed(HthorError):
    """A world was used after it was closed."""

    @classmethod
    def of(cls, house: str) -> WorldClosed:
        """The error for the world of a house."""
        return cls(
            f"this world of house '{house}' is closed. Make another one with World(...), or close this one only after "
            "its last use."
        )


class PhysicsError(HthorError):
    """The physics engine lost the state of a world; the message names the objects, and the world stays usable."""


class StaleObservation(RuntimeError):
    """An observation was read after its tick; read pictures, scans and detections inside ``act``."""
