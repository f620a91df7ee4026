"""Several people in one trial: how they are named, numbered, drawn and made, and what their runs are called."""

from __future__ import annotations

import json
from pathlib import Path

import eval_fakes as fakes
import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st
from typer.testing import CliRunner

from hthor import seeds, tasks
from hthor.calibration.from_logs import one_person, trial_features
from hthor.cli import app
from hthor.errors import HthorError, UnknownName
from hthor.eval.config import cli_command, human_populations, run_config, shards
from hthor.eval.config.options import EvalOptions
from hthor.eval.planning.resolve import resolve
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.replay import human_trace
from hthor.eval.replay.session_history import RunFiles
from hthor.eval.runner import experiment, progress
from hthor.leaderboard.entries import overrides
from hthor.report.drawing import trial_trace
from hthor.tasks.suite import encode_suite, make_suite
from hthor.trials import human_team, sessions
from hthor.types import HUMAN
from hthor.types.events import Shown

pytestmark = pytest.mark.usefixtures("no_workers")

SECOND = "human2"


def test_a_comma_joins_the_people_of_one_trial() -> None:
    both = human_team.find_team("greedy, proxy")
    assert (both.name, both.word, both.models) == ("greedy+proxy", "greedy,proxy", ("greedy", "proxy"))
    assert [member.name for member in both.members] == ["greedy", "proxy"]
    alone = human_team.find_team("proxy")
    assert (alone.name, alone.sha256) == ("proxy", both.members[1].sha256), "one person is named as before"
    swapped, twice = human_team.find_team("proxy,greedy"), human_team.find_team("proxy,proxy")
    assert len({alone.sha256, both.sha256, swapped.sha256, twice.sha256}) == 4
    several = human_populations.find_people(["proxy,proxy", "greedy", "proxy,proxy"])
    assert [one.name for one in several] == ["proxy+proxy", "greedy"], "the option repeated means several runs"


def test_a_path_may_have_a_comma(tmp_path: Path) -> None:
    path = tmp_path / "left,right" / "standing.py"
    path.parent.mkdir()
    path.write_text('"""Stands."""\nclass Model:\n    def __init__(self, person): self.person = person\n')
    assert human_team.split_word(str(path)) == (str(path),)
    assert len(human_team.find_team(str(path)).members) == 1


@pytest.mark.parametrize(
    ("word", "error", "words"),
    [
        ("proxy,greedi", UnknownName, r"unknown people 'greedi'. Did you mean 'greedy'\?"),
        ("proxy,", HthorError, "a population on both sides"),
        (",proxy", HthorError, "a population on both sides"),
        ("kinds,proxy", HthorError, "'kinds' stands for several populations"),
        ("proxy,bracket@study", HthorError, "stands for several populations"),
        ("proxy+proxy", UnknownName, r"A comma joins the people of one trial, as in proxy,proxy\."),
    ],
)
def test_what_is_wrong_is_said_with_a_way_out(word: str, error: type[HthorError], words: str) -> None:
    with pytest.raises(error, match=words):
        human_populations.find_people([word])


@given(st.integers(0, 500), st.integers(1, 4))
def test_people_are_numbered_session_by_session(session: int, count: int) -> None:
    team = human_team.form_team([fakes.persons()] * count)
    seats = team.seats(session)
    assert [one.seat for one in seats] == [HUMAN, *(f"{HUMAN}{number}" for number in range(2, count + 1))]
    assert [one.participant for one in seats] == list(range(count * session, count * (session + 1)))
    before = team.seats(session + 1)
    assert before[0].participant == seats[-1].participant + 1, "nobody takes part twice"


def test_the_tasks_depend_on_the_session_alone() -> None:
    suite, crew = fakes.suite(30), fakes.crew("helper")
    one, two = (sessions.make_sessions(suite, agent=crew, humans=word, seed=7) for word in ("proxy", "proxy,greedy"))
    assert [[trial.task.id for trial in each.trials] for each in one] == [
        [trial.task.id for trial in each.trials] for each in two
    ]
    for each in one:
        assert all(trial.session == trial.humans[0].participant == each.number for trial in each.trials)
    assert [human.participant for human in two[2].trials[0].humans] == [4, 5]
    names = ("world", 2, two[2].trials[3].index, two[2].trials[3].task.id)
    assert seeds.derive(7, *names) == seeds.derive(7, "world", one[2].number, 3, one[2].trials[3].task.id)


def test_the_number_of_participants_comes_out_even() -> None:
    suite, crew = fakes.suite(30), fakes.crew("helper")
    build = run_config.build_config
    plan = build(suite, crew, humans="proxy,proxy", seed=0, participants=None)
    assert (plan.participants, plan.sessions, plan.trials) == (6, 3, 30)
    assert build(suite, crew, humans="proxy,proxy", seed=0, participants=8).sessions == 4
    with pytest.raises(HthorError, match="must be a multiple of 2, such as 6"):
        build(suite, crew, humans="proxy,proxy", seed=0, participants=5)
    part = run_config.shard_config(plan, shards.parse_shard("3/3"), 30)
    assert part.shard.trials == 10
    with pytest.raises(HthorError, match="has 3 sessions, so there can be 3 shards at most"):
        run_config.shard_config(plan, shards.parse_shard("1/4"), 30)


def test_run_json_has_each_of_them() -> None:
    suite, crew = fakes.suite(30), fakes.crew("helper")
    plan = run_config.build_config(suite, crew, humans="greedy,proxy", seed=0, participants=None)
    assert (plan.humans.name, plan.humans.source, plan.humans.model) == ("greedy+proxy", "greedy,proxy", "greedy+proxy")
    assert [one.name for one in plan.humans.members] == ["greedy", "proxy"]
    assert "greedy+proxy" in plan.folder_name
    assert "--humans greedy,proxy" in cli_command.resume_command(Path("runs/x"), plan)
    assert overrides.overridden_settings(plan)["humans"] == "greedy,proxy", "no such run is ranked"
    alone = run_config.build_config(suite, crew, humans="proxy", seed=0, participants=None)
    assert "people" not in msgspec.to_builtins(alone.humans)
    assert alone.humans.members == (alone.humans,)
    again = msgspec.json.decode(msgspec.json.encode(plan), type=run_config.RunConfig)
    assert again == plan


def test_names_in_pictures() -> None:
    assert trial_trace.seat_name(HUMAN, (HUMAN, "robot")) == "person"
    assert [trial_trace.seat_name(seat, (HUMAN, SECOND)) for seat in (HUMAN, SECOND)] == [HUMAN, SECOND]
    assert len({trial_trace.seat_colour(seat) for seat in (HUMAN, SECOND, "robot", "robot2")}) == 4


# ------------------------------------------------------------------------------------------------------ a run of two


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A small run: two different people, three trials in one house."""
    folder = tmp_path_factory.mktemp("two")
    smoke = tasks.load_suite("smoke")
    few = make_suite("few", 1, tuple(task for task in smoke.tasks if task.house == "elder")[:3])
    (folder / "few.json").write_bytes(encode_suite(few))
    options = EvalOptions(
        agent=("oracle",),
        humans=("greedy,proxy",),
        suite=str(folder / "few.json"),
        jobs=1,
        out=folder / "run",
        control=False,
    )
    list(experiment.run_experiment(resolve(options), lambda _: progress.Silent()))
    return folder / "run"


def hthor(*words: str) -> str:
    said = CliRunner().invoke(app, words, env={"COLUMNS": "200"}, catch_exceptions=False)
    assert said.exit_code == 0, said.output
    return said.output


def test_both_take_part(run: Path) -> None:
    for record in RunFolder(run).records():
        assert list(record.paths) == [HUMAN, SECOND, "robot"]
        assert [one.model for one in record.spec.humans] == ["greedy", "proxy"]
        assert set(record.ratings) == {HUMAN, SECOND}
        assert {entry.seat for entry in record.journal} == {HUMAN, SECOND}
        assert set(record.metrics.by_seat("trust_by")) == {HUMAN, SECOND}


def test_a_run_of_two_is_the_same_again(run: Path, tmp_path: Path) -> None:
    hthor(
        *("eval", "--agent", "oracle", "--humans", "greedy,proxy", "--suite", str(run.parent / "few.json")),
        *("--jobs", "1", "--no-control", "--quiet", "--out", str(tmp_path / "again")),
    )
    assert (tmp_path / "again" / "trials.jsonl").read_bytes() == (run / "trials.jsonl").read_bytes()


def test_the_mind_of_either_can_be_shown(run: Path) -> None:
    record = RunFolder(run).records()[0]
    for seat in ("", SECOND):
        found = human_trace.trace_human(RunFolder(run), record, RunFiles(), seat=seat)
        assert found.same
        assert found.seat == (seat or HUMAN)
        assert {event.seat for event in found.events} <= {found.seat, "robot"}
    with pytest.raises(UnknownName, match=r"unknown person 'human3'.*Valid: human, human2"):
        human_trace.trace_human(RunFolder(run), record, RunFiles(), seat="human3")


def test_both_can_be_replayed(run: Path, tmp_path: Path) -> None:
    hthor(
        *("eval", "--agent", "oracle", "--humans", f"replay:{run},replay:{run}"),
        *("--suite", str(run.parent / "few.json"), "--jobs", "1", "--no-control", "--quiet", "--out", str(tmp_path)),
    )
    again = RunFolder(tmp_path).records()
    for one, other in zip(RunFolder(run).records(), again, strict=True):
        assert one.ratings == other.ratings
        assert abs(one.ticks - other.ticks) < 50


def test_estimators_read_each_of_them(run: Path) -> None:
    found = trial_features.read_sessions([run])
    assert (len(found.trials), found.people, found.sessions) == (6, 2, 2)
    record = RunFolder(run).records()[0]
    for side, seat in zip(one_person.split_by_person(record), (HUMAN, SECOND), strict=True):
        assert side.paths[HUMAN] == record.paths[seat]
        assert len(side.journal) == sum(entry.seat == seat for entry in record.journal)
        shown = [event for event in record.events if isinstance(event, Shown) and event.seat == seat]
        assert sum(isinstance(event, Shown) for event in side.events) == len(shown)


def test_commands_take_such_a_run(run: Path, tmp_path: Path) -> None:
    hthor("replay", str(run), "0", "--out", str(tmp_path / "trial.png"))
    hthor("report", str(run), "--out", str(tmp_path / "report"))
    assert "2 in each trial" in (tmp_path / "report" / "report.html").read_text()
    assert "adoption: human2" in hthor("score", str(run), "--all")
    view = json.loads(hthor("runs", "view", str(run), "--participant", "1", "--json"))
    assert [line["session"] for line in view["trials"]] == [0, 0, 0]
    assert json.loads(hthor("runs", "view", str(run), "--participant", "2", "--json"))["trials"] == []
    assert "greedy+proxy" in hthor("runs", "list", str(run.parent))
