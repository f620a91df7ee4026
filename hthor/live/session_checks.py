"""Checks for `hthor doctor` of what a session with people needs: the page, the network, a headset by cable."""

from __future__ import annotations

import shutil
from pathlib import Path

from hthor.eval.doctor.check_result import CheckResult, read_system_file
from hthor.live import local_network
from hthor.live.server import FOLDER, PAGE

USB = Path("/sys/bus/usb/devices")
"""Linux: the devices at USB, a folder for each."""
_META = "2833"
"""The number of the maker of Quests among the makers of USB devices."""


def check_session() -> list[CheckResult]:
    """All of them; none fails, as evaluations do not need them."""
    return [check_page(FOLDER), check_network(local_network.addresses()), check_headset(USB, shutil.which("adb"))]


def check_page(folder: Path) -> CheckResult:
    """Whether a folder has the page that people open."""
    if (folder / PAGE).is_file():
        return CheckResult(name="page", says="built: people can take part with 'hthor live'")
    says = "not built, so nobody can take part with 'hthor live'"
    return CheckResult(name="page", status="warn", says=says, fix="make page")


def check_network(addresses: tuple[str, ...]) -> CheckResult:
    """Whether other machines, such as headsets, can reach this one at one of its addresses."""
    name = "local network"
    if addresses:
        says = f"with 'hthor live --lan', other machines reach this one at {', '.join(addresses)}"
        return CheckResult(name=name, says=says)
    says = "this machine has no address there: only a browser on it, or a headset by cable, can open the page"
    fix = "join a network, which need not lead to the internet"
    return CheckResult(name=name, status="warn", says=says, fix=fix)


def check_headset(usb: Path, adb: str | None) -> CheckResult:
    """Whether a headset is at USB, and can open the page over the cable.

    Args:
        usb: the folder of the devices. adb: the program, Android Debug Bridge, that leads the page's port to a headset.
    """
    name = "headset"
    found = [
        read_system_file(str(maker.parent / "product")) or "a headset"
        for maker in sorted(usb.glob("*/idVendor"))
        if read_system_file(str(maker)) == _META
    ]
    if not found:
        way = "adb is installed" if adb else "that needs adb, of Android's platform tools"
        return CheckResult(name=name, says=f"none at USB ({way}); over the network it needs no cable")
    says = f"{', '.join(found)} at USB"
    if adb is None:
        fix = "apt-get install adb, or Android's platform tools, and then: adb reverse tcp:8765 tcp:8765"
        return CheckResult(name=name, status="warn", says=f"{says}, but adb is not installed", fix=fix)
    return CheckResult(name=name, says=f"{says}; 'adb reverse tcp:8765 tcp:8765' lets it open the page")
