"""The doctor: what it finds on this machine, how it judges what it finds, and that its reference is not stale."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import msgspec
import pytest

from hthor.eval.doctor import hardware, isolation_levels, libraries, rendering, reproducibility
from hthor.eval.doctor.check_result import CheckResult, DoctorReport
from hthor.eval.doctor.rendering import RenderingProbe
from hthor.eval.doctor.reproducibility import TrialFingerprint
from hthor.guest import IsolationError

STALE = "trials go otherwise than before: if that is meant, renew the reference with 'hthor doctor --write-reference'"


@pytest.fixture(scope="module")
def examined(tmp_path_factory: pytest.TempPathFactory) -> tuple[DoctorReport, subprocess.CompletedProcess[str], Path]:
    """What the command says of this machine."""
    folder = tmp_path_factory.mktemp("here")
    words = ["-m", "hthor", "doctor", "--json", "--out", str(folder / "runs")]
    done = subprocess.run([sys.executable, *words], capture_output=True, text=True, timeout=900, cwd=folder)
    return msgspec.json.decode(done.stdout.encode(), type=DoctorReport), done, folder


def found(health: DoctorReport, name: str) -> CheckResult:
    return next(one for one in health.findings if one.name == name)


def test_the_command_leaves_nothing_and_its_code_says_whether_all_is_well(examined) -> None:
    health, done, folder = examined
    assert list(folder.iterdir()) == []
    assert health.well == all(one.status != "fail" for one in health.findings)
    assert done.returncode == (0 if health.well else 5)
    assert all(one.fix for one in health.findings if one.status != "ok")
    assert len({one.name for one in health.findings}) == len(health.findings)


def test_the_first_level_starts_and_the_robot_sees(examined) -> None:
    health, _, _ = examined
    assert found(health, "isolation L1").status == "ok"
    assert found(health, "robot's camera").status == "ok"
    assert found(health, "mujoco").status == "ok"


def test_the_reference_is_that_of_this_code(examined) -> None:
    one = found(examined[0], "determinism")
    assert one.status == "ok", f"{one.says}: {STALE}"


HERE = TrialFingerprint(trial="t", sha256="1", outcome={"met": True}, platform={"cpu": "one"})


@pytest.mark.parametrize(
    ("changed", "status", "words"),
    [
        ({}, "ok", "byte for byte"),
        ({"platform": {"cpu": "two"}}, "ok", "byte for byte"),
        ({"sha256": "2"}, "fail", "outcome equal"),
        ({"sha256": "2", "outcome": {"met": False}}, "fail", "outcome different"),
        ({"sha256": "2", "platform": {"cpu": "two"}}, "ok", "outcome equal"),
        ({"sha256": "2", "platform": {"cpu": "two"}, "outcome": {"met": False}}, "warn", "outcome different"),
    ],
)
def test_another_platform_may_differ_in_bytes_and_this_one_in_nothing(monkeypatch, changed, status, words) -> None:
    monkeypatch.setattr(reproducibility, "load_reference", lambda: HERE)
    (one,) = reproducibility.check_reproducibility(msgspec.structs.replace(HERE, **changed))
    assert one.status == status
    assert words in one.says


def test_what_crashes_or_is_blank_is_told_with_a_way_out() -> None:
    assert [one.status for one in reproducibility.check_reproducibility("it ended with signal 11")] == ["fail"]
    assert [one.status for one in rendering.check_rendering("it ended with signal 11")] == ["fail"]
    assert [one.status for one in rendering.check_rendering(RenderingProbe(fast=1, nice=90, backend="egl"))] == [
        "fail",
        "ok",
    ]
    blank, none = RenderingProbe(fast=90, nice=1, backend="egl"), RenderingProbe(fast=90, reason="egl: no library")
    for drawn, word in ((blank, "blank"), (none, "no library")):
        one = rendering.check_rendering(drawn)[1]
        assert one.status == "warn"
        assert word in one.says
        assert "apt-get install libegl1" in one.fix


@pytest.mark.parametrize(
    ("level", "files", "bwrap", "kernel", "fix"),
    [
        ("L3", {}, None, "6.1.0", "apt-get install bubblewrap"),
        (
            "L3",
            {"/proc/sys/kernel/apparmor_restrict_unprivileged_userns": "1"},
            "/usr/bin/bwrap",
            "6.8.0",
            "sysctl -w kernel.apparmor_restrict_unprivileged_userns=0",
        ),
        (
            "L3",
            {"/proc/sys/user/max_user_namespaces": "0"},
            "/usr/bin/bwrap",
            "6.8.0",
            "user.max_user_namespaces=15000",
        ),
        ("L2", {}, None, "5.4.0-generic", "a kernel of 5.13 or later"),
        ("L2", {"/sys/kernel/security/lsm": "capability,yama"}, None, "6.8.0", "lsm=landlock,capability,yama"),
    ],
)
def test_a_level_that_does_not_start_comes_with_its_fix(monkeypatch, level, files, bwrap, kernel, fix) -> None:
    def refuse(wanted: str) -> None:
        raise IsolationError(
            f"isolation {wanted} is not available on this machine: it is forbidden. 'hthor eval' helps."
        )

    monkeypatch.setattr(isolation_levels, "in_force", refuse)
    monkeypatch.setattr(isolation_levels, "read_system_file", lambda path: files.get(path, ""))
    monkeypatch.setattr(isolation_levels.shutil, "which", lambda _: bwrap)
    monkeypatch.setattr(isolation_levels.platform, "release", lambda: kernel)
    by_name = {one.name: one for one in isolation_levels.check_isolation("L2")}
    assert by_name["isolation L3"].status == "warn"
    assert by_name["isolation L2"].status == "fail"
    assert by_name[f"isolation {level}"].says == "it is forbidden"
    assert fix in by_name[f"isolation {level}"].fix


def test_a_library_of_another_version_fails_or_warns(monkeypatch) -> None:
    real = libraries.metadata.version
    monkeypatch.setattr(libraries.metadata, "version", lambda name: "4.0.0" if name == "mujoco" else real(name))
    monkeypatch.setattr(libraries, "pinned_versions", lambda: {"numpy": "1.0"})
    by_name = {one.name: one for one in libraries.check_libraries()}
    assert by_name["mujoco"].status == "fail"
    assert "pip install 'mujoco==" in by_name["mujoco"].fix
    assert by_name["numpy"].status == "warn"


def test_a_place_that_cannot_be_written_to_fails(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    by_name = {one.name: one for one in hardware.check_hardware(tmp_path / "file" / "runs")}
    assert by_name["disk"].status == "fail"
    assert os.listdir(tmp_path) == ["file"]
