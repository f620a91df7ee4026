"""The page that shows a trial: one HTML file with everything in it, which asks nobody for anything."""

from __future__ import annotations

import base64
import gzip
import hashlib
import html
import re
from pathlib import Path
from typing import TYPE_CHECKING

from hthor import jsonio
from hthor.live import server
from hthor.watch import recording

if TYPE_CHECKING:
    from hthor.watch.record_trial import RecordedTrial

TEMPLATE, SCRIPT, STYLE = "watch.html", "watch.js", "watch.css"
"""Names of the built page's parts."""
_LINKED_STYLE, _LINKED_SCRIPT = '<link rel="stylesheet" href="watch.css" />', '<script src="watch.js"></script>'
_HEAD, _TITLE, _DATA = '<meta charset="utf-8" />', "<title>hthor watch</title>", "<!-- data -->"


def make_page(trial: RecordedTrial) -> bytes:
    """The page; the same trial gives the same bytes.

    Raises:
        HthorError: if the page is not built.
    """
    server.check_built()
    template, script, style = ((server.FOLDER / name).read_text(encoding="utf-8") for name in (TEMPLATE, SCRIPT, STYLE))
    script = re.sub(r"</(script)", r"<\\/\1", script, flags=re.IGNORECASE)
    made = trial.recording
    data = {
        "recording": gzip.compress(recording.encode(made), 9, mtime=0),
        "house": trial.house.data,
    }
    blocks = "".join(
        f'<script type="text/plain" id="{name}">{base64.b64encode(one).decode()}</script>\n'
        for name, one in data.items()
    )
    parts = {
        _HEAD: f'{_HEAD}\n    <meta http-equiv="Content-Security-Policy" content="{policy(script, style)}" />',
        _TITLE: f"<title>{html.escape(made.instruction)} {html.escape(made.task)}</title>",
        _LINKED_STYLE: f"<style>{style}</style>",
        _DATA: blocks,
        _LINKED_SCRIPT: f"<script>{script}</script>",
    }
    for place, part in parts.items():
        before, found, after = template.partition(place)
        assert found, f"{TEMPLATE} lacks {place}"
        template = before + part + after
    return template.encode()


def write_page(folder: Path, page: bytes) -> Path:
    """Write the page into a folder, and return its file."""
    path = folder / "index.html"
    jsonio.write(path, page)
    return path


def policy(script: str, style: str) -> str:
    """What a browser lets the page do: run this script, and read from itself."""
    return (
        f"default-src 'none'; script-src '{_hash(script)}'; style-src '{_hash(style)}'; img-src data: blob:; "
        "connect-src blob:; base-uri 'none'; form-action 'none'"
    )


def _hash(text: str) -> str:
    return f"sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}"
