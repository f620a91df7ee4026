"""What of a machine and its libraries can change the last bits of a number."""

from __future__ import annotations

import platform

from hthor import installation


def this_platform() -> dict[str, str]:
    """The platform that this process computes on: where all of it is equal, records are equal byte for byte."""
    import llvmlite.binding
    import numpy

    found = numpy.show_config(mode="dicts")["SIMD Extensions"]
    return {
        "system": platform.system(),
        "machine": platform.machine(),
        "cpu": llvmlite.binding.get_host_cpu_name(),
        "simd": " ".join(sorted((*found["baseline"], *found.get("found", ())))),
        "libc": " ".join(platform.libc_ver()),
        **{name: version for name, version in installation.versions().items() if name != "hthor"},
    }


def platform_differences(there: dict[str, str], now: dict[str, str]) -> list[str]:
    """What is not the same, in words."""
    names = [name for name in sorted({*there, *now}) if there.get(name) != now.get(name)]
    return [f"{name} {now.get(name, 'unknown')} here, {there.get(name, 'unknown')} there" for name in names]
