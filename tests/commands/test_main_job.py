"""The main job with the real engine and real processes: the same bytes, whatever is killed or fails; clear words."""

from __future__ import annotations

import copy
import functools
import itertools
import json
import os
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import msgspec
import pytest
from command_line import Said

from benchmarks import forging
from hthor import guest, houses, jsonio, rules, tasks
from hthor.errors import AgentError
from hthor.eval.records import find, run_isolation, scored_trial
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.records.trial_log import TrialLog
from hthor.eval.records.trial_record import TrialRecord
from hthor.eval.runner import session_runner
from hthor.leaderboard import enter
from hthor.leaderboard.entries import entry_metrics, files, trial_outcomes
from hthor.leaderboard.entries.entry import Entry
from hthor.leaderboard.entries.trial_outcomes import outcome_bytes
from hthor.leaderboard.verify.verify import draw_sample
from hthor.tasks.suite import encode_suite, make_suite
from hthor.tasks.suites.commitment import Commitment
from hthor.trials import Sources, robot_team
from hthor.trials.sessions import Session, make_sessions
from hthor.types import HUMAN

HOUSES = ("alder", "elder")
"""The smoke suite's tasks in these are enough here; `test_eval_session` deals the whole suite."""
FOLDER = Path(tempfile.mkdtemp(prefix="hthor-tests-"))
SUITE, FEW_TASKS = FOLDER / "brief.json", FOLDER / "few.json"
EVAL = ("eval", "--agent", "frontier", "--humans", "proxy", "--suite", str(SUITE), "--participants", "2", "--quiet")
EVAL += ("--no-control",)
TRIALS, FEW, SAMPLE = 12, 3, 3


@pytest.fixture(scope="module", autouse=True)
def brief() -> Iterator[tasks.Suite]:
    """A suite of two houses' tasks, in a file; another file has a few tasks of the smaller house."""
    chosen = tuple(task for task in tasks.load_suite("smoke").tasks if task.house in HOUSES)
    suite = make_suite("brief", 1, chosen)
    SUITE.write_bytes(encode_suite(suite))
    few = tuple(task for task in chosen if task.house == HOUSES[1])[:FEW]
    FEW_TASKS.write_bytes(encode_suite(make_suite("few", 1, few)))
    yield suite
    shutil.rmtree(FOLDER)


def command(*words: str) -> list[str]:
    return [sys.executable, "-m", "hthor", *words]


def hthor(*words: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(command(*words), cwd=cwd, capture_output=True, text=True, timeout=900)


def lines(folder: Path) -> list[bytes]:
    path = folder / "trials.jsonl"
    return path.read_bytes().splitlines(keepends=True) if path.exists() else []


def by_key(folder: Path) -> list[bytes]:
    return sorted(lines(folder), key=lambda line: json.loads(line)["key"])


@pytest.fixture(scope="module")
def reference(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two people with the frontier robot, played by two workers and disturbed by nobody. Not to be changed."""
    folder = tmp_path_factory.mktemp("main") / "frontier"
    done = hthor(*EVAL, "--jobs", "2", "--out", str(folder), cwd=folder.parent)
    assert done.returncode == 0, done.stderr
    return folder


@pytest.fixture
def copied(reference: Path, tmp_path: Path) -> Path:
    """A copy of the reference run, to be spoiled."""
    folder = tmp_path / "copy"
    folder.mkdir()
    for name in ("run.json", "trials.jsonl", "result.json"):
        (folder / name).write_bytes((reference / name).read_bytes())
    return folder


# ----------------------------------------------------------------------------------------------- the same bytes, always


def test_one_process_writes_the_same_records_as_two_workers(reference: Path, tmp_path: Path, say: Callable[..., Said]):
    done = say(*EVAL, "--out", tmp_path / "run", "--json")
    assert done.code == 0, done.err
    assert by_key(tmp_path / "run") == by_key(reference)
    assert len(lines(reference)) == TRIALS
    (one,), two = (
        (run["result"] for run in json.loads(done.out)["runs"]),
        json.loads((reference / "result.json").read_bytes()),
    )
    del one["effort"], two["effort"]  # what it cost is all that may differ
    assert one == two


@contextmanager
def started(*words: str, cwd: Path) -> Iterator[subprocess.Popen[str]]:
    """A command in a session of its own. All its processes, guests too, can be told by their TMPDIR."""
    with subprocess.Popen(
        command(*words),
        cwd=cwd,
        env={**os.environ, "TMPDIR": str(cwd)},
        start_new_session=True,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        try:
            yield process
        finally:
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGKILL)


def until(true: Callable[[], object], what: str) -> None:
    deadline = time.monotonic() + 900.0
    while not true():
        assert time.monotonic() < deadline, what
        time.sleep(0.005)


def processes(tmpdir: Path) -> list[str]:
    """Command lines of living processes with this TMPDIR, or, as guests have, with a folder in it."""
    mark, found = f"TMPDIR={tmpdir}".encode(), []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            state = (folder / "stat").read_text().rpartition(")")[2].split()[0]
            words = (folder / "environ").read_bytes().split(b"\0")
            if state not in "ZX" and any(word == mark or word.startswith(mark + b"/") for word in words):
                found.append((folder / "cmdline").read_bytes().replace(b"\0", b" ").decode())
        except OSError:
            continue  # it ended while we looked, or is not ours
    return found


linux = pytest.mark.skipif(sys.platform != "linux", reason="looks for processes in /proc")


@linux
@pytest.mark.parametrize(
    "kills",
    [
        pytest.param(((3, os.killpg),), id="once"),
        pytest.param(((1, os.kill), (3, os.killpg), (2, os.kill)), id="three times", marks=pytest.mark.nightly),
    ],
)
def test_killed_and_resumed_by_the_same_command(
    kills: tuple[tuple[int, Callable[[int, int], None]], ...], reference: Path, tmp_path: Path, say: Callable[..., Said]
):
    words = (*EVAL, "--jobs", "2", "--out", str(tmp_path / "run"))
    folder = tmp_path / "run"
    for more, kill in kills:
        aim = len(lines(folder)) + more
        with started(*words, cwd=tmp_path) as process:
            ended = process.poll
            until(lambda aim=aim, ended=ended: len(lines(folder)) >= aim or ended() is not None, "the run hangs")
            assert len(lines(folder)) >= aim, process.stderr.read()
            kill(process.pid, signal.SIGKILL)
            process.wait()
        until(lambda: not processes(tmp_path), "processes outlived their run")
    assert sum(more for more, _ in kills) <= len(lines(folder)) < TRIALS
    assert say(*words).code == 0
    assert by_key(folder) == by_key(reference)


PARENT = """
import subprocess
from hthor.types import Action, Wait

class Agent:
    def begin(self, briefing):
        self.child = subprocess.Popen(["sleep", "600"])
    def act(self, observation):
        return Action(motion=Wait(seconds=0.1))
"""


@linux
def test_not_even_what_an_agent_started_outlives_the_run(tmp_path: Path):
    (tmp_path / "parent.py").write_text(PARENT)
    words = (
        "eval",
        "--agent",
        "parent.py",
        "--suite",
        str(SUITE),
        "--participants",
        "1",
        "--jobs",
        "1",
        "--out",
        "run",
        "--quiet",
        "--no-control",
        "--isolation",
        "L1",  # stronger ones let no agent start anything
    )
    with started(*words, cwd=tmp_path) as process:
        until(lambda: "sleep 600 " in processes(tmp_path), "the agent never began")
        process.kill()
    until(lambda: not processes(tmp_path), "processes outlived their run")


def test_what_an_early_death_leaves_is_cleared_away(copied: Path, say: Callable[..., Said]):
    (copied / ".run.json.k1ll3d").write_text("{")
    said = say(*EVAL, "--out", copied)
    assert said.code == 0
    assert not list(copied.glob(".run.json.*"))
    (copied / "run.json").rename(copied / ".run.json.k1ll3d")
    (copied / "trials.jsonl").write_bytes(b"")
    (copied / "result.json").unlink()
    with TrialLog(copied):  # so that nothing is played: the folder was accepted, and then found busy
        assert say(*EVAL, "--out", copied).code == 75


# --------------------------------------------------------------------------------------------------------- agents


def test_a_new_agent_works_unedited_from_anywhere_beside_one_that_fails(
    tmp_path: Path, say: Callable[..., Said], monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "far").mkdir()
    assert say("agent", "new", "far/mine.py").code == 0
    written(tmp_path, act="assert observation.tick < 100, 'tired'")
    agents = ("--agent", "far/mine.py", "--agent", "agent.py")
    done = say("eval", *agents, "--suite", FEW_TASKS, "--participants", "1", "--json")
    assert done.code == 3, done.err
    mine, tired = (one["result"] for one in json.loads(done.out)["runs"])
    assert (mine["counts"]["trials"], mine["counts"]["faults"]) == (FEW, 0)
    assert (tired["counts"]["trials"], tired["counts"]["faults"] > 1) == (FEW, True)
    assert mine["isolation"]["level"] == tired["isolation"]["level"] == guest.in_force().level
    assert f"failed in {tired['counts']['faults']} of {FEW} trials" in done.err
    assert "after 10.0 s: raised: AssertionError: tired" in done.err
    assert 'File "agent.py", line' in done.err, "the agent's own frames, and none of ours"
    assert "hthor/" not in done.err.partition("Traceback")[2].partition("see:")[0]
    see = next(line for line in done.err.splitlines() if line.startswith("see:"))
    again = say(*shlex.split(see.removeprefix("see:"))[1:], "--json")
    assert again.code == 3, again.err
    rerun = json.loads(again.out)
    assert (rerun["same"], rerun["changed"]) == (True, False)
    assert rerun["left"]["failures"][0]["detail"].endswith("AssertionError: tired\n")
    assert rerun["left"]["failures"][0]["looks"][-1]["action"] is None
    folder = next((tmp_path / "runs").glob("mine-few-*"))
    assert json.loads((folder / "result.json").read_bytes()) == mine


def dealt(agent: str, count: int = 2) -> tuple[Sources, Session]:
    """Where an agent's file lies, and the first trials of its first person."""
    who = robot_team.form_team(["scout"], [agent])
    whole = make_sessions(tasks.load_suite(SUITE), agent=who, participants=1)[0]
    return Sources(agent_paths=who.agent_paths, manifests=who.manifests), msgspec.structs.replace(
        whole, trials=whole.trials[:count]
    )


def played(agent: str, count: int = 2) -> list[TrialRecord]:
    sources, session = dealt(agent, count)
    return [done.record for done in session_runner.make_runner(sources)(session)]


def test_the_example_works(root: Path):
    (record,) = played(str(root / "examples" / "sweeper.py"), 1)
    assert not record.faults
    assert len(set(record.paths["robot"])) > 10, "it goes places"


AGENT = """
import math, os, sys
import numpy as np
from hthor.types import *

class Agent:
    def begin(self, briefing):
        {begin}
    def act(self, observation):
        {act}
        return Action(motion=Wait(seconds=0.5))
"""
HARMLESS = {
    "waits": {"act": "pass"},
    "prints": {"act": "print('hello ' * 10000); os.write(1, b'hello'); sys.stdout.flush()"},
    "numpy": {"act": "return Action(motion=Rotate(yaw=np.float64(0.0), pitch=np.zeros(1)[0]))"},
    "asks for the impossible": {"act": "return Action(motion=Pick(object='no such thing'))"},
}
FAULTY = {
    "raises in begin": ({"begin": "raise ValueError('no begin')"}, "raised", "ValueError: no begin"),
    "raises in act": ({"act": "raise KeyError('x')"}, "raised", "KeyError: 'x'"),
    "hangs": ({"act": "while True: pass"}, "timeout", "gave no answer within 0.2 s"),
    "exits": ({"act": "sys.exit(3)"}, "raised", "SystemExit: 3"),
    "kills itself": ({"act": "os.kill(os.getpid(), 9)"}, "raised", "PermissionError"),
    "aborts": ({"act": "os.abort()"}, "died", "SIGABRT"),
    "gives nothing": ({"act": "return None"}, "wrong_type", "act must return an hthor.types.Action, got NoneType"),
    "gives a text as motion": ({"act": "return Action(motion='forward')"}, "garbage", "motion: Expected `object`"),
    "gives a short position": (
        {"act": "return Action(say=Send(text='x', position=np.zeros(2)))"},
        "garbage",
        "say.position: Expected `array` of length 3, got 2",
    ),
    "gives NaN": ({"act": "return Action(motion=Move(forward=math.nan))"}, "not_finite", "Move.forward"),
    "wants all memory": ({"act": "bytearray(1 << 62)"}, "raised", "MemoryError"),
}


TELLING = ("raises in begin", "hangs", "aborts", "gives NaN")
"""A fault in `begin`, a deadline, a death, and an answer that is refused; the others take one of these ways too."""


def written(folder: Path, **bodies: str) -> str:
    path = folder / "agent.py"
    path.write_text(AGENT.format(**{"begin": "pass", "act": "pass", **bodies}))
    return str(path)


@pytest.fixture(scope="module")
def idle_robot(tmp_path_factory: pytest.TempPathFactory) -> list[TrialRecord]:
    """Two trials with a robot that waits."""
    return played(written(tmp_path_factory.mktemp("idle"), act="pass"))


@pytest.mark.parametrize("name", HARMLESS)
def test_harmless_agents_have_no_faults(name: str, tmp_path: Path, idle_robot: list[TrialRecord]):
    records = played(written(tmp_path, **HARMLESS[name]))
    assert not any(record.faults for record in records)
    assert [record.paths[HUMAN] for record in records] == [record.paths[HUMAN] for record in idle_robot]


def test_a_robot_that_does_nothing_is_as_no_robot_until_its_body_is_in_the_way(idle_robot: list[TrialRecord]):
    _, session = dealt("silent")
    alone = [done.record for done in session_runner.make_runner()(session)]
    assert [one.spec.task for one in alone] == [one.spec.task for one in idle_robot]
    for none, idle in zip(alone, idle_robot, strict=True):
        met = [event.tick for event in idle.events if event.kind == "in_way"]
        until = min(met, default=idle.ticks) // rules.LOG_EVERY_TICKS
        assert until > 10
        assert none.paths[HUMAN][:until] == idle.paths[HUMAN][:until]
        assert met or none.ticks == idle.ticks
        assert not any(event.kind in ("sent", "fault") for event in idle.events)


@pytest.mark.parametrize(
    "name", [name if name in TELLING else pytest.param(name, marks=pytest.mark.nightly) for name in FAULTY]
)
def test_a_failing_agent_leaves_the_person_alone(
    name: str, tmp_path: Path, idle_robot: list[TrialRecord], monkeypatch: pytest.MonkeyPatch
):
    if name == "hangs":  # the others keep the usual limits, so that they are in time on a busy machine
        monkeypatch.setattr(guest, "Guest", functools.partial(guest.Guest, step_s=0.2, bank_s=0.0))
    bodies, kind, told = FAULTY[name]
    records = played(written(tmp_path, **bodies))
    assert len(records) == 2, "the next trial is played all the same"
    for record, idle in zip(records, idle_robot, strict=True):
        assert [fault.kind for fault in record.faults] == [kind]
        assert told in record.faults[0].detail
        assert record.paths == idle.paths, "as if the robot had stood still"
        assert scored_trial.score(record).metrics == scored_trial.score(idle).metrics


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("def oops(:\n", "agent.py:1: invalid syntax"),
        ("\0", "source code string cannot contain null bytes"),
        ("import no_such_module\n", "No module named 'no_such_module'"),
        ("raise SystemExit(5)\n", "SystemExit: 5"),
        ("x = 1\n", "no agent class found"),
        (AGENT.format(begin="pass", act="pass") + "    privileges = 5\n", "must be a tuple of names, got 5"),
    ],
)
def test_an_agent_that_does_not_load(text: str, told: str, tmp_path: Path, say: Callable[..., Said]):
    (tmp_path / "agent.py").write_text(text)
    said = say("eval", "--agent", tmp_path / "agent.py", "--out", tmp_path / "run")
    assert said.code == 4
    assert told in said.err
    assert "hthor/guest" not in said.err, "no frames of ours"
    assert not (tmp_path / "run").exists()


@pytest.mark.parametrize(
    ("words", "code", "told"),
    [
        (
            ("--isolation", "L1", "--require-isolation", "L2"),
            5,
            "isolation L2 is required, but --isolation asks for L1",
        ),
        (("--isolation", "L9"), 2, "unknown isolation level 'L9'"),
        (("--require-isolation", "L9"), 2, "unknown isolation level 'L9'"),
    ],
)
def test_less_isolation_than_required(
    words: tuple[str, ...], code: int, told: str, tmp_path: Path, say: Callable[..., Said]
):
    agent = written(tmp_path)
    said = say("eval", "--agent", agent, "--suite", SUITE, *words, "--out", tmp_path / "run")
    assert (said.code, told in said.err) == (code, True), said.err
    assert not (tmp_path / "run").exists()


def test_a_run_has_the_weakest_isolation_of_its_commands(tmp_path: Path):
    held = {level: guest.Isolation(level=level) for level in ("L1", "L2", "L3")}
    assert run_isolation.weakest_isolation(tmp_path, held["L2"], "L2") == held["L2"]
    jsonio.write(tmp_path / run_isolation.NAME, jsonio.pretty(held["L1"]))
    assert run_isolation.weakest_isolation(tmp_path, held["L3"], "") == held["L1"]
    with pytest.raises(guest.IsolationError, match="has trials played at L1"):
        run_isolation.weakest_isolation(tmp_path, held["L3"], "L2")


def test_a_file_that_changes_during_its_run_ends_it(tmp_path: Path):
    sources, session = dealt(written(tmp_path))
    written(tmp_path, act="return None")
    with pytest.raises(AgentError, match=r"agent\.py was changed while its run was going on"):
        list(session_runner.make_runner(sources)(session))


# ----------------------------------------------------------------------------------------------------- what a run holds


def test_scoring_again_gives_the_same_result(copied: Path, say: Callable[..., Said]):
    before = (copied / "result.json").read_bytes()
    assert say("score", copied, "--json").out.encode() == before
    (copied / "result.json").unlink()
    assert say("score", copied).code == 0
    now, then = json.loads((copied / "result.json").read_bytes()), json.loads(before)
    del now["effort"], then["effort"]  # no log knows what it cost
    assert now == then


def _flipped(line: bytes) -> bytes:
    """The line as if its trial had ended the other way."""
    met, missed = b'"met":true', b'"met":false'
    return line.replace(met, missed) if met in line else line.replace(missed, met)


def test_a_log_that_was_changed(copied: Path, say: Callable[..., Said]):
    whole, path = lines(copied), copied / "trials.jsonl"
    alien = json.loads(whole[7])
    alien["spec"]["seed"] = 5
    for line, told in (
        (whole[7][:300] + b"\n", "line 8: $: "),
        (whole[7].replace(b'"ticks":', b'"ticks":"many","t":'), "line 8: ticks: Expected `int`, got `str`"),
        (_flipped(whole[7]), "line 8: check: "),
        (json.dumps(alien).encode() + b"\n", "line 8: check: "),
        (whole[6], f"trial {json.loads(whole[6])['key']} is there twice"),
    ):
        path.write_bytes(b"".join([*whole[:7], line, *whole[8:]]))
        for words in (("score", copied), (*EVAL, "--out", copied)):
            said = say(*words)
            assert said.code == 2, words
            assert str(path) in said.err
            assert told in said.err
            assert "Traceback" not in said.err


def test_a_torn_last_line_is_one_trial_less(copied: Path, say: Callable[..., Said], tmp_path: Path):
    whole = lines(copied)
    (copied / "trials.jsonl").write_bytes(b"".join(whole)[:-9])
    assert f"1 of {TRIALS} trials are missing" in say("score", copied).err
    refused = say("leaderboard", "add", copied, "--board", tmp_path / "board")
    assert refused.code == 2
    assert f"lacks 1 of its {TRIALS} trials" in refused.err
    assert "hthor eval --agent frontier" in refused.err
    assert not (tmp_path / "board").exists()


def test_folders_that_cannot_be_used(copied: Path, say: Callable[..., Said], tmp_path: Path):
    with TrialLog(copied):
        busy = say(*EVAL, "--out", copied)
    assert busy.code == 75
    assert f"{copied} is being written by process {os.getpid()}" in busy.err
    other = say(*EVAL, "--seed", "9", "--out", copied)
    assert other.code == 2
    assert "seed is 0 there and 9 here" in other.err
    nowhere = say(*EVAL, "--out", copied / "run.json" / "below")
    assert nowhere.code == 2
    assert f"{copied / 'run.json' / 'below'}: Not a directory" in nowhere.err
    assert "Traceback" not in nowhere.err


@pytest.fixture
def board(reference: Path, brief: tasks.Suite, say: Callable[..., Said], tmp_path: Path) -> Path:
    """A leaderboard that knows the brief suite as an official one, with the run on it and its control."""
    both, path = tmp_path / "both", tmp_path / "commitment.json"
    shutil.copytree(reference, both / "run")
    assert say(*EVAL[:2], "silent", *EVAL[3:], "--out", both / "alone").code == 0
    made = Commitment(
        name="brief", salt="0" * 64, houses=2, tasks=TRIALS, suite_sha256=brief.sha256, files={}, made_with={}
    )
    jsonio.write(path, jsonio.pretty(made))
    assert say("leaderboard", "open", path, "--board", tmp_path / "board").code == 0
    enter.add_runs(both / "run", tmp_path / "board")
    return tmp_path / "board"


def revealing_word(claim: Entry, true: Entry, lie: Entry) -> str:
    """A word whose draw has a trial with a forged outcome; which words do depends on the platform."""
    outcomes = [[outcome_bytes(row) for row in trial_outcomes.unpack(one.trials).rows] for one in (true, lie)]
    forged = {place for place, pair in enumerate(zip(*outcomes, strict=True)) if pair[0] != pair[1]}
    assert forged
    words = map(str, itertools.count())
    return next(word for word in words if forged.intersection(draw_sample(word, claim.digest, TRIALS, SAMPLE)))


def test_leaderboard(board: Path, reference: Path, brief: tasks.Suite, say: Callable[..., Said]):
    """Put on the board, verified by real physics on this platform and as on another; a forged copy is caught."""
    here = board
    on = ("--board", here)
    assert say("leaderboard", "validate", *on).code == 0
    assert say("leaderboard", "build", "--check", *on).code == 1
    assert say("leaderboard", "build", *on).code == say("leaderboard", "build", "--check", *on).code == 0
    entry = next(here.glob("entries/frontier-*.json"))
    metrics = json.loads(entry.read_bytes())["metrics"]
    whole = json.loads((reference / "result.json").read_bytes())["metrics"]
    assert metrics == {name: whole[name] for name in metrics}

    verify = ("leaderboard", "verify", entry, "--suite", SUITE, "--json", "--sample", str(SAMPLE), "--fresh", "0")
    said = say(*verify, "--draw", "0123abcd", "--by", "a test", "--date", "2027-01-01", "--write")
    assert said.code == 0, said.err
    found = json.loads(said.out)
    for part in (found["trials"], found["control"]):
        assert (part["tier"], part["drawn"], part["passed"]) == ("V1", SAMPLE, True)
        assert part["compared"] == part["equal"] == part["same_bytes"] >= SAMPLE
        assert 0.0 < part["caught"] <= 1.0
    assert json.loads((here / "verifications" / entry.name).read_bytes()) == found
    assert say("leaderboard", "build", "--check", *on).code == 0
    assert "V1" in (here / "index.html").read_text()

    alone = next(here.glob("entries/none-*.json"))
    control, true = files.read_entry(alone), files.read_entry(entry)
    lie = forging.forged(true, 1.0, control, brief)
    elsewhere = ({**lie.platforms[0], "libc": "another"},)
    for platforms, tier in ((lie.platforms, "V1"), (elsewhere, "V2")):
        claim = msgspec.structs.replace(lie, platforms=platforms)
        files.write_document(entry, claim)
        assert say("leaderboard", "validate", *on).code == 0  # all of it follows from its trials, which never were
        said = say(*verify, "--draw", revealing_word(claim, true, lie))
        assert (said.code, json.loads(said.out)["trials"]["tier"]) == (5, tier)
    worse = forging.forged(control, 1.0, None, brief)
    uplift = entry_metrics.entry_uplift(
        true, trial_outcomes.unpack(true.trials), worse, trial_outcomes.unpack(worse.trials)
    )
    claim = msgspec.structs.replace(true, uplift=uplift)
    files.write_document(alone, worse)
    files.write_document(entry, claim)
    said = say(*verify, "--draw", revealing_word(claim, control, worse), "--write")
    parts = json.loads(said.out)
    assert (said.code, parts["trials"]["passed"], parts["control"]["passed"]) == (5, True, False)
    listed = json.loads((here / "leaderboard.json").read_bytes())
    assert [one["id"] for one in listed["refuted"]] == [control.id], "it is the control that does not stand"
    (row,) = [row for section in listed["sections"] for row in section["rows"]]
    assert (row["id"], row["uplift"]) == (true.id, None)

    text = entry.read_text().replace('"seed": 0', '"seed": 1')
    entry.write_text(text)
    said = say(*verify, "--draw", "0123abcd")
    assert said.code == 2
    assert f"{entry}: hashes.run" in said.err


def test_a_trial_is_found_by_any_of_its_names(reference: Path, say: Callable[..., Said]):
    record = find.find_trial(RunFolder(reference), "3")
    for name in (record.key[:8], record.spec.task.id):
        assert find.find_trial(RunFolder(reference), name) == record
    for wrong in (record.spec.task.id[:-1], record.spec.task.id.split("/")[-1]):
        said = say("replay", reference, wrong)
        assert said.code == 2
        assert f"unknown trial '{wrong}'. Did you mean '" in said.err
    assert (
        f"number from 0 to {TRIALS - 1}" in say("replay", reference, "99999999").err
    )  # so long that no key begins with it


def test_a_process_without_standard_streams(reference: Path):
    line = f"{sys.executable} -m hthor score {reference} --json >&- 2>&- <&-"
    assert subprocess.run(["sh", "-c", line], timeout=900).returncode == 0


# ------------------------------------------------------------------------------------------------------- broken houses


def _set(*path: Any, to: Any) -> Callable[[Any], None]:
    def spoil(house: Any) -> None:
        for step in path[:-1]:
            house = house[step]
        house[path[-1]] = to

    return spoil


DAMAGE: dict[str, Callable[[Any], object]] = {
    "walls: is missing": lambda house: house.pop("walls"),
    "objects: expected a list": _set("objects", to={}),
    "rooms: is empty": _set("rooms", to=[]),
    "rooms[0].floorPolygon[1].x: must be a finite number": _set("rooms", 0, "floorPolygon", 1, "x", to=float("nan")),
    "rooms[1].floorPolygon: ": lambda house: house["rooms"][1].update(floorPolygon=house["rooms"][0]["floorPolygon"]),
    "rooms[0].floorPolygon: needs at least 3": lambda house: house["rooms"][0]["floorPolygon"].__delitem__(slice(2, 9)),
    "rooms[1].id: ": lambda house: house["rooms"][1].update(id=house["rooms"][0]["id"]),
    "rooms[0].roomType: unknown room type": _set("rooms", 0, "roomType", to="Dungeon"),
    "doors[0].wall0: no wall has the id": _set("doors", 0, "wall0", to="wall|nowhere"),
    "walls[0].polygon: needs 4 corners": lambda house: house["walls"][0]["polygon"].pop(),
    "objects[0].assetId: unknown asset 'No_Such_1'": _set("objects", 0, "assetId", to="No_Such_1"),
    "objects[0].position.x: expected a number": _set("objects", 0, "position", "x", to="1.0"),
    "objects[1].id: ": lambda house: house["objects"][1].update(id=house["objects"][0]["id"]),
}


def _spoiled(source: Path, folder: Path, say: Callable[..., Said]) -> None:
    file, sound = folder / "spoiled.json", json.loads(source.read_bytes())
    for told, spoil in DAMAGE.items():
        house = copy.deepcopy(sound)
        spoil(house)
        file.write_text(json.dumps(house))
        _refused(file, told, say)
    file.write_bytes(source.read_bytes()[:1000])
    _refused(file, "$: not valid JSON", say)


def _refused(file: Path, told: str, say: Callable[..., Said]) -> None:
    said = say("houses", "check", file)
    assert said.code == 2, told
    assert f"{file}: {told}" in said.err
    assert "Traceback" not in said.err


@pytest.mark.parametrize(
    "name", [name if name == "cedar" else pytest.param(name, marks=pytest.mark.nightly) for name in houses.names()]
)
def test_damaged_copies_of_our_own_houses(name: str, root: Path, tmp_path: Path, say: Callable[..., Said]):
    assert say("houses", "check", name).code == 0
    _spoiled(root / "hthor" / "houses" / "data" / f"{name}.json", tmp_path, say)


def test_damaged_copies_of_a_sample_house(samples: list[Path], tmp_path: Path, say: Callable[..., Said]):
    assert say("houses", "check", samples[-1]).code == 0
    _spoiled(samples[-1], tmp_path, say)
