"""Checks which isolation levels start on this machine, and says how to fix the others; confines nothing itself."""

import os
import platform
import shutil

from hthor.eval.doctor.check_result import CheckResult, read_system_file
from hthor.guest import Isolation, IsolationError, in_force
from hthor.guest.confinement import LEVELS, suffices

_LANDLOCK_SINCE = (5, 13)
_UNCONFINED = "docker run --security-opt seccomp=unconfined --security-opt apparmor=unconfined ..., or leave it"


def check_isolation(required: str) -> list[CheckResult]:
    """Start a guest on each level; all up to the required level must start."""
    return [_finding(level, suffices(required, level)) for level in LEVELS]


def _finding(level: str, needed: bool) -> CheckResult:
    name = f"isolation {level}"
    try:
        return CheckResult(name=name, says=_layers(in_force(level)))
    except IsolationError as error:
        reason = str(error).partition("this machine: ")[2].partition(". 'hthor eval")[0] or str(error)
        return CheckResult(name=name, status="fail" if needed else "warn", says=reason, fix=suggest_fix(level))


def _layers(held: Isolation) -> str:
    layers = [
        "a process of its own",
        f"memory {held.memory}",
        f"Landlock ABI {held.landlock_abi}" if held.landlock_abi else "",
        "seccomp" if held.seccomp else "",
        "no network" if held.netns else "",
        "no other processes" if held.pidns else "",
    ]
    return "; ".join(layer for layer in layers if layer)


def suggest_fix(level: str) -> str:
    """How to fix a level that does not start, judged by the properties of this machine."""
    if platform.system() != "Linux":
        return "run hthor on Linux: a virtual machine will do"
    if level == "L3" and not shutil.which("bwrap"):
        return "sudo apt-get install bubblewrap"
    if level == "L3" and (switch := _namespaces()):
        return f"sudo sysctl -w {switch}"
    if level != "L1" and platform.machine() != "x86_64":
        return "run hthor on an x86_64 machine"
    if level != "L1" and _kernel() < _LANDLOCK_SINCE:
        return f"a kernel of {'.'.join(map(str, _LANDLOCK_SINCE))} or later; this is {platform.release()}"
    lsm = read_system_file("/sys/kernel/security/lsm")
    if level != "L1" and lsm and "landlock" not in lsm.split(","):
        return f"boot with lsm=landlock,{lsm}"
    if _in_container():
        return _UNCONFINED
    return "see docs/isolation.md for what it takes"


def _namespaces() -> str:
    """The kernel setting that forbids users to make namespaces, with its correct value; empty if none forbids it."""
    for name, wrong, right in (
        ("kernel.apparmor_restrict_unprivileged_userns", "1", "0"),
        ("kernel.unprivileged_userns_clone", "0", "1"),
        ("user.max_user_namespaces", "0", "15000"),
    ):
        if read_system_file("/proc/sys/" + name.replace(".", "/")) == wrong:
            return f"{name}={right}"
    return ""


def _kernel() -> tuple[int, ...]:
    numbers = platform.release().split("-")[0].split(".")[:2]
    return tuple(int(number) for number in numbers if number.isdecimal())


def _in_container() -> bool:
    return any(os.path.exists(mark) for mark in ("/.dockerenv", "/run/.containerenv"))
