"""What programs rely on: exit codes, one document under --json, dry runs, completion, the page.

The codes of success, of an error of our own and of an interruption are those of real processes; the others are those
that the same function returns in this one.
"""

from __future__ import annotations

import fcntl
import functools
import io
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from unittest import mock

import eval_fakes as fakes
import pytest
from command_line import Said, run, start
from rich.console import Console
from typer.testing import CliRunner

from hthor import code_identity, houses, plugins, tasks
from hthor.cli import app
from hthor.console import completion, exit_status
from hthor.eval.config import human_populations
from hthor.eval.runner import engines, progress, session_runner
from hthor.guest.confinement import LEVELS
from hthor.humans.population import kinds, population_file
from hthor.trials import robot_team
from scripts import cli_reference

WITHOUT_JSON = {
    "hthor agent serve": "serves until it is stopped, and has nothing to tell",
}


@pytest.fixture(scope="module")
def both(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two finished runs, of which one is much better."""
    folder = tmp_path_factory.mktemp("both")
    words = ("--agent", "none", "--agent", "helper", "--suite", "fake", "--participants", "16")
    code, document, _ = run("eval", *words, "--out", str(folder), play="leaning_player")
    assert code == 0
    assert [one["result"]["name"] for one in document["runs"]] == ["none", "helper"]
    return folder


Hthor = Callable[..., Said]


def played(hthor: Hthor, player: Callable[[], object], *words: str) -> tuple[int, object, str]:
    """Like `run`, in this process: exit code, the one document on standard output, and what is said to people."""
    with mock.patch.object(session_runner, "make_runner", player):
        said = hthor(*words, "--json")
    return said.code, json.loads(said.out), said.err


@pytest.fixture
def here(hthor: Hthor, monkeypatch: pytest.MonkeyPatch) -> Hthor:
    """A command in this process that knows the fake agents too."""
    real = robot_team.load_agent_info

    def introduce(word: str, *rest: object) -> robot_team.AgentInfo:
        return fakes.character(word) if word in ("helper", "clumsy") else real(word, *rest)

    monkeypatch.setattr(robot_team, "load_agent_info", introduce)
    return functools.partial(played, hthor, fakes.player)


def failed(said: tuple[int, object, str], code: int) -> str:
    """The words of an error, which are the same for people and programs."""
    found, document, err = said
    assert found == code
    assert set(document) == {"error", "exit_code"}
    assert document["exit_code"] == code
    assert document["error"].splitlines()[0] in err
    return document["error"]


def test_1_is_a_fault_of_our_own(tmp_path: Path) -> None:
    said = run("eval", "--agent", "none", "--suite", "fake", "--out", str(tmp_path / "a"), play="failing_player:own")
    assert "ZeroDivisionError" in failed(said, 1)


def test_2_is_a_wrong_word(here: Hthor) -> None:
    assert "--agent" in failed(here("eval", "--agnet", "none"), 2)


def test_3_is_an_agent_that_failed(here: Hthor, tmp_path: Path) -> None:
    words = ("--agent", "clumsy", "--suite", "fake", "--out", str(tmp_path / "a"), "--no-control")
    code, document, _ = here("eval", *words)
    assert code == 3
    assert document["runs"][0]["result"]["counts"]["faults"] == 2


def test_4_is_an_agent_that_does_not_load(here: Hthor, tmp_path: Path) -> None:
    failed(here("eval", "--agent", str(tmp_path / "none.py"), "--suite", "fake"), 4)


def test_5_is_too_little_isolation(here: Hthor, tmp_path: Path) -> None:
    agent = tmp_path / "mine.py"
    agent.write_text(plugins.Path(plugins.__file__).with_name("agents").joinpath("_template.py.txt").read_text())
    words = ("--agent", str(agent), "--suite", "fake", "--isolation", "L1", "--require-isolation", "L2")
    assert "L2 is required" in failed(here("eval", *words), 5)


def test_6_is_a_run_that_is_worse(both: Path, here: Hthor) -> None:
    code, document, _ = here("compare", str(both / "helper"), str(both / "none"), "--fail-if-worse")
    assert code == 6
    assert document["pairs"][0]["better"] == "helper"


def test_75_is_a_run_that_another_process_writes(both: Path, here: Hthor) -> None:
    with (both / "none" / ".lock").open("rb") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        words = ("--agent", "none", "--suite", "fake", "--participants", "16", "--out", str(both / "none"))
        assert "is being written" in failed(here("eval", *words), 75)


def test_130_is_an_interruption_and_the_same_command_resumes(here: Hthor, tmp_path: Path) -> None:
    words = ("eval", "--agent", "none", "--suite", "fake", "--out", str(tmp_path / "a"), "--jobs", "1")
    process = start(*words, "--json", play="slow_player:0.2")
    until = time.monotonic() + 900.0
    while not (log := tmp_path / "a" / "trials.jsonl").exists() or not log.stat().st_size:
        assert time.monotonic() < until
        time.sleep(0.05)
    process.send_signal(signal.SIGINT)
    out, _ = process.communicate(timeout=900)
    assert process.returncode == 130
    assert json.loads(out)["exit_code"] == 130
    assert here(*words)[0] == 0


def test_the_exit_codes_are_listed_where_people_look(root: Path) -> None:
    text = (root / "docs" / "cli.md").read_text()
    assert all(f"| {code} | " in text for code in exit_status.CODES)
    assert all(f" {code} {meaning}" in exit_status.words() for code, meaning in exit_status.CODES.items())


def test_every_command_that_has_something_to_tell_tells_programs() -> None:
    lacking = {name for name, one in cli_reference.leaves() if not any("--json" in param.opts for param in one.params)}
    assert lacking <= set(WITHOUT_JSON)


def test_help_fills_the_screen_that_there_is() -> None:
    broken = [name for name, one in cli_reference.leaves() if any("\n" in part for part in one.help.split("\n\n"))]
    assert broken == [], "a docstring's line breaks would show in the middle of a narrower line"


def test_the_page_has_every_command(root: Path) -> None:
    text = (root / "docs" / "cli.md").read_text()
    assert text == cli_reference.page(text), "write it anew: python scripts/cli_reference.py docs/cli.md"


def test_a_dry_run_tells_all_and_writes_nothing(
    both: Path, here: Hthor, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)  # the pace may also be that of a finished run in the usual folder

    def files(folder: Path) -> dict[str, int]:
        return {str(path): path.stat().st_mtime_ns for path in folder.rglob("*")}

    words = ("eval", "--agent", "helper", "--suite", "fake", "--seed", "3", "--dry-run")
    code, document, _ = here(*words, "--out", str(tmp_path / "new"))
    assert code == 0
    assert files(tmp_path) == {}
    assert {one["name"]: (one["played"], one["trials"]) for one in document["runs"]} == {
        "no robot": (0, 20),
        "helper": (0, 20),
    }
    assert document["seconds"] is not None, "a fake trial takes no time that would show"
    assert {one["pace"]["played"] for one in document["runs"]} == {3}
    settings = {one["name"]: (one["value"], one["origin"]) for one in document["settings"]}
    assert settings["seed"] == (3, "flag")
    assert settings["suite"] == ("fake", "flag")
    assert settings["robot"] == (["scout"], "default")
    before = files(both)
    half = both / "helper" / "trials.jsonl"
    data = half.read_bytes()
    words = ("eval", "--agent", "helper", "--suite", "fake", "--participants", "16", "--dry-run")
    code, document, _ = here(*words, "--out", str(both / "helper"))
    (one,) = document["runs"]
    assert (one["played"], one["trials"], one["seconds"]) == (160, 160, 0.0)
    assert data == half.read_bytes()
    assert files(both) == before


def complete(words: str, folder: Path, shell: str = "bash") -> list[str]:
    """What the shell would offer, from a process that must not import what computes."""
    code = (
        "import sys; sys.argv = ['hthor']\n"
        "from hthor.cli import main\n"
        "try: main()\n"
        "except SystemExit: pass\n"
        "heavy = {'numpy', 'mujoco', 'numba', 'cv2', 'matplotlib', 'hthor.types'} & set(sys.modules)\n"
        "sys.exit(f'imports {heavy}' if heavy else 0)"
    )
    asked = {
        "_HTHOR_COMPLETE": f"complete_{shell}",
        "COMP_WORDS": words,
        "COMP_CWORD": str(words.count(" ")),
        "_TYPER_COMPLETE_ARGS": words,
    }
    path = os.pathsep.join((str(Path(completion.__file__).parents[2]), os.environ.get("PYTHONPATH", "")))
    environment = {**os.environ, **asked, "PYTHONPATH": path}
    done = subprocess.run([sys.executable, "-c", code], env=environment, cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout.split()


def test_the_shell_completes_values(both: Path) -> None:
    assert complete("hthor eval --agent fr", both) == ["frontier"]
    assert complete("hthor compare n", both) == ["none"]
    assert "study" in complete("hthor humans describe st", both, "zsh")[-1]


def test_what_is_offered_is_what_there_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert completion.agents() == list(plugins.names("agent"))
    assert completion.suites() == list(tasks.suite_names())
    assert completion.houses() == list(houses.names())
    assert completion.engines() == sorted(engines.engine_names())
    assert completion.robots() == sorted((*plugins.names("robot"), *robot_team.ALIASES))
    assert ["auto", *LEVELS] == completion.LEVELS
    loaded = [plugins.load("task kind", name) for name in plugins.names("task kind")]
    assert completion.kinds() == sorted({name for kind in loaded for name in (kind.name, kind.short)})
    everybody = (*population_file.names(), *kinds.names(), *plugins.names("human model"), *human_populations.WORDS)
    assert completion.people() == sorted(set(everybody))
    names = {param.name for _, one in cli_reference.leaves() for param in one.params}
    assert {offer.rpartition(" ")[2] for offer in completion.OFFERS} <= names
    (tmp_path / "runs" / "one" / "control").mkdir(parents=True)
    for folder in ("one", "one/control"):
        (tmp_path / "runs" / folder / "run.json").write_text("{}")
    monkeypatch.chdir(tmp_path)
    assert completion.runs() == ["runs/one", "runs/one/control"]
    assert completion.runs("runs/o") == completion.runs("runs/") == completion.runs()
    assert completion.runs("nowhere/") == []


@pytest.mark.parametrize(
    "words", [["robots", "list"], ["agent", "check", "nowhere.py"], ["replay", "nowhere", "0", "--mind"]]
)
def test_every_command_keeps_compiled_code_in_one_place(words: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    """Agents' processes look for it there too; without it each of them would compile for 20 s."""
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    CliRunner().invoke(app, words)
    assert os.environ["NUMBA_CACHE_DIR"] == str(code_identity.compiled())


@pytest.mark.parametrize("live", [False, True])
def test_a_run_says_that_it_compiles_only_if_it_will(
    live: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "compiled"))

    def begun(kept: int) -> str:
        heard = io.StringIO()
        watcher = progress.make_watcher(
            Console(file=heard, width=120, force_terminal=live), "frontier", quiet=False, live=live
        )
        watcher.begin(60, kept)
        watcher.close()
        return heard.getvalue()

    assert "compiling for the first run" in begun(0)
    assert "compiling for the first run" not in begun(60)
    folder = tmp_path / "compiled" / "navigation"
    folder.mkdir(parents=True)
    assert "compiling for the first run" in begun(0)
    (folder / "scan_kernel.march.nbi").touch()
    assert "compiling for the first run" not in begun(0)


@pytest.mark.parametrize("within", [False, True])
def test_names_that_are_no_text_are_refused_at_once(tmp_path: Path, within: bool) -> None:
    folder = Path(os.fsdecode(os.fsencode(tmp_path) + b"/d\xff"))
    folder.mkdir()
    (folder / "mine.py").write_text("")
    where, what = (folder, "mine.py") if within else (tmp_path, str(folder / "mine.py"))
    command = [sys.executable, "-m", "hthor", "eval", "--agent", what, "--humans", "proxy", "--json"]
    done = subprocess.run(command, cwd=where, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert "is not UTF-8" in json.loads(done.stdout)["error"]
    assert r"d\udcff" in done.stderr
    assert sorted(path.name for path in folder.iterdir()) == ["mine.py"]
