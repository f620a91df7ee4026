"""Boards of made-up runs that need no engine, for the tests of the leaderboard."""

from __future__ import annotations

import hashlib
import shutil
from pathlib import Path
from unittest import mock

import eval_fakes as fakes
import msgspec
import pytest

from hthor import code_identity, jsonio
from hthor.eval.records import trial_record
from hthor.leaderboard import enter, publish
from hthor.leaderboard.entries import files
from hthor.leaderboard.entries.entry import Entry
from hthor.leaderboard.entries.verification import KeeperRecords, Replayed, Verification
from hthor.leaderboard.ranking import admission
from hthor.tasks.suites.commitment import Commitment
from hthor.trials import robot_team
from hthor.types import AgentRef

COUNT = 20


@pytest.fixture(scope="module", autouse=True)
def code():
    with mock.patch.object(code_identity, "code_sha256", return_value="34" * 32):
        yield


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Runs as their folders, with the control beside them."""
    return play(tmp_path_factory.mktemp("runs"))


def play(base: Path) -> Path:
    """Write made-up runs of two agents, and one without a robot, to a folder."""
    for name in ("helper", "clumsy", "silent"):
        with mock.patch.object(fakes, "character", character):
            plan, dealt = fakes.run_of(COUNT, name=name, absent=name == "silent")
        jsonio.write(base / name / "run.json", jsonio.pretty(plan))
        made = [one for session in dealt for one in fakes.records(session)]
        made = [late(one) for one in made] if name == "clumsy" else made
        jsonio.write(base / name / "trials.jsonl", b"".join(trial_record.encode(one) for one in made))
        if name != "silent":
            held = {"level": "L3", "memory": "2048 MiB"}
            jsonio.write(base / name / "isolation.json", jsonio.pretty(held))
        else:
            text = (base / name / "run.json").read_text().replace('"silent.py"', '"hthor.agents.silent"')
            (base / name / "run.json").write_text(text)
    return base


def character(name: str = "helper", *, absent: bool = False) -> robot_team.AgentInfo:
    """Agents whose code is not the same, as their names are not."""
    return robot_team.AgentInfo(
        ref=AgentRef(name=name, source=f"{name}.py", sha256=hashlib.sha256(name.encode()).hexdigest()), absent=absent
    )


def late(one: trial_record.TrialRecord) -> trial_record.TrialRecord:
    """The same trial, but what succeeds takes three seconds longer, so that the agent is another."""
    if not one.met or one.ticks > 870:
        return one
    events = (*one.events[:-1], msgspec.structs.replace(one.events[-1], tick=one.ticks + 30))
    return trial_record.make_record(one.spec, msgspec.structs.replace(one.log, ticks=one.ticks + 30, events=events))


def committed(board: Path) -> Path:
    """A board that knows the made-up suite as an official one, and takes the made-up people."""
    suite = fakes.suite(COUNT)
    made = Commitment(
        name="fake", salt="0" * 64, houses=3, tasks=COUNT, suite_sha256=suite.sha256, files={}, made_with={}
    )
    jsonio.write(board / "suites" / "fake.json", jsonio.pretty(made))
    who = admission.Admitted(name="proxy", sha256=fakes.persons().sha256)
    files.write_document(
        board / admission.NAME, msgspec.structs.replace(admission.extended_admission(board, made), people=(who,))
    )
    return board


@pytest.fixture(scope="module")
def whole(runs: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return filled(runs, tmp_path_factory.mktemp("board"))


def filled(runs: Path, folder: Path) -> Path:
    """A board with these runs."""
    board = committed(folder)
    enter.add_runs(runs, board)
    publish.build_board(board)
    return board


@pytest.fixture
def board(whole: Path, tmp_path: Path) -> Path:
    return shutil.copytree(whole, tmp_path / "board")


def entry_of(board: Path, name: str) -> Path:
    return next(path for path in files.entry_paths(board) if path.name.startswith(name))


def contents(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def replayed(**changed) -> Replayed:
    """Trials that were played again and bear an entry out."""
    given = {"tier": "V1", "passed": True, "drawn": 1, "compared": 1, "equal": 1, "same_bytes": 1, "caught": 1.0}
    return Replayed(**{**given, "why": "tested.", **changed})


def verified(entry: Entry, /, **changed) -> Verification:
    """The keeper's verification of an entry."""
    control = None if entry.alone else replayed()
    given = {"id": entry.id, "entry": entry.digest, "draw": "x", "trials": replayed(), "control": control}
    return Verification(**{**given, "platform": "0" * 64, **changed})


def kept(*entries: Entry) -> KeeperRecords:
    """What a keeper wrote who verified these entries."""
    return KeeperRecords(verifications={one.id: verified(one) for one in entries}, refutations=())
