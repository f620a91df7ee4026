"""Checks of the machine: space and speed of the runs' folder, memory, cores, environment; they change nothing."""

import os
import shutil
import tempfile
import time
from collections.abc import Iterator
from importlib import util
from pathlib import Path

from hthor.eval.doctor.check_result import CheckResult, read_system_file
from hthor.eval.runner import worker

_MB = 1e6
_ROOM_MB, _ROOM_LEAST_MB = 1000.0, 100.0
"""Free space [MB] below which to warn, and to fail. A run of 2000 trials takes 35 MB, with its control twice that."""
_SYNC_MS = 50.0
"""A disk that takes longer than this [ms] slows runs down: records wait at most 250 ms for the disk."""
_SYNCS = 8
_WORKER_MB = 700.0
"""Memory [MB] of a worker that has built all ten houses, with a margin."""
_RAY_SHM_MB = 1000.0
_OTHERWISE = (
    *("NPY_DISABLE_CPU_FEATURES", "NPY_ENABLE_CPU_FEATURES", "OPENBLAS_CORETYPE"),
    *("NUMBA_CPU_NAME", "NUMBA_CPU_FEATURES"),
)
"""Variables that can change the last bits of numbers."""
_SLOW = "NUMBA_DISABLE_JIT"


def check_hardware(runs: Path) -> list[CheckResult]:
    """All checks of the machine; ``runs`` is the folder for runs."""
    cores = _cores()
    return [*_disk(runs), _memory(cores), _processors(cores), _environment(), _shm(), _houses()]


def _disk(runs: Path) -> Iterator[CheckResult]:
    """Checks of the runs' folder or, if it does not exist yet, of its nearest parent that exists."""
    folder = runs.absolute()
    while not folder.exists():
        folder = folder.parent
    cure = "choose another folder with --out"
    try:
        free, took = shutil.disk_usage(folder).free / _MB, _sync_ms(folder)
    except OSError as error:
        yield CheckResult(name="disk", status="fail", says=f"{folder} cannot be written to: {error.strerror}", fix=cure)
        return
    says = f"{free / 1000.0:.1f} GB free in {folder}"
    if free < _ROOM_MB:
        fix = f"make room, or {cure}"
        yield CheckResult(name="disk", status="fail" if free < _ROOM_LEAST_MB else "warn", says=says, fix=fix)
    else:
        yield CheckResult(name="disk", says=says)
    says, slow = f"a record is on the disk after {took:.1f} ms", took > _SYNC_MS
    fix = "write runs to a local disk with --out" if slow else ""
    yield CheckResult(name="disk speed", status="warn" if slow else "ok", says=says, fix=fix)


def _sync_ms(folder: Path) -> float:
    """Median time that it takes to put the bytes of a trial on the disk, in a file without a name."""
    times = []
    with tempfile.TemporaryFile(dir=folder) as file:
        for _ in range(_SYNCS):
            began = time.perf_counter()
            os.write(file.fileno(), bytes(17_000))
            os.fdatasync(file.fileno())
            times.append(1000.0 * (time.perf_counter() - began))
    return sorted(times)[_SYNCS // 2]


def _memory(cores: float) -> CheckResult:
    free, workers = _free_mb(), max(1, int(cores))
    if free is None:
        return CheckResult(name="memory", says="this system does not say how much is free")
    needed = workers * _WORKER_MB
    says = f"{free / 1000.0:.1f} GB free, {needed / 1000.0:.1f} GB needed for {workers} workers and built-in agents"
    if free >= needed:
        return CheckResult(name="memory", says=says)
    return CheckResult(
        name="memory", status="warn", says=says, fix=f"hthor eval --jobs {max(1, int(free / _WORKER_MB))}"
    )


def _free_mb() -> float | None:
    """Free memory [MB], or the rest of the container's limit if that is less."""
    found = []
    for line in read_system_file("/proc/meminfo").splitlines():
        if line.startswith("MemAvailable:"):
            found.append(float(line.split()[1]) * 1024 / _MB)
    for limit, used in (
        ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory.current"),
        ("/sys/fs/cgroup/memory/memory.limit_in_bytes", "/sys/fs/cgroup/memory/memory.usage_in_bytes"),
    ):
        most, now = read_system_file(limit), read_system_file(used)
        if most.isdecimal() and now.isdecimal():
            found.append((int(most) - int(now)) / _MB)
    return max(0.0, min(found)) if found else None


def _processors(cores: float) -> CheckResult:
    allowed, there = len(os.sched_getaffinity(0)), os.cpu_count() or 1
    says = f"{allowed} of {there} may be used" if allowed < there else f"{there}"
    if cores < allowed:
        says += f", but no more than {cores:g} of them at a time (a container's quota)"
        return CheckResult(name="cores", status="warn", says=says, fix=f"hthor eval --jobs {max(1, int(cores))}")
    return CheckResult(name="cores", says=f"{says}, one worker each")


def _cores() -> float:
    """Cores that this process can keep busy."""
    allowed = float(len(os.sched_getaffinity(0)))
    quota, _, period = read_system_file("/sys/fs/cgroup/cpu.max").partition(" ")
    return min(allowed, int(quota) / int(period)) if quota.isdecimal() and period.isdecimal() else allowed


def _environment() -> CheckResult:
    if os.environ.get(_SLOW, "0") != "0":
        says = f"{_SLOW} is set: a trial takes minutes instead of a tenth of a second"
        return CheckResult(name="environment", status="warn", says=says, fix=f"unset {_SLOW}")
    pinned = [f"{name}={os.environ[name]}" for name in (*worker.ONE_THREAD, *_OTHERWISE) if name in os.environ]
    here = f"; set here: {', '.join(pinned)}" if pinned else ""
    return CheckResult(name="environment", says=f"workers compute with one thread each{here}")


def _shm() -> CheckResult:
    """The check of /dev/shm. Only Ray stores data there; frames for agents have shared memory of their own."""
    name, folder = "shared memory", Path("/dev/shm")
    if not folder.is_dir():
        return CheckResult(name=name, says="there is no /dev/shm; only Ray would use it")
    free = shutil.disk_usage(folder).free / _MB
    says = f"{free / 1000.0:.1f} GB free in /dev/shm; only Ray uses it"
    if free < _RAY_SHM_MB and util.find_spec("ray") is not None:
        return CheckResult(name=name, status="warn", says=says, fix="docker run --shm-size=2g ...")
    return CheckResult(name=name, says=says)


def _houses() -> CheckResult:
    from hthor import houses, tasks
    from hthor.looks import pack

    scenes, suites, packs = houses.names(), tasks.suite_names(), pack.installed()
    says = f"{len(scenes)} houses, {len(suites)} suites, furniture packs: {', '.join(packs) or 'none'}"
    if not scenes or not suites:
        return CheckResult(name="houses", status="fail", says=says, fix="pip install --force-reinstall hthor")
    return CheckResult(name="houses", says=says)
