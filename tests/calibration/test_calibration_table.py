"""Targets, tables and where simulated trials are kept."""

from __future__ import annotations

import json

import msgspec
import numpy as np
import pytest
from calibration_fakes import NAMES, sessions, whole
from hypothesis import given, settings
from hypothesis import strategies as st
from law_cases import cases

from hthor import jsonio, tasks
from hthor.calibration import targets
from hthor.calibration.diagnostics import acceptance
from hthor.calibration.evidence import AbcShift
from hthor.calibration.pipeline.stages import ArtifactCache
from hthor.calibration.simulation import design_points, session_store, trial_table
from hthor.calibration.simulation.session_simulation import SessionOutcome
from hthor.calibration.simulation.session_store import SessionStore, TrialIdentity
from hthor.errors import HthorError, RunError, RunLocked, UnknownName
from hthor.eval.records import trial_record

SUITE = tasks.load_suite("paper")
PAPER = targets.load_targets("paper")


# -------------------------------------------------------------------------------------------------------------- targets


def test_the_counts_print_as_the_published_percentages_and_no_others_do():
    assert [(PAPER.sr[name].k, PAPER.sr[name].n) for name in targets.CONDITIONS] == [(37, 58), (43, 59), (53, 58)]
    assert sum(count.n for count in PAPER.sr.values()) == 175
    for name, count in PAPER.sr.items():
        printed = PAPER.published[f"sr {name}"]
        candidates = {(k, n) for n in range(50, 61) for k in range(n + 1) if f"{100 * k / n:.1f}" == f"{printed:.1f}"}
        assert candidates == {(count.k, count.n)}


def test_fifty_is_the_only_denominator_that_both_adoption_rates_can_have():
    def possible(printed):
        return {n for n in range(15, 61) for k in range(n + 1) if f"{100 * k / n:.1f}" == f"{printed:.1f}"}

    both = possible(PAPER.published["adoption frontier"]) & possible(PAPER.published["adoption oracle"])
    assert both == {PAPER.adoption["frontier"].n} == {PAPER.adoption["oracle"].n} == {50}
    assert all(count.inferred and count.note for count in PAPER.adoption.values())
    assert not any(count.inferred for count in PAPER.sr.values())


def test_the_ratios_are_those_of_the_published_rates():
    for name, ratio in PAPER.ratio.items():
        assert ratio == pytest.approx(PAPER.published[f"twsr {name}"] / 100.0 / PAPER.sr[name].share, abs=0.002)
    assert PAPER.verbal
    assert not any(said.fitted for said in PAPER.verbal)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda d: d["sr"]["none"].update(k=59), "59 of 58 trials cannot be"),
        (lambda d: d["sr"]["none"].update(k=38), "63.8 % was printed"),
        (lambda d: d["ratio"].update(none=0.8), "ratio.none: is 0.8"),
        (lambda d: d["sr"].update(silent={"k": 1, "n": 2}), "no condition is called 'silent'"),
        (lambda d: d.update(schema="hthor.targets/9"), "this version reads 'hthor.targets/1'"),
        (lambda d: d["sr"]["none"].pop("n"), "sr"),
        (lambda d: d.update(extra=1), "extra"),
    ],
)
def test_a_file_that_contradicts_itself_is_told_so(tmp_path, change, says):
    document = msgspec.to_builtins(PAPER)
    document.pop("left_out")
    path = tmp_path / "mine.json"
    path.write_bytes(jsonio.pretty(document))
    assert targets.load_targets(path).sha256 == PAPER.sha256
    change(document)
    path.write_bytes(jsonio.pretty(document))
    with pytest.raises(HthorError, match=says) as told:
        targets.load_targets(path)
    assert str(path) in str(told.value)


def test_an_unknown_name_and_a_missing_file_are_told_apart(tmp_path):
    with pytest.raises(UnknownName, match="Did you mean 'paper'"):
        targets.load_targets("papers")
    with pytest.raises(HthorError, match="cannot be read"):
        targets.load_targets(tmp_path / "none.json")
    (tmp_path / "torn.json").write_text("{")
    with pytest.raises(HthorError, match=r"torn\.json"):
        targets.load_targets(tmp_path / "torn.json")


# --------------------------------------------------------------------------------------------------------------- points


@given(st.integers(1, 60), st.integers(1, 60), st.integers(0, 5))
@settings(max_examples=cases(20))
def test_points_of_a_smaller_number_are_the_first_of_a_larger(few, many, seed):
    small, large = (design_points.sobol_points(count, 5, seed, "some") for count in sorted((few, many)))
    assert np.array_equal(small, large[: len(small)])
    assert ((large > 0.0) & (large < 1.0)).all()


def test_points_fill_the_cube_and_depend_on_seed_and_name():
    first = design_points.sobol_points(256, len(NAMES), 0, "a")
    counts = np.stack([np.histogram(column, 8, (0, 1))[0] for column in first.T])
    assert (counts == 32).all()
    assert not np.array_equal(first, design_points.sobol_points(256, len(NAMES), 1, "a"))
    assert not np.array_equal(first, design_points.sobol_points(256, len(NAMES), 0, "b"))
    assert json.loads(json.dumps(first.tolist())) == first.tolist()


# ---------------------------------------------------------------------------------------------------------------- table


def _some(count=6, seed=0, name="some"):
    return sessions(design_points.sobol_points(count, len(NAMES), seed, name), SUITE, seed, None, 1, None, name)


def test_a_table_is_the_same_from_its_file_and_its_bytes_repeat(tmp_path):
    made = _some()
    for name in ("one.npz", "two.npz"):
        trial_table.save_table(tmp_path / name, made)
    assert (tmp_path / "one.npz").read_bytes() == (tmp_path / "two.npz").read_bytes()
    back = trial_table.load_table(tmp_path / "one.npz")
    assert back.names == made.names
    for name in ("points", *trial_table.COLUMNS):
        assert np.array_equal(getattr(back, name), getattr(made, name)), name
        assert getattr(back, name).dtype == getattr(made, name).dtype
    (tmp_path / "one.npz").write_bytes((tmp_path / "two.npz").read_bytes()[:400])
    with pytest.raises(RunError, match="Delete it"):
        trial_table.load_table(tmp_path / "one.npz")


def test_joined_tables_keep_each_trials_point():
    first, second = _some(4), _some(3, seed=1, name="more")
    both = trial_table.join_tables([first, second])
    assert len(both) == len(first) + len(second)
    assert np.array_equal(both.unit(), np.concatenate([first.unit(), second.unit()]))
    assert np.array_equal(both.take(both.point >= len(first.points)).unit(), second.unit())


def test_twsr_is_the_metric_of_a_trial():
    made, least = _some(12), trial_table.suite_t_star(SUITE)
    worth, spent = trial_table.twsr(made, least), trial_table.time_spent_s(made)
    for number in range(0, len(made), 7):
        best = SUITE.tasks[made.task[number]].t_star
        expected = best / max(best, spent[number]) if made.met[number] else 0.0
        assert worth[number] == pytest.approx(expected)
    assert (spent[~made.met] == 90.0).all()


def test_a_simulated_study_loses_as_many_trials_as_the_published_one():
    made = whole(design_points.sobol_points(3, len(NAMES), 0, "s"), SUITE, 0, None, 1, None, "s", PAPER.design)
    assert len(made) == 3 * 180
    for study in range(3):
        for number, name in enumerate(targets.CONDITIONS):
            rows = (made.study == study) & (made.condition == number)
            assert rows.sum() == 60
            assert made.valid[rows].sum() == PAPER.design.valid[name] == PAPER.sr[name].n
            assert made.counted[rows].sum() == PAPER.design.counted.get(name, 0)
    assert not (made.counted & ~made.valid).any()
    lost = [set(np.flatnonzero(~made.valid[made.study == study]).tolist()) for study in range(3)]
    assert lost[0] != lost[1]


# -------------------------------------------------------------------------------------------------- identity and ledger


def test_what_decides_only_t_star_is_no_part_of_a_trials_identity():
    slower = tuple(msgspec.structs.replace(task, t_star=task.t_star + 7.0, difficulty="hard") for task in SUITE.tasks)
    elsewhere = (msgspec.structs.replace(SUITE.tasks[0], time_limit=80.0), *SUITE.tasks[1:])
    known = session_store.trials_identity(SUITE)
    assert session_store.trials_identity(msgspec.structs.replace(SUITE, tasks=slower)) == known
    assert known.differences(session_store.trials_identity(msgspec.structs.replace(SUITE, tasks=elsewhere))) == [
        "suite paper"
    ]


def test_identity_has_the_code_the_rules_and_the_priors():
    parts = session_store.trials_identity(SUITE).parts
    assert {"code", "rules", "parameters and their priors", "version of mujoco", "suite paper"} <= set(parts)
    assert "version of hthor" not in parts
    assert session_store.statistics_sha256() != parts["code"]


def _identity(**parts):
    return TrialIdentity(parts=parts)


def _line(key, *rows):
    return trial_record.encode(SessionOutcome(key=key, rows=rows))


def test_sessions_are_kept_once_and_a_torn_line_is_cut(tmp_path):
    known = _identity(a="1")
    with SessionStore(tmp_path, known) as book:
        assert book.append(_line("", (1, 2))).rows == ((1, 2),)
        for _ in range(2):
            book.append(_line("one", (1, 2), (3, 4)))
    whole_file = (tmp_path / session_store.FILE).read_bytes()
    assert whole_file.count(b"\n") == 1
    (tmp_path / session_store.FILE).write_bytes(whole_file + b'{"key":"two","ro')
    with SessionStore(tmp_path, known) as book:
        assert book.cut_bytes == 16
        assert set(book.sessions) == {"one"}
    assert (tmp_path / session_store.FILE).read_bytes() == whole_file


def test_a_changed_line_is_told_of(tmp_path):
    with SessionStore(tmp_path, _identity(a="1")) as book:
        book.append(_line("one", (1, 2)))
    path = tmp_path / session_store.FILE
    path.write_bytes(path.read_bytes().replace(b"[1,2]", b"[1,3]"))
    with pytest.raises(RunError, match=r"line 1: check: [0-9a-f]+ is not the line's checksum"):
        SessionStore(tmp_path, _identity(a="1"))


def test_sessions_of_another_world_are_never_taken_for_ones_of_this(tmp_path):
    with SessionStore(tmp_path, _identity(a="1", b="2")):
        pass
    with SessionStore(tmp_path, _identity(a="1", b="3")) as book:  # nothing was played yet
        book.append(_line("one", (1, 2)))
        with pytest.raises(RunLocked):
            SessionStore(tmp_path, _identity(a="1", b="3"))
    with pytest.raises(RunError, match="another world or person: b changed"):
        SessionStore(tmp_path, _identity(a="1", b="4"))


def test_a_product_is_made_again_only_when_what_it_comes_of_has_changed(tmp_path):
    made = []

    def make():
        made.append(1)
        return np.arange(3)

    for key in ("a", "a", "b", "b", "a"):
        assert ArtifactCache(tmp_path, key * 64).get("thing", make).tolist() == [0, 1, 2]
    assert len(made) == 3


# ---------------------------------------------------------------------------------------------------------------- gates

GOOD = acceptance.QualityFigures(
    coverage=0.9,
    studies=200,
    z_sd=1.0,
    shifts=(AbcShift(name="v_pace", shift=-0.2),),
    effective=4000.0,
    covered=(8, 8),
    close=(8, 8),
)


def test_each_gate_fails_alone():
    assert all(gate.passed for gate in acceptance.judge_calibration(GOOD, quick=False))
    bad = {
        "coverage": 0.8,
        "studies": 199,
        "z_sd": 1.2,
        "shifts": (*GOOD.shifts, AbcShift(name="a0", shift=-0.6)),
        "effective": 10.0,
        "covered": (7, 8),
        "close": (7, 8),
    }
    for name, value in bad.items():
        verdicts = acceptance.judge_calibration(msgspec.structs.replace(GOOD, **{name: value}), quick=False)
        assert sum(not gate.passed for gate in verdicts) == 1, name
    assert not all(
        gate.passed for gate in acceptance.judge_calibration(msgspec.structs.replace(GOOD, shifts=()), quick=False)
    )


def test_a_small_calibration_has_wider_gates_and_they_still_can_fail():
    small = msgspec.structs.replace(GOOD, studies=10, shifts=(), close=(3, 8), z_sd=1.3)
    assert all(gate.passed for gate in acceptance.judge_calibration(small, quick=True))
    for change in ({"z_sd": 2.2}, {"coverage": 0.5}, {"covered": (2, 8)}, {"effective": 3.0}):
        assert not all(
            gate.passed for gate in acceptance.judge_calibration(msgspec.structs.replace(small, **change), quick=True)
        )
