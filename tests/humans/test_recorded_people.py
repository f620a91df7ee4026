"""People who act 60 times a second: their inputs are in the journal, and `recorded` repeats the trial from them."""

from __future__ import annotations

import itertools
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import msgspec
import pytest
import world_house as tiny
from hypothesis import given, settings
from hypothesis import strategies as st
from law_cases import cases
from typer.testing import CliRunner
from world_house import COFFEE, on

from hthor.cli import app
from hthor.episode import Charged, EpisodeLog, play
from hthor.errors import HthorError
from hthor.eval.records import trial_record
from hthor.humans.core.recorded_inputs import RecordedInputs
from hthor.humans.models import recorded
from hthor.humans.population.participant import Participant
from hthor.types import (
    HUMAN,
    SUBTICKS,
    Action,
    AgentRef,
    Controls,
    Drive,
    Goal,
    HumanSeat,
    Move,
    Pick,
    Place,
    Pose,
    Reply,
    RobotSeat,
    Rotate,
    Send,
    Show,
    TrialSpec,
    Wait,
)
from hthor.types.events import Accepted, Acted, Declined, Displayed, Inputs, JournalEntry, Note, Shown
from hthor.world import World

SEAT = RobotSeat(seat="robot", robot="scout", agent=AgentRef(name="teller", source="", sha256=""))
SIXTY_HERTZ = Path(__file__).parents[1] / "support" / "sixty_hertz_person.py"


@pytest.fixture(scope="module")
def world() -> World:
    return World(tiny.house(), robots=("scout",), objects=[("apple", "apple")])


def trial(seconds: float = 12.0, index: int = 0) -> TrialSpec:
    plain = tiny.task(on(COFFEE, "apple"), robots=(Pose(x=9.4, y=1.0),))
    goal = Goal(target="apple", relation="on", destination="dining_table")
    task = msgspec.structs.replace(
        plain, kind="mobile_manipulation", goal=goal, instruction="Bring the apple.", time_limit=seconds
    )
    humans = (HumanSeat(seat=HUMAN, model="scripted", sha256="0", participant=0),)
    hashes = dict.fromkeys(("suite_sha256", "rules_sha256", "code_sha256"), "0")
    return TrialSpec(task=task, robots=(SEAT,), humans=humans, session=0, index=index, seed=0, **hashes)


class Teller:
    """A robot that sends a message every two seconds, and turns."""

    def begin(self, briefing: Any) -> None:
        self.said = 0

    def act(self, observation: Any) -> Action:
        say = None
        if observation.tick >= 20 * (self.said + 1):
            self.said += 1
            say = Send(text="It is here.", object="apple", position=(3.0, 1.0, 0.5))
        return Action(motion=Rotate(yaw=0.3) if self.said % 2 else Wait(seconds=0.3), say=say)


class Scripted:
    """A person who does at each frame what a script says.

    ``script``: what is done at a frame, by its number: a `Drive`, an `Action`, "look", or "accept" and "decline" for
    the newest message that was looked at.
    """

    def __init__(self, script: Mapping[int, Sequence[Any]]) -> None:
        self.script = script

    def begin(self, briefing: Any) -> None:
        self.seen: Any = None
        self.drive = Drive()

    def frame(self, controls: Controls) -> None:
        for deed in self.script.get(controls.tick * SUBTICKS + controls.step, ()):
            if isinstance(deed, Drive):
                self.drive = deed
                controls.steer(deed)
            elif isinstance(deed, Action):
                controls.submit(deed, self.seen)
            elif deed == "look":
                self.seen = controls.observe() if controls.step == 0 else self.seen
            elif self.seen is not None and self.seen.inbox:
                reply = Reply(message=self.seen.inbox[-1].id, accept=deed == "accept")
                controls.submit(Action(motion=self.drive, say=reply))

    def rate(self, met: bool, tick: int) -> int | None:
        return 5

    @property
    def journal(self) -> tuple[Note, ...]:
        return (Note(tick=3, seat=HUMAN, topic="script", values={"frames": len(self.script)}),)


def repeated(world: World, spec: TrialSpec, log: EpisodeLog, folder: Path) -> EpisodeLog:
    """The trial once more, from its line in a log."""
    (folder / "trials.jsonl").write_bytes(trial_record.encode(trial_record.make_record(spec, log)))
    person = recorded.Model(Participant(seed=0, number=0), {"trials": spec.index}, str(folder))
    return play(spec, world, {HUMAN: person}, {"robot": Teller()})


class Repeater:
    """Repeats the inputs of one seat of a log, a person's or a robot's."""

    def __init__(self, seat: str, log: EpisodeLog) -> None:
        self.inputs = RecordedInputs(seat, log.events, log.journal, log.ticks)
        assert self.inputs.found

    def begin(self, briefing: Any) -> None:
        """Nothing to prepare."""

    def frame(self, controls: Controls) -> None:
        self.inputs.frame(controls)

    def rate(self, met: bool, tick: int) -> int | None:
        return 5

    @property
    def journal(self) -> tuple[JournalEntry, ...]:
        return self.inputs.own_journal


def delivery() -> dict[int, list[Any]]:
    """Walks with a swaying head, reads and answers, picks up the apple, and hides the panel; all between two ticks."""
    script: dict[int, list[Any]] = {}
    for frame in range(700):
        script[frame] = [Drive(forward=0.6 if frame < 80 else 0.0, yaw=0.0007 * frame, pitch=-0.2 + 0.0003 * frame)]
        script[frame] += ["look"] if frame % SUBTICKS == 0 else []
    script[250].append("decline")
    script[381].append("accept")
    script[403].append(Action(motion=Pick(object="apple")))
    script[433].append(Action(motion=Drive(), signals=(Show(what="map", on=False),)))
    script[435].append(Action(motion=Drive(), signals=(Show(what="map", on=True),)))
    return script


def test_a_recorded_trial_is_repeated_byte_for_byte(world: World, tmp_path: Path) -> None:
    spec = trial()
    log = play(spec, world, {HUMAN: Scripted(delivery())}, {"robot": Teller()})
    kinds = {type(event) for event in log.events if event.seat == HUMAN}
    assert {Shown, Declined, Accepted, Displayed} <= kinds
    again = repeated(world, spec, log, tmp_path)
    assert again == log
    assert trial_record.encode(trial_record.make_record(spec, again)) == (tmp_path / "trials.jsonl").read_bytes()


def test_the_journal_has_every_press_with_its_time(world: World) -> None:
    log = play(trial(), world, {HUMAN: Scripted(delivery())}, {"robot": Teller()})
    acted = [entry for entry in log.journal if isinstance(entry, Acted)]
    assert [SUBTICKS * entry.tick - entry.early for entry in acted] == [250, 381, 403, 433, 435]
    assert [entry.tick for entry in acted] == [42, 64, 68, 73, 73]
    (inputs,) = [entry for entry in log.journal if isinstance(entry, Inputs)]
    frames = [SUBTICKS * tick + step for tick, step in zip(inputs.runs[::6], inputs.runs[1::6], strict=True)]
    assert len(frames) > 600
    assert frames == sorted(frames)


def test_a_press_takes_effect_as_the_next_tick_begins(world: World) -> None:
    script = delivery()
    log = play(trial(), world, {HUMAN: Scripted(script)}, {"robot": Teller()})
    ticks = [event.tick for event in log.events if isinstance(event, (Accepted, Declined))]
    assert ticks == [42, 64]


motions = st.sampled_from(
    [
        Wait(),
        Move(forward=0.3),
        Pick(object="apple"),
        Place(on=COFFEE),
        Drive(forward=0.4, yaw=1.0),
        Pick(object="pear"),
    ]
)
numbers = st.floats(-1.5, 1.5)
deeds = st.one_of(
    st.builds(Drive, forward=numbers, left=numbers, yaw=st.floats(-4.0, 4.0), pitch=numbers),
    st.builds(Action, motion=motions, signals=st.sampled_from([(), (Show(what="map", on=False),)])),
    st.builds(Action, motion=motions, say=st.builds(Send, text=st.sampled_from(["Where?", "Wait."]))),
    st.sampled_from(["look", "accept", "decline"]),
)


@settings(max_examples=cases(15))
@given(st.dictionaries(st.integers(0, 60 * 8), st.lists(deeds, min_size=1, max_size=3), min_size=2, max_size=25))
def test_whatever_a_person_does_is_repeated(
    world: World, tmp_path_factory: pytest.TempPathFactory, script: dict[int, list[Any]]
) -> None:
    script.setdefault(0, []).append(Drive(yaw=0.1))
    spec = trial(8.0)
    log = play(spec, world, {HUMAN: Scripted(script)}, {"robot": Teller()})
    assert repeated(world, spec, log, tmp_path_factory.mktemp("run")) == log


def test_after_the_end_of_its_log_a_recorded_person_stands_still(world: World) -> None:
    script = {0: [Drive(forward=0.2, yaw=0.3)]}
    log = play(trial(2.0), world, {HUMAN: Scripted(script)}, {"robot": Teller()})
    longer = play(trial(4.0), world, {HUMAN: Repeater(HUMAN, log)}, {"robot": Teller()})
    path = longer.paths[HUMAN]
    assert path[: len(log.paths[HUMAN])] == log.paths[HUMAN]
    assert path[11][:2] == path[-1][:2] != path[9][:2]


@settings(max_examples=cases(15))
@given(st.lists(st.floats(0.0, 0.9), min_size=5, max_size=30))
def test_a_trial_in_which_thinking_takes_time_is_repeated_with_its_robots(world: World, spent: list[float]) -> None:
    """The robot takes as long to decide as the list says, over and over; the log alone repeats the trial."""
    times = itertools.accumulate(itertools.chain.from_iterable((0.0, one) for one in itertools.cycle(spent)))
    spec = msgspec.structs.replace(trial(8.0), clock="charged")
    clock = Charged(clock=lambda: next(times))
    log = play(spec, world, {HUMAN: Scripted(delivery())}, {"robot": Teller()}, clock)
    again = play(spec, world, {HUMAN: Repeater(HUMAN, log)}, {"robot": Repeater("robot", log)})
    assert again == log


def test_people_without_inputs_cannot_be_repeated_from_them(world: World, tmp_path: Path) -> None:
    spec = trial(1.0)
    log = play(spec, world, {HUMAN: Scripted({})}, {"robot": Teller()})
    with pytest.raises(HthorError, match=r"its journal has no inputs of 'human'.*--humans replay:RUN"):
        repeated(world, spec, log, tmp_path)


def test_recorded_without_a_run_says_how_to_name_one() -> None:
    with pytest.raises(HthorError, match="--humans recorded:RUN"):
        recorded.Model(Participant(seed=0, number=0))


@pytest.mark.slow
def test_a_run_of_a_person_at_60_hertz_is_repeated_from_its_folder(tmp_path: Path) -> None:
    def run(humans: str, out: Path) -> list[dict[str, Any]]:
        words = ["eval", "--agent", "oracle", "--humans", humans, "--suite", "smoke", "--limit", "2", "--no-control"]
        done = CliRunner().invoke(app, [*words, "--jobs", "1", "--out", str(out), "--quiet"])
        assert done.exit_code == 0, done.output
        lines = [json.loads(line) for line in (out / "trials.jsonl").read_text().splitlines()]
        return sorted(lines, key=lambda line: line["spec"]["index"])

    first = run(str(SIXTY_HERTZ), tmp_path / "first")
    again = run(f"recorded:{tmp_path / 'first'}", tmp_path / "again")
    for one, other in zip(first, again, strict=True):
        assert {entry["kind"] for entry in one["journal"]} >= {"inputs", "acted"}
        for name in ("events", "paths", "journal", "ticks", "met", "ratings", "idle"):
            assert one[name] == other[name], name
