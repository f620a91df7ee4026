"""`hthor replay --mind`: what is heard is what was logged; beliefs, choices and answers add up; it can be seen."""

from __future__ import annotations

import json
import math
from itertools import pairwise
from pathlib import Path

import cv2
import msgspec
import pytest
from typer.testing import CliRunner

from hthor import tasks
from hthor.cli import app
from hthor.errors import HthorError, RunError
from hthor.eval.config.options import EvalOptions
from hthor.eval.planning.resolve import resolve
from hthor.eval.records import find, trial_log
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.records.trial_record import TrialRecord
from hthor.eval.replay import human_trace, session_history
from hthor.eval.replay.human_trace import HumanTrace
from hthor.eval.replay.session_history import RunFiles
from hthor.eval.runner import experiment, progress
from hthor.guest.host.info import GuestConfig
from hthor.humans.core.thoughts import Aim, Forgot, Noticed
from hthor.report.drawing import human_trace_figure, human_trace_timeline, render_trial
from hthor.report.first_person import film
from hthor.report.page import camera_frames
from hthor.tasks.suite import encode_suite, make_suite
from hthor.types import HUMAN
from hthor.types.events import Attempt

pytestmark = pytest.mark.usefixtures("no_workers")

HOUSE = "elder"
PNG = b"\x89PNG\r\n"


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A small run with the oracle: one person, two trials in one house."""
    folder = tmp_path_factory.mktemp("mind")
    smoke = tasks.load_suite("smoke")
    few = make_suite("few", 1, tuple(task for task in smoke.tasks if task.house == HOUSE)[:2])
    (folder / "few.json").write_bytes(encode_suite(few))
    options = EvalOptions(
        agent=("oracle",),
        suite=str(folder / "few.json"),
        participants=1,
        jobs=1,
        seed=4,
        out=folder / "run",
        control=False,
    )
    list(experiment.run_experiment(resolve(options), lambda _: progress.Silent()))
    return folder / "run"


@pytest.fixture(scope="module")
def heard(run: Path) -> list[tuple[TrialRecord, HumanTrace]]:
    records = [find.find_trial(RunFolder(run), str(number)) for number in range(2)]
    return [(one, human_trace.trace_human(RunFolder(run), one, RunFiles())) for one in records]


def test_a_trial_is_the_same_while_somebody_listens(heard: list[tuple[TrialRecord, HumanTrace]]) -> None:
    assert [stream.same for _, stream in heard] == [True] * 2
    assert all(stream.key == record.key for record, stream in heard)
    assert all([e.tick for e in s.events] == sorted(e.tick for e in s.events) for _, s in heard)


def test_a_trial_is_the_same_while_it_is_filmed_and_another_one_is_not_shown(run: Path) -> None:
    one = find.find_trial(RunFolder(run), "1")
    views = camera_frames.render_frames(run, one, [0, one.ticks]).views
    assert sorted(views) == [0, one.ticks]
    for seen in views.values():
        assert seen.keys() == one.paths.keys()
        assert all(view.shape == (camera_frames.SIZE[1], camera_frames.SIZE[0], 3) for view in seen.values())
    with pytest.raises(RunError, match="did not repeat as it was logged"):
        camera_frames.render_frames(run, msgspec.structs.replace(one, ticks=one.ticks - 1), [0])


@pytest.mark.parametrize(("seat", "end"), [("human", "png"), ("robot", "webm")])
def test_the_command_draws_what_a_seat_saw(
    run: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, seat: str, end: str
) -> None:
    monkeypatch.setattr(film, "film_ticks", lambda record: [0, 20, record.ticks])  # three frames, not hundreds
    out = tmp_path / f"seen.{end}"
    more = ["--video"] if end == "webm" else []
    done = CliRunner().invoke(app, ["replay", str(run), "1", "--eyes", seat, *more, "--out", str(out)])
    assert (done.exit_code, done.stdout.strip()) == (0, str(out)), done.output
    if end == "webm":
        assert cv2.VideoCapture(str(out)).get(cv2.CAP_PROP_FRAME_WIDTH) == 746, "the shape of scout's camera, and a rim"
    else:
        assert cv2.imread(str(out)).shape[1] == 1440


@pytest.mark.parametrize(
    ("more", "words"),
    [
        (["--eyes", "robot2"], "unknown seat 'robot2'"),
        (["--eyes", "human", "--out", "x.gif"], "x.gif: the name of a picture must end in .png, .svg or .pdf."),
        (["--eyes", "human", "--video", "--out", "x.mp4"], "x.mp4: the name of a video must end in .webm."),
        (["--mind", "--out", "x.jpg"], "x.jpg: the name of a picture must end in .png, .svg or .pdf."),
        (["--mind", "--eyes", "human"], "leave out --eyes and --video"),
    ],
)
def test_a_wrong_name_is_refused_before_anything_is_played(run: Path, more: list[str], words: str) -> None:
    done = CliRunner().invoke(app, ["replay", str(run), "1", *more])
    assert done.exit_code != 0
    assert words in str(done.exception) + done.output


def test_the_stream_tells_what_the_log_has_and_more(heard: list[tuple[TrialRecord, HumanTrace]]) -> None:
    for record, stream in heard:
        logged = [event.tick for event in record.journal if event.kind == "choice" and event.aim == "target"]
        thought = [event.tick for event in stream.events if event.kind == "choice" and event.aim == "target"]
        assert thought == logged
        for kind in ("attempt", "exposure", "offer"):
            assert [e for e in stream.events if e.kind == kind] == [e for e in record.journal if e.kind == kind]
        aims = [event.about for event in stream.events if event.kind == "aim"]
        assert aims[0] == "begin"
        assert all(a != b for a, b in pairwise(aims))
    kinds = {event.kind for _, stream in heard for event in stream.events}
    assert {"beliefs", "choice", "noticed", "aim", "trust", "weighed", "offer", "shown"} <= kinds


def test_beliefs_and_chances_add_up(heard: list[tuple[TrialRecord, HumanTrace]]) -> None:
    seen = 0
    for _, stream in heard:
        for event in stream.events:
            if event.kind == "beliefs":
                places, ahead = human_trace_figure.posterior(event)
                assert sum(places.values()) + ahead == pytest.approx(1.0)
            elif event.kind == "choice":
                shares = human_trace_timeline.option_chances(event, stream.traits["beta"])
                assert sum(shares.values()) == pytest.approx(1.0)
                assert event.chosen in shares
                seen += 1
    assert seen


def test_the_terms_of_an_answer_are_its_chance(heard: list[tuple[TrialRecord, HumanTrace]]) -> None:
    weighed = [event for _, stream in heard for event in stream.events if event.kind == "weighed"]
    assert weighed
    for event in weighed:
        logit = sum(event.terms[name] for name in ("a0", "trust", "gain", "load", "again"))
        share = 1.0 / (1.0 + math.exp(-logit)) if event.relevant else 0.0
        assert event.share == pytest.approx(share, abs=1e-3)


def test_trust_at_the_end_is_what_the_next_trial_begins_with(heard: list[tuple[TrialRecord, HumanTrace]]) -> None:
    courses = [[e.mean for e in stream.events if e.kind == "trust"] for _, stream in heard]
    for before, after in pairwise(courses):
        assert before[-1] == after[0]


def test_it_is_drawn(heard: list[tuple[TrialRecord, HumanTrace]], tmp_path: Path) -> None:
    record, stream = max(heard, key=lambda pair: len(pair[1].events))
    house = render_trial.load_house(tmp_path, record)
    figure = human_trace_figure.figure(record, house, stream)
    figure.savefig(tmp_path / "mind.png", dpi=40)
    assert (tmp_path / "mind.png").read_bytes().startswith(PNG)
    quiet = msgspec.structs.replace(stream, events=tuple(e for e in stream.events if e.kind == "aim"))
    human_trace_figure.figure(record, house, quiet).savefig(tmp_path / "quiet.png", dpi=40)
    assert human_trace_timeline.row_names(quiet) == ["is about"]


def test_the_command_prints_thoughts_or_draws_them(run: Path, heard: list[tuple[TrialRecord, HumanTrace]]) -> None:
    found = CliRunner().invoke(app, ["replay", str(run), "1", "--mind", "--json"])
    assert found.exit_code == 0, found.output
    told = json.loads(found.stdout)
    assert told["schema"] == human_trace.SCHEMA
    assert told["events"] == json.loads(msgspec.json.encode(heard[1][1].events))


def test_a_damaged_past_is_no_past(run: Path, tmp_path: Path) -> None:
    """Without the trials before it nobody knows how far the person trusted; from other code nothing can be told."""
    for name in ("run.json", "trials.jsonl"):
        (tmp_path / name).write_bytes((run / name).read_bytes())
    lines = (run / "trials.jsonl").read_bytes().splitlines(keepends=True)
    (tmp_path / "trials.jsonl").write_bytes(b"".join(lines[1:]))
    wanted = find.find_trial(RunFolder(tmp_path), "0")
    with pytest.raises(RunError, match="lacks some of the trials before this one in session 0"):
        human_trace.trace_human(RunFolder(tmp_path), wanted, RunFiles())
    other = msgspec.structs.replace(wanted, spec=msgspec.structs.replace(wanted.spec, code_sha256="0" * 64))
    with pytest.raises(RunError, match="another version of hthor"):
        human_trace.trace_human(RunFolder(run), other, RunFiles())


def test_whose_agent_is_a_file_needs_the_file(run: Path) -> None:
    _, record = next(trial_log.read(run / "trials.jsonl"))
    (seat,) = record.spec.robots
    agent = msgspec.structs.replace(seat.agent, name="mine", source="my_agent.py")
    spec = msgspec.structs.replace(record.spec, robots=(msgspec.structs.replace(seat, agent=agent),))
    with pytest.raises(HthorError, match=r"came from the file my_agent\.py\. Give that file, unchanged, with --agent"):
        session_history.replay_team(RunFolder(run), spec, RunFiles(), GuestConfig())


def test_a_trial_with_a_fault_repeats_itself_too(run: Path, tmp_path: Path) -> None:
    """What the agent raised names its file; the log has it without the folder, and so must the second time."""
    agent = tmp_path / "clumsy.py"
    agent.write_text(
        "from hthor.types import Action, Move\n\n\nclass Agent:\n    def begin(self, briefing): ...\n\n"
        "    def act(self, observation):\n        if observation.tick > 20:\n            raise RuntimeError('lost')\n"
        "        return Action(motion=Move(forward=0.3))\n"
    )
    one = make_suite("one", 1, tuple(task for task in tasks.load_suite("smoke").tasks if task.house == HOUSE)[:1])
    (tmp_path / "one.json").write_bytes(encode_suite(one))
    options = EvalOptions(
        agent=(str(agent),),
        suite=str(tmp_path / "one.json"),
        jobs=1,
        out=tmp_path / "run",
        max_faults="100%",
        control=False,
    )
    list(experiment.run_experiment(resolve(options), lambda _: progress.Silent()))
    faulty = find.find_trial(RunFolder(tmp_path / "run"), "0")
    assert "clumsy.py" in faulty.faults[0].detail
    assert str(tmp_path) not in faulty.faults[0].detail
    assert human_trace.trace_human(RunFolder(tmp_path / "run"), faulty, RunFiles(agents=(str(agent),))).same
    assert camera_frames.render_frames(tmp_path / "run", faulty, [0], agents=(str(agent),)).views.keys() == {0}


def test_forgetting_and_misses_have_their_marks() -> None:
    events = (
        Aim(tick=0, seat=HUMAN, about="begin"),
        Noticed(tick=5, seat=HUMAN, object="sofa", position=(1.0, 2.0, 0.4)),
        Forgot(tick=9, seat=HUMAN, object="sofa"),
        Attempt(tick=20, seat=HUMAN, what="pick", ok=False, seconds=1.0),
    )
    stream = HumanTrace(key="", seat=HUMAN, same=True, traits={"beta": 1.0}, events=events)
    assert human_trace_timeline.row_names(stream) == ["hands", "noticed", "is about"]
    assert human_trace_timeline.offers(stream) == []
