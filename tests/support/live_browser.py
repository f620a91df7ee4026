"""The browser at a page of a live session: Chromium without a screen, which draws on the processor."""

from __future__ import annotations

import shutil
from typing import Any

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
_GRAPHICS = ("--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist")


def launch(playwright: Any, *arguments: str) -> Any:
    """Start it."""
    return playwright.chromium.launch(executable_path=CHROMIUM, args=[*_GRAPHICS, *arguments])
