"""Several robots in one trial: reading who they are, playing them together, and going on when one of them fails."""

from __future__ import annotations

import json
import shlex
from pathlib import Path

import eval_fakes as fakes
import msgspec
import pytest

from hthor import tasks
from hthor.errors import HthorError, RunError, UnknownName
from hthor.eval.config import cli_command
from hthor.eval.config.options import EvalOptions
from hthor.eval.config.run_config import team_name
from hthor.eval.planning.resolve import resolve
from hthor.eval.records import find, scored_trial, trial_record
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.records.trial_record import TrialRecord
from hthor.eval.results import aggregate
from hthor.eval.runner import experiment, progress, run, session_runner
from hthor.guest import GuestConfig
from hthor.report.drawing import trial_figure
from hthor.tasks.suite import encode_suite, make_suite
from hthor.trials import make_sources, robot_team, sessions
from hthor.types import HUMAN

pytestmark = pytest.mark.usefixtures("no_workers")

HOUSE = "elder"
GUEST = """
import os
from hthor.types import Action, Move, Rotate, Send, Wait

class Agent:
    def begin(self, briefing):
        self.seat, self.crew = briefing.seat, sorted(briefing.crew)
        self.step = 0
    def act(self, observation):
        self.step += 1
        {act}
        return Action(motion=Rotate(yaw=0.3))
"""
TALKS = "if self.step % 9 == 1: return Action(say=Send(text=f'{{self.seat}} of {{self.crew}} in {{os.getpid()}}'))"
FAILS = "assert observation.tick < 40, 'tired'"


def pairs(crew: robot_team.RobotTeam) -> list[tuple[str, str, str]]:
    return [(robot.seat, robot.robot, robot.agent.name) for robot in crew.listed]


# ------------------------------------------------------------------------------------------------------------- reading


def test_bodies_and_minds_are_read_in_order():
    (crew,) = robot_team.parse_teams("tall:oracle, small:frontier,puck:oracle", ())
    assert pairs(crew) == [
        ("robot", "tender", "oracle"),
        ("robot2", "puck", "frontier"),
        ("robot3", "puck", "oracle"),
    ]
    assert team_name(crew.listed) == "tender-oracle+puck-frontier+puck-oracle"


def test_bodies_without_a_mind_take_the_agents_in_turn():
    first, second = robot_team.parse_teams("tall,small:frontier", ("oracle", "none"))
    assert pairs(first) == [("robot", "tender", "oracle"), ("robot2", "puck", "frontier")]
    assert pairs(second) == [("", "", "none"), ("robot", "puck", "frontier")], "who wants no robot has no seat"
    assert team_name(second.listed) == "none+puck-frontier"
    assert [robot.seat for robot in second.seats] == ["robot"]


def test_a_comma_within_an_agent_is_escaped(monkeypatch: pytest.MonkeyPatch):
    heard: list[str] = []

    def introduce(agent: str, _: object) -> robot_team.AgentInfo:
        heard.append(agent)
        return fakes.character()

    monkeypatch.setattr(robot_team, "load_agent_info", introduce)
    robot_team.parse_teams(r"tall:cmd:tool --at 1\,2,small:oracle", ())
    assert heard == ["cmd:tool --at 1,2", "oracle"]


def test_a_crew_of_nobody_is_one_silent_agent():
    (crew,) = robot_team.parse_teams("tall,small", ("none",))
    assert pairs(crew) == [("", "", "none")]
    assert team_name(crew.listed) == "none"


@pytest.mark.parametrize(
    ("robots", "agents", "told"),
    [
        ("tall:oracle,", (), "'' is not ROBOT:AGENT; expected something like --robots tall:oracle"),
        ("tall:,small:oracle", (), "'tall:' is not ROBOT:AGENT"),
        ("tall,small:oracle", (), "'tall' has no agent. Write tall:AGENT"),
        ("tall:oracle", ("oracle",), "--agent has no robot left"),
        ("tal:oracle", (), "unknown robot 'tal'. Did you mean 'tall'?"),
        ("tall:orcale", (), "unknown agent 'orcale'. Did you mean 'oracle'?"),
    ],
)
def test_wrong_crews_are_told_what_is_right(robots: str, agents: tuple[str, ...], told: str):
    with pytest.raises(HthorError) as caught:
        robot_team.parse_teams(robots, agents)
    assert told in str(caught.value)


def test_a_mind_made_for_other_bodies_is_refused():
    picky = robot_team.AgentInfo(ref=fakes.character().ref, robots=("porter",))
    with pytest.raises(UnknownName, match="unknown robot for the agent helper 'puck'"):
        robot_team.form_team(["puck"], [picky])


# ------------------------------------------------------------------------------------------------------------- playing


@pytest.fixture(scope="module")
def guests(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """Files of two minds: one talks, one fails after four seconds."""
    folder = tmp_path_factory.mktemp("guests")
    files = {"talker": TALKS, "tired": FAILS}
    for name, act in files.items():
        (folder / f"{name}.py").write_text(GUEST.format(act=act.replace("{{", "{").replace("}}", "}")))
    return {name: str(folder / f"{name}.py") for name in files}


def played(robots: str, count: int = 1, config: GuestConfig | None = None) -> list[TrialRecord]:
    """The first trials of one person in a small house."""
    (crew,) = robot_team.parse_teams(robots, ())
    few = make_suite("few", 1, tuple(task for task in tasks.load_suite("smoke").tasks if task.house == HOUSE))
    whole = sessions.make_sessions(few, agent=crew, participants=1)[0]
    perform = session_runner.make_runner(make_sources(crew, guests=config))
    some = msgspec.structs.replace(whole, trials=whole.trials[:count])
    return [done.record for done in perform(some)]


def said(record_: TrialRecord, seat: str) -> list[str]:
    return [event.text for event in record_.events if event.kind == "sent" and event.seat == seat]


def test_two_guests_and_a_built_in_agent_share_a_trial(guests: dict[str, str]):
    config = GuestConfig(isolation="L1")  # where process ids tell processes apart
    (one,) = played(f"tall:{guests['talker']},small:frontier,scout:{guests['talker']}", config=config)
    assert list(one.paths) == [HUMAN, "robot", "robot2", "robot3"]
    assert len(set(one.paths["robot2"])) > 10, "the built-in one explores"
    first, third = said(one, "robot")[0], said(one, "robot3")[0]
    assert first.startswith("robot of ['human', 'robot', 'robot2', 'robot3'] in ")
    assert third.startswith("robot3 of ")
    assert first.split()[-1] != third.split()[-1], "each in a process of its own"
    assert not one.faults
    metrics = scored_trial.score(one).metrics
    assert metrics.sent >= 2
    assert {pair for pair in metrics.hindered_by if pair.startswith("human")} == {
        "human by robot",
        "human by robot2",
        "human by robot3",
    }


def test_when_one_robot_fails_the_others_go_on(guests: dict[str, str]):
    first, second = played(f"tall:{guests['tired']},small:{guests['talker']}", count=2)
    for one in (first, second):
        assert [(fault.seat, fault.kind) for fault in one.faults] == [("robot", "raised")]
        assert 40 <= one.faults[0].tick < 50
        later = [event for event in one.events if event.kind == "sent" and event.tick > one.faults[0].tick]
        assert later
        assert all(event.seat == "robot2" for event in later)
        assert len(one.paths["robot"]) == len(one.paths["robot2"])
    assert find.fault_words(first).startswith("robot (tired), after 4.")


def test_a_trial_of_several_robots_can_be_looked_at(guests: dict[str, str], tmp_path: Path):
    from hthor import houses

    (one,) = played(f"tall:oracle,small:{guests['talker']}")
    sheet = trial_figure.trial_figure(one.spec, one.log, houses.load(HOUSE))
    words = [text.get_text() for legend in sheet.legends for text in legend.get_texts()]
    assert "robot: tender (oracle)" in words
    assert "robot2: puck (talker)" in words
    told = [text.get_text() for ax in sheet.axes for text in ax.texts]
    assert any("robot2: “robot2 of" in text for text in told), "its messages can be read"
    sheet.savefig(tmp_path / "x.svg")


# ---------------------------------------------------------------------------------------------------------------- runs


def _lines(folder: Path) -> list[bytes]:
    return sorted((folder / "trials.jsonl").read_bytes().splitlines(keepends=True))


def test_a_run_of_several_robots_is_resumed_and_told_from_others(tmp_path: Path):
    plan, dealt = fakes.run_of(20, name="helper+other")
    assert plan.name == "scout-helper+scout-other"
    assert plan.folder_name.startswith("scout-helper+scout-other-fake-")
    whole = run.run_evaluation(plan, dealt, fakes.player, folder=RunFolder(tmp_path), jobs=1, watcher=progress.Silent())
    before = _lines(tmp_path)
    (tmp_path / "trials.jsonl").write_bytes(b"".join(before[::2]))
    again = run.run_evaluation(plan, dealt, fakes.player, folder=RunFolder(tmp_path), jobs=1, watcher=progress.Silent())
    assert _lines(tmp_path) == before
    assert again.metrics == whole.metrics
    assert whole.counts.faults_by_seat == {"robot": 0, "robot2": 0}
    other, _ = fakes.run_of(20, name="other+helper")
    with pytest.raises(RunError, match=r"robots\.0\.agent\.name is helper there and other here"):
        run.run_evaluation(other, dealt, fakes.player, folder=RunFolder(tmp_path), jobs=1, watcher=progress.Silent())
    (tmp_path / "run.json").unlink()
    RunFolder(tmp_path).write_config(other)
    with pytest.raises(RunError, match=r"spec\.robots is not the one in run\.json"):
        aggregate.rescore(tmp_path)


def test_the_command_that_finishes_a_run_names_every_robot(tmp_path: Path):
    plan, _ = fakes.run_of(20, name="helper+other")
    told = cli_command.resume_command(tmp_path, plan)
    assert " --humans proxy --suite fake --robots scout:helper.py,scout:other.py --seed 0 " in told
    assert shlex.split(cli_command.resume_command(tmp_path / "my run", plan))[-2:] == [
        "--out",
        str(tmp_path / "my run"),
    ]


def test_real_runs_of_several_robots_repeat_themselves(tmp_path: Path):
    chosen = [task for task in tasks.load_suite("smoke").tasks if task.house == HOUSE][:2]
    suite = tmp_path / "brief.json"
    suite.write_bytes(encode_suite(make_suite("brief", 1, tuple(chosen))))
    results = []
    for jobs in (1, 2):
        options = EvalOptions(
            robots="tall:oracle,small:frontier",
            suite=str(suite),
            participants=2,
            jobs=jobs,
            out=tmp_path / str(jobs),
            control=False,
        )
        (done,) = experiment.run_experiment(resolve(options), lambda _: progress.Silent())
        results.append(done.result)
    assert _lines(tmp_path / "1") == _lines(tmp_path / "2")
    assert len(_lines(tmp_path / "1")) == 4
    assert results[0].hashes == results[1].hashes
    one = trial_record.decode(_lines(tmp_path / "1")[0])
    assert [(robot.robot, robot.agent.name) for robot in one.spec.robots] == [
        ("tender", "oracle"),
        ("puck", "frontier"),
    ]
    assert json.loads((tmp_path / "1" / "run.json").read_bytes())["schema"] == "hthor.run/5"
