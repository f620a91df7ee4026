"""An agent is what its files say: its own, what it imports and opens, wherever it lies and whenever it does that."""

from __future__ import annotations

import functools
import importlib.util
import json
import os
import py_compile
import sqlite3
import sys
import textwrap
import threading
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import episode_fakes
import eval_fakes
import guest_fakes
import levels
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from law_cases import cases
from typer.testing import CliRunner

from hthor import guest
from hthor.cli import app
from hthor.errors import AgentError, HthorError, RunError
from hthor.eval.runner import session_runner
from hthor.guest import AgentInputs, Guest, GuestConfig, GuestFault
from hthor.guest.agent import agent_files, manifest
from hthor.guest.agent import inputs as giving
from hthor.guest.agent.agent_paths import AgentPaths
from hthor.guest.agent.manifest import File
from hthor.guest.client import file_recorder
from hthor.trials import Participants, TrialRunner, robot_team
from tests.support.guest_agents import BRIEFING, HEAD, look


def write(
    folder: Path, body: str = "", *, top: str = "", init: str = "", act: str = "", name: str = "agent.py"
) -> Path:
    """An agent's file whose methods do this besides standing still."""
    folder.mkdir(parents=True, exist_ok=True)
    parts = {"__init__(self)": init, "begin(self, briefing)": body, "act(self, observation)": act}
    methods = "".join(f"    def {head}:\n{textwrap.indent(text or 'pass', ' ' * 8)}\n" for head, text in parts.items())
    text = f"{HEAD}from pathlib import Path\nHERE = Path(__file__).parent\n{top}\nclass Agent:\n{methods}"
    (folder / name).write_text(f"{text}        return Action()\n")
    return folder / name


def names(agent: Path | str, config: GuestConfig | None = None) -> list[str]:
    """What the agent's manifest lists."""
    made = robot_team.load_agent_info(str(agent), config).manifest
    assert made is not None
    return [file.path for file in made.files]


WEIGHTS = "name = 'net' + '-' + 'big.txt'\nassert open(HERE / 'weights' / name).read()"
"""Opens a file whose name stands nowhere in the source."""


def test_a_manifest_lists_what_is_imported_and_opened_while_it_comes_up_and_begins(tmp_path: Path) -> None:
    for name, text in {
        "helper.py": "import deep.inner\n",
        "deep/__init__.py": "",
        "deep/inner.py": "from . import cousin\n",
        "deep/cousin.py": "",
        "late.py": "X = 1\n",
        "unused.py": "",
        "weights/net-big.txt": "1",
        "weights/net-small.txt": "1",
        "table.csv": "1",
        "picture.png": "1",
        "__pycache__/helper.cpython-311.pyc": "",
        "runs/old/run.json": "{}",
    }.items():
        (tmp_path / "a" / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "a" / name).write_text(text)
    act = "import late\ncv2 = None\nif False:\n    cv2.imread(str(HERE / 'picture.png'))"
    top = "import helper\nTABLE = (HERE / ('table' + '.csv')).read_text()"
    path = write(tmp_path / "a", WEIGHTS, top=top, act=act)
    assert names(path) == [
        "agent.py",
        "deep/__init__.py",
        "deep/cousin.py",
        "deep/inner.py",
        "helper.py",
        "late.py",
        "picture.png",
        "table.csv",
        "weights/net-big.txt",
    ]


WAYS_TO_OPEN = ("open(F, 'rb').read()", "os.close(os.open(F, 0))", "sqlite3.connect(F).execute('select 1')")


def test_a_file_that_changes_makes_another_agent(tmp_path: Path) -> None:
    """However the agent opens it and wherever: one agent opens nine files, each in a way and a place of its own."""
    files, opens = [], {"top": "import sqlite3\n", "init": "", "body": ""}
    for where in opens:
        for number, way in enumerate(WAYS_TO_OPEN):
            opens[where] += f"F = str(HERE / ('{where}' + '-{number}.txt'))\n{way}\n"
            files.append(tmp_path / "a" / f"{where}-{number}.txt")
    path = write(tmp_path / "a", **opens)
    for file in files:
        sqlite3.connect(file).execute("create table t (x)").connection.close()
    before = robot_team.load_agent_info(str(path))
    assert robot_team.load_agent_info(str(path)).ref == before.ref
    for file in files:
        file.write_bytes(file.read_bytes() + b" ")
    after = robot_team.load_agent_info(str(path))
    assert before.manifest is not None
    assert after.manifest is not None
    changed = manifest.differences(before.manifest.files, after.manifest.files)
    assert sorted(changed) == sorted(f"{file.name} has changed" for file in files)
    assert after.ref.sha256 != before.ref.sha256
    assert after.ref.name == before.ref.name == "agent"


def test_an_agent_is_the_same_wherever_it_lies_and_whatever_holds_it(tmp_path: Path) -> None:
    (tmp_path / "a").mkdir()
    (tmp_path / "a" / "helper.py").write_text("")
    (tmp_path / "a" / "weights").mkdir()
    (tmp_path / "a" / "weights" / "net-big.txt").write_text("1")
    path = write(tmp_path / "a", WEIGHTS, top="import helper")
    found = []
    for level in ("L1", levels.need("L2")):
        found.append(robot_team.load_agent_info(str(path), GuestConfig(isolation=level)).manifest)
    (tmp_path / "a").rename(tmp_path / "elsewhere")
    found.append(robot_team.load_agent_info(str(tmp_path / "elsewhere" / "agent.py")).manifest)
    assert found[0] == found[1] == found[2]


def test_libraries_and_this_package_are_no_part_of_an_agent_beside_them(tmp_path: Path) -> None:
    path = write(tmp_path / "a", top="import numpy, hthor.navigation")
    (tmp_path / "a" / "venv").mkdir()
    paths = Guest(path).paths
    inside = AgentPaths(root="/home/me", base="/home/me", apart=("/home/me/.venv",))
    assert paths.name(str(path)) == "agent.py"
    assert inside.name("/home/me/.venv/lib/numpy/__init__.py") is None
    assert inside.name("/home/me/x/y.py") == "x/y.py"
    assert inside.name("/home/you/y.py") is None
    assert names(path) == ["agent.py"]


def test_compiled_files_beside_an_agent_are_never_run(tmp_path: Path) -> None:
    """A compiled file that says it is of the present source, though it is of another, would run unseen."""
    folder = tmp_path / "a"
    folder.mkdir()
    path = write(folder, top="import helper", act="return Action(motion=Move(forward=helper.X))")
    for module in ("helper", "agent"):
        source = folder / f"{module}.py"
        honest = source.read_text() if source.exists() else "X = 0.25\n"
        source.write_text("X = 0.5\n" if module == "helper" else honest.replace("helper.X", "0.125   "))
        py_compile.compile(str(source), invalidation_mode=py_compile.PycInvalidationMode.UNCHECKED_HASH, doraise=True)
        source.write_text(honest)
        assert Path(importlib.util.cache_from_source(str(source))).exists()
    for level in ("L1", levels.need("L2")):
        with Guest(path, config=GuestConfig(isolation=level)) as mind:
            mind.begin(BRIEFING)
            action = mind.act(look())
        assert getattr(action.motion, "forward", None) == 0.25, level
    (folder / "helper.py").unlink()
    py_compile.compile(str(path), cfile=str(folder / "helper.pyc"))
    with pytest.raises(AgentError, match="No module named 'helper'"):
        guest.load_info(path)


def test_a_recorder_names_each_file_once_and_only_the_agents_own(tmp_path: Path) -> None:
    own = tmp_path / "own"
    own.mkdir()
    for name in ("a.txt", "b.txt"):
        (own / name).write_text("")
    (tmp_path / "other.txt").write_text("")
    recorder = file_recorder.FileRecorder(AgentPaths(root=str(own), base=str(own)))
    for path in (own / "b.txt", own / "a.txt", own / "a.txt", tmp_path / "other.txt", own / "absent", own, 3, b"\xff"):
        recorder._hear("open", (path, "r", os.O_RDONLY))
    recorder._hear("open", (own / "new.txt", "w", os.O_WRONLY))
    recorder._hear("import", ("x", None))
    assert recorder.take() == ("b.txt", "a.txt")
    assert recorder.take() == ()


@pytest.mark.parametrize("name", [b"weights\xff.npz", b"weights\n.npz"])
def test_a_file_that_no_manifest_can_list_is_not_opened_unseen(tmp_path: Path, name: bytes) -> None:
    path = os.fsencode(tmp_path) + b"/" + name
    Path(os.fsdecode(path)).write_bytes(b"")
    recorder = file_recorder.FileRecorder(AgentPaths(root=str(tmp_path), base=str(tmp_path)))
    for _ in range(2):
        with pytest.raises(PermissionError, match="printable letters"):
            recorder._hear("open", (path, "r", os.O_RDONLY))
    assert recorder.take() == ()


@given(st.lists(st.text(st.characters(codec="ascii", exclude_characters="/\0"), min_size=1, max_size=40), max_size=8))
@settings(max_examples=cases(50), suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_scanning_never_leaves_the_agents_folder(tmp_path: Path, words: list[str]) -> None:
    own = tmp_path / "own"
    own.mkdir(exist_ok=True)
    (tmp_path / "outside.txt").write_text("")
    (own / "inside.txt").write_text("")
    (own / "x.py").write_text(f"WORDS = {[*words, '../outside.txt', '..', 'inside.txt', str(tmp_path)]!r}")
    found = agent_files.referenced_files([str(own / "x.py")], AgentPaths(root=str(own), base=str(own)))
    assert found == {str(own / "x.py"), str(own / "inside.txt")}


def test_claims_about_files_that_are_not_the_agents_are_not_believed(tmp_path: Path) -> None:
    path = write(tmp_path / "a")
    (tmp_path / "secret").write_text("")
    paths = Guest(path).paths
    known = manifest.make_manifest("a", "a.py", {}, ())
    told = ("../secret", "../../etc/passwd", "/etc/passwd", "agent.py", "absent", "./agent.py", "")
    assert [file.path for file in agent_files.unlisted_files(told, known, paths)] == ["agent.py"]


def test_a_program_is_its_command_and_the_files_that_its_texts_name(tmp_path: Path) -> None:
    for name, text in {
        "mind.sh": "#!/bin/sh\n. ./lib/common.sh\ncat weights.bin\n",
        "lib/common.sh": "exec perl tool.pl\n",
        "tool.pl": "",
        "weights.bin": "1",
        "notes.md": "",
    }.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text)
    mind = Guest(f"cmd:sh {tmp_path / 'mind.sh'}")
    first = agent_files.list_files(mind.reference, AgentInputs(), mind.paths, ())
    assert [file.path for file in first] == ["lib/common.sh", "mind.sh", "tool.pl", "weights.bin"]
    (tmp_path / "weights.bin").write_text("2")
    assert agent_files.list_files(mind.reference, AgentInputs(), mind.paths, ()) != first


ARGS = """
def __init__(self, checkpoint="", speed=0.5, loud: bool = False):
    from pathlib import Path
    self.text = Path(checkpoint).read_text() if checkpoint else "none"
    self.speed, self.loud = speed, loud
def begin(self, briefing): pass
def act(self, observation):
    return Action(motion=Move(forward=self.speed), say=Send(text=f"{self.text} {self.loud}"))
"""


@pytest.fixture
def taking(tmp_path: Path) -> Path:
    """An agent that takes arguments, beside weights outside its folder."""
    (tmp_path / "own").mkdir()
    (tmp_path / "own" / "agent.py").write_text(f"{HEAD}class Agent:\n{textwrap.indent(ARGS, '    ')}")
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "net.txt").write_text("learned")
    return tmp_path / "own" / "agent.py"


@pytest.mark.parametrize("level", levels.EVERY)
def test_arguments_reach_the_constructor_and_a_file_among_them_is_readable(taking: Path, level: str) -> None:
    levels.need(level)
    out = taking.parents[1] / "out" / "net.txt"
    given = giving.parse_inputs([f"checkpoint={out}", "speed=0.25", "loud=yes"])
    with Guest(taking, config=GuestConfig(isolation=level, inputs=given)) as mind:
        mind.begin(BRIEFING)
        action = mind.act(look())
    assert action.motion is not None
    assert getattr(action.motion, "forward", None) == 0.25
    assert getattr(action.say, "text", None) == "learned True"


def test_arguments_are_part_of_who_an_agent_is(taking: Path) -> None:
    out = taking.parents[1] / "out" / "net.txt"
    found = []
    for words in ([], ["speed=0.1"], ["speed=0.2"], [f"checkpoint={out}"]):
        config = GuestConfig(inputs=giving.parse_inputs(words))
        found.append(robot_team.load_agent_info(str(taking), config))
    out.write_text("more")
    found.append(robot_team.load_agent_info(str(taking), config))
    assert len({one.ref.sha256 for one in found}) == 5
    assert [one.ref.name for one in found[:4]] == [
        "agent",
        "agent-speed-0-1",
        "agent-speed-0-2",
        "agent-checkpoint-net-txt",
    ]
    made = found[3].manifest
    assert made is not None
    assert made.args == {"checkpoint": "../net.txt"}
    assert [file.path for file in made.files] == ["../net.txt", "agent.py"]


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["chekpoint=x"], "Did you mean 'checkpoint'? It takes: checkpoint, speed, loud."),
        (["speed=fast"], "--agent-args speed=fast: the agent takes float there"),
        (["loud=perhaps"], "the agent takes bool there"),
        (["speed"], "is not KEY=VALUE"),
        (["speed=1", "speed=2"], "gives 'speed' twice"),
        (["checkpoint=../out/"], "Name the folder with --readable too"),
    ],
)
def test_wrong_arguments_are_told_apart(taking: Path, words: list[str], told: str, monkeypatch: Any) -> None:
    monkeypatch.chdir(taking.parent)
    with pytest.raises(HthorError) as caught:
        guest.load_info(taking, config=GuestConfig(inputs=giving.parse_inputs(words)))
    assert told in str(caught.value)


def test_an_agent_without_arguments_says_so(tmp_path: Path) -> None:
    with pytest.raises(AgentError, match="Its constructor takes no arguments"):
        guest.load_info(write(tmp_path / "a"), config=GuestConfig(inputs=giving.parse_inputs(["speed=1"])))


def test_a_command_gets_arguments_as_words(tmp_path: Path) -> None:
    (tmp_path / "mind.py").write_text("import sys\nprint(sys.argv[1:], file=sys.stderr)\nsys.exit(3)\n")
    with pytest.raises(AgentError, match=r"\['--speed=1', '--mode=fast'\]"):
        guest.load_info(
            f"cmd:{sys.executable} {tmp_path / 'mind.py'}",
            config=GuestConfig(inputs=giving.parse_inputs(["speed=1", "mode=fast"])),
        )


@pytest.mark.parametrize("level", levels.EVERY)
def test_what_isolation_hides_is_named_and_readable_shows_it(tmp_path: Path, level: str) -> None:
    levels.need(level)
    (tmp_path / "out" / "old").mkdir(parents=True)
    (tmp_path / "out" / "net.txt").write_text("0.25")
    (tmp_path / "out" / "old" / "run.json").write_text(json.dumps({"schema": "hthor.run/4"}))
    body = f"self.x = open({str(tmp_path / 'out' / 'net.txt')!r}).read()"
    hidden = f"open({str(tmp_path / 'out' / 'old' / 'run.json')!r}).read()"
    path = write(tmp_path / "own", body, act=hidden)
    if level != "L1":
        with Guest(path, config=GuestConfig(isolation=level)) as mind, pytest.raises(GuestFault) as caught:
            mind.begin(BRIEFING)
        assert f"The file 'net.txt' is there, but isolation {level} hides it" in caught.value.detail
        assert "--readable" in caught.value.detail
    given = giving.parse_inputs(readable=[tmp_path / "out"])
    with Guest(path, config=GuestConfig(isolation=level, inputs=given)) as mind:
        mind.begin(BRIEFING)
        if level != "L1":
            with pytest.raises(GuestFault):  # a run stays hidden
                mind.act(look())
    assert names(path, GuestConfig(isolation=level, inputs=given)) == ["../out/net.txt", "agent.py"]


def test_a_missing_environment_variable_is_explained(tmp_path: Path) -> None:
    path = write(tmp_path / "a", "os.environ['MY_KEY']")
    with Guest(path) as mind, pytest.raises(GuestFault) as caught:
        mind.begin(BRIEFING)
    assert "No environment variable of yours reaches an agent, MY_KEY neither" in caught.value.detail


def test_what_is_readable_must_be_there(tmp_path: Path) -> None:
    with pytest.raises(HthorError, match="there is no such file or folder"):
        giving.parse_inputs(readable=[tmp_path / "absent"])
    for place in ("a/w", "b/w"):
        (tmp_path / place).mkdir(parents=True)
    with pytest.raises(HthorError, match="two files or folders called 'w'"):
        giving.parse_inputs(readable=[tmp_path / "a" / "w", tmp_path / "b" / "w"])


def test_a_served_agent_says_what_it_consists_of_and_that_is_marked(taking: Path) -> None:
    pytest.importorskip("websockets")
    from hthor.guest.client import websocket_server

    out = taking.parents[1] / "out" / "net.txt"
    server = websocket_server.serve(str(taking), "127.0.0.1", 0, giving.parse_inputs([f"checkpoint={out}"]))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    try:
        url = websocket_server.address(server)
        first = robot_team.load_agent_info(url)
        made = first.manifest
        assert made is not None
        assert made.claimed
        assert made.sha256 == first.ref.sha256
        assert [file.path for file in made.files] == ["../net.txt", "agent.py"]
        with Guest(url) as mind:
            mind.begin(BRIEFING)
            assert getattr(mind.act(look()).say, "text", None) == "learned False"
        out.write_text("more")
        assert robot_team.load_agent_info(url).ref.sha256 != first.ref.sha256
        with pytest.raises(HthorError, match="--agent-args is for 'hthor agent serve' there"):
            Guest(url, config=GuestConfig(inputs=giving.parse_inputs(["speed=1"])))
    finally:
        server.shutdown()


def test_compiled_files_beside_a_program_in_python_are_not_run(tmp_path: Path) -> None:
    (tmp_path / "helper.py").write_text("raise SystemExit('stale')\n")
    py_compile.compile(
        str(tmp_path / "helper.py"), invalidation_mode=py_compile.PycInvalidationMode.UNCHECKED_HASH, doraise=True
    )
    (tmp_path / "helper.py").write_text("raise SystemExit('fresh')\n")
    (tmp_path / "mind.py").write_text("import helper\n")
    with pytest.raises(AgentError, match="fresh"):
        guest.load_info(f"cmd:{sys.executable} {tmp_path / 'mind.py'}")


def test_a_folder_with_too_many_files_is_not_made_readable(taking: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(agent_files, "_MOST_READABLE", 1)
    config = GuestConfig(inputs=giving.parse_inputs(readable=[taking.parents[1] / "out"]))
    assert len(names(taking, config)) == 2
    (taking.parents[1] / "out" / "more.txt").write_text("")
    with pytest.raises(AgentError, match=r"has more than 1 files.*Name the folders or files in there"):
        names(taking, config)


def test_what_no_source_names_can_be_made_part_of_an_agent(tmp_path: Path) -> None:
    path = write(tmp_path / "a")
    (tmp_path / "a" / "w").mkdir()
    (tmp_path / "a" / "w" / "net.bin").write_bytes(b"1")
    assert names(path) == ["agent.py"]
    config = GuestConfig(inputs=giving.parse_inputs(readable=[tmp_path / "a" / "w"]))
    assert names(path, config) == ["agent.py", "w/net.bin"]


in_force = functools.cache(guest.in_force)
"""Each command asks this by starting a guest; here the first answer counts for all."""


class Quick(TrialRunner):
    """Trials of some dozen ticks in a world without an engine."""

    def enter(self, session: Any) -> Participants:
        make = lambda seat: self._make_agent(seat, None)  # noqa: E731
        return Participants({"human": episode_fakes.Mind()}, session.trials[0].robots, make)

    def world(self, trial: Any) -> Any:
        return guest_fakes.Stage(seen=20 + trial.index)


@pytest.fixture
def evaluate(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., Any]:
    """`hthor eval` with real agents, logs and results, in a world without an engine."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(session_runner, "TrialRunner", Quick)
    monkeypatch.setattr(guest, "in_force", in_force)
    eval_fakes.play_here(monkeypatch)

    def run(*words: str) -> Any:
        fixed = ["--kind", "object_goal_navigation", "--limit", "1", "--participants", "2", "--isolation", "L1"]
        fixed += ["--no-control", "--quiet", "--json"]
        return invoke("eval", "--agent", "a/agent.py", *fixed, *words)

    return run


def told(said: Any) -> Any:
    """The result of the one run that a command played."""
    return json.loads(said.stdout)["runs"][0]["result"]


def invoke(*words: str) -> Any:
    """A command as a user types it; an error of theirs is exit code 2 and its words."""
    result = CliRunner().invoke(app, list(words))
    if isinstance(result.exception, HthorError):
        return SimpleNamespace(exit_code=2, output=str(result.exception), stdout="")
    return result


CHANGES: dict[str, tuple[dict[str, str], str]] = {
    "weights opened in __init__": ({"init": WEIGHTS}, "weights/net-big.txt"),
    "weights opened in begin": ({"body": WEIGHTS}, "weights/net-big.txt"),
    "a helper": ({"top": "import helper"}, "helper.py"),
    "a helper that is imported late": ({"act": "import helper"}, "helper.py"),
    "a file that is named": ({"act": "open(HERE / 'weights' / 'net-big.txt').read()"}, "weights/net-big.txt"),
}


def own(folder: Path, **parts: str) -> None:
    write(folder, **parts)
    (folder / "helper.py").write_text("X = 1\n")
    (folder / "weights").mkdir(exist_ok=True)
    (folder / "weights" / "net-big.txt").write_text("1")


TOLD_AT_EACH_COMMIT = ("weights opened in begin", "a helper that is imported late")
"""The file tests above open and import in every way; here a run is told from another by what they found."""


@pytest.mark.parametrize(
    "how", [how if how in TOLD_AT_EACH_COMMIT else pytest.param(how, marks=pytest.mark.nightly) for how in CHANGES]
)
def test_an_agent_that_was_changed_is_played_as_another(evaluate: Any, tmp_path: Path, how: str) -> None:
    parts, changed = CHANGES[how]
    own(tmp_path / "a", **parts)
    first = evaluate("--participants", "1")
    assert first.exit_code == 0, first.output
    before = told(first)
    assert changed in [file["path"] for file in before["agents"][0]["files"]]
    (tmp_path / "a" / changed).write_text("X = 2\n")
    after = told(evaluate("--participants", "1"))
    assert len(list((tmp_path / "runs").iterdir())) == 2
    assert after["hashes"]["run"] != before["hashes"]["run"]


def test_a_folder_of_an_agent_that_was_changed_is_refused_by_the_files_name(evaluate: Any, tmp_path: Path) -> None:
    own(tmp_path / "a", top="import helper")
    first = evaluate("--participants", "1", "--out", "mine")
    assert evaluate("--participants", "1", "--out", "mine").stdout == first.stdout  # nothing is played again
    (tmp_path / "a" / "helper.py").write_text("X = 2\n")
    refused = evaluate("--participants", "1", "--out", "mine")
    assert refused.exit_code == 2
    assert "agents.0.files.helper.py.sha256 is" in refused.output


OPENED = "name = 'net' + '-big.txt'\nopen(HERE / 'weights' / name).read()"


def test_what_is_opened_only_in_play_is_checked_before_a_run_goes_on(evaluate: Any, tmp_path: Path) -> None:
    own(tmp_path / "a", act=OPENED)
    assert names(tmp_path / "a" / "agent.py") == ["agent.py"]
    first = evaluate()
    assert first.exit_code == 0, first.output
    files = told(first)["agents"][0]["files"]
    assert [file["path"] for file in files] == ["agent.py", "weights/net-big.txt"]
    log = next((tmp_path / "runs").glob("*/trials.jsonl"))
    whole = log.read_bytes()
    lines = whole.splitlines(keepends=True)
    log.write_bytes(b"".join(lines[:1]))  # as if the command had been killed
    (tmp_path / "a" / "weights" / "net-big.txt").write_text("retrained")
    refused = evaluate()
    assert refused.exit_code == 2
    assert "weights/net-big.txt was changed since trials of this run were played with it" in refused.output
    assert log.read_bytes() == b"".join(lines[:1])
    (tmp_path / "a" / "weights" / "net-big.txt").write_text("1")
    assert evaluate().exit_code == 0
    assert sorted(log.read_bytes().splitlines()) == sorted(whole.splitlines())
    (tmp_path / "a" / "weights" / "net-big.txt").write_text("retrained")
    assert evaluate().exit_code == 2  # a finished run is not taken for that of the new weights


@pytest.mark.parametrize("changed", ["helper.py", "weights/net-big.txt"])
def test_a_file_that_changes_during_a_run_ends_it_and_is_named(
    evaluate: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, changed: str
) -> None:
    own(tmp_path / "a", top="import helper", act=OPENED)
    played: list[str] = []

    def edited(self: Any, trial: Any) -> Any:
        played.append(trial.task.id)
        if len(played) == 2:
            (tmp_path / "a" / changed).write_text("X = 2  # edited\n")
        return guest_fakes.Stage(seen=20)

    monkeypatch.setattr(Quick, "world", edited)
    ended = evaluate()
    assert ended.exit_code == 2
    assert f"{changed} was changed while its run was going on" in ended.output
    log = next((tmp_path / "runs").glob("*/trials.jsonl"))
    assert len(log.read_bytes().splitlines()) == 1


def test_shards_have_one_manifest_between_them_or_are_not_merged(evaluate: Any, tmp_path: Path) -> None:
    own(tmp_path / "a", act=OPENED)
    whole = told(evaluate("--out", "whole"))
    for shard in ("1/2", "2/2"):
        assert evaluate("--out", "part", "--shard", shard).exit_code == 0
    merge = ["merge", "part-shard-1-of-2", "part-shard-2-of-2"]
    merged = invoke(*merge, "--out", "joined")
    assert merged.exit_code == 0, merged.output
    joined = json.loads(Path("joined/result.json").read_text())
    assert joined["agents"] == whole["agents"]
    assert joined["hashes"] == whole["hashes"]
    Path("part-shard-2-of-2/trials.jsonl").unlink()
    (tmp_path / "a" / "weights" / "net-big.txt").write_text("retrained")
    assert evaluate("--out", "part", "--shard", "2/2").exit_code == 0
    refused = invoke(*merge, "--out", "mixed")
    assert refused.exit_code == 2
    assert "weights/net-big.txt was not the same in all trials of this run" in refused.output
    assert not Path("mixed").exists()


def test_files_of_readable_folders_are_part_of_the_run(evaluate: Any, tmp_path: Path) -> None:
    own(tmp_path / "a")
    (tmp_path / "more").mkdir()
    (tmp_path / "more" / "net.bin").write_bytes(b"1")
    (tmp_path / "more" / "runs").mkdir()
    found = told(evaluate("--participants", "1", "--readable", "more"))
    assert [file["path"] for file in found["agents"][0]["files"]] == ["../more/net.bin", "agent.py"]
    (tmp_path / "more" / "new.bin").write_bytes(b"2")
    again = told(evaluate("--participants", "1", "--readable", "more"))
    assert again["hashes"]["run"] != found["hashes"]["run"]


def test_differences_name_the_files() -> None:
    one, other = (
        (File(path=p, sha256=h, bytes=1) for p, h in pairs)
        for pairs in ([("a", "1"), ("b", "1")], [("b", "2"), ("c", "1")])
    )
    assert manifest.differences(one, other) == ["a is gone", "b has changed", "c is new"]


def test_two_contents_of_one_file_are_no_manifest() -> None:
    from hthor.eval.records import opened_files

    plan, sessions = eval_fakes.run_of(20)
    lines = [done for session in sessions for done in eval_fakes.records(session)]
    import msgspec

    mixed = [
        msgspec.structs.replace(one, files={"robot": (File(path="w", sha256=str(number), bytes=1),)})
        for number, one in enumerate(lines[:2])
    ]
    with pytest.raises(RunError, match="w was not the same in all trials"):
        opened_files.complete_manifests(plan, mixed)
