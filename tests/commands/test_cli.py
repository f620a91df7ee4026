"""What the command line says and returns: errors that help, data on standard output, words on standard error."""

from __future__ import annotations

import html
import json
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import eval_fakes as fakes
import pytest

from hthor import __version__, houses
from hthor.console import output, python_version
from hthor.eval.runner import session_runner
from hthor.report.drawing import render_trial
from hthor.trials import robot_team


@pytest.fixture
def done(hthor, tmp_path: Path) -> Path:
    """A finished run."""
    assert hthor("eval", "--agent", "none", "--suite", "fake", "--out", str(tmp_path / "run"), "--quiet").code == 0
    return tmp_path / "run"


def test_help_names_every_command_and_exit_code(hthor):
    said = hthor("--help")
    assert said.code == 0
    words = "eval score compare power replay leaderboard houses tasks agents agent humans robots"
    for word in words.split():
        assert word in said.out
    for code in (0, 1, 2, 3, 4, 75, 130):
        assert str(code) in said.out.split("Exit codes")[1]


def test_version(hthor):
    assert hthor("--version").out == f"hthor {__version__}\n"


@pytest.mark.parametrize(
    ("words", "hints"),
    [
        (("evla",), ("No such command 'evla'", "eval")),
        (("eval", "--agnet", "none"), ("No such option", "--agent")),
        (("houses", "chekc", "x"), ("No such command 'chekc'", "check")),
        (("eval",), ("name an agent with --agent", "--robots tall:oracle")),
        (("eval", "--robots", "tall"), ("'tall' has no agent", "--agent")),
        (("eval", "--robots", "tall:oracle", "--robot", "scout"), ("leave out --robot",)),
        (("eval", "--agent", "none", "--kind", "colect"), ("unknown kind of task 'colect'", "'collect'")),
        (("eval", "--agent", "none", "--jobs", "0"), ("--jobs", "greater than or equal to 1")),
        (
            ("eval", "--agent", "frontir", "--suite", "fake"),
            ("unknown agent 'frontir'. Did you mean 'frontier'?", "my_agent.py"),
        ),
        (("eval", "--agent", "none", "--suite", "smokey"), ("unknown suite 'smokey'",)),
        (
            ("eval", "--agent", "none", "--suite", "fake", "--humans", "prox"),
            ("unknown people 'prox'", "'proxy'", "my_human.py"),
        ),
        (("eval", "--agent", "none", "--suite", "fake", "--robot", "scuot"), ("unknown robot 'scuot'", "'scout'")),
        (
            ("eval", "--agent", "none", "--suite", "fake", "--detector", "perfect"),
            ("unknown detector 'perfect'", "own, ideal, noisy"),
        ),
        (("score", "nowhere"), ("nowhere is not a run's folder", "hthor eval")),
    ],
)
def test_wrong_usage_says_what_is_right(hthor, words, hints):
    said = hthor(*words)
    assert said.code == 2
    for hint in hints:
        assert hint in said.err
    assert said.out == ""
    assert "Traceback" not in said.err


def test_an_agent_file_that_is_missing_or_broken(hthor, tmp_path: Path):
    missing = hthor("eval", "--agent", str(tmp_path / "mine.py"), "--suite", "fake")
    assert missing.code == 4
    assert "mine.py" in missing.err
    (tmp_path / "bad.py").write_text("def oops(:\n")
    broken = hthor("eval", "--agent", str(tmp_path / "bad.py"), "--suite", "fake")
    assert broken.code == 4
    assert "bad.py" in broken.err


def test_eval_writes_what_json_shows(hthor, tmp_path: Path):
    said = hthor("eval", "--agent", "none", "--suite", "fake", "--out", str(tmp_path / "run"), "--json", "--jobs", "1")
    assert said.code == 0
    (one,) = json.loads(said.out)["runs"]
    assert one["folder"] == str(tmp_path / "run")
    assert one["result"] == json.loads((tmp_path / "run" / "result.json").read_bytes())
    assert one["result"]["counts"]["trials"] == 20


def test_the_document_of_eval_has_one_shape_however_many_agents_there_are(hthor, tmp_path: Path, monkeypatch):
    monkeypatch.setattr(robot_team, "load_agent_info", fakes.character)
    shapes = []
    for count, agents in enumerate((("helper",), ("helper", "twin")), 1):
        words = [word for agent in agents for word in ("--agent", agent)]
        said = hthor("eval", *words, "--suite", "fake", "--out", str(tmp_path / str(count)), "--json", "--jobs", "1")
        document = json.loads(said.out)
        assert [one["result"]["name"] for one in document["runs"]] == list(agents)
        assert document["peoples"] is None
        shapes.append((sorted(document), sorted(document["runs"][0])))
    assert shapes[0] == shapes[1]
    assert "20/20 trials" in said.err
    assert "success rate" in said.err


def test_eval_again_only_scores(hthor, done: Path):
    before = (done / "result.json").read_bytes()
    said = hthor("eval", "--agent", "none", "--suite", "fake", "--out", str(done))
    assert said.code == 0
    assert "20 of them played before" in said.err
    assert "success rate" in said.out
    assert f"hthor replay {done} 0" in said.out
    assert (done / "result.json").read_bytes() == before


def test_eval_of_something_else_in_the_same_folder_is_refused(hthor, done: Path):
    said = hthor("eval", "--agent", "none", "--suite", "fake", "--out", str(done), "--seed", "5")
    assert said.code == 2
    assert "seed is 0 there and 5 here" in said.err


def test_several_agents_are_compared(hthor, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    real = robot_team.load_agent_info
    monkeypatch.setattr(
        robot_team, "load_agent_info", lambda name, _: real(name) if name == "none" else fakes.character(name)
    )
    said = hthor("eval", "--agent", "none", "--agent", "clumsy", "--suite", "fake", "--out", str(tmp_path), "--quiet")
    assert said.code == 3, "done, but an agent failed in some trials"
    assert "none" in said.out
    assert "clumsy" in said.out
    assert "trials with a fault" in said.out
    assert {path.name for path in tmp_path.iterdir()} == {"none", "clumsy"}


def test_the_control_is_played_too_once_and_the_uplift_is_reported(hthor, tmp_path: Path, monkeypatch):
    real = robot_team.load_agent_info
    monkeypatch.setattr(
        robot_team, "load_agent_info", lambda name, _: real(name) if name == "none" else fakes.character(name)
    )
    words = ("eval", "--agent", "helper", "--suite", "fake", "--jobs", "1")
    said = hthor(*words, "--out", str(tmp_path / "run"))
    assert said.code == 0
    assert "no robot" in said.err
    assert "uplift: success rate" in said.out
    assert json.loads((tmp_path / "run" / "control" / "result.json").read_bytes())["name"] == "none"
    again = hthor(*words, "--out", str(tmp_path / "run"))
    assert "no robot" not in again.err
    assert "uplift: success rate" in again.out
    other = hthor(*words, "--out", str(tmp_path / "alone" / "run"), "--no-control", "--seed", "5")
    assert "uplift" not in other.out, "there is no such run for other people"


def test_runs_are_compared_and_a_worse_one_fails(hthor, tmp_path: Path, monkeypatch):
    monkeypatch.setattr(session_runner, "make_runner", fakes.leaning_player)
    real = robot_team.load_agent_info
    monkeypatch.setattr(
        robot_team, "load_agent_info", lambda name, _: real(name) if name == "none" else fakes.character(name)
    )
    agents = ("--agent", "none", "--agent", "helper")
    hthor("eval", *agents, "--suite", "fake", "--participants", "16", "--out", str(tmp_path), "--quiet")
    silent, helper = str(tmp_path / "none"), str(tmp_path / "helper")
    said = hthor("compare", silent, helper, "--fail-if-worse")
    assert said.code == 0
    assert "helper is better than no robot by" in said.out
    assert "could have seen" in said.out
    assert hthor("compare", helper, silent, "--fail-if-worse").code == 6
    document = json.loads(hthor("compare", silent, helper, "--json").out)
    assert document["schema"] == "hthor.compare/1"
    assert document["pairs"][0]["better"] == "helper"
    assert "paired" in hthor("power", silent, helper).out
    assert json.loads(hthor("power", "--rates", "0.7,0.8", "--json").out)["schema"] == "hthor.power/2"
    assert hthor("power").code == 2
    assert hthor("compare", silent).code == 2


def test_a_run_of_other_people_is_not_sent_to_the_board(hthor, tmp_path: Path, monkeypatch):
    monkeypatch.setattr(robot_team, "load_agent_info", fakes.character)
    where, board = str(tmp_path / "run"), str(tmp_path / "board")
    words = ("eval", "--agent", "helper", "--suite", "fake", "--no-control", "--out", where)
    said = hthor(*words, "--participants", "3")
    assert "not for the leaderboard: participants is 3" in said.out
    assert "hthor leaderboard add" not in said.out
    refused = hthor("leaderboard", "add", where, "--board", board)
    assert refused.code == 2
    assert refused.err.count("\n") == 1, "one sentence, no list of mismatches"
    assert "was played with --participants 3, and cannot stand on the leaderboard" in refused.err
    alike = hthor(*words[:-1], str(tmp_path / "usual"))
    assert "hthor leaderboard add" in alike.out


def test_a_between_subjects_study_is_played_continued_and_compared(hthor, tmp_path: Path, monkeypatch):
    real = robot_team.load_agent_info
    monkeypatch.setattr(
        robot_team, "load_agent_info", lambda name, *_: real(name) if name == "none" else fakes.character(name)
    )
    agents = ("--agent", "rival", "--agent", "helper", "--design", "between", "--suite", "fake")
    words = ("eval", *agents, "--participants", "12", "--out", str(tmp_path / "study"))
    dry = hthor(*words, "--dry-run")
    assert "between subjects: 12 people in groups (no robot 4, rival 4, helper 4)" in dry.out
    said = hthor(*words)
    assert sorted(path.name for path in (tmp_path / "study").iterdir()) == ["helper", "none", "rival"]
    assert "not for the leaderboard: design is between" in said.out + said.err
    assert "uplift of success" in said.out
    before = {path: path.read_bytes() for path in (tmp_path / "study").glob("*/trials.jsonl")}
    hthor("eval", "--agent", "helper", "--agent", "rival", *words[5:])
    assert {path: path.read_bytes() for path in before} == before, "the order of agents makes no difference"
    compared = hthor("compare", str(tmp_path / "study" / "none"), str(tmp_path / "study" / "helper"))
    assert "40 trials of 4 people against 40 of 4 other people" in compared.out
    assert "had different people at the same tasks" in compared.out
    one = hthor("eval", *agents[2:], "--no-control", "--out", str(tmp_path / "one"))
    assert one.code == 2
    assert "there is one condition only" in one.err
    team = hthor("eval", "--robots", "tall:helper", "--design", "between", "--suite", "fake")
    assert "name them with --agent, not --robots" in team.err


def test_an_agents_faults_are_shown_with_a_way_to_look(hthor, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(robot_team, "load_agent_info", fakes.character)
    said = hthor("eval", "--agent", "clumsy", "--suite", "fake", "--out", str(tmp_path / "run"))
    assert said.code == 3
    assert "failed in 2 of 20 trials" in said.out
    assert "Faults by kind: 2 raised." in said.out
    assert "after 7.0 s: raised: ValueError: no" in said.out
    assert "    Traceback\n" in said.out
    words = ("eval", "--agent", "clumsy", "--suite", "fake", "--out", str(tmp_path / "run"), "--quiet", "--max-faults")
    assert [hthor(*words, most).code for most in ("1", "2", "9%", "10%", "x")] == [3, 0, 3, 0, 2]


def _printed(text: str) -> list[str]:
    """Commands that a page or a command's words tell the reader to type."""
    return [
        html.unescape(one).strip()
        for one in re.findall(r"(?:<code>|<pre>|^next: |^see: |^ {6,})\s*(hthor [^<\n]+)", text, re.M)
    ]


def test_every_command_that_a_report_and_an_evaluation_print_can_be_typed(hthor, tmp_path: Path, monkeypatch):
    monkeypatch.chdir(tmp_path)

    def introduce(text, _):  # the fakes' source is a file, so that is what a command names
        name = text.removesuffix(".py")
        return fakes.character(name, absent=name == "none")

    monkeypatch.setattr(robot_team, "load_agent_info", introduce)
    drawn: list[str] = []
    hazel = houses.load("hazel")
    monkeypatch.setattr(render_trial, "load_house", lambda *_: hazel)
    monkeypatch.setattr(render_trial, "draw_trial", lambda run, record, path, video: drawn.append(record.key))
    words = ("--suite", "fake", "--out", "my runs/demo", "--jobs", "1")
    said = hthor("eval", "--agent", "none", "--agent", "helper", "--agent", "clumsy", *words)
    single = hthor("eval", "--agent", "helper", "--suite", "fake", "--out", "my runs/one", "--jobs", "1")
    next_ones = [one for one in _printed(single.out) if "leaderboard" not in one]
    assert next_ones == ["hthor replay 'my runs/one' 0", "hthor score 'my runs/one' --all"]
    assert hthor("report", "my runs/demo/helper", "my runs/demo/clumsy", "--out", "rep").code == 0
    page = (tmp_path / "rep" / "report.html").read_text(encoding="utf-8")
    # An unmarked run is drawn as a block of several lines.
    listed = [line for one in re.findall(r"<pre>(.*?)</pre>", page, re.S) for line in html.unescape(one).splitlines()]
    commands = [*next_ones, *_printed(page), *(line for line in listed if line.startswith("hthor "))]
    assert {one.split()[1] for one in commands} >= {"replay", "score", "eval"}
    for one in dict.fromkeys(commands):
        typed = shlex.split(one)[1:]
        if typed[:2] == ["agent", "run"]:  # plays with a guest; the folder that it names has to be there
            assert (Path(typed[-2]) / "run.json").is_file(), one
        else:
            done = hthor(*typed)
            assert done.code in ((0, 3) if "clumsy" in one else (0,)), (one, done.err)
    assert drawn
    assert said.code == 3
    assert sorted(path.name for path in tmp_path.glob("**/run.json")) == ["run.json"] * 5, (
        "nothing was played elsewhere"
    )


def test_a_report_without_a_control_names_the_command_that_plays_it(hthor, tmp_path: Path, monkeypatch):
    fakes.play_here(monkeypatch)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(robot_team, "load_agent_info", lambda name, _: fakes.character(name, absent=name == "none"))
    assert hthor("eval", "--agent", "helper", "--suite", "fake", "--no-control", "--quiet").code == 0
    run = next((tmp_path / "runs").iterdir())
    hazel = houses.load("hazel")
    monkeypatch.setattr(render_trial, "load_house", lambda *_: hazel)
    assert hthor("report", str(run), "--out", "rep").code == 0
    told = json.loads((tmp_path / "rep" / "report.json").read_bytes())["origins"][0]["alone"]
    assert html.escape(told, quote=False) in html.unescape((tmp_path / "rep" / "report.html").read_text("utf-8"))
    assert hthor(*shlex.split(told)[1:]).code == 0
    assert "uplift: success" in hthor("score", str(run)).out


def test_what_the_people_were_not_calibrated_for_is_said_once_and_last(hthor, tmp_path: Path, monkeypatch):
    monkeypatch.setattr(robot_team, "load_agent_info", lambda name, _: fakes.character(name, absent=name == "none"))
    agents = ("--agent", "none", "--agent", "helper", "--agent", "twin")
    said = hthor("eval", *agents, "--suite", "fake", "--out", str(tmp_path), "--jobs", "1")
    told = [line for line in said.out.splitlines() + said.err.splitlines() if "was calibrated" in line]
    assert told == [said.out.splitlines()[-1]]
    assert told[0].startswith("note: the population study was calibrated on the tasks of the suite paper, not on th")
    assert "silent" not in said.out
    assert "no robot" in said.out
    scored = hthor("score", str(tmp_path / "helper"))
    assert (scored.out + scored.err).count("was calibrated") == 1


def test_each_thing_has_one_word_and_the_words_of_before_are_read(hthor, tmp_path: Path):
    for words, name, before in ((("agents", "list"), "none", "silent"), (("humans", "list"), "study", "paper")):
        listed = [row["name"] for row in json.loads(hthor(*words, "--json").out)]
        assert name in listed
        assert before not in listed
    runs = []
    for agent, people in (("none", "study"), ("silent", "paper")):
        folder = tmp_path / agent
        words = ("--agent", agent, "--humans", people, "--suite", "fake", "--out", str(folder), "--quiet")
        assert hthor("eval", *words, "--jobs", "1").code == 0
        runs.append((folder / "run.json").read_bytes())
    assert runs[0] == runs[1]


def test_another_clock_is_another_run_and_says_so(hthor, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(robot_team, "load_agent_info", fakes.character)
    monkeypatch.chdir(tmp_path)
    modes = {}
    for words in ((), ("--clock", "charged")):
        said = hthor("eval", "--agent", "helper", "--suite", "fake", "--no-control", "--json", *words)
        result = json.loads(said.out)["runs"][0]["result"]
        modes[result["mode"]] = result["hashes"]["run"], result["hashes"]["trials"]
        assert ("charged clock" in said.err) == bool(words)
    assert modes.keys() == {"lockstep", "charged"}
    assert len({*modes["lockstep"], *modes["charged"]}) == 4
    late, soon = sorted((tmp_path / "runs").iterdir(), key=lambda folder: "-charged-" not in folder.name)
    assert "-charged-" in late.name
    assert hthor("score", str(late)).code == 0
    (soon / "trials.jsonl").write_bytes((late / "trials.jsonl").read_bytes())
    assert "spec.clock is not the one in run.json" in hthor("score", str(soon)).err


def test_faults_of_several_robots_are_told_apart(hthor, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(robot_team, "load_agent_info", fakes.character)
    folder = str(tmp_path / "run")
    said = hthor("eval", "--robots", "tall:clumsy,small:other", "--suite", "fake", "--out", folder)
    assert said.code == 3
    assert "tender-clumsy+puck-other: fake, 20 trials" in said.out
    assert "An agent failed in 2 of 20 trials (robot in 2); there the others continued without it." in said.out
    assert "robot (clumsy), after 7.0 s: raised: ValueError: no" in said.out
    brief, full = hthor("score", folder).out, hthor("score", folder, "--all").out
    for row in ("human idle", "messages sent, a trial", "messages that were false", "share of the work: robot2"):
        assert row not in brief
        assert row in full
    assert "by kind of task" in full


def test_score_says_whether_it_agrees(hthor, done: Path):
    assert "equal to" in hthor("score", str(done)).err
    document = json.loads((done / "result.json").read_bytes())
    document["metrics"]["sr"]["mean"] = 1.0
    (done / "result.json").write_text(json.dumps(document))
    said = hthor("score", str(done), "--json")
    assert "differs from" in said.err
    assert "in metrics" in said.err
    assert json.loads(said.out)["metrics"]["sr"]["mean"] < 1.0
    assert "equal to" in hthor("score", str(done)).err


def test_score_of_a_part_is_shown_but_not_stored(hthor, done: Path):
    (done / "result.json").unlink()
    path = done / "trials.jsonl"
    path.write_bytes(b"".join(path.read_bytes().splitlines(keepends=True)[:5]))
    said = hthor("score", str(done))
    assert said.code == 0
    assert "15 of 20 trials are missing" in said.err
    assert not (done / "result.json").exists()


def test_a_run_that_is_spelt_wrong_is_guessed(hthor, done: Path):
    said = hthor("score", str(done.parent / "ran"))
    assert said.code == 2
    assert f"Did you mean '{done}'?" in said.err


def test_a_calibration_is_foretold_and_nothing_written(hthor, tmp_path: Path):
    said = hthor("calibrate", "--quick", "--seed", "7", "--out", str(tmp_path / "new"), "--dry-run", "--json")
    assert said.code == 0
    document = json.loads(said.out)
    assert (document["seed"], document["quick"], document["resumes"]) == (7, True, False)
    assert not (tmp_path / "new").exists()


def test_replay_names_what_it_cannot_find(hthor, done: Path):
    said = hthor("replay", str(done), "t00")
    assert said.code == 2
    assert "unknown trial 't00'. Did you mean 't0" in said.err
    assert "number from 0 to 19" in said.err
    wrong = hthor("replay", str(done), "0", "--out", "x.gif")
    assert wrong.code == 2
    assert ".png" in wrong.err


@pytest.mark.parametrize("words", [("houses",), ("tasks",), ("agents",), ("humans",), ("robots",)])
def test_lists_agree_with_their_json(hthor, words):
    rows = json.loads(hthor(*words, "list", "--json").out)
    table = hthor(*words, "list").out
    assert rows
    for row in rows:
        assert row["name"] in table


def test_tasks_of_a_suite(hthor):
    rows = json.loads(hthor("tasks", "list", "fake", "--json").out)
    assert len(rows) == 20
    assert rows[0]["instruction"] == "Find the apple."


def test_a_broken_house_and_a_sound_one(hthor, tmp_path: Path):
    (tmp_path / "broken.json").write_text("{}")
    broken = hthor("houses", "check", str(tmp_path / "broken.json"))
    assert broken.code == 2
    assert "broken.json" in broken.err
    name = json.loads(hthor("houses", "list", "--json").out)[0]["name"]
    sound = hthor("houses", "check", name, "--radius", "0.2")
    assert sound.code == 0
    assert "sound" in sound.out
    assert hthor("houses", "check", name, "--radius", "1.5").code == 1


def test_a_new_agent_is_not_written_over(hthor, tmp_path: Path):
    path = tmp_path / "mine.py"
    assert hthor("agent", "new", str(path)).code == 0
    text = path.read_text()
    assert hthor("agent", "new", str(path)).code == 2
    path.write_text("changed")
    assert hthor("agent", "new", str(path), "--force").code == 0
    assert path.read_text() == text
    assert "check '" in hthor("agent", "new", str(tmp_path / "my own.py")).err, "what is to be typed next can be typed"


def test_what_looks_like_a_picture_is_a_name(capsys: pytest.CaptureFixture[str]):
    output.put_line("two.py:B: sound")
    assert capsys.readouterr().out == "two.py:B: sound\n"


@pytest.mark.parametrize("words", [("--version",), ("agents", "list"), ("agents", "list", "--json")])
def test_whoever_stops_reading_is_no_failure(words: tuple[str, ...]):
    process = subprocess.Popen([sys.executable, "-m", "hthor", *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert process.stdout is not None
    assert process.stderr is not None
    process.stdout.close()
    assert (process.stderr.read(), process.wait(900)) == (b"", 0)
    process.stderr.close()


def _process(*words: str, **environment: str) -> subprocess.CompletedProcess[str]:
    bare = {name: value for name, value in os.environ.items() if name not in ("NO_COLOR", "FORCE_COLOR", "COLUMNS")}
    return subprocess.run(
        [sys.executable, "-m", "hthor", *words],
        env={**bare, **environment},
        capture_output=True,
        text=True,
        timeout=900,
    )


def test_colours_survive_a_pipe_only_when_forced():
    assert "\x1b[" not in _process("tasks", "--help").stdout
    assert "\x1b[" not in _process("tasks", "--help", GITHUB_ACTIONS="true").stdout
    assert "\x1b[" in _process("tasks", "--help", FORCE_COLOR="1").stdout
    assert "\x1b[3" not in _process("tasks", "--help", FORCE_COLOR="1", NO_COLOR="1").stdout


def test_help_imports_nothing_heavy():
    code = (
        "import sys; sys.argv = ['hthor', '--help']\n"
        "from hthor.cli import main\n"
        "try: main()\n"
        "except SystemExit: pass\n"
        "heavy = {'numpy', 'mujoco', 'dm_control', 'numba', 'cv2', 'matplotlib', 'scipy', 'torch'} & set(sys.modules)\n"
        "sys.exit(f'imports {heavy}' if heavy else 0)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=900)
    assert done.returncode == 0, done.stderr


def test_another_python_is_told_so(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]):
    monkeypatch.setattr(sys, "version_info", (3, 13, 1, "final", 0))
    with pytest.raises(SystemExit) as end:
        python_version.check()
    assert end.value.code == 2
    assert "hthor needs Python 3.11 or 3.12, this is Python 3.13.1" in capsys.readouterr().err
