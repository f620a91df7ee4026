"""No agent reads a run, a log, a suite, people, a board or a salt that lies below its own folder, at any depth."""

from __future__ import annotations

import os
from pathlib import Path

import levels
import pytest

from hthor import houses, jsonio, tasks
from hthor.guest import Guest, GuestConfig, GuestFault
from hthor.guest.confinement import hidden_paths, paths
from hthor.humans.population import population_file
from hthor.tasks.suite import encode_suite, make_suite
from hthor.tasks.suites import commitment
from hthor.types import Observation, Pose
from tests.support.guest_agents import BRIEFING

LOOK = Observation(tick=0, pose=Pose(x=0.0, y=0.0, yaw=0.0), idle=True, senses=None)
RUN = jsonio.pretty({"schema": "hthor.run/9", "seed": 0})
LINE = b'{"key":"d39adb2d0789d898","spec":{"rules_sha256":"0"},"check":"2e9db6fa"}\n'
HOUSE = (Path(houses.__file__).parent / "data" / "hazel.json").read_bytes()
SECRETS = {
    "study/one/run.json": RUN,
    "study/one/trials.jsonl": LINE,
    "study/one/result.json": b"{}",
    "study/one/notes.txt": b"what came of it",
    "study/one/faults/d39adb2d0789d898.json": b"{}",
    "study/one/control/run.json": RUN,
    "a/b/c/d/e/shard-1-of-4/run.json": RUN,
    "a/b/c/d/e/shard-1-of-4/trials.jsonl": LINE,
    "early/trials.jsonl": LINE,
    "old.jsonl": LINE,
    "mine/tasks.json": encode_suite(make_suite("mine", 1, tasks.load_suite("smoke").tasks[:1])),
    "mine/houses/h1.json": HOUSE,
    "official/commitment.json": jsonio.pretty({"schema": "hthor.commitment/1", "salt": "0" * 64}),
    "official/houses/h2.json": HOUSE,
    "flat.json": HOUSE,
    "people.json": (population_file.FOLDER / "paper.json").read_bytes(),
    "people.npz": b"PK",
    "board/entries/oracle.json": jsonio.pretty({"id": "x", "schema": "hthor.entry/9"}),
    "calibrated/sessions.jsonl": b'{"key":"x","check":"2e9db6fa"}\n',
    "calibrated/design.pkl": b"...",
    ".git/config": b"",
    "runs/anything.txt": b"",
}
OWN = {
    "weights/policy.npz": b"PK",
    "weights/config.json": b'{"layers": [64, 64], "schema": "mine/1"}',
    "data/steps.jsonl": b'{"observation": 1, "action": 2}\n',
    "houses/notes.json": b'{"rooms": 4}',
    "helper.py": b"ANSWER = 42\n",
    "study/two.txt": b"not a run",
    "digest.txt": b"0" * 64 + b" weights/policy.npz\n",
}


@pytest.fixture
def home(tmp_path: Path) -> Path:
    for name, data in (SECRETS | OWN).items():
        path = tmp_path / "home" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)
    commitment.create_salt(tmp_path / "home" / "season" / "word")
    (tmp_path / "home" / "shortcut").symlink_to(tmp_path / "home" / "study" / "one")
    return tmp_path / "home"


def covered(path: Path, allowed: tuple[str, ...]) -> bool:
    return any(path.resolve().is_relative_to(Path(one).resolve()) for one in allowed)


def test_what_is_hthors_is_hidden_wherever_it_lies(home: Path) -> None:
    allowed = paths.readable_paths(str(home / "agent.py"), str(home), [])
    for name in (*SECRETS, "season/word", "shortcut/trials.jsonl"):
        assert not covered(home / name, allowed), name
    for name in OWN:
        assert covered(home / name, allowed), name


def test_a_name_that_is_no_text_is_in_no_list(home: Path) -> None:
    Path(os.fsdecode(os.fsencode(home) + b"/weights\xff.npz")).write_bytes(b"")
    allowed = paths.readable_paths(str(home / "agent.py"), str(home), [])
    assert all(jsonio.is_text(path) for path in allowed)
    assert covered(home / "weights" / "policy.npz", allowed)


def test_an_agent_that_lies_in_a_runs_folder_reads_its_own_files_still(home: Path) -> None:
    run = home / "study" / "one"
    (run / "helper.py").write_bytes(b"")
    allowed = paths.readable_paths(str(run / "agent.py"), str(run), [])
    assert covered(run / "helper.py", allowed)
    for name in ("run.json", "trials.jsonl", "faults/d39adb2d0789d898.json", "control/run.json"):
        assert not covered(run / name, allowed), name
    inner = paths.readable_paths(str(run / "code" / "agent.py"), str(home), [])
    assert not covered(run / "trials.jsonl", inner)


def test_the_walk_is_bounded_and_what_it_did_not_come_to_is_hidden(home: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    deep = home.joinpath(*("x" * 60))
    deep.mkdir(parents=True)
    (deep / "trials.jsonl").write_bytes(LINE)
    monkeypatch.setattr(hidden_paths, "_ENTRIES_MAX", 60)
    found = hidden_paths.hidden_below(home)
    assert any(deep.is_relative_to(place) for place in found)
    assert len(found) < 60


def test_a_loop_of_links_and_a_folder_that_cannot_be_read_are_passed_over(tmp_path: Path) -> None:
    (tmp_path / "self").symlink_to(tmp_path)
    (tmp_path / "closed").mkdir(mode=0)
    found = hidden_paths.hidden_below(tmp_path)
    (tmp_path / "closed").chmod(0o700)
    assert found == ()


THIEF = """
from pathlib import Path
from hthor.types import Action

class Agent:
    def begin(self, briefing): ...
    def act(self, observation):
        got = []
        for path in sorted(Path(__file__).parent.rglob("*")):
            try:
                if path.is_file() and path.name != "agent.py" and path.read_bytes():
                    got.append(path.name)
            except OSError:
                pass
        raise RuntimeError("read: " + " ".join(got))
"""


@pytest.mark.parametrize("level", ["L2", "L3"])
def test_an_agent_tries(level: str, home: Path) -> None:
    """A real one, that reads whatever it can below its folder and says what that was."""
    levels.need(level)
    (home / "agent.py").write_text(THIEF)
    with Guest(home / "agent.py", config=GuestConfig(isolation=level)) as guest:
        guest.begin(BRIEFING)
        with pytest.raises(GuestFault, match="read: ") as caught:
            guest.act(LOOK)
    read = str(getattr(caught.value, "detail", caught.value)).rpartition("RuntimeError: read: ")[2].split()
    assert set(read) == {Path(name).name for name in OWN}
