"""`hthor.evaluate`: the options of the command line from Python, what it returns, and where it may be called."""

from __future__ import annotations

import inspect
import json
import re
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import eval_fakes as fakes
import msgspec
import pytest

import hthor
from hthor import jsonio, tasks
from hthor.api import notebook
from hthor.api.evaluation import Evaluation
from hthor.errors import HthorError, UnknownName
from hthor.eval.config import option
from hthor.eval.config.options import EvalOptions
from hthor.eval.runner import session_runner
from hthor.tasks.suite import encode_suite, make_suite
from hthor.trials import robot_team

OWN = ("progress",)
"""The parameters that `hthor eval` has not, or as other options."""


@pytest.fixture
def fake(monkeypatch: pytest.MonkeyPatch, no_workers: None) -> None:
    real = tasks.load_suite
    monkeypatch.setattr(tasks, "load_suite", lambda name: fakes.suite(20) if name == "fake" else real(name))
    monkeypatch.setattr(session_runner, "make_runner", fakes.player)


def test_every_option_is_a_parameter_with_the_same_default_and_is_documented():
    shown = inspect.signature(hthor.evaluate).parameters
    known = option.fields(EvalOptions)
    assert [name for name in shown if name not in OWN] == list(known)
    assert {name: shown[name].default for name in known} == {name: one.default for name, one in known.items()}
    text = inspect.getdoc(hthor.evaluate) or ""
    assert [name for name in known if not re.search(rf"^\s*{name}: ", text, re.MULTILINE)] == []


def test_it_returns_what_the_command_prints(fake: None, hthor_json, tmp_path: Path):
    words = ("--agent", "none", "--agent", "oracle", "--suite", "fake", "--no-control", "--jobs", "1")
    told = hthor_json("eval", *words, "--out", str(tmp_path / "a"))
    found = hthor.evaluate(["none", "oracle"], suite="fake", control=False, jobs=1, out=tmp_path / "b", progress=False)
    here = json.loads(jsonio.pretty(found))
    for run in (*told["runs"], *here["runs"]):
        run["result"].pop("effort")
        run["folder"] = Path(run["folder"]).name
    assert here == told
    assert isinstance(found, Evaluation)


@pytest.fixture
def hthor_json(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]):
    from typer.testing import CliRunner

    from hthor.cli import app

    def run(*words: str):
        said = CliRunner().invoke(app, [*words, "--json"], catch_exceptions=False)
        return json.loads(said.stdout)

    return run


def test_one_run_has_a_result_and_several_say_what_to_do(fake: None, tmp_path: Path):
    one = hthor.evaluate("oracle", suite="fake", control=False, jobs=1, out=tmp_path / "one", progress=False)
    assert one.result is one.runs[0].result
    assert "success rate" in repr(one)
    assert f"files: {tmp_path}/one/" in repr(one)
    two = hthor.evaluate(["none", "oracle"], suite="fake", control=False, jobs=1, out=tmp_path / "two", progress=False)
    with pytest.raises(HthorError, match=r"has 2 runs \(0: none, 1: oracle\); take one, as in \.runs\[0\]\.result\.$"):
        _ = two.result
    html = two._repr_html_()
    assert html.count("<table>") == 1
    assert re.findall(r"<th>([\w ]+)</th>", html) == ["no robot", "oracle"]
    assert "<script" not in html


def test_a_run_is_continued_and_shown_as_the_user_wants(fake: None, tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    options = {"suite": "fake", "control": False, "jobs": 1, "out": tmp_path / "run"}
    first = hthor.evaluate("oracle", **options)
    assert "20/20 trials" in capsys.readouterr().err
    again = hthor.evaluate("oracle", **options, progress=False)
    assert capsys.readouterr() == ("", "")
    assert again == first


def test_faults_do_not_raise_and_are_told(fake: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(robot_team, "load_agent_info", lambda word, *_: fakes.character(word))
    found = hthor.evaluate("clumsy", suite="fake", control=False, jobs=1, out=tmp_path / "run", progress=False)
    counts = found.result.counts
    assert counts.faults
    assert f"an agent failed in {counts.faults} of 20 trials" in repr(found)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"agnt": "oracle"}, r"unknown option 'agnt'\. Did you mean 'agent'\?"),
        ({"jobs": 0}, r"--jobs 0: expected a whole number, at least 1\."),
        ({"jobs": True}, r"--jobs True: expected a whole number"),
        ({"seed": "3"}, r"--seed '3': expected a whole number, at least 0\."),
        ({"seed": -1}, r"--seed -1: expected a whole number, at least 0\."),
        ({"step_limit": float("nan")}, r"--step-limit nan: expected a number, at least 0\.01 and at most 3600\."),
        ({"suite": 3}, r"--suite 3: expected text\."),
        ({"house": [3]}, r"--house 3: expected text, or a list of such\."),
        ({"control": "no"}, r"--control 'no': expected true or false\."),
        ({"clock": "charge"}, r"unknown value of --clock 'charge'\. Did you mean 'charged'\?"),
        ({"difficulty": 1}, r"--difficulty 1: expected one of easy, medium, hard\."),
        ({"agent": 3}, r"agent int: give the class int, not an object of it"),
        ({"max_faults": "few"}, r"--max-faults 'few' is neither"),
        ({"suite": "smok"}, r"unknown suite 'smok'\. Did you mean 'smoke'\?"),
    ],
)
def test_a_wrong_option_is_told(given: dict[str, object], words: str):
    with pytest.raises(HthorError, match=words):
        hthor.evaluate(**{"agent": "oracle", "progress": False, **given})


def test_arguments_may_be_a_dictionary_and_none_is_the_default(monkeypatch: pytest.MonkeyPatch):
    asked: list[EvalOptions] = []

    def note(options: EvalOptions, tell: object) -> None:
        asked.append(options)
        raise UnknownName("end", "here", ())

    monkeypatch.setattr("hthor.api.evaluate.resolve", note)
    with pytest.raises(UnknownName):
        hthor.evaluate("x.py", agent_args={"gain": 2}, humans=None, house="alder", max_faults=3, step_limit=1)
    (one,) = asked
    assert (one.agent, one.agent_args, one.humans, one.house) == (("x.py",), ("gain=2",), ("proxy",), ("alder",))
    assert (one.max_faults, one.step_limit) == ("3", 1.0)


def test_a_package_that_is_only_imported_costs_nothing():
    code = "import sys, hthor; print(sorted({'numpy', 'msgspec', 'rich', 'typer', 'inspect'} & set(sys.modules)))"
    said = subprocess.run([sys.executable, "-c", f"{code}; print('evaluate' in dir(hthor))"], capture_output=True)
    assert said.stdout.split() == [b"[]", b"True"]
    with pytest.raises(AttributeError, match="no attribute 'evaluat'"):
        _ = hthor.evaluat


def test_a_cell_has_a_bar_that_goes_on(monkeypatch: pytest.MonkeyPatch):
    drawn: list[str] = []

    def display(shown: object, **_: object) -> SimpleNamespace:
        drawn.append(repr(shown))
        return SimpleNamespace(update=lambda shown: drawn.append(shown._repr_html_()))

    assert not notebook.is_here()
    shell, shown = SimpleNamespace(kernel=1), SimpleNamespace(display=display)
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=lambda: shell, display=shown))
    assert notebook.is_here()
    bar = notebook.NotebookBar("a<b")
    bar.begin(20, 5)
    bar.played(True, False)
    bar.close()
    assert drawn[0].startswith("a<b [==========  ")
    assert all('<b>a&lt;b</b> <progress value="6" max="20">' in one for one in drawn[1:])
    assert "6/20 trials, success 100 %" in drawn[-1]


SCRIPT = """
import hthor
from hthor.types import Action, Move

STEP = 0.5


class Ahead:
    def begin(self, briefing):
        pass

    def act(self, now):
        return Action(motion=Move(forward=STEP))


found = hthor.evaluate(Ahead, suite="few.json", control=False, jobs=1, out="run", progress=False)
print(found.result.name, found.result.counts.trials, found.result.counts.faults)
"""


@pytest.fixture(scope="module")
def few() -> bytes:
    short = [msgspec.structs.replace(one, time_limit=2.0, t_star=1.0) for one in tasks.load_suite("smoke").tasks[:2]]
    return encode_suite(make_suite("few", 1, tuple(short)))


@pytest.mark.slow
@pytest.mark.parametrize(
    "way", ["file", pytest.param("-c", marks=pytest.mark.nightly), pytest.param("-m", marks=pytest.mark.nightly)]
)
def test_a_script_needs_no_guard_against_being_imported_by_its_workers(few: bytes, tmp_path: Path, way: str):
    (tmp_path / "few.json").write_bytes(few)
    (tmp_path / "program.py").write_text(SCRIPT)
    words = {"file": ["program.py"], "-c": ["-c", SCRIPT], "-m": ["-m", "program"]}[way]
    said = subprocess.run([sys.executable, *words], cwd=tmp_path, capture_output=True, text=True)
    assert said.stdout == "Ahead 2 0\n", said.stderr


def _outputs(text: str) -> str:
    """What a page shows or prints, without the ends of folders' names, which every version of the code changes."""
    return re.sub(r"-[0-9a-f]{10}/", "-HASH/", "".join(f"{line.rstrip()}\n" for line in text.splitlines() if line))


@pytest.mark.slow
@pytest.mark.nightly
def test_the_page_shows_what_its_code_prints(root: Path, tmp_path: Path):
    text = (root / "docs" / "python.md").read_text()
    (tmp_path / "page.py").write_text("\n".join(re.findall(r"```python\n(.*?)```", text, re.DOTALL)))
    said = subprocess.run([sys.executable, "page.py"], cwd=tmp_path, capture_output=True, text=True)
    assert _outputs(said.stdout) == _outputs("\n".join(re.findall(r"```text\n(.*?)```", text, re.DOTALL))), said.stderr
