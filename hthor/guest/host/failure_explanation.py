"""Explains an agent's failure where isolation caused it."""

import os
import re
from collections.abc import Iterator
from pathlib import Path

from hthor.guest.confinement import Policy
from hthor.guest.host.channel import GuestFault

_QUOTED = re.compile(r"'([^'\n]+)'|\"([^\"\n]+)\"|(?<![\w'\"])(/[^\s'\":,;()]+)")
_VARIABLE = re.compile(r"KeyError: '([A-Za-z_]\w*)'")
_ENVIRONMENT = ("os.environ", "<frozen os>", "/os.py")


def explain_fault(fault: GuestFault, policy: Policy, root: str) -> GuestFault:
    """The fault, with one more sentence where isolation is the reason."""
    more = isolation_reason(fault.detail, policy, root) if fault.kind == "raised" else ""
    if not more:
        return fault
    return GuestFault(fault.kind, f"{fault.detail.rstrip()}\n{more}", "", fault.log)


def isolation_reason(text: str, policy: Policy, root: str) -> str:
    """One sentence on how isolation caused a failure; empty where it did not.

    Args:
        text: the error message, with its traceback if there is one. root: the agent's folder.
    """
    said = _said(text)
    variable = _VARIABLE.match(said)
    if variable and any(word in text for word in _ENVIRONMENT):
        return (
            f"No environment variable of yours reaches an agent, {variable[1]} neither; give it what it needs with "
            "--agent-args. See docs/isolation.md."
        )
    if policy.level == "L1":
        return ""
    hidden = next((path for path in _paths(said, root) if path.exists() and not _shown(path, policy)), None)
    if hidden is None:
        return ""
    if root and hidden.is_relative_to(root):
        return f"'{hidden.name}' is there, but isolation {policy.level} hides runs and .git from every agent."
    what = "folder" if hidden.is_dir() else "file"
    return (
        f"The {what} '{hidden.name}' is there, but isolation {policy.level} hides it, as it lies outside the agent's "
        "own folder. Let the agent read it with --readable PATH. See docs/isolation.md."
    )


def _said(text: str) -> str:
    """The exception's own message, which follows its traceback."""
    lines = text.strip().splitlines()
    frames = [number for number, line in enumerate(lines) if line.startswith(" ")]
    return "\n".join(lines[frames[-1] + 1 if frames else 0 :])


def _paths(said: str, root: str) -> Iterator[Path]:
    for found in _QUOTED.finditer(said):
        text = next(group for group in found.groups() if group)
        if os.path.isabs(text) or (root and os.sep in text):
            yield Path(os.path.normpath(os.path.join(root or "/", text)))


def _shown(path: Path, policy: Policy) -> bool:
    """Whether the agent may read it."""
    real = path.resolve()
    return any(one.is_relative_to(place) for one in (path, real) for place in (*policy.read, policy.scratch))
