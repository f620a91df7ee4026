"""Hashes of what code does: of the syntax of modules and of all that they import.

Comments, docstrings, annotations of functions, white space, and the names and places of modules do not count; every
other change does. A module or package that cannot affect a trial says so in a line of its own:
``CODE_PART = "pictures"`` (camera images) or ``CODE_PART = "tools"`` (all else: processes, proofs, file formats);
a package's line holds for all in it. Modules in which trials begin say ``CODE_ROOT = "trial"``, modules that judge
them ``CODE_ROOT = "scoring"``, modules that make houses and tasks ``CODE_ROOT = "makers"``. Each hash says which parts
it covers.
"""

from hthor.code_identity.hashes import (
    agent_sha256,
    code_sha256,
    compiled,
    is_compiled,
    keep_compiled,
    makers_sha256,
    modules_sha256,
    pictures_sha256,
    robot_sha256,
    roots,
    scoring_sha256,
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
    "is_compiled",
    "is_python",
    "keep_compiled",
    "makers_sha256",
    "modules_sha256",
    "ours",
    "pictures_sha256",
    "robot_sha256",
    "roots",
    "scoring_sha256",
]
