"""The validation report: what it works out of trials, what it says of them, and the page that it makes."""

from __future__ import annotations

import functools
import math
import re
from pathlib import Path
from xml.etree import ElementTree

import eval_fakes
import msgspec
import numpy as np
import pytest
import validation_fakes as fakes
from hypothesis import given, settings
from hypothesis import strategies as st
from law_cases import cases
from typer.testing import CliRunner

from hthor.calibration import evidence, targets
from hthor.calibration.evidence import FIGURES
from hthor.calibration.simulation import trial_table as tables
from hthor.calibration.validation import plan, run
from hthor.calibration.validation.report import build, criteria, measures, page, phrases, study_groups
from hthor.calibration.validation.report.figures import diagnostics
from hthor.calibration.validation.report.findings import Findings, ModelUnderTest, Setting
from hthor.cli import app as cli
from hthor.errors import HthorError, RunError
from hthor.humans.population import resolve
from hthor.report.html import elements, matplotlib_svg

PUBLISHED = build.published_study(targets.load_targets("paper"))


def subject(**more: str) -> ModelUnderTest:
    return ModelUnderTest(**{"name": "paper", "model": "proxy", "sha256": "12" * 32, **more})


def setting(**more: object) -> Setting:
    plain = Setting(
        suite="paper",
        suite_sha256="56" * 32,
        simulation=1,
        seed=0,
        participants=12,
        trials=360,
        code_sha256="78" * 32,
        versions={"hthor": "0"},
    )
    return msgspec.structs.replace(plain, **more)


@functools.cache
def whole(*, known: bool = True, quick: bool = False, seed: int = 0) -> Findings:
    return build.make_findings(
        subject(),
        setting(quick=quick),
        targets.load_targets("paper"),
        build.PlayedTrials(
            trials=fakes.trials(12, seed), t_star=fakes.LEAST, round_size=3, rivals={"greedy": fakes.trials(6, 9)}
        ),
        evidence=fakes.evidence(PUBLISHED.figures) if known else None,
        evidence_missing="" if known else "This human model was not calibrated.",
    )


def drawn(table: tables.Table, draws: int = 400) -> dict[str, study_groups.StudyGroups]:
    design = targets.load_targets("paper").design
    return study_groups.make_groups(
        table, fakes.LEAST, round_size=3, valid=design.valid, counted=design.counted, draws=draws
    )


# ------------------------------------------------------------------------------------------------------------- groups


def test_a_group_is_of_the_published_size() -> None:
    made = drawn(fakes.trials(12))
    for name, count in (("none", 58), ("frontier", 59), ("oracle", 58)):
        assert np.allclose(made[name].sr * count, np.round(made[name].sr * count))
    assert np.allclose(made["oracle"].adoption * 50, np.round(made["oracle"].adoption * 50))
    assert set(study_groups.group_figures(made)) == set(FIGURES)


def test_groups_do_every_task_twice() -> None:
    one = fakes.trials(12).take(np.flatnonzero(fakes.trials(12).condition == 0))
    chance = np.random.default_rng(0)
    rows = study_groups._people(one)[study_groups._chosen(12, 3, chance, 5)].reshape(5, -1)
    for group in one.task[rows]:
        assert np.array_equal(np.sort(group), np.repeat(np.arange(30), 2))


def test_groups_of_people_who_are_all_alike_are_all_alike() -> None:
    made = drawn(fakes.trials(12, sr=dict.fromkeys(fakes.RATES, 1.1), adopts=dict.fromkeys(fakes.RATES, -0.1)))
    assert np.all(made["none"].sr == 1.0)
    assert np.all(made["oracle"].adoption == 0.0)


def test_the_mean_of_groups_is_the_mean_of_all_trials() -> None:
    run = fakes.trials(30)
    made = drawn(run, draws=2000)
    average = measures.mean_figures(run, fakes.LEAST)
    for name, draws in study_groups.group_figures(made).items():
        assert average[name] == pytest.approx(float(draws.mean()), abs=0.01)


def test_too_few_people_for_a_group_are_refused() -> None:
    with pytest.raises(HthorError, match="too few"):
        drawn(fakes.trials(3))


def test_a_missing_trial_is_noticed() -> None:
    run = fakes.trials(6)
    with pytest.raises(HthorError, match="missing"):
        drawn(run.take(np.arange(len(run)) != 7))


def test_slopes() -> None:
    steps = np.arange(10.0)
    assert study_groups.slopes(np.stack([3.0 + 0.25 * steps, 5.0 - 0.5 * steps])) == pytest.approx([0.25, -0.5])


@given(st.floats(0.02, 0.98), st.floats(1.0, 4.0), st.integers(2, 60))
@settings(max_examples=cases(60))
def test_chances_of_all_counts_add_up_to_one(share: float, phi: float, n: int) -> None:
    chances = [math.exp(study_groups.log_count(k, n, share, phi)) for k in range(n + 1)]
    assert sum(chances) == pytest.approx(1.0, abs=1e-6)
    assert sum(k * chance for k, chance in enumerate(chances)) == pytest.approx(n * share, rel=1e-6)


def test_clustering_widens_a_count() -> None:
    def spread(phi: float) -> float:
        chance = np.exp([study_groups.log_count(k, 50, 0.6, phi) for k in range(51)])
        return float((chance * (np.arange(51) - 30.0) ** 2).sum())

    assert spread(2.0) == pytest.approx(2.0 * 50 * 0.24, rel=1e-6)
    assert spread(1.0) == pytest.approx(50 * 0.24, rel=0.02)


# ----------------------------------------------------------------------------------------------------------- measures


def test_the_table_tells_covered_from_close() -> None:
    rows = {row.figure: row for row in whole().table}
    assert list(rows) == list(FIGURES)
    for row in rows.values():
        assert row.inside == (row.band.low <= row.published <= row.band.high)
        assert row.close == (abs(row.band.median - row.published) <= row.tolerance + 1e-9)
    far = msgspec.structs.replace(rows["sr none"], published=rows["sr none"].band.high + 0.001, tolerance=0.5)
    assert not far.inside
    assert far.close


def test_a_share_in_the_middle_has_a_percentile_in_the_middle() -> None:
    made = drawn(fakes.trials(30))
    median = {name: float(np.median(draws)) for name, draws in study_groups.group_figures(made).items()}
    study = msgspec.structs.replace(PUBLISHED, figures=median)
    for row in measures.predict_figures(study, fakes.trials(30), fakes.LEAST, made):
        assert 0.4 < row.percentile < 0.6


def test_time_spent_is_what_it_is() -> None:
    run = fakes.trials(12)
    found = {one.condition: one for one in measures.time_spent(run)}
    seconds = tables.time_spent_s(run)[run.condition == 2]
    assert found["oracle"].least == pytest.approx(seconds.min())
    assert found["oracle"].lower == pytest.approx(np.percentile(seconds, 25))
    assert found["oracle"].most <= 90.0
    gaps = {(one.statistic, one.a, one.b): one.value for one in measures.time_differences(run, drawn(run))}
    assert gaps["lower quartile", "oracle", "none"] == pytest.approx(found["oracle"].lower - found["none"].lower)
    assert len(gaps) == 6


def test_trust_is_known_only_where_both_robots_were_rated() -> None:
    run = fakes.trials(12)
    found = measures.trust_findings(run, drawn(run))
    assert found is not None
    rated = run.trust[run.condition == 2].astype(float)
    oracle = next(curve for curve in found.curves if curve.condition == "oracle")
    assert np.mean(oracle.mean) == pytest.approx(rated.mean())
    assert len(oracle.mean) == 10
    assert oracle.slope > 0.0
    silent = msgspec.structs.replace(run, trust=np.zeros_like(run.trust))
    assert measures.trust_findings(silent, drawn(silent)) is None


def test_a_model_that_is_right_scores_better() -> None:
    right, wrong = (
        fakes.trials(30, 1),
        fakes.trials(30, 1, dict.fromkeys(fakes.RATES, 0.3), dict.fromkeys(fakes.RATES, 0.1)),
    )
    good = measures.score_model("good", PUBLISHED, right, fakes.LEAST, drawn(right)).log_score
    bad = measures.score_model("bad", PUBLISHED, wrong, fakes.LEAST, drawn(wrong)).log_score
    assert all(good[name] > bad[name] + 1.0 for name in good)


def test_records_become_the_same_numbers() -> None:
    suite = eval_fakes.suite(30)
    runs = {}
    for condition, absent in (("none", True), ("oracle", False)):
        _, dealt = eval_fakes.run_of(30, absent=absent)
        runs[condition] = [done for session in dealt for done in eval_fakes.records(session)]
    made = build.records_table(runs, suite)
    for number, condition in ((0, "none"), (2, "oracle")):
        one = made.take(made.condition == number)
        order = sorted(runs[condition], key=lambda done: (done.spec.session, done.spec.index))
        place = np.lexsort((one.index, one.participant))
        assert np.array_equal(one.met[place], [bool(done.metrics.sr) for done in order])
        assert np.allclose(tables.time_spent_s(one)[place], [done.metrics.time_s for done in order])
        assert np.allclose(tables.twsr(one, tables.suite_t_star(suite))[place], [done.metrics.twsr for done in order])
        assert np.array_equal(one.adopted[place], [bool(done.metrics.adoption) for done in order])
        assert np.array_equal(one.trust[place], [done.metrics.trust or 0 for done in order])


# -------------------------------------------------------------------------------------------------------------- words


@given(st.integers(0, 8), st.integers(0, 8))
@settings(max_examples=cases(30))
def test_the_verdict_counts(covered: int, close: int) -> None:
    base = whole()
    rows = tuple(
        msgspec.structs.replace(
            row,
            published=0.5,
            tolerance=0.04,
            band=evidence.Band(low=0.4 if place < covered else 0.6, median=0.5 if place < close else 0.9, high=0.95),
        )
        for place, row in enumerate(base.table)
    )
    said = phrases.verdict(msgspec.structs.replace(base, table=rows))
    assert said.startswith(f"{covered} of 8 published figures")
    assert f"and {close} of 8 medians" in said
    assert ("Outside" in said) == (covered < 8)
    assert ("Too far" in said) == (close < 8)


@pytest.mark.parametrize(
    ("contraction", "recovery", "word"),
    [
        (0.79, 0.89, phrases.IDENTIFIED),
        (0.79, None, phrases.IDENTIFIED),
        (0.79, 0.50, phrases.WEAKLY),
        (0.27, 0.53, phrases.WEAKLY),
        (0.21, 0.17, phrases.NOT),
        (0.05, 0.90, phrases.NOT),
    ],
)
def test_what_is_identified(contraction: float, recovery: float | None, word: str) -> None:
    one = fakes.evidence(PUBLISHED.figures).parameters[0]
    one = msgspec.structs.replace(one, contraction=contraction, recovery=recovery)
    assert phrases.identified(one) == word


def test_converging_is_never_claimed() -> None:
    said = " ".join((*phrases.trust(whole().trust), *whole().misfits))  # type: ignore[arg-type]
    assert "is not claimed" in said
    for sentence in re.split(r"(?<=[.:]) ", said):
        if "converg" in sentence:
            assert "claimed" in sentence


def test_quartiles_that_differ_are_told_by_how_much() -> None:
    found = whole()
    near = [msgspec.structs.replace(one, value=6.9) for one in found.differences]
    far = [msgspec.structs.replace(one, value=-9.5 if one.a == "oracle" else 1.0) for one in found.differences]
    assert "within 7 s of one another" in phrases.quartiles(found.spent, near)
    assert "2.5 s beyond 7 s" in phrases.quartiles(found.spent, far)


def test_small_words() -> None:
    assert phrases.listed([]) == "none"
    assert phrases.listed(["a", "b", "c"]) == "a, b and c"
    assert phrases.signed(-0.04) == "0.0"
    assert phrases.signed(-1.26) == "−1.3"
    assert phrases.percent(None) == "–"
    assert phrases.span(evidence.Band(low=-0.01, median=0.0, high=2.0)) == "0.0 … 2.0"


def test_the_worst_kind_is_named() -> None:
    kinds = tuple(
        measures.model_figures(name, fakes.trials(6, 1, {"none": 0.3, "frontier": 0.6, "oracle": oracle}), fakes.LEAST)
        for name, oracle in (("fast", 0.95), ("slow", 0.4))
    )
    said = phrases.kinds(msgspec.structs.replace(whole(), kinds=kinds))
    assert "slow people fare worst" in said
    assert "does not hold in both SR and TWSR for slow" in said


# -------------------------------------------------------------------------------------------------------------- gates


def verdicts(found: Findings) -> dict[str, str]:
    return {gate.name: gate.verdict for gate in criteria.judge_findings(found)}


def changed(**parts: object) -> Findings:
    known = whole().evidence
    assert known is not None
    return msgspec.structs.replace(whole(), evidence=msgspec.structs.replace(known, **parts))


def test_good_evidence_passes() -> None:
    found = verdicts(changed())
    passed = (
        "held-out figures",
        "held-out log scores",
        "coverage",
        "emulator",
        "ABC cross-check",
        "order of the robots",
    )
    assert {name: found[name] for name in passed} == dict.fromkeys(passed, "passed")


def test_each_bar_can_be_missed() -> None:
    known = whole().evidence
    assert known is not None
    assert known.coverage is not None
    first = known.held_out[0]
    outside = msgspec.structs.replace(first.figures[0], published=first.figures[0].band.high + 0.01)
    order = msgspec.structs.replace(known.rankings[0], twsr=0.94)
    missed = {
        "held-out figures": {"held_out": (msgspec.structs.replace(first, figures=(outside,)),)},
        "held-out log scores": {"held_out": (msgspec.structs.replace(first, log_score=-99.0),)},
        "coverage": {"coverage": msgspec.structs.replace(known.coverage, mean=0.85)},
        "emulator": {"emulator_z": 1.11},
        "ABC cross-check": {"abc": (evidence.AbcShift(name="v_pace", shift=-0.5),)},
        "order of the robots": {"rankings": (order,)},
    }
    for name, parts in missed.items():
        found = verdicts(changed(**parts))
        assert [gate for gate, verdict in found.items() if verdict == "failed" and gate in missed] == [name]


def test_too_few_simulated_studies_fail() -> None:
    known = whole().evidence
    assert known is not None
    assert known.coverage is not None
    few = msgspec.structs.replace(known.coverage, studies=199)
    assert verdicts(changed(coverage=few))["coverage"] == "failed"


def test_what_is_quick_or_unknown_is_not_judged() -> None:
    assert set(verdicts(whole(known=False, quick=True)).values()) == {"not judged"}
    known = whole().evidence
    assert known is not None
    quick = changed(origin=msgspec.structs.replace(known.origin, quick=True), emulator_z=7.0)
    assert verdicts(quick)["emulator"] == "not judged"


# --------------------------------------------------------------------------------------------------------------- page


@functools.cache
def rendered(known: bool) -> str:
    return page.render(whole(known=known))


def test_the_page_is_whole_and_needs_nothing_else() -> None:
    for known in (True, False):
        text = rendered(known)
        assert re.findall(r"<h2><span>(\d+)</span>", text) == [str(number) for number in range(1, 12)]
        for stranger in ("http", "<script", "src=", "@import", "url(h", "xlink"):
            assert stranger not in text
        ids = re.findall(r' id="([^"]+)"', text)
        assert len(ids) == len(set(ids))
        assert set(re.findall(r'href="#([^"]+)"', text)) <= set(ids)
        assert set(re.findall(r"url\(#([^)]+)\)", text)) <= set(ids)
        assert text.count("<svg") == text.count("</svg>") > 2
    assert rendered(True).count("<svg") > rendered(False).count("<svg")


def test_the_same_findings_make_the_same_page() -> None:
    assert page.render(whole(known=False)) == rendered(False)
    drawings = [matplotlib_svg.to_svg(diagnostics.contraction(whole().evidence.parameters), "a", "b") for _ in range(2)]  # type: ignore[union-attr]
    assert drawings[0] == drawings[1]


def test_drawings_are_well_formed_and_in_the_colours_of_the_page() -> None:
    body = rendered(True).partition("</style>")[2]
    drawings = re.findall(r"<svg.*?</svg>", body, flags=re.DOTALL)
    for drawing in drawings:
        ElementTree.fromstring(drawing)
    assert not re.search(r"#[0-9a-f]{6}\b", body)
    assert set(re.findall(r"var\(--(\w+)\)", body)) <= set(matplotlib_svg.VARIABLES.values())
    assert matplotlib_svg.DARK.keys() == matplotlib_svg.VARIABLES.keys()


def test_the_page_shows_the_numbers_of_its_findings() -> None:
    text = rendered(True)
    for row in whole().table:
        assert f'<td class="n">{phrases.span(row.band, 100.0)}</td>' in text
    assert text.count(">not identified<") >= 20
    for one in whole().spent:
        assert f">{one.lower:.1f}</td>" in text
    assert tuple(whole(seed=5).table) != whole().table


def test_without_a_calibration_the_page_says_so_in_each_section() -> None:
    text = rendered(False)
    for name in ("predictive", "held-out", "parameters", "coverage", "emulator", "ranking"):
        section = text.partition(f'<section id="{name}">')[2].partition("</section>")[0]
        assert "This human model was not calibrated." in section
    assert "Log score of the published counts" in text


def test_names_cannot_break_the_page() -> None:
    found = msgspec.structs.replace(whole(known=False), subject=subject(name="<b>&", purpose='"</title>'))
    text = page.render(found)
    assert "<b>&" not in text
    assert "&lt;b&gt;&amp;" in text
    assert elements.table(("<i>",), [("&",)]).count("&amp;") == 1


def test_findings_travel_as_json() -> None:
    text = msgspec.json.encode(whole())
    assert msgspec.json.decode(text, type=Findings) == whole()
    assert whole().schema == "hthor.validation/1"


# ----------------------------------------------------------------------------------------------------------- evidence


def test_evidence_is_read_back(tmp_path: Path) -> None:
    known = fakes.evidence(PUBLISHED.figures)
    (tmp_path / evidence.FILE).write_bytes(evidence.encode_evidence(known))
    assert evidence.load_evidence(tmp_path) == evidence.load_evidence(tmp_path / evidence.FILE) == known


def test_evidence_that_cannot_be_used_says_what_to_do(tmp_path: Path) -> None:
    with pytest.raises(RunError, match="hthor calibrate"):
        evidence.load_evidence(tmp_path)
    (tmp_path / evidence.FILE).write_text("{")
    with pytest.raises(RunError, match=r"evidence\.json"):
        evidence.load_evidence(tmp_path)
    strange = msgspec.structs.replace(fakes.evidence(PUBLISHED.figures), schema="hthor.evidence/0")
    (tmp_path / evidence.FILE).write_bytes(evidence.encode_evidence(strange))
    with pytest.raises(RunError, match="schema"):
        evidence.load_evidence(tmp_path)


def test_evidence_of_another_population_is_not_believed(tmp_path: Path) -> None:
    known = fakes.evidence(PUBLISHED.figures)
    (tmp_path / evidence.FILE).write_bytes(evidence.encode_evidence(known))
    found = resolve.resolve_humans("literature")
    assert run._evidence(found, tmp_path) == (None, run.OTHERS)
    mine = msgspec.structs.replace(known.origin, population_sha256=found.population.sha256)
    (tmp_path / evidence.FILE).write_bytes(evidence.encode_evidence(msgspec.structs.replace(known, origin=mine)))
    assert run._evidence(found, tmp_path)[0] is not None


@pytest.mark.parametrize(
    ("name", "says"), [("greedy", "not calibrated"), ("cautious", "by hand"), ("literature", "not fitted to data")]
)
def test_people_without_evidence_are_told_apart(name: str, says: str) -> None:
    known, missing = run._evidence(resolve.resolve_humans(name), None)
    assert known is None
    assert says in missing


# ------------------------------------------------------------------------------------------------------------ command


@pytest.fixture
def stage(monkeypatch: pytest.MonkeyPatch) -> list[tuple[str, str, int]]:
    """Nobody plays; what would have been played is noted."""
    asked: list[tuple[str, str, int]] = []

    def play(self: object, one: plan.ValidationRun) -> tables.Table:
        asked.append((one.word, one.suite, one.participants))
        return fakes.trials(one.participants)

    monkeypatch.setattr(run._ConditionRuns, "trials", play)
    return asked


def test_the_command_writes_the_report_and_fails_with_its_bars(
    stage: list[tuple[str, str, int]], tmp_path: Path
) -> None:
    done = CliRunner().invoke(cli, ["humans", "validate", "literature", "--out", str(tmp_path), "--json"])
    stored = msgspec.json.decode((tmp_path / "validation.json").read_bytes(), type=Findings)
    failed = criteria.failed_gates(stored.gates)
    assert done.exit_code == (1 if failed else 0)
    assert failed  # the made-up people are too slow for the published TWSR
    assert msgspec.json.decode(done.stdout, type=Findings) == stored
    assert (tmp_path / "validation.html").read_text() == page.render(stored)
    assert "published figures covered" in done.stderr
    assert "not cleared: " in done.stderr
    assert [(word, many) for word, _, many in stage] == [("literature", 60), ("greedy", 30), ("random", 30)]


def test_a_quick_run_is_small_and_judges_nothing_played(stage: list[tuple[str, str, int]], tmp_path: Path) -> None:
    done = CliRunner().invoke(cli, ["humans", "validate", "greedy", "--quick", "--out", str(tmp_path)])
    assert done.exit_code == 0, done.stderr
    assert [many for _, _, many in stage] == [plan.QUICK]
    assert "SR no robot" in done.stdout


def test_a_dry_run_says_what_would_be_played_and_writes_nothing(tmp_path: Path) -> None:
    out = tmp_path / "report"
    words = ["humans", "validate", "greedy", "--participants", "6", "--suite", "smoke", "--dry-run", "--out", str(out)]
    done = CliRunner().invoke(cli, words)
    assert done.exit_code == 0, done.stderr
    assert "540 of 540 trials would be played" in done.stdout  # greedy and random, then greedy on smoke
    told = msgspec.json.decode(CliRunner().invoke(cli, [*words, "--json"]).stdout)
    assert [(one["people"], one["role"], one["suite"]) for one in told["runs"]][::3] == [
        ("greedy", "judged", "paper"),
        ("random", "rival", "paper"),
        ("greedy", "suite", "smoke"),
    ]
    assert told["trials"] == sum(one["run"]["trials"] for one in told["runs"])
    assert not out.exists()


def test_kinds_and_suites_are_played_when_asked_for(stage: list[tuple[str, str, int]], tmp_path: Path) -> None:
    options = run.ValidationOptions(name="literature", quick=True, kinds=True, suites=("smoke",), out=tmp_path)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(measures, "model_figures", lambda name, run, least: _played(name))
        done = run.run_validation(options, lambda _: pytest.fail("nobody plays"))
    names = [word for word, suite, _ in stage if suite == "paper"]
    assert "cautious" in names
    assert ("literature", "smoke", plan.QUICK) in stage
    assert "By kind of people" in (tmp_path / "validation.html").read_text()
    assert [one.name for one in done.findings.suites] == ["smoke"]


def _played(name: str) -> object:
    from hthor.calibration.validation.report.findings import ModelFigures

    return ModelFigures(name=name, figures=dict.fromkeys(FIGURES, 0.5), trials=30)


def test_too_few_participants_are_refused_before_anything_is_played(stage: list[tuple[str, str, int]]) -> None:
    with pytest.raises(HthorError, match="too few"):
        run.run_validation(run.ValidationOptions(participants=5), lambda _: pytest.fail("nobody plays"))
    assert not stage


def test_few_people_are_not_judged(stage: list[tuple[str, str, int]], tmp_path: Path) -> None:
    options = run.ValidationOptions(name="greedy", participants=12, out=tmp_path)
    done = run.run_validation(options, lambda _: pytest.fail("nobody plays"))
    assert [many for _, _, many in stage] == [12, 12]
    assert set(verdicts(done.findings).values()) == {"not judged"}
    assert "ask for 18 people or more" in (tmp_path / "validation.html").read_text()
