"""Compares what is installed with what this version of hthor was made with: libraries, extras, hthor's files."""

import platform
import subprocess
import tomllib
from collections.abc import Iterator, Sequence
from importlib import metadata

from packaging.requirements import Requirement

from hthor import code_identity, installation
from hthor.eval.doctor.check_result import CheckResult

_SCORING = ("mujoco", "dm-control", "numba", "numpy")
"""Libraries that trials are computed with."""
_EXTRAS = {
    "cluster": "Ray, for --engine ray",
    "calibration": "for hthor calibrate",
    "live": "for hthor live",
    "learn": "for environments of Gymnasium and PettingZoo",
    "torch": "for robots that learn",
    "assets": "for hthor assets build",
    "priors": "for hthor priors build",
}
_GIT_LIMIT_S = 10.0


def check_libraries() -> list[CheckResult]:
    """Check Python, each library that trials are computed with, the other libraries, the extras, and the checkout."""
    found = [CheckResult(name="python", says=platform.python_version())]
    try:
        base, extras = _required()
    except metadata.PackageNotFoundError:
        says = "hthor is not installed, so what it requires is not known"
        return [*found, CheckResult(name="libraries", status="warn", says=says, fix="pip install -e ."), *_checkout()]
    scoring = [one for one in base if one.name in _SCORING]
    found += [_library(one, pinned_versions()) for one in scoring]
    found.append(_others([one for one in base if one not in scoring]))
    return [*found, *(_extra(name, extras[name]) for name in _EXTRAS if extras.get(name)), *_checkout()]


def _required() -> tuple[list[Requirement], dict[str, list[Requirement]]]:
    """What hthor requires, and what each extra adds; a checkout's own file, if there is one, is the newest source."""
    path = code_identity.PACKAGE.parent / "pyproject.toml"
    if path.is_file():
        project = tomllib.loads(path.read_text(encoding="utf-8"))["project"]
        more = project["optional-dependencies"]
        extras = {name: [Requirement(line) for line in more[name]] for name in more}
        return [Requirement(line) for line in project["dependencies"]], extras
    wanted = [Requirement(line) for line in metadata.requires("hthor") or ()]
    base = [one for one in wanted if one.marker is None or one.marker.evaluate({"extra": ""})]
    rest = [(one, one.marker) for one in wanted if one.marker is not None and one not in base]
    return base, {name: [one for one, marker in rest if marker.evaluate({"extra": name})] for name in _EXTRAS}


def pinned_versions() -> dict[str, str]:
    """The versions that this version's own results were made with; empty where hthor is not a checkout."""
    path = code_identity.PACKAGE.parent / "constraints.txt"
    if not path.is_file():
        return {}
    pairs = (line.split("==") for line in path.read_text(encoding="utf-8").split() if "==" in line)
    return {name.lower().replace("_", "-"): version for name, version in pairs}


def _library(wanted: Requirement, pins: dict[str, str]) -> CheckResult:
    trouble = _trouble(wanted)
    if trouble:
        return CheckResult(name=wanted.name, status="fail", says=trouble, fix=f"pip install '{_bare(wanted)}'")
    version, pin = metadata.version(wanted.name), pins.get(wanted.name)
    if pin and pin != version:
        says = f"{version}, but hthor's own results were made with {pin}: records may differ byte for byte"
        return CheckResult(name=wanted.name, status="warn", says=says, fix="pip install -c constraints.txt -e .")
    return CheckResult(name=wanted.name, says=version)


def _others(wanted: Sequence[Requirement]) -> CheckResult:
    bad = [(one, trouble) for one in wanted if (trouble := _trouble(one))]
    name = "other libraries"
    if not bad:
        return CheckResult(name=name, says=f"all {len(wanted)} are installed")
    says = "; ".join(f"{one.name}: {trouble}" for one, trouble in bad)
    fix = "pip install " + " ".join(f"'{_bare(one)}'" for one, _ in bad)
    return CheckResult(name=name, status="fail", says=says, fix=fix)


def _extra(name: str, parts: Sequence[Requirement]) -> CheckResult:
    """The check of an extra: it need not be installed, but an installed part in a wrong version is a warning."""
    present = {one.name: _installed(one.name) for one in parts}
    title, install = f"extra {name}", f"pip install 'hthor[{name}]'"
    bad = [trouble for one in parts if present[one.name] and (trouble := _trouble(one))]
    if bad:
        return CheckResult(name=title, status="warn", says="; ".join(bad), fix=install)
    if not all(present.values()):
        return CheckResult(name=title, says=f"not installed ({_EXTRAS[name]}): {install}")
    return CheckResult(name=title, says=", ".join(f"{part} {version}" for part, version in present.items()))


def _checkout() -> Iterator[CheckResult]:
    """Which code of hthor this is, and whether it differs from its commit."""
    from hthor import __version__

    code, root = installation.sha256()[:10], code_identity.PACKAGE.parent
    yield CheckResult(name="hthor", says=f"{__version__}, code {code}, {code_identity.PACKAGE}")
    if not (root / ".git").exists():
        return
    commit, changes = _git("rev-parse", "--short=10", "HEAD"), _git("status", "--porcelain", "--", "hthor")
    if commit is None or changes is None:
        yield CheckResult(
            name="git", status="warn", says="git does not say what commit this is", fix=f"git -C {root} status"
        )
        return
    changed = changes.splitlines()
    if changed:
        says = f"{commit}, with {len(changed)} changed or new files in hthor/: results cannot be told from a commit's"
        yield CheckResult(name="git", status="warn", says=says, fix=f"git -C {root} status, then commit or undo")
        return
    yield CheckResult(name="git", says=f"{commit}, unchanged")


def _git(*words: str) -> str | None:
    root = str(code_identity.PACKAGE.parent)
    try:
        done = subprocess.run(
            ["git", "--no-optional-locks", "-C", root, *words], capture_output=True, text=True, timeout=_GIT_LIMIT_S
        )
    except (OSError, subprocess.TimeoutExpired):
        return None
    return done.stdout.strip() if done.returncode == 0 else None


def _trouble(wanted: Requirement) -> str:
    """Why a requirement is not met, empty when it is."""
    version = _installed(wanted.name)
    if not version:
        return "not installed"
    return "" if wanted.specifier.contains(version, prereleases=True) else f"{version}, hthor needs {wanted.specifier}"


def _installed(name: str) -> str:
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return ""


def _bare(wanted: Requirement) -> str:
    return f"{wanted.name}{wanted.specifier}"
