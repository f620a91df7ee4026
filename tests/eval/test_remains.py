"""What a failed agent leaves behind helps its author, is the same wherever its file lies, and fills no disk."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import eval_fakes as fakes
import msgspec
import pytest

from hthor.episode import Fault
from hthor.errors import RunError
from hthor.eval.runner import fault_report
from hthor.eval.runner.fault_report import RecordedAgent
from hthor.eval.runner.messages import TrialDone, TrialOutcome
from hthor.eval.runner.worker import SessionPlayer
from hthor.trials.sessions import Session
from hthor.types import Action, Observation, Pose

TRIAL = fakes.run_of()[1][0].trials[0]


def look(tick: int) -> Observation:
    return Observation(tick=tick, pose=Pose(x=1.0, y=2.0), idle=True, senses=None)


class Tired:
    log = "x" * 20_000 + "last words"

    def begin(self, briefing: object) -> None:
        pass

    def act(self, observation: Observation) -> Action:
        if observation.tick >= 30:
            raise ValueError("tired")
        return Action()


def left(key: str, kind: str = "raised") -> fault_report.FaultReport:
    mind = RecordedAgent(Tired())
    mind.begin(None)
    for tick in range(30):
        mind.act(look(tick))
    with pytest.raises(ValueError):
        mind.act(look(30))
    fault = Fault(seat="robot", kind=kind, tick=30, detail="ValueError: tired")
    return fault_report.describe_faults(key, TRIAL, [fault], {"robot": mind})


def test_the_last_looks_and_the_last_words_are_kept_and_read_again(tmp_path: Path):
    fault_report.FaultArchive(tmp_path, "hthor agent run x").keep(left("ab"))
    (failure,) = fault_report.load_fault_report(tmp_path / "faults" / "ab.json").failures
    assert [one.tick for one in failure.looks] == list(range(11, 31))
    assert [one.action is None for one in failure.looks] == [False] * 19 + [True]
    assert failure.output.endswith("last words")
    assert len(failure.output) == 8000
    assert fault_report.rerun_command(tmp_path, "ab") == "hthor agent run x ab"
    assert fault_report.rerun_command(tmp_path, "none") == ""
    (tmp_path / "faults" / "ab.json").write_text("{}")
    with pytest.raises(RunError, match=r"ab\.json.*delete it"):
        fault_report.load_fault_report(tmp_path / "faults" / "ab.json")


def test_a_thousand_faults_fill_no_disk(tmp_path: Path):
    for command in range(2):  # the second one resumes
        keeper = fault_report.FaultArchive(tmp_path)
        for number in range(500):
            keeper.keep(left(f"{command}-{number}", "raised" if number % 5 else f"odd{number}"))
    kept = [fault_report.load_fault_report(path).failures[0].kind for path in (tmp_path / "faults").glob("*.json")]
    assert kept.count("raised") == fault_report.MOST_OF_A_KIND
    assert len(kept) == fault_report.MOST
    assert sum(path.stat().st_size for path in (tmp_path / "faults").iterdir()) < 8 << 20


def test_a_report_travels_with_the_message_of_its_trial():
    """Two workers in one process, turn by turn: each report comes with its own trial, and is kept nowhere else."""
    _, dealt = fakes.run_of(20, name="clumsy")

    def make(session: Session) -> Iterator[TrialOutcome]:
        for done in fakes.player()(session):
            yield msgspec.structs.replace(done, fault_report=left(done.record.key) if done.record.faults else None)

    streams = [SessionPlayer(lambda: make).run(session) for session in dealt]
    for pair in zip(*streams, strict=True):
        for message in pair:
            if isinstance(message, TrialDone):
                assert (message.fault_report.key if message.fault_report else "") == message.key * message.faulty


def test_a_faults_words_are_the_same_wherever_the_file_lies(tmp_path: Path):
    text = 'File "{}/lib/a.py", line 3\n<Thing object at {}> not in {}/x and "{}"'
    told = set()
    for folder, address, scratch in (
        ("one", "0x7f3a00112233", "/tmp/hthor-guest-a_b1c2d3"),
        ("two", "0x5566778899", "/tmp/hthor-guest"),
    ):
        file = tmp_path / folder / "agent.py"
        words = text.format(file.parent, address, scratch, scratch)
        told.add(fault_report.redact(words, [str(file), f"{tmp_path}/else.py:Agent"]))
        told.add(fault_report.redact(words, [os.path.relpath(file) + ":Agent"]))
    assert told == {'File "lib/a.py", line 3\n<Thing object at 0x...> not in $TMPDIR/x and "$TMPDIR"'}
