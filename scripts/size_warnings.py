"""Warns of files of the package over 400 lines and folders over 28 files; it forbids nothing.

A long file often holds two ideas, and a full folder two concerns. Where it does not, leave it: an idea that is cut to
fit a number is harder to read than a long file.
"""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

MOST_LINES, MOST_FILES = 400, 28


def warnings(package: Path) -> Iterator[str]:
    """A line for each file and folder below ``package`` that is large, in the order of their paths."""
    files = sorted(package.rglob("*.py"))
    for folder, count in sorted(Counter(path.parent for path in files).items()):
        if count > MOST_FILES:
            yield f"{folder}: {count} files, more than {MOST_FILES}: does it hold one concern?"
    for path in files:
        count = len(path.read_text(encoding="utf-8").splitlines())
        if count > MOST_LINES:
            yield f"{path}: {count} lines, more than {MOST_LINES}: does it hold one idea?"


if __name__ == "__main__":
    sys.stdout.writelines(f"warning: {line}\n" for line in warnings(Path("hthor")))
