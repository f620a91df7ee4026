"""What code does, as a hash over the syntax of modules and of all that they import.

Comments, docstrings, annotations of functions, white space, and the names and places of modules do not count; every
other change does. A package or a module that has no part in the course of a trial says so in a line of its own,
``CODE_PART = "pictures"`` (what robots' cameras show) or ``CODE_PART = "tools"`` (all else: processes, proofs, makers
of files); what is below a package belongs to the same part. Where trials begin, a module says ``CODE_ROOT = "trial"``,
where houses and tasks are made, ``CODE_ROOT = "makers"``. Who asks for a hash says which parts count.
"""

from __future__ import annotations

from hthor.code_identity.compiled import compiled, keep_compiled
from hthor.code_identity.hashes import (
    agent_sha256,
    code_sha256,
    makers_sha256,
    modules_sha256,
    pictures_sha256,
    robot_sha256,
    roots,
)
from hthor.code_identity.sources import PACKAGE, Sources, ours
from hthor.code_identity.syntax import PICTURES, SIMULATION, TOOLS, is_python

__all__ = [
    "PACKAGE",
    "PICTURES",
    "SIMULATION",
    "TOOLS",
    "Sources",
    "agent_sha256",
    "code_sha256",
    "compiled",
    "is_python",
    "keep_compiled",
    "makers_sha256",
    "modules_sha256",
    "ours",
    "pictures_sha256",
    "robot_sha256",
    "roots",
]
