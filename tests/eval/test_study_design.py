"""Between-subjects studies: who meets which robot, and that everything which pairs trials knows of it."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from unittest import mock

import eval_fakes as fakes
import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hthor import code_identity
from hthor.errors import HthorError, RunError
from hthor.eval.comparison import compare, sample_size
from hthor.eval.config import cli_command, run_config, shards, study_design
from hthor.eval.config.run_config import RunConfig
from hthor.eval.config.study_design import StudyDesign, assign_conditions
from hthor.eval.merge import merge_shards
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.results import aggregate, group_difference, pairing
from hthor.eval.runner import progress, run
from hthor.humans.population import resolve
from hthor.leaderboard.entries import overrides
from hthor.report.analysis import build, load_runs
from hthor.report.page import case_study, headline, sentences
from hthor.report.terminal import result_tables
from hthor.trials import sessions
from hthor.trials.sessions import Session

COUNT = 20
CONDITIONS = ("helper", "none", "rival")


@given(st.integers(0, 200), st.integers(1, 9), st.integers(0, 10**6))
def test_groups_are_balanced_for_any_number_of_people_and_conditions(people: int, conditions: int, seed: int) -> None:
    found = assign_conditions(people, conditions, seed)
    sizes = Counter(found)
    assert len(found) == people
    assert set(sizes) <= set(range(conditions))
    held = [sizes[condition] for condition in range(conditions)]
    assert max(held) - min(held) <= 1
    for block in range(people // conditions):
        assert sorted(found[block * conditions : (block + 1) * conditions]) == list(range(conditions))
    assert found == assign_conditions(people, conditions, seed)
    assert assign_conditions(people + 5, conditions, seed)[:people] == found, "later people change no earlier ones"


@given(st.integers(2, 60), st.integers(2, 5), st.integers(1, 3), st.integers(0, 99))
def test_everybody_is_in_one_group(units: int, conditions: int, together: int, seed: int) -> None:
    names = tuple(f"a{number}" for number in range(conditions))
    if units < conditions:
        return
    designs = [StudyDesign(conditions=names, condition=k, participants=units * together) for k in range(conditions)]
    groups = [design.sessions(seed, together) for design in designs]
    assert sorted(number for group in groups for number in group) == list(range(units))
    assert len({design.study for design in designs}) == 1


def test_the_order_of_conditions_is_drawn_for_each_block() -> None:
    orders = {assign_conditions(30, 3, seed)[start : start + 3] for seed in range(5) for start in range(0, 30, 3)}
    assert len(orders) == 6, "all orders of three conditions occur"


def design_of(name: str, participants: int = 6) -> StudyDesign:
    return study_design.plan_study(CONDITIONS, name, participants=participants, sessions_each=2, people=1)


def condition(name: str, participants: int = 6, *, seed: int = 0) -> tuple[RunConfig, tuple[Session, ...]]:
    """The run of one condition of a study."""
    tasks, who = fakes.suite(COUNT), fakes.crew(name, absent=name == "none")
    with (
        mock.patch.object(resolve, "resolve_humans", return_value=fakes.persons()),
        mock.patch.object(code_identity, "code_sha256", return_value="34" * 32),
    ):
        design = design_of(name, participants)
        plan = run_config.build_config(tasks, who, humans="proxy", seed=seed, participants=None, design=design)
        return plan, sessions.make_sessions(tasks, agent=who, seed=seed, numbers=design.sessions(seed, 1))


def test_groups_do_the_same_tasks_with_different_people() -> None:
    runs = {name: condition(name) for name in CONDITIONS}
    people = {name: [one.trials[0].humans[0].participant for one in dealt] for name, (_, dealt) in runs.items()}
    assert sorted(number for some in people.values() for number in some) == list(range(6))
    tasks = {name: [[trial.task.id for trial in one.trials] for one in dealt] for name, (_, dealt) in runs.items()}
    assert tasks["helper"] == tasks["none"] == tasks["rival"]
    assert sorted(name for hand in tasks["none"] for name in hand) == sorted(
        task.id for task in fakes.suite(COUNT).tasks
    )
    for plan, dealt in runs.values():
        assert (plan.participants, plan.trials) == (2, sum(len(one.trials) for one in dealt))
        assert list(plan.session_numbers) == [one.number for one in dealt]
        assert all(one.number == one.trials[0].session == one.trials[0].humans[0].participant for one in dealt)


def test_the_design_is_part_of_the_configuration() -> None:
    plan, _ = condition("helper")
    paired, _ = fakes.run_of(COUNT)
    assert plan.sha256 != paired.sha256
    assert "-between-" in plan.folder_name
    assert msgspec.json.decode(msgspec.json.encode(plan), type=RunConfig) == plan
    assert b"design" not in msgspec.json.encode(paired), "the paired default reads as before"


def test_a_command_plays_the_whole_study_again() -> None:
    plan, _ = condition("helper")
    words = cli_command.resume_command(Path("runs/study/helper"), plan)
    assert "--agent helper --agent none --agent rival" in words
    assert "--no-control --design between" in words
    assert "--participants 6" in words
    assert "--out runs/study " in words


def test_a_study_needs_conditions_and_people_for_them() -> None:
    with pytest.raises(HthorError, match=r"there is one condition only\. Name another --agent"):
        study_design.plan_study(["helper"], "helper", participants=6, sessions_each=2, people=1)
    with pytest.raises(HthorError, match=r"--participants 2: 3 conditions with 1 .* and 3 at least"):
        design_of("helper", 2)
    with pytest.raises(HthorError, match="need a multiple of 2"):
        study_design.plan_study(CONDITIONS, "helper", participants=7, sessions_each=2, people=2)
    usual = study_design.plan_study(CONDITIONS, "helper", participants=None, sessions_each=2, people=2)
    assert usual.participants == 12, "every condition does every task once"


def played(folder: Path, name: str, participants: int = 6) -> RunFolder:
    plan, dealt = condition(name, participants)
    where = RunFolder(folder / name)
    run.run_evaluation(plan, dealt, fakes.player, folder=where, engine=fakes.Here(), watcher=progress.Silent())
    return where


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("study")
    for name in ("none", "helper", "rival"):
        played(folder, name, 12)
    return folder


def test_groups_are_compared_without_pairs(study: Path) -> None:
    (pair,) = compare.compare_runs([study / "none", study / "helper"]).pairs
    assert (pair.mcnemar, pair.tally, pair.dropped) == (None, None, (0, 0))
    assert pair.groups_of
    assert [(one.trials, one.people) for one in pair.groups_of] == [(40, 4), (40, 4)]
    assert (pair.n, pair.people, pair.tasks) == (80, 8, COUNT)
    one, other = (RunFolder(study / name).records() for name in ("none", "helper"))
    rates = [sum(record.met for record in some) / len(some) for some in (one, other)]
    assert pair.differences["sr"].difference == pytest.approx(rates[1] - rates[0], abs=1e-6)
    assert pair.differences["sr"].correlation is None
    assert "40 trials of 4 people against 40 of 4 other people" in pair.sentence
    assert result_tables.BETWEEN_WORDS in list(result_tables.comparison_lines(pair))
    assert pairing.pair_trials(one, other).pairs == ()


def test_the_uplift_of_a_group_is_over_the_group_without_a_robot(study: Path) -> None:
    result = aggregate.rescore(study / "helper")[1]
    found = group_difference.group_difference(
        RunFolder(study / "none").records(), RunFolder(study / "helper").records(), "sr"
    )
    assert result.uplift is not None
    assert result.uplift.sr == found
    assert result.design == RunFolder(study / "helper").config.design


def test_runs_of_other_designs_are_not_compared(study: Path, tmp_path: Path) -> None:
    plan, dealt = fakes.run_of(COUNT)
    paired = RunFolder(tmp_path / "paired")
    run.run_evaluation(plan, dealt, fakes.player, folder=paired, engine=fakes.Here(), watcher=progress.Silent())
    smaller = played(tmp_path / "smaller", "helper")
    for other in (paired.path, smaller.path):
        with pytest.raises(RunError, match=r"design\.study is between subjects, 12 people.*other groups of people"):
            compare.compare_runs([study / "none", other])


def test_power_takes_the_rates_of_groups(study: Path) -> None:
    found = sample_size.plan_study([study / "none", study / "helper"], "", None, 0.1, 0.8)
    assert found.shared is None
    assert found.unpaired.trials > found.paired.trials


def test_a_report_says_that_people_were_different(study: Path, tmp_path: Path) -> None:
    runs = load_runs.with_baselines(load_runs.load_runs([study / "helper", study / "rival"]))
    found = build.build_findings(runs)
    assert [one.design.study for one in found.origins if one.design] == [found.origins[0].design.study] * 3  # type: ignore[union-attr]
    assert "groups of different people at the same tasks" in headline.headline(found)
    assert "12 people" in sentences.page_facts(found)
    assert found.shown, "examples are ranked by themselves"
    assert all(one.alone_s is None for one in found.shown)
    assert len(found.comparisons) == 3
    assert not found.apart
    with pytest.raises(RunError, match="are groups of a between-subjects study, and nobody was in both"):
        case_study.write_case_study([study / "helper", study / "rival"], "t000", tmp_path)


def test_a_group_is_not_ranked() -> None:
    plan, _ = condition("helper")
    found = overrides.overridden_settings(plan)
    assert found["design"] == "between"
    assert "was played with" in overrides.refusal(Path("run"), plan, found)
    assert "--design between" in overrides.refusal(Path("run"), plan, found)


def test_shards_of_a_group_are_merged(tmp_path: Path) -> None:
    plan, dealt = condition("helper", 12)
    whole = played(tmp_path / "whole", "helper", 12)
    parts = []
    for words in ("1/2", "2/2"):
        shard = run_config.shard_config(plan, shards.parse_shard(words), COUNT)
        part = RunFolder(tmp_path / words[0])
        run.run_evaluation(
            shard,
            shard.shard.share(dealt),
            fakes.player,
            folder=part,
            engine=fakes.Here(),
            watcher=progress.Silent(),  # type: ignore[union-attr]
        )
        parts.append(part.path)
    done = merge_shards.merge_shards(parts, tmp_path / "merged")
    assert done.result is not None
    assert done.result.hashes.trials == aggregate.rescore(whole.path)[1].hashes.trials
