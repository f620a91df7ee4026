"""The workflows: every step calls a script that is here and can run, and a pull request sees no secret."""

from __future__ import annotations

import json
import os
import re
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
WORKFLOWS = sorted((ROOT / ".github" / "workflows").glob("*.yml"))
SCRIPTS = sorted((ROOT / "scripts").rglob("*.sh"))
STEPS = ROOT / "scripts" / "leaderboard"
NAMES = {"submission-check", "official-eval", "leaderboard-validate", "pages", "nightly"}


def _steps(path: Path) -> list[list[str]]:
    """The lines of each step; our files have no step that is written otherwise."""
    found: list[list[str]] = []
    inside = False
    for line in path.read_text().splitlines():
        if re.match(r"      - \w", line):
            inside = True
            found.append([line.replace("- ", "  ", 1)])
        elif inside and line.startswith("        "):
            found[-1].append(line)
        elif line.strip():
            inside = False
    return found


def test_they_are_all_there():
    assert {path.stem for path in WORKFLOWS} == NAMES


@pytest.mark.parametrize("path", WORKFLOWS, ids=lambda path: path.stem)
def test_every_step_calls_a_script_or_a_pinned_action(path: Path):
    text, steps = path.read_text(), _steps(path)
    assert text.count("run:") == sum(line.strip().startswith("run:") for step in steps for line in step) > 0
    for step in steps:
        runs = [line.strip().removeprefix("run:").strip() for line in step if line.strip().startswith("run:")]
        uses = [line.strip() for line in step if line.strip().startswith("uses:")]
        assert len(runs) + len(uses) == 1, step
        for run in runs:
            script = run.split()[0]
            assert re.fullmatch(r"scripts/[\w/]+\.sh", script), run
            assert os.access(ROOT / script, os.X_OK), script
            assert "${{" not in run, "what others write must not become part of a command"
        for use in uses:
            assert re.fullmatch(r"uses: actions/[\w-]+@[0-9a-f]{40} # v\d+\.\d+\.\d+", use), use
    assert "pull_request_target" not in text
    assert re.search(r"^permissions:\n  contents: read\n", text, re.MULTILINE)


@pytest.mark.parametrize("path", WORKFLOWS, ids=lambda path: path.stem)
def test_the_salt_is_only_where_no_agent_is(path: Path):
    text = path.read_text()
    if re.search(r"^  pull_request:", text, re.MULTILINE):
        assert "secrets." not in text
        assert "write" not in text.split("jobs:")[0].replace("can write nothing", "")
        assert not re.search(r":\s*write\b", text)
    for step in _steps(path):
        if any("secrets." in line for line in step):
            assert any(line.strip().startswith("run: scripts/leaderboard/salt.sh") for line in step), step


@pytest.mark.parametrize("path", SCRIPTS, ids=lambda path: path.name)
def test_scripts_are_sound_bash_and_say_how_they_are_called(path: Path):
    subprocess.run(["bash", "-n", str(path)], check=True)
    assert "set -euo pipefail" in path.read_text() or "common.sh" in path.read_text()
    if "usage\n" in path.read_text() and path.name != "common.sh":
        wrong = "abcdefg" if path.stem in ("validate", "build") else ""
        done = subprocess.run([str(path), *wrong], capture_output=True, text=True, check=False)
        assert done.returncode == 2
        assert done.stderr.startswith(path.name)


def test_every_script_is_called_by_a_workflow_or_by_the_whole_pipeline():
    callers = "".join(path.read_text() for path in (*WORKFLOWS, ROOT / "scripts" / "leaderboard.sh"))
    assert [path.name for path in STEPS.glob("*.sh") if path.name != "common.sh" and path.name not in callers] == []


def _run(*words: object, cwd: Path, **env: str) -> subprocess.CompletedProcess[str]:
    given = {**os.environ, **env}
    return subprocess.run(
        [str(word) for word in words], cwd=cwd, capture_output=True, text=True, check=False, env=given
    )


def test_a_pull_request_hands_in_one_folder(tmp_path: Path):
    def git(*words: str) -> str:
        done = _run("git", "-c", "user.name=a", "-c", "user.email=a@b", *words, cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        return done.stdout.strip()

    def commit(path: str) -> str:
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).write_text(path)
        git("add", "-A")
        git("commit", "-q", "-m", path)
        return git("rev-parse", "HEAD")

    git("init", "-q")
    base = commit("README.md")
    head = commit("submissions/mine/agent.py")
    done = _run(STEPS / "changed.sh", base, head, cwd=tmp_path, GITHUB_OUTPUT=str(tmp_path / "out"))
    assert (done.returncode, done.stdout) == (0, "submissions/mine\n")
    assert (tmp_path / "out").read_text() == "folder=submissions/mine\n"
    for path in ("submissions/other/agent.py", "hthor/cli.py", "submissions/Odd name/agent.py"):
        more = commit(path)
        refused = _run(STEPS / "changed.sh", base, more, cwd=tmp_path)
        assert refused.returncode == 1
        assert path in refused.stderr
        git("reset", "-q", "--hard", head)
    git("checkout", "-q", base)
    assert _run(STEPS / "fetch.sh", head, "submissions/mine", cwd=tmp_path).returncode == 0
    assert (tmp_path / "submissions" / "mine" / "agent.py").is_file()
    assert _run(STEPS / "fetch.sh", head, "submissions/../hthor", cwd=tmp_path).returncode == 2


def test_what_jobs_hand_on_is_sealed_and_the_salt_is_forgotten(tmp_path: Path):
    secret = "c0ffee" * 10
    assert _run(STEPS / "salt.sh", tmp_path / "salt", cwd=tmp_path, HTHOR_SALT=secret).returncode == 0
    assert (tmp_path / "salt").stat().st_mode & 0o077 == 0
    (tmp_path / "suite").mkdir()
    (tmp_path / "suite" / "suite.json").write_text("the apple is in the fridge")
    assert _run(STEPS / "seal.sh", tmp_path / "salt", "sealed", "suite", cwd=tmp_path).returncode == 0
    assert b"apple" not in (tmp_path / "sealed").read_bytes()
    other = tmp_path / "other"
    other.mkdir()
    assert _run(STEPS / "unseal.sh", tmp_path / "salt", tmp_path / "sealed", cwd=other).returncode == 0
    assert "apple" in (other / "suite" / "suite.json").read_text()
    assert not (tmp_path / "salt").exists()
    none = _run(STEPS / "salt.sh", tmp_path / "none", cwd=tmp_path, HTHOR_SALT="")
    assert none.returncode == 2


def test_plan_and_proposal(tmp_path: Path):
    done = _run(STEPS / "plan.sh", 3, cwd=tmp_path, GITHUB_OUTPUT=str(tmp_path / "out"))
    assert json.loads(done.stdout) == [1, 2, 3]
    assert (tmp_path / "out").read_text() == "shards=[1,2,3]\n"
    said = _run(STEPS / "pull_request.sh", "mine", cwd=tmp_path, DRY_RUN="1").stdout
    assert "git switch -c leaderboard/mine" in said
    assert "gh pr create" in said
    assert _run(STEPS / "pull_request.sh", "$(rm)", cwd=tmp_path, DRY_RUN="1").returncode == 2
