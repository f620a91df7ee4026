"""A fault's words without what is another each time: paths of this machine, addresses.

The words are part of the trial's record, which must be the same bytes wherever the agent's file lies.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path

_SCRATCH = re.compile(r"[^\s'\"]*/hthor-guest(?:-\w+)?(?=[/\s'\":,)]|$)")
_ADDRESS = re.compile(r"\b0x[0-9a-f]{6,16}\b")


def redact(text: str, files: Iterable[str]) -> str:
    """The text with names relative to the folders of these files or classes in files, and no addresses."""
    scripts = [file for file in files if file.endswith(".py") or ".py:" in file]
    folders = {str(Path(file.rpartition(":")[0] if ".py:" in file else file).resolve().parent) for file in scripts}
    for folder in sorted(folders, key=len, reverse=True):
        if folder != "/":
            text = text.replace(f"{folder}/", "")
    return _ADDRESS.sub("0x...", _SCRATCH.sub("$TMPDIR", text))
