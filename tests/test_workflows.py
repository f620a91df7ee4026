"""The workflows: every step calls a script that is here and can run, and a pull request sees no secret."""

from __future__ import annotations

import importlib
import io
import json
import os
import re
import shutil
import subprocess
import sys
import tarfile
import tomllib
from pathlib import Path

import pytest

from hthor.live import server
from hthor.watch import page

ROOT = Path(__file__).resolve().parents[1]
WORKFLOWS = sorted((ROOT / ".github" / "workflows").glob("*.yml"))
SCRIPTS = sorted((ROOT / "scripts").rglob("*.sh"))
STEPS = ROOT / "scripts" / "leaderboard"
NAMES = {"guard", "submission-check", "official-eval", "leaderboard-validate", "pages", "nightly", "tests"}


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
            assert "${{" not in run, "what others write must not become part of a command"
            if re.fullmatch(r"make [\w-]+", run):
                continue
            script = run.split()[0]
            assert re.fullmatch(r"scripts/[\w/]+\.sh", script), run
            assert os.access(ROOT / script, os.X_OK), script
        for use in uses:
            assert re.fullmatch(r"uses: actions/[\w-]+@[0-9a-f]{40} # v\d+\.\d+\.\d+", use), use
    assert ("pull_request_target" in text) == (path.stem == "guard")
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


def test_the_guard_is_the_base_branchs_and_runs_nothing_of_the_pull_request():
    """It runs as the base branch has it, so a pull request cannot take it away; it must not run what comes with one."""
    text = (ROOT / ".github" / "workflows" / "guard.yml").read_text()
    assert "secrets." not in text
    assert not re.search(r":\s*write\b", text)
    steps = _steps(ROOT / ".github" / "workflows" / "guard.yml")
    runs = [line.strip() for step in steps for line in step if line.strip().startswith("run:")]
    assert runs == ['run: scripts/leaderboard/guard.sh "$BASE_SHA" "$HEAD_SHA"']
    refs = [line.strip() for step in steps for line in step if line.strip().startswith("ref:")]
    assert refs == ["ref: ${{ github.event.pull_request.base.sha }}"]
    assert "persist-credentials: false" in text


def test_where_the_salt_is_everything_is_installed_by_its_hash():
    text = (ROOT / ".github" / "workflows" / "official-eval.yml").read_text()
    assert "setup.sh dev" not in text
    assert "--require-hashes" in (STEPS / "setup.sh").read_text()
    lines = (STEPS / "requirements.txt").read_text().splitlines()
    pinned = {}
    for name, line, after in ((line.partition("==")[0], line, number) for number, line in enumerate(lines)):
        if "==" in line:
            pinned[re.sub(r"[-_.]+", "-", name).lower()] = line.split()[0].partition("==")[2]
            assert re.fullmatch(r"    --hash=sha256:[0-9a-f]{64}( \\)?", lines[after + 1]), line
        else:
            assert not line or line.startswith(("#", "    --hash=sha256:")), line
    wanted = dict(line.split("==") for line in (ROOT / "constraints.txt").read_text().split())
    wanted = {re.sub(r"[-_.]+", "-", name).lower(): version for name, version in wanted.items()}
    assert {name: wanted[name] for name in pinned if name in wanted} == {
        name: version for name, version in pinned.items() if name in wanted
    }, "lock.sh makes requirements.txt anew"
    core = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["dependencies"]
    assert {re.split(r"[<>=!~ ]", word)[0].replace("_", "-").lower() for word in core} <= set(pinned)


def test_only_the_verification_is_taken_from_the_machine_that_ran_the_agent():
    text = (ROOT / ".github" / "workflows" / "official-eval.yml").read_text()
    publish = text.partition("  publish:\n")[2]
    paths = re.findall(r"^          path: (.*)$", publish, re.MULTILINE)
    assert paths == ["entered", "verified"], "nothing is unpacked into the checkout's own folders"
    assert publish.index("place.sh entered leaderboard") < publish.index("record.sh verified leaderboard")
    verify = text.partition("  verify:\n")[2].partition("  publish:\n")[0]
    assert "name: verified\n          path: verified" in verify
    assert "          path: leaderboard\n" not in text


@pytest.mark.parametrize("path", SCRIPTS, ids=lambda path: path.name)
def test_scripts_are_sound_bash_and_say_how_they_are_called(path: Path):
    subprocess.run(["bash", "-n", str(path)], check=True)
    assert "set -euo pipefail" in path.read_text() or "common.sh" in path.read_text()
    if "usage\n" in path.read_text() and path.name != "common.sh":
        wrong = "abcdefg" if path.stem in ("validate", "build", "setup", "lock") else ""
        done = subprocess.run([str(path), *wrong], capture_output=True, text=True, check=False)
        assert done.returncode == 2
        assert done.stderr.startswith(path.name)


def test_every_script_is_called_by_a_workflow_or_by_the_whole_pipeline():
    callers = "".join(path.read_text() for path in (*WORKFLOWS, ROOT / "scripts" / "leaderboard.sh"))
    by_hand = ("common.sh", "lock.sh")
    assert [path.name for path in STEPS.glob("*.sh") if path.name not in by_hand and path.name not in callers] == []


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


def _sealed(tmp_path: Path, *folders: str) -> Path:
    assert _run(STEPS / "salt.sh", tmp_path / "salt", cwd=tmp_path, HTHOR_SALT="c0ffee" * 10).returncode == 0
    done = _run(STEPS / "seal.sh", tmp_path / "salt", "sealed", *folders, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    return tmp_path / "sealed"


def _there(folder: Path) -> list[str]:
    return sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file())


def test_what_jobs_hand_on_is_sealed_and_the_salt_is_forgotten(tmp_path: Path):
    (tmp_path / "suite").mkdir()
    (tmp_path / "suite" / "suite.json").write_text("the apple is in the fridge")
    sealed = _sealed(tmp_path, "suite")
    assert (tmp_path / "salt").stat().st_mode & 0o077 == 0
    assert b"apple" not in sealed.read_bytes()
    other = tmp_path / "other"
    other.mkdir()
    assert _run(STEPS / "unseal.sh", tmp_path / "salt", "suite", sealed, cwd=other).returncode == 0
    assert "apple" in (other / "suite" / "suite.json").read_text()
    assert not (tmp_path / "salt").exists()
    none = _run(STEPS / "salt.sh", tmp_path / "none", cwd=tmp_path, HTHOR_SALT="")
    assert none.returncode == 2


def test_what_was_changed_on_the_way_or_sealed_with_another_salt_is_refused(tmp_path: Path):
    (tmp_path / "suite").mkdir()
    (tmp_path / "suite" / "suite.json").write_text("the apple is in the fridge")
    sealed = _sealed(tmp_path, "suite")
    data = bytearray(sealed.read_bytes())
    data[20] ^= 1
    (tmp_path / "changed").write_bytes(data)
    (tmp_path / "short").write_bytes(b"x")
    for name in ("changed", "short"):
        refused = _run(STEPS / "unseal.sh", tmp_path / "salt", "suite", tmp_path / name, cwd=tmp_path / "suite")
        assert refused.returncode == 1
        assert _there(tmp_path / "suite") == ["suite.json"]
    (tmp_path / "salt").write_text("decaf" * 10)
    refused = _run(STEPS / "unseal.sh", tmp_path / "salt", "suite", sealed, cwd=tmp_path / "suite")
    assert "not sealed with this salt" in refused.stderr


SMUGGLED = {
    "a script of the checkout": ("scripts/leaderboard/merge.sh", b"echo mine"),
    "out of the folder": ("../merge.sh", b"echo mine"),
    "an absolute path": ("/tmp/hthor-smuggled", b"x"),
    "a link": ("runs/mine-shard-1-of-2/trials.jsonl", None),
    "another file of a run": ("runs/mine-shard-1-of-2/agent.py", b"x"),
    "a run of another name": ("runs/other/run.json", b"{}"),
}


@pytest.mark.parametrize("how", SMUGGLED)
def test_of_what_a_shard_sealed_only_its_records_are_taken(tmp_path: Path, how: str):
    """The machine that sealed it ran the agent: the parcel can hold anything."""
    name, data = SMUGGLED[how]
    with tarfile.open(tmp_path / "parcel.tar", "w") as parcel:
        for member in ("runs/mine-shard-1-of-2/run.json", name):
            info = tarfile.TarInfo(member)
            held = b"{}" if member != name else data
            if held is None:
                info.type, info.linkname = tarfile.SYMTYPE, "/etc/passwd"
            info.size = len(held or b"")
            parcel.addfile(info, io.BytesIO(held or b""))
    out = tmp_path / "out"
    out.mkdir()
    done = subprocess.run(
        [sys.executable, str(STEPS / "parcel.py"), "unpack", "shard", str(out)],
        input=(tmp_path / "parcel.tar").read_bytes(),
        capture_output=True,
        check=False,
    )
    assert done.returncode == 1, how
    assert set(_there(out)) <= {"runs/mine-shard-1-of-2/run.json"}
    assert not Path("/tmp/hthor-smuggled").exists()


def test_all_that_a_merge_needs_of_a_shard_is_taken(tmp_path: Path):
    folder = tmp_path / "runs" / "mine-shard-1-of-2"
    (folder / "houses").mkdir(parents=True)
    (folder / "faults").mkdir()
    wanted = [
        "run.json",
        "trials.jsonl",
        "isolation.json",
        "platform.json",
        "effort.json",
        "replays.json",
        "suite.json",
    ]
    wanted += ["houses/h0123456789ab.json"]
    for name in (*wanted, ".lock", "faults/0123.json"):
        (folder / name).write_text("{}")
    sealed = _sealed(tmp_path, "runs")
    other = tmp_path / "other"
    other.mkdir()
    done = _run(STEPS / "unseal.sh", tmp_path / "salt", "shard", sealed, cwd=other)
    assert done.returncode == 0, done.stderr
    assert _there(other / "runs" / "mine-shard-1-of-2") == sorted(wanted)


def test_nothing_is_unpacked_over_what_is_there(tmp_path: Path):
    (tmp_path / "suite").mkdir()
    (tmp_path / "suite" / "suite.json").write_text("a")
    sealed = _sealed(tmp_path, "suite")
    refused = _run(STEPS / "unseal.sh", tmp_path / "salt", "suite", sealed, cwd=tmp_path)
    assert "is there already" in refused.stderr
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(STEPS))
        parcel = importlib.import_module("parcel")
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "x").write_text("x")
    with pytest.raises(SystemExit, match="not empty"):
        parcel.unpack("suite", str(tmp_path / "full"))


def test_only_new_entries_are_placed_on_a_board(tmp_path: Path):
    made, board = tmp_path / "made", tmp_path / "board"
    (made / "entries").mkdir(parents=True)
    board.mkdir()
    name = "entries/mine-suite-0123456789.json"
    (made / name).write_text("{}")
    assert _run(STEPS / "place.sh", made, board, cwd=tmp_path).stdout == f"{board / name}\n"
    assert _run(STEPS / "place.sh", made, board, cwd=tmp_path).returncode == 0, "the same once more"
    (board / name).write_text("another")
    assert "not written over" in _run(STEPS / "place.sh", made, board, cwd=tmp_path).stderr
    (board / name).unlink()
    for stranger in ("index.html", "verifications/mine-suite-0123456789.json", "entries/x.sh"):
        path = made / stranger
        path.parent.mkdir(exist_ok=True)
        path.write_text("x")
        assert "is no entry's file" in _run(STEPS / "place.sh", made, board, cwd=tmp_path).stderr
        path.unlink()
        if path.parent.name == "verifications":
            path.parent.rmdir()
    (made / "entries" / "link-suite-0123456789.json").symlink_to("/etc/passwd")
    assert "no plain file" in _run(STEPS / "place.sh", made, board, cwd=tmp_path).stderr
    assert "must have verification.json and nothing else" in _run(STEPS / "record.sh", made, board, cwd=tmp_path).stderr


def test_strangers_change_neither_workflows_nor_what_the_keeper_decides(tmp_path: Path):
    def git(*words: str) -> str:
        done = _run("git", "-c", "user.name=a", "-c", "user.email=a@b", *words, cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        return done.stdout.strip()

    def commit(*paths: str, text: str = "x") -> str:
        for path in paths:
            (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
            (tmp_path / path).write_text(text)
        git("add", "-A")
        git("commit", "-q", "-m", "one")
        return git("rev-parse", "HEAD")

    git("init", "-q")
    base = commit("README.md", "leaderboard/entries/old-0123456789.json", ".github/workflows/guard.yml")
    for paths, stranger, keeper in (
        (("submissions/mine/agent.py",), 0, 0),
        (("submissions/mine/agent.py", ".github/workflows/guard.yml"), 1, 1),
        (("submissions/mine/agent.py", "README.md"), 1, 1),
        ((".github/workflows/more.yml",), 1, 0),
        (("leaderboard/entries/new-0123456789.json",), 0, 0),
        (("leaderboard/entries/old-0123456789.json",), 1, 0),
        (("leaderboard/verifications/old-0123456789.json",), 1, 0),
        (("leaderboard/refutations/x.json",), 1, 0),
        (("leaderboard/admission.json",), 1, 0),
        (("leaderboard/suites/mine.json",), 1, 0),
        (("hthor/cli/app.py", "docs/cli.md"), 0, 0),
    ):
        head = commit(*paths, text="changed")
        assert _run(STEPS / "guard.sh", base, head, cwd=tmp_path).returncode == stranger, paths
        assert _run(STEPS / "guard.sh", base, head, cwd=tmp_path, KEEPER="true").returncode == keeper, paths
        git("reset", "-q", "--hard", base)
    (tmp_path / "leaderboard" / "entries" / "old-0123456789.json").unlink()
    gone = commit("README.md", text="y")
    assert _run(STEPS / "guard.sh", base, gone, cwd=tmp_path).returncode == 1, "taking an entry away"


def test_plan_and_proposal(tmp_path: Path):
    done = _run(STEPS / "plan.sh", 3, cwd=tmp_path, GITHUB_OUTPUT=str(tmp_path / "out"))
    assert json.loads(done.stdout) == [1, 2, 3]
    assert (tmp_path / "out").read_text() == "shards=[1,2,3]\n"
    said = _run(STEPS / "pull_request.sh", "mine", cwd=tmp_path, DRY_RUN="1").stdout
    assert "git switch -c leaderboard/mine" in said
    assert "gh pr create" in said
    assert _run(STEPS / "pull_request.sh", "$(rm)", cwd=tmp_path, DRY_RUN="1").returncode == 2


def _board(tmp_path: Path, *agents: str) -> Path:
    """A copy of the board with these agents' entries only."""
    board = tmp_path / "board"
    shutil.copytree(ROOT / "leaderboard", board)
    for path in (board / "entries").iterdir():
        if path.name.partition("-")[0] not in agents:
            path.unlink()
    return board


def test_pages_of_trials_are_taken_for_entries_of_the_board_only(tmp_path: Path):
    board, made = _board(tmp_path, "none", "frontier", "oracle"), tmp_path / "made"
    ids = {path.stem.partition("-")[0]: path.stem for path in (board / "entries").iterdir()}
    pages = {name: made / name for name in (ids["none"], ids["frontier"], "stranger-standard-0123456789")}
    for folder in pages.values():
        folder.mkdir(parents=True)
        (folder / "more.js").write_text("x")
    (pages[ids["none"]] / "index.html").write_text("a trial")
    (pages[ids["frontier"]] / "index.html").symlink_to("/etc/passwd")
    (made / "index.html").write_text("another board")
    done = _run(STEPS / "link.sh", made, board, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert _there(board / "watch") == [f"{ids['none']}/index.html"]
    assert (board / "index.html").read_text().count("watch a trial") == 1


def test_each_entry_gets_a_page_of_a_trial(tmp_path: Path):
    if not (server.FOLDER / page.TEMPLATE).exists():
        pytest.skip("the page is not built: make page")
    board = _board(tmp_path, "frontier", "oracle")
    played, absent = sorted((board / "entries").iterdir())
    entry = json.loads(absent.read_bytes())
    unknown = absent.with_name("unknown-standard-0123456789.json")
    command = {"name": f"cmd:touch {tmp_path / 'ran'}"}
    absent.write_text(json.dumps({**entry, "reference": False, "submission": "elsewhere"}))
    unknown.write_text(json.dumps({**entry, "reference": False, "id": unknown.stem, "agent": command}))
    done = _run(STEPS / "watch.sh", board, "submissions", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert f"{absent.stem}: no page" in done.stderr
    assert f"{unknown.stem}: no page" in done.stderr
    assert not (tmp_path / "ran").exists(), "what an entry says of itself is never a command"
    assert _there(board / "watch") == [f"{played.stem}/index.html"]
    assert (board / "watch" / played.stem / "index.html").stat().st_size > 1_000_000, "a house and a program"
