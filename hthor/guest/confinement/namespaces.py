"""Runs a guest in namespaces of its own, by bubblewrap.

There it sees only its own processes, no network, not even the machine's loopback, and only the files that it may read.
Its files are in memory of a fixed size and end with it.
"""

import shutil
from collections.abc import Sequence

from hthor.guest.confinement.isolation import Policy

_HELP = "Install it: apt-get install bubblewrap"
_APART = ("--unshare-user", "--unshare-ipc", "--unshare-pid", "--unshare-net", "--unshare-uts", "--unshare-cgroup-try")
_NOBODY = ("--uid", "65534", "--gid", "65534")
_OWN = ("/proc/", "/dev/")


def unavailable() -> str:
    """Why bubblewrap is not available; empty if it is available."""
    return "" if shutil.which("bwrap") else f"bubblewrap is not installed. {_HELP}"


def bwrap_command(policy: Policy, inner: Sequence[str]) -> list[str]:
    """The bubblewrap command that runs ``inner``."""
    words = [shutil.which("bwrap") or "bwrap", *_APART, *_NOBODY, "--hostname", "guest"]
    words += ["--die-with-parent", "--cap-drop", "ALL", "--proc", "/proc", "--dev", "/dev"]
    words += ["--size", str(policy.disk_mb << 20), "--tmpfs", policy.scratch]
    for path in policy.read:  # after the scratch folder: later mounts cover earlier ones
        if not path.startswith(_OWN):
            words += ["--ro-bind-try", path, path]
    if policy.compiled:
        words += ["--bind-try", policy.compiled, policy.compiled]
    for path in policy.devices:
        words += ["--dev-bind-try", path, path]
    return [*words, "--remount-ro", "/", "--chdir", "/", "--", *inner]


def failure_reason(said: str) -> str:
    """Why bubblewrap did not start, from its output, and what to do about it."""
    lines = [line for line in said.splitlines() if line.strip()]
    reason = lines[-1] if lines else "bubblewrap ended without a word"
    if "uid map" in reason or "namespace" in reason:
        reason += (
            ". This machine does not let users make namespaces: on Ubuntu, sysctl -w "
            "kernel.apparmor_restrict_unprivileged_userns=0; in Docker, another seccomp profile"
        )
    return reason
