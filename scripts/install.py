"""Installs hthor and extras of it into the Python that runs this, and says how far it is: `install.py [EXTRA...]`.

pip is silent while it resolves and unpacks, which takes most of the time. This counts the packages that it has
collected and then those that lie in the environment. At a terminal it keeps one line up to date; elsewhere it writes a
line every few seconds. If pip fails, its output is printed.
"""

from __future__ import annotations

import subprocess
import sys
import sysconfig
import threading
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = Path(sysconfig.get_paths()["purelib"])
_REDRAW_S, _LINE_S = 0.2, 5.0
"""Time between two updates, at a terminal and elsewhere."""


class Progress:
    """The output of pip so far, and the sentence about it."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.collected: set[str] = set()
        self.total = 0
        self._before = _installed()
        self._start = time.monotonic()

    def read(self, line: str) -> None:
        """Take a line of pip."""
        self.lines.append(line)
        first, _, rest = line.strip().partition(" ")
        if first in ("Collecting", "Obtaining"):
            self.collected.add(rest)
        elif line.startswith("Installing collected packages:"):
            self.total = line.count(",") + 1

    def __str__(self) -> str:
        seconds = time.monotonic() - self._start
        if self.total:
            count = min(len(_installed() - self._before), self.total)
            return f"Installing packages into .venv: {count} of {self.total} ({seconds:.0f} s)"
        return f"Collecting packages: {len(self.collected)} ({seconds:.0f} s)"


def _installed() -> set[str]:
    return {path.name for path in PACKAGES.glob("*.dist-info")}


def show(progress: Progress, done: threading.Event) -> None:
    """Keep the sentence about the progress up to date until ``done``."""
    terminal = sys.stderr.isatty()
    while not done.wait(_REDRAW_S if terminal else _LINE_S):
        sys.stderr.write(f"\r\033[K{progress}" if terminal else f"{progress}\n")
        sys.stderr.flush()
    if terminal:
        sys.stderr.write("\r\033[K")


def main(extras: list[str]) -> int:
    """Install; the exit code of pip."""
    target = f".[{','.join(extras)}]" if extras else "."
    command = [sys.executable, "-m", "pip", "install", "--disable-pip-version-check", "--progress-bar", "off"]
    command += ["-c", "constraints.txt", "-e", target]
    sys.stderr.write(f"Installing hthor{target[1:]} and its libraries into .venv; this takes about a minute.\n")
    progress, done = Progress(), threading.Event()
    with subprocess.Popen(command, cwd=ROOT, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT) as pip:
        display = threading.Thread(target=show, args=(progress, done), daemon=True)
        display.start()
        assert pip.stdout
        for line in pip.stdout:
            progress.read(line)
        code = pip.wait()
        done.set()
        display.join()
    if code:
        sys.stderr.writelines(progress.lines)
        sys.stderr.write("The installation failed; pip says above why.\n")
    else:
        sys.stderr.write(f"Done: {progress.total} packages.\n" if progress.total else "Done: everything was there.\n")
    return code


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
