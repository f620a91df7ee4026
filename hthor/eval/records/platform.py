"""The platforms that ran a run's trials, kept in `platform.json`.

Several commands on several machines may work on one run, so the file is a list. It is not part of the run's
configuration: equal platforms give equal bytes, different platforms may not.
"""

import platform
from collections.abc import Iterable
from pathlib import Path

from hthor import documents, installation, jsonio
from hthor.errors import RunError

NAME = "platform.json"
Platform = dict[str, str]
"""Properties of a machine and its libraries that can change the last bits of numbers, by name; see `this_platform`."""


def this_platform() -> Platform:
    """The platform of this process. Where all properties are equal, records are equal byte for byte."""
    import llvmlite.binding
    import numpy

    extensions = numpy.show_config(mode="dicts")["SIMD Extensions"]
    return {
        "system": platform.system(),
        "machine": platform.machine(),
        "cpu": llvmlite.binding.get_host_cpu_name(),
        "simd": " ".join(sorted((*extensions["baseline"], *extensions.get("found", ())))),
        "libc": " ".join(platform.libc_ver()),
        **{name: version for name, version in installation.versions().items() if name != "hthor"},
    }


def platform_differences(there: Platform, here: Platform) -> list[str]:
    """The differences between two platforms, in words."""
    names = [name for name in sorted({*there, *here}) if there.get(name) != here.get(name)]
    return [f"{name} {here.get(name, 'unknown')} here, {there.get(name, 'unknown')} there" for name in names]


def join(out: Path, folders: Iterable[Path], more: Iterable[Platform] = ()) -> None:
    """Keep the platforms of several folders, and ``more``, with the run in ``out``."""
    before = load(out)
    platforms = (*before, *(one for folder in folders for one in load(folder)), *more)
    by_hash = {jsonio.sha256(one): one for one in platforms}
    after = tuple(by_hash[digest] for digest in sorted(by_hash))
    if after != before:
        jsonio.write(out / NAME, jsonio.pretty(after))


def load(folder: Path) -> tuple[Platform, ...]:
    """The platforms of the run in a folder; empty if no platform was noted. Raises RunError for a damaged file."""
    hint = "delete the file; the run is then of unknown platforms"
    return documents.read_or_none(folder / NAME, tuple[Platform, ...], RunError, hint=hint) or ()
