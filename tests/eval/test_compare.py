"""Comparisons: mirrors, agents against themselves, textbook tests, refusals, and verdicts that come out right."""

from __future__ import annotations

import itertools
import math
import os
import shutil
from collections.abc import Iterator
from pathlib import Path
from unittest import mock

import eval_fakes as fakes
import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from law_cases import cases
from scipy import stats as scipy_stats

from hthor import jsonio
from hthor.errors import HthorError, RunError
from hthor.eval.comparison import compare, ranking, sample_size
from hthor.eval.metrics import registry
from hthor.eval.metrics.metric import SECONDS, SHARE
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.results import aggregate, baseline, paired_difference, pairing, result_file
from hthor.eval.runner import progress, run
from hthor.eval.statistics import power
from hthor.report.terminal import result_tables

pytestmark = pytest.mark.usefixtures("no_workers")


def _run(folder: Path, name: str, *, absent: bool = False, seed: int = 0, make=fakes.player, count: int = 60) -> Path:
    plan, dealt = fakes.run_of(count, name=name, absent=absent, seed=seed)
    run.run_evaluation(plan, dealt, make, folder=RunFolder(folder / name), jobs=1, watcher=progress.Silent())
    return folder / name


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An agent, the same under another name, and one beside which people succeed more often than alone."""
    folder = tmp_path_factory.mktemp("runs")
    _run(folder, "helper")
    _run(folder, "twin")
    leaning = folder / "leaning"
    _run(leaning, "alone", absent=True, make=fakes.leaning_player)
    _run(leaning, "better", make=fakes.leaning_player)
    return folder


def test_an_agent_cannot_be_told_from_itself_under_another_name(runs: Path):
    pair = compare.compare_runs([runs / "helper", runs / "twin"]).pairs[0]
    assert pair.n == 60
    assert pair.better == ""
    assert pair.differences["sr"].p == 1.0
    assert pair.differences["sr"].ci95[1] > 0.0, "sixty trials do not prove that two agents are the same"
    assert (pair.tally.wins, pair.tally.ties, pair.tally.losses) == (0, 60, 0)
    assert pair.sentence.startswith("These data cannot separate twin from helper: +0.0 points")
    assert pair.sentence.endswith("success was the same in every trial.")


def test_what_is_better_is_said_to_be_and_by_how_much(runs: Path):
    found = compare.compare_runs([runs / "leaning" / "alone", runs / "leaning" / "better"])
    pair = found.pairs[0]
    assert pair.better == "better"
    assert pair.differences["sr"].p < 0.001
    assert pair.sentence.startswith("better is better than no robot by 4")
    assert "p < 0.001" in pair.sentence
    assert "adoption" not in pair.differences, "without a robot there is nothing to adopt"
    assert set(pair.groups) == {"kind", "scene"}
    assert sum(one.n for one in pair.groups["scene"].values()) == pair.n
    assert not found.worse
    assert compare.compare_runs([runs / "leaning" / "better", runs / "leaning" / "alone"]).worse


def test_a_comparison_is_the_mirror_of_its_mirror(runs: Path):
    one, other = (runs / "leaning" / name for name in ("alone", "better"))
    here, there = compare.compare_runs([one, other]).pairs[0], compare.compare_runs([other, one]).pairs[0]
    assert here.better == there.better
    for metric, found in here.differences.items():
        turned = there.differences[metric]
        assert (found.difference, found.p, found.n) == (-turned.difference, turned.p, turned.n)
        assert found.ci95 == (-turned.ci95[1], -turned.ci95[0])
        assert (found.mde80, found.more_tasks) == (turned.mde80, turned.more_tasks)
    assert (here.mcnemar.only_first, here.mcnemar.p) == (there.mcnemar.only_second, there.mcnemar.p)
    assert (here.tally.wins, here.tally.losses) == (there.tally.losses, there.tally.wins)


@given(st.integers(0, 60), st.integers(0, 60))
def test_mcnemar_is_the_binomial_test(one: int, other: int):
    expected = scipy_stats.binomtest(one, one + other).pvalue if one + other else 1.0
    assert paired_difference.exact_p_value(one, other) == pytest.approx(expected, rel=1e-4)


@given(st.lists(st.floats(0, 1), min_size=1, max_size=8))
def test_holm_is_never_bolder_than_one_test_nor_shyer_than_bonferroni(p: list[float]):
    adjusted = paired_difference.holm_adjusted(p)
    for before, after in zip(p, adjusted, strict=True):
        assert before - 1e-6 <= after <= min(1.0, before * len(p)) + 1e-6
    assert sorted(range(len(p)), key=lambda k: (p[k], k)) == sorted(range(len(p)), key=lambda k: (adjusted[k], p[k], k))


@settings(max_examples=cases(30))
@given(st.lists(st.tuples(st.booleans(), st.booleans()), min_size=2, max_size=50))
def test_the_interval_and_p_say_the_same(outcomes: list[tuple[bool, bool]]):
    first, second = (np.array([pair[k] for pair in outcomes], dtype=float) for k in (0, 1))
    found = paired_difference.difference_of_values(
        first, second, np.arange(len(first)), np.arange(len(first)) // 10, registry.get("sr"), limit_s=None
    )
    low, high = found.ci95
    assert low <= found.difference <= high
    assert found.separated == (low > 0.0 or high < 0.0)


def test_several_runs_are_compared_pair_by_pair(runs: Path):
    found = compare.compare_runs([runs / "helper", runs / "twin", runs / "helper"])
    assert [party.name for party in found.runs] == ["helper (helper) #1", "twin", "helper (helper) #3"]
    assert len(found.pairs) == 3
    assert all(pair.p_holm == 1.0 for pair in found.pairs)


@settings(max_examples=cases(100))
@given(st.lists(st.tuples(st.floats(-1, 1), st.floats(0, 1)), min_size=1, max_size=8))
def test_a_verdict_and_the_level_of_its_interval_say_the_same(differences: list[tuple[float, float]]):
    for (difference, p), found in zip(differences, paired_difference.verdicts(differences), strict=True):
        assert found.among == len(differences)
        assert found.level >= 0.95
        if abs(p - (1.0 - found.level)) > 1e-5:
            told = found.sign != 0 or (difference == 0.0 and found.p < 0.05)
            assert told == (p < 1.0 - found.level)
        assert found.sign in (0, math.copysign(1.0, difference))


@pytest.fixture(scope="module")
def four() -> tuple[compare.LoadedRun, ...]:
    """Four runs: of one pair the difference counts alone, but not among six."""
    names = ("none", "one", "two", "three")
    chance = np.random.default_rng(4)
    level = chance.random(120)
    plan, dealt = fakes.run_of(120)
    kept = [one for session in dealt for one in fakes.records(session)]

    def run(name: str, rate: float) -> compare.LoadedRun:
        met = level + 0.15 * np.random.default_rng(len(name)).normal(size=120) < rate
        records = (
            msgspec.structs.replace(one, metrics=msgspec.structs.replace(one.metrics, sr=int(hit), twsr=0.5 * hit))
            for one, hit in zip(kept, met, strict=True)
        )
        return compare.LoadedRun(name=name, folder=Path(name), plan=plan, records=tuple(records))

    return tuple(run(name, rate) for name, rate in zip(names, (0.5, 0.6, 0.52, 0.51), strict=True))


def test_where_the_verdict_is_adjusted_its_interval_is_too_and_both_say_so(four: tuple[compare.LoadedRun, ...]):
    (alone,), among = compare.compare_pairs(four[:2]), compare.compare_pairs(four)
    assert alone.better == "one"
    assert (alone.among, alone.level, alone.interval) == (1, 0.95, alone.differences["sr"].ci95)
    pair = next(one for one in among if (one.first, one.second) == ("none", "one"))
    assert pair.differences == alone.differences, "alone it is what it was"
    assert (pair.among, pair.better) == (6, "")
    assert pair.interval[0] < alone.interval[0]
    assert "adjusted for 6 comparisons" in pair.sentence
    assert f"it would count alone (p = {alone.p_holm:.3f}), but not among 6 comparisons" in pair.sentence
    for one in among:
        assert bool(one.better) == (one.interval[0] > 0.0 or one.interval[1] < 0.0)


def test_ranks_judge_as_comparisons_do(four: tuple[compare.LoadedRun, ...]):
    tasks, people = np.arange(120), np.arange(120) // 10
    outcomes = np.array([[one.metrics.sr for one in run.records] for run in four], dtype=float)
    ties = [set(place.ties) for place in ranking.rank_agents(outcomes, tasks, people)]
    for pair, (one, other) in zip(compare.compare_pairs(four), itertools.combinations(range(4), 2), strict=True):
        assert (other in ties[one]) == (not pair.better)


def test_a_comparison_and_a_plan_say_the_same_of_more_tasks(runs: Path, four: tuple[compare.LoadedRun, ...]):
    for one, other in ((four[0], four[2]), (four[1], four[3])):
        (pair,) = compare.compare_pairs([one, other])
        with mock.patch.object(compare, "load_runs", return_value=(one, other)):
            plan = sample_size.plan_study([one.folder, other.folder], "", None, None, 0.8)
        assert plan.more == pair.differences["sr"].more_tasks > 0
        assert plan.paired.trials == plan.more + pair.n
        words = power.rounded_count(plan.more)
        assert f"about {words} more tasks" in pair.sentence
        assert f"about {words} more than the {pair.n}" in plan.sentence
    folders = [runs / "leaning" / "alone", runs / "leaning" / "better"]
    found = compare.compare_runs(folders).pairs[0].differences["sr"]
    assert sample_size.plan_study(folders, "", None, None, 0.8).more == found.more_tasks


def test_a_plan_for_another_difference_scales_what_was_measured(runs: Path):
    folders = [runs / "leaning" / "alone", runs / "leaning" / "better"]
    near, far = (sample_size.plan_study(folders, "", None, gap, 0.8) for gap in (0.05, 0.2))
    assert near.paired.trials > far.paired.trials
    assert near.unpaired.trials > near.paired.trials


def test_other_conditions_are_refused_by_name(runs: Path, tmp_path: Path):
    other = _run(tmp_path, "helper", seed=1, count=10)
    with pytest.raises(RunError, match=r"suite\.sha256 is .* other tasks"):
        compare.compare_runs([runs / "helper", other])
    plan = RunFolder(runs / "helper").config
    changes = {
        "seed": msgspec.structs.replace(plan, seed=9),
        "humans.sha256": msgspec.structs.replace(plan, humans=msgspec.structs.replace(plan.humans, sha256="0" * 64)),
        "rules_sha256": msgspec.structs.replace(plan, rules_sha256="0" * 64),
        "code_sha256": msgspec.structs.replace(plan, code_sha256="0" * 64),
    }
    for field, changed in changes.items():
        assert pairing.differing_field(plan, changed) == field


def test_an_occasion_is_the_trial_without_a_robot():
    with_robot, without = (fakes.run_of(20, absent=absent)[1][1].trials[3] for absent in (False, True))
    assert pairing.pairing_key(with_robot) == pairing.pairing_key(without)
    assert pairing.pairing_key(with_robot) != pairing.pairing_key(msgspec.structs.replace(with_robot, index=4))


# ------------------------------------------------------------------------------------------------------------- uplift


def test_uplift_is_the_comparison_with_the_run_without_a_robot_that_lies_beside(runs: Path):
    folder = runs / "leaning"
    result = result_file.load_result(folder / "better")
    assert result.uplift is not None
    assert result.uplift.control == result_file.load_result(folder / "alone").hashes.run
    assert result.uplift.sr == compare.compare_runs([folder / "alone", folder / "better"]).pairs[0].differences["sr"]
    assert result_file.load_result(folder / "alone").uplift is None
    assert result_file.load_result(runs / "helper").uplift is None, "nothing without a robot lies beside it"
    assert aggregate.rescore(folder / "better")[1] == result


def _better(folder: Path) -> Path:
    """A run and its control, which lies beside it."""
    _run(folder, "alone", absent=True, make=fakes.leaning_player, count=20)
    return _run(folder, "better", make=fakes.leaning_player, count=20)


def test_a_copied_run_keeps_its_uplift_with_a_note_and_loses_the_note_where_its_control_is(tmp_path: Path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    whole = _better(tmp_path / "runs" / "here")
    before = result_file.load_result(whole)
    moved = shutil.copytree(whole, tmp_path / "far" / "off" / "copy")
    monkeypatch.chdir(moved.parent)
    result_file.store_result(moved, aggregate.rescore(moved)[1])
    kept = result_file.load_result(moved).uplift
    assert kept.note == baseline.RECORDED
    assert msgspec.structs.replace(kept, note=msgspec.UNSET) == before.uplift
    result_file.store_result(moved, aggregate.rescore(moved)[1])
    assert result_file.load_result(moved).uplift == kept, "once more changes nothing"
    monkeypatch.chdir(tmp_path)
    assert aggregate.rescore(moved)[1].uplift == before.uplift, "found below ./runs, by what it is"


def test_an_older_result_does_not_lose_its_uplift_either(tmp_path: Path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    whole = _better(tmp_path / "runs")
    text = (whole / "result.json").read_text(encoding="utf-8").replace(result_file.SCHEMA, "hthor.result/2")
    shutil.rmtree(tmp_path / "runs" / "alone")
    (whole / "result.json").write_text(text, encoding="utf-8")
    kept = aggregate.rescore(whole)[1]
    assert kept.uplift.note == baseline.RECORDED
    older = msgspec.structs.replace(kept, hashes=msgspec.structs.replace(kept.hashes, scoring="78" * 32))
    for _ in range(2):  # scored once more, the uplift is still as old as it is
        result_file.store_result(whole, older)
        older = aggregate.rescore(whole)[1]
        assert older.uplift.note == f"{baseline.RECORDED}, by another scoring version than the other numbers"


def test_a_finished_run_that_is_evaluated_again_without_its_control_keeps_its_uplift(tmp_path: Path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    whole = _better(tmp_path / "runs")
    before = result_file.load_result(whole).uplift
    shutil.rmtree(tmp_path / "runs" / "alone")
    _run(tmp_path / "runs", "better", make=fakes.leaning_player, count=20)
    assert result_file.load_result(whole).uplift.sr == before.sr


def test_of_several_controls_it_is_the_one_that_the_result_names(tmp_path: Path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    whole = _better(tmp_path / "runs")
    named = result_file.load_result(whole).uplift.control
    other = shutil.copytree(tmp_path / "runs" / "alone", tmp_path / "runs" / "aaa")
    plan = RunFolder(other).config
    assert plan.sha256 == named
    (other / "run.json").write_bytes(jsonio.pretty(msgspec.structs.replace(plan, versions={"hthor": "another"})))
    assert RunFolder(other).config.sha256 != named
    assert aggregate.rescore(whole)[1].uplift.control == named
    assert baseline.baseline_folder(whole, RunFolder(whole).config).name == "alone"


def test_a_result_of_another_run_lends_no_uplift(tmp_path: Path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    whole = _better(tmp_path / "runs")
    shutil.rmtree(tmp_path / "runs" / "alone")
    assert result_file.stored_uplift(whole, run="0" * 64) is None
    (whole / "result.json").write_text("[" * 100_000, encoding="utf-8")
    assert result_file.stored_uplift(whole, run=RunFolder(whole).config.sha256) is None


def test_half_a_control_is_none(tmp_path: Path):
    folder = _run(tmp_path, "helper", count=20)
    alone = _run(tmp_path, "alone", absent=True, count=20)
    assert baseline.find_baseline(folder, RunFolder(folder).config) is not None
    lines = (alone / "trials.jsonl").read_bytes().splitlines(keepends=True)
    (alone / "trials.jsonl").write_bytes(b"".join(lines[:-1]))
    assert baseline.find_baseline(folder, RunFolder(folder).config) is None


def test_a_folder_of_another_program_that_vanishes_during_the_search_is_no_error(tmp_path: Path, monkeypatch):
    def scan(path: str | Path | int = ".") -> Iterator[os.DirEntry[str]]:
        if Path(str(path)).name == "vanishing":
            raise FileNotFoundError(2, "No such file or directory", str(path))
        return scandir(path)

    scandir = os.scandir
    folder = _run(tmp_path / "runs", "helper", count=20)
    alone = _run(tmp_path / "zzz", "alone", absent=True, count=20)
    (tmp_path / "vanishing").mkdir()
    monkeypatch.setattr(os, "scandir", scan)
    found = baseline.measure_uplift(folder, RunFolder(folder).config, RunFolder(folder).records())
    assert found is not None
    assert found.control == RunFolder(alone).config.sha256


# -------------------------------------------------------------------------------------------------------------- power


def test_power_of_textbook_size():
    found = power.sample_size(0.73, 0.76)
    assert 3_250 <= found.trials <= 3_350
    assert found.sessions == -(-found.trials // 10)


@settings(max_examples=cases(40))
@given(st.floats(0.1, 0.9), st.floats(0.02, 0.09), st.floats(0.0, 0.6))
def test_more_correlation_and_larger_differences_need_less(rate: float, gap: float, correlation: float):
    plain = power.sample_size(rate, rate + gap)
    correlation = min(correlation, power.correlation_range(rate, rate + gap)[1])
    assert power.sample_size(rate, rate + gap, correlation=correlation).trials <= plain.trials
    assert power.sample_size(rate, rate + gap / 2).trials >= plain.trials


def test_what_cannot_be_is_refused():
    for first, second, correlation, said in ((0.5, 1.2, 0.0, "second rate"), (0.1, 0.9, 0.9, "cannot correlate")):
        with pytest.raises(HthorError, match=said):
            power.sample_size(first, second, correlation=correlation)
    with pytest.raises(HthorError, match="equal"):
        power.sample_size(0.5, 0.5)
    for rates, difference in (("0.73,1.2", None), ("0.73,0.76", 0.4)):
        with pytest.raises(HthorError, match="second rate"):
            sample_size.plan_study((), rates, None, difference, 0.8)
    with pytest.raises(HthorError, match="two rates"):
        sample_size.plan_study((), "0.5", None, None, 0.8)


def test_a_difference_that_cannot_be_is_not_one_that_could_have_been_seen():
    shares = [result_tables.format_detectable(value, SHARE) for value in (None, 0.0, 0.123, 1.4)]
    assert shares == ["–", "–", "12.3", "> 100"]
    assert result_tables.format_detectable(1.4, SECONDS) == "1.4"


def test_a_plan_from_two_runs_has_their_rates_and_correlation(runs: Path):
    found = sample_size.plan_study([runs / "leaning" / "alone", runs / "leaning" / "better"], "", None, None, 0.8)
    assert found.measured
    assert found.paired.trials < found.unpaired.trials
    assert found.second > found.first


@pytest.mark.parametrize("value", [-0.0004, -0.0, 0.0])
def test_nothing_has_no_minus(value: float) -> None:
    assert result_tables.format_difference(value, SHARE) == "+0.0"
