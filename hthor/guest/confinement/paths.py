"""Lists the files of the machine that a guest may read.

Landlock and bubblewrap only have rules that allow access. So a folder that contains something hidden is not listed
itself; its other members are listed one by one.
"""

import os
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path

from hthor import jsonio
from hthor.guest.confinement import hidden_paths

PACKAGE = Path(__file__).resolve().parents[2]
_OURS = ("types", "geometry", "guest", "agents", "navigation", "comms", "catalog", "houses/space", "houses/checks")
"""Parts of this package that agents may use; tasks, humans, worlds, evaluation and the houses are hidden."""
_LIBRARIES = ("site-packages", "dist-packages")
_SYSTEM = ("/usr", "/bin", "/lib", "/lib64", "/lib32", "/etc/ld.so.cache", "/etc/localtime", "/etc/ssl")
_FACTS = ("/sys/devices/system/cpu", "/proc/cpuinfo", "/proc/meminfo")
DEVICES = ("/dev/null", "/dev/zero", "/dev/full", "/dev/random", "/dev/urandom")
GPU_VARIABLES = ("CUDA_VISIBLE_DEVICES", "CUDA_DEVICE_ORDER", "NVIDIA_VISIBLE_DEVICES", "NVIDIA_DRIVER_CAPABILITIES")
"""Environment variables that choose among the machine's GPUs."""
GPU_FACTS = ("/proc/driver/nvidia", "/sys/bus/pci", "/sys/devices", "/sys/module/nvidia")
"""Files about the machine that GPU drivers read."""


def gpu_devices(root: str = "/dev") -> tuple[str, ...]:
    """Device files of the machine's GPUs."""
    return tuple(sorted(str(path) for path in Path(root).glob("nvidia*")))


def library_folders() -> list[str]:
    """Folders of installed libraries."""
    return [path for path in sys.path if Path(path).name in _LIBRARIES and Path(path).is_dir()]


def readable_paths(agent: str, root: str, hidden: Sequence[str], beyond: Sequence[str] = ()) -> tuple[str, ...]:
    """Files and folders that a guest may read, folders with everything in them.

    Args:
        agent: the agent's file. root: its own folder, empty for none.
        hidden: files and folders that it may not read, wherever they are.
        beyond: files and folders elsewhere that the user lets it read.
    """
    secret = [PACKAGE, *(Path(path).resolve() for path in hidden)]
    found = [str(path) for path in _ours()]
    roots = [sys.prefix, sys.base_prefix, sys.exec_prefix, os.path.realpath(sys.executable), *library_folders()]
    for place in (*_SYSTEM, *_FACTS, *roots):
        found += _open(Path(place), secret)
    if root:
        folder = Path(root)
        found += _open(folder, [*secret, *hidden_paths.hidden_below(folder.resolve(), agent)])
    for place in beyond:
        found += _open(Path(place), [*secret, *hidden_paths.hidden_below(Path(place).resolve())])
    found.append(agent)
    return _tops(found)


def listed_folders(root: str) -> tuple[str, ...]:
    """Folders whose names a guest may read, since Python searches for modules there."""
    return (str(PACKAGE), *library_folders(), *([root] if root else []))


def _ours() -> Iterable[Path]:
    yield from (path for path in sorted(PACKAGE.glob("*.py")))
    yield from (PACKAGE / name for name in _OURS)
    yield from (path for path in sorted((PACKAGE / "houses").glob("*.py")))  # maps need this code, not the houses


def _open(root: Path, secret: Sequence[Path]) -> list[str]:
    """The folder, or its members that contain no ``secret`` path."""
    real = root.resolve()
    if any(real.is_relative_to(hidden) for hidden in secret):
        return []
    if not jsonio.is_text(str(root)):  # the list is sent as a message, which cannot contain it
        return []
    below = [hidden for hidden in secret if hidden.is_relative_to(real)]
    if not below or not real.is_dir():
        return [str(root)] if root.exists() else []
    try:
        members = [path for path in sorted(root.iterdir()) if path.resolve().is_relative_to(real)]  # no link leads out
    except OSError:
        return []
    return [path for member in members for path in _open(member, below)]


def _tops(found: Iterable[str]) -> tuple[str, ...]:
    """Each path once, without those inside another one."""
    tops: list[str] = []
    for path in sorted(set(found)):
        if not tops or not Path(path).is_relative_to(tops[-1]):
            tops.append(path)
    return tuple(tops)
