"""Corrections of trials: append-only, found when damaged, respected by everything that reads trials, and revocable."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from unittest import mock

import eval_fakes as fakes
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from law_cases import cases
from typer.testing import CliRunner

from hthor import code_identity, jsonio, log_corrections
from hthor.calibration.from_logs import trial_features
from hthor.cli import app
from hthor.errors import HthorError, RunError, RunLocked, UnknownName
from hthor.eval.comparison import compare
from hthor.eval.config import run_config
from hthor.eval.config.shards import parse_shard
from hthor.eval.merge import merge_shards
from hthor.eval.records import corrections, find, trial_log
from hthor.eval.records.corrections import CorrectionOptions
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.results import aggregate, result_file
from hthor.eval.results.result_file import RunResult
from hthor.eval.runner import progress, run
from hthor.humans.models import _logged_trials
from hthor.leaderboard import enter
from hthor.leaderboard.entries.files import BoardError
from hthor.report.analysis import load_runs, run_provenance
from hthor.report.page import case_study

pytestmark = pytest.mark.usefixtures("no_workers")

COUNT = 20
CABLE = "the headset's cable came loose"
APART = "study/runs"
"""Folders between a run and those of other tests, which would be found as its baseline."""


def played(folder: Path, *, absent: bool = False) -> RunFolder:
    """A complete run of two sessions."""
    plan, dealt = fakes.run_of(COUNT, absent=absent)
    where = RunFolder(folder)
    run.run_evaluation(plan, dealt, fakes.player, folder=where, engine=fakes.Here(), watcher=progress.Silent())
    return RunFolder(folder)


@pytest.fixture(scope="module")
def source(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("source") / APART / "run"
    played(folder)
    return folder


@pytest.fixture
def folder(source: Path, tmp_path: Path) -> Path:
    shutil.copytree(source, tmp_path / APART / "run")
    return tmp_path / APART / "run"


def correct(folder: Path, trial: object = "", *, reason: str = CABLE, **asked: object) -> corrections.CorrectionList:
    return corrections.correct(folder, CorrectionOptions(trial=str(trial), reason=reason, **asked))  # type: ignore[arg-type]


def scored(folder: Path) -> RunResult:
    """The result, stored as by `hthor score`."""
    result = aggregate.rescore(folder)[1]
    result_file.store_result(folder, result)
    return result


def hthor(*words: str, code: int = 0) -> str:
    said = CliRunner().invoke(app, words, env={"COLUMNS": "200"})
    output = said.output if said.exception is None or isinstance(said.exception, SystemExit) else str(said.exception)
    if isinstance(said.exception, HthorError):
        assert said.exception.exit_code == code
    else:
        assert said.exit_code == code, output
    return output


MADE = st.lists(
    st.tuples(st.integers(0, COUNT - 1), st.sampled_from(["void", "again", "yes", "no", "exclude"])),
    min_size=1,
    max_size=5,
    unique_by=lambda pair: pair[0],
)


def asked(what: str) -> dict[str, object]:
    return {"void": True, "again": what == "again"} if what in ("void", "again") else {"adoption": what}


@settings(max_examples=cases(12), suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(made=MADE, order=st.randoms(use_true_random=False))
def test_withdrawing_all_corrections_gives_back_the_same_bytes(
    source: Path, tmp_path_factory: pytest.TempPathFactory, made: list[tuple[int, str]], order: object
) -> None:
    folder = tmp_path_factory.mktemp("law") / APART / "run"
    shutil.copytree(source, folder)
    log, result = (folder / "trials.jsonl").read_bytes(), (folder / "result.json").read_bytes()
    for trial, what in made:
        before = (folder / "corrections.jsonl").read_bytes() if (folder / "corrections.jsonl").exists() else b""
        correct(folder, trial, **asked(what))
        assert (folder / "corrections.jsonl").read_bytes().startswith(before), "the file only grows"
    assert scored(folder).corrections.count == len(made)  # type: ignore[union-attr]
    numbers = list(range(1, len(made) + 1))
    order.shuffle(numbers)  # type: ignore[attr-defined]
    for number in numbers:
        correct(folder, withdraw=number)
    scored(folder)
    assert (folder / "result.json").read_bytes() == result
    assert (folder / "trials.jsonl").read_bytes() == log
    assert len(RunFolder(folder).corrections.lines) == 2 * len(made), "nothing was deleted"


@settings(max_examples=cases(12), suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(made=MADE, order=st.randoms(use_true_random=False))
def test_the_order_of_corrections_of_different_trials_makes_no_difference(
    source: Path, tmp_path_factory: pytest.TempPathFactory, made: list[tuple[int, str]], order: object
) -> None:
    found = []
    other = list(made)
    order.shuffle(other)  # type: ignore[attr-defined]
    for some in (made, other):
        folder = tmp_path_factory.mktemp("law") / APART / "run"
        shutil.copytree(source, folder)
        for trial, what in some:  # numbers of trials do not move when trials are voided
            correct(folder, trial, **asked(what))
        result = aggregate.rescore(folder)[1]
        found.append((result.metrics, result.counts, result.hashes))
    assert found[0] == found[1]


def test_every_reader_drops_a_void_trial(folder: Path, tmp_path: Path) -> None:
    alone = played(tmp_path / "alone", absent=True)
    whole = aggregate.rescore(folder)[1]
    key = find.find_trial(RunFolder(folder), "5").key
    task = find.find_trial(RunFolder(folder), "5").spec.task.id
    correct(folder, 5, void=True)
    this = RunFolder(folder)
    assert len(this.records()) == COUNT - 1
    assert key not in {one.key for one in this.records()}
    assert [(one.key, one.reason, one.correction) for one in this.voided] == [(key, CABLE, 1)]
    assert find.find_trial(this, "5").log.voided == CABLE, "the trial keeps its number"
    assert find.find_trial(this, "6").spec.index == 6, "and so do those after it"
    result = scored(folder)
    assert (result.counts.trials, result.counts.voided, result.over) == (COUNT - 1, 1, COUNT)
    assert result.hashes.trials != whole.hashes.trials
    compared = compare.compare_runs([alone.path, folder])
    assert (compared.pairs[0].n, compared.pairs[0].dropped) == (COUNT - 1, (1, 0))
    assert (compared.runs[1].voided, compared.runs[1].corrections, compared.runs[1].planned) == (1, 1, COUNT - 1)
    (read,) = load_runs.load_runs([folder])
    (shown,) = run_provenance.run_provenance(read).corrections
    assert (len(read.records), shown.correction.reason, shown.task) == (COUNT - 1, CABLE, task)
    assert len(trial_features.read_sessions([folder]).trials) == COUNT - 1
    assert len(trial_features.read_sessions([folder / "trials.jsonl"]).trials) == COUNT - 1
    logged = _logged_trials.read_logged_trials(str(folder))
    assert sum(map(len, logged.values())) == COUNT - 1
    with pytest.raises(RunError, match=f"{key} of '{task}' is void.*{CABLE}"):
        case_study.write_case_study([folder], task, tmp_path / "report")


def test_people_who_replay_a_log_are_other_people_after_a_correction(folder: Path) -> None:
    before = _logged_trials.ingredients(str(folder))
    correct(folder, 5, void=True)
    assert _logged_trials.ingredients(str(folder)) != before


def test_a_void_trial_of_the_run_without_a_robot_has_no_partner(folder: Path) -> None:
    shutil.rmtree(folder / "control", ignore_errors=True)
    control = played(folder / "control", absent=True)
    assert scored(folder).uplift.sr.n == COUNT  # type: ignore[union-attr]
    correct(control.path, 3, void=True)
    found = scored(folder).uplift
    assert found is not None
    assert (found.sr.n, found.note) == (COUNT - 1, found.note)
    assert not found.note, "the run without a robot is still whole"


@pytest.mark.parametrize(("word", "value"), [("yes", 1.0), ("no", 0.0), ("exclude", None)])
def test_a_judgement_replaces_the_adoption(folder: Path, word: str, value: float | None) -> None:
    before = aggregate.rescore(folder)[1]
    correct(folder, 4, adoption="no" if word == "yes" else "yes", reason="a mistake")
    correct(folder, 4, adoption=word, reason="they said so")
    record = find.find_trial(RunFolder(folder), "4")
    assert record.metrics["adoption"] == value
    assert record.metrics["sent"] == 1, "the messages are as they were"
    after = aggregate.rescore(folder)[1]
    assert after.metrics["adoption"].n == COUNT - (value is None)
    assert after.metrics["sr"] == before.metrics["sr"]
    assert after.counts.trials == COUNT
    correct(folder, withdraw=2)
    other = 0.0 if word == "yes" else 1.0
    assert find.find_trial(RunFolder(folder), "4").metrics["adoption"] == other, "the first judgement is back"


def test_a_void_trial_is_repeated_only_on_request(folder: Path) -> None:
    plan, dealt = fakes.run_of(COUNT)

    def go_on() -> RunResult:
        where = RunFolder(folder)
        return run.run_evaluation(
            plan, dealt, fakes.player, folder=where, engine=fakes.Here(), watcher=progress.Silent()
        )

    log = (folder / "trials.jsonl").read_bytes()
    correct(folder, 5, void=True)
    assert go_on().counts.trials == COUNT - 1
    assert (folder / "trials.jsonl").read_bytes() == log, "simulated people would do the same again"
    correct(folder, withdraw=1)
    correct(folder, 5, void=True, again=True)
    found = go_on()
    assert (found.counts.trials, found.counts.voided, found.over) == (COUNT, 1, COUNT)
    assert (folder / "trials.jsonl").read_bytes().startswith(log)
    assert find.find_trial(RunFolder(folder), "5").spec.attempt == 1
    assert find.find_trial(RunFolder(folder), "5@0").log.voided == CABLE


def test_a_correction_is_refused_with_what_can_be_done(folder: Path) -> None:
    correct(folder, 5, void=True)
    key = find.find_trial(RunFolder(folder), "5").key
    before = (folder / "corrections.jsonl").read_bytes()
    refused: list[tuple[type[HthorError], str, dict[str, object]]] = [
        (HthorError, "needs a reason: add --reason", {"trial": 6, "void": True, "reason": "  "}),
        (HthorError, "--void and --adoption are two corrections", {"trial": 6, "void": True, "adoption": "yes"}),
        (HthorError, "--void needs a trial", {"void": True}),
        (HthorError, f"trial {key} .* was voided by correction 1; withdraw that first", {"trial": 5, "void": True}),
        (UnknownName, "unknown judgement 'yess'. Did you mean 'yes'", {"trial": 6, "adoption": "yess"}),
        (UnknownName, "unknown person 'human2'", {"trial": 6, "adoption": "yes", "seat": "human2"}),
        (UnknownName, "unknown correction '7'.*Valid: 1", {"withdraw": 7}),
        (HthorError, "names a correction by its number, and no trial", {"trial": 5, "withdraw": 1}),
        (HthorError, "say what is to be corrected", {"trial": 6}),
    ]
    for kind, words, what in refused:
        with pytest.raises(kind, match=words):
            correct(folder, **what)  # type: ignore[arg-type]
    assert (folder / "corrections.jsonl").read_bytes() == before
    correct(folder, withdraw=1)
    with pytest.raises(HthorError, match="withdrawn already, by correction 2"):
        correct(folder, withdraw=1)
    with pytest.raises(HthorError, match="is a withdrawal itself"):
        correct(folder, withdraw=2)


def test_nobody_corrects_a_run_that_is_being_written(folder: Path) -> None:
    with RunFolder(folder).open_log(), pytest.raises(RunLocked):
        correct(folder, 5, void=True)


def test_without_a_robot_there_is_no_adoption_to_correct(tmp_path: Path) -> None:
    alone = played(tmp_path / "alone", absent=True)
    with pytest.raises(HthorError, match="has no robot"):
        correct(alone.path, 5, adoption="yes")


@settings(max_examples=cases(40))
@given(data=st.data())
def test_damage_is_found_and_named(data: st.DataObject, tmp_path_factory: pytest.TempPathFactory) -> None:
    folder, check, text = tmp_path_factory.mktemp("damage"), "", b""
    for number in range(1, 5):
        line = log_corrections.encode(
            log_corrections.VoidTrial(number=number, trial=f"{number:016x}", reason=CABLE), check
        )
        text, check = text + line, log_corrections.check_of(line)
    path = folder / "corrections.jsonl"
    path.write_bytes(text)
    assert len(log_corrections.load(folder).lines) == 4
    lines = text.splitlines(keepends=True)
    damage = data.draw(st.sampled_from(["byte", "cut", "drop", "swap", "garbage"]))
    if damage == "byte":
        place = data.draw(st.integers(0, len(text) - 1))
        changed = text[:place] + bytes([text[place] ^ data.draw(st.integers(1, 255))]) + text[place + 1 :]
    elif damage == "cut":
        changed = text[: data.draw(st.integers(1, len(text) - 1).filter(lambda n: text[n - 1 : n] != b"\n"))]
    elif damage == "drop":
        place = data.draw(st.integers(0, 2))
        changed = b"".join([*lines[:place], *lines[place + 1 :]])
    elif damage == "swap":
        place = data.draw(st.integers(0, 2))
        changed = b"".join([*lines[:place], lines[place + 1], lines[place], *lines[place + 2 :]])
    else:
        changed = text + data.draw(st.binary(min_size=1))
    path.write_bytes(changed)
    with pytest.raises(RunError, match=r"corrections\.jsonl, line [1-6]: .*take the file from a copy"):
        log_corrections.load(folder)


def test_lines_that_are_gone_from_the_end_are_missed(folder: Path) -> None:
    correct(folder, 5, void=True)
    correct(folder, 6, adoption="yes")
    scored(folder)
    path = folder / "corrections.jsonl"
    whole = path.read_bytes()
    for less in (whole.splitlines(keepends=True)[0], b""):
        path.write_bytes(less)
        with pytest.raises(RunError, match="is not a continuation of the 2 with which"):
            aggregate.rescore(folder)
    path.write_bytes(whole)
    correct(folder, 7, adoption="no")
    assert scored(folder).corrections.lines == 3  # type: ignore[union-attr]


def test_the_corrections_of_another_run_are_refused(folder: Path, tmp_path: Path) -> None:
    other = played(tmp_path / "other", absent=True)
    correct(other.path, 5, void=True)
    shutil.copy(other.path / "corrections.jsonl", folder)
    for read in (RunFolder(folder).records, lambda: trial_features.read_sessions([folder])):
        with pytest.raises(RunError, match=r"corrections\.jsonl, line 1: trial: .* has no trial"):
            read()


def shards(folder: Path, tmp_path: Path) -> list[Path]:
    parts = []
    for words in ("1/2", "2/2"):
        shard = run_config.shard_config(RunFolder(folder).config, parse_shard(words), COUNT)
        part = RunFolder(tmp_path / f"part-{words[0]}")
        part.path.mkdir()
        part.write_config(shard)
        own = shard.shard.share(range(2))  # type: ignore[union-attr]
        kept = (line for line, one in trial_log.read(folder / "trials.jsonl") if one.spec.session in own)
        part.log_file.write_bytes(b"".join(kept))
        parts.append(part.path)
    return parts


def test_merged_shards_bring_their_corrections(folder: Path, tmp_path: Path) -> None:
    parts, out = shards(folder, tmp_path), tmp_path / "merged"
    correct(parts[0], 4, void=True)
    correct(parts[1], 2, void=True)
    correct(parts[1], 3, adoption="exclude")
    correct(parts[1], withdraw=1)
    done = merge_shards.merge_shards(parts, out)
    assert done.result is not None
    assert (done.trials, done.result.counts.trials) == (COUNT, COUNT - 1)
    lines = RunFolder(out).corrections.lines
    assert [type(line).__name__ for line in lines] == ["VoidTrial", "VoidTrial", "Withdraw", "CorrectAdoption"]
    assert lines[2].withdraws == 2  # type: ignore[union-attr]
    before = (out / "corrections.jsonl").read_bytes()
    merge_shards.merge_shards(parts, out)
    assert (out / "corrections.jsonl").read_bytes() == before, "merging again adds nothing"
    correct(parts[0], 5, adoption="yes")
    merge_shards.merge_shards(parts, out)
    assert (out / "corrections.jsonl").read_bytes().startswith(before)
    assert len(RunFolder(out).corrections.lines) == 5


def test_corrections_that_contradict_each_other_are_not_merged(folder: Path, tmp_path: Path) -> None:
    parts, out = shards(folder, tmp_path), tmp_path / "merged"
    twin = tmp_path / "twin"
    shutil.copytree(parts[0], twin)
    correct(parts[0], 4, adoption="yes")
    correct(twin, 4, adoption="no")
    with pytest.raises(RunError, match=r"not the same in .*part-1.* and in .*twin"):
        merge_shards.merge_shards([*parts, twin], out)


def test_a_corrected_run_is_not_ranked(folder: Path) -> None:
    correct(folder, 4, adoption="yes")
    same = mock.patch.object(code_identity, "code_sha256", return_value=RunFolder(folder).config.code_sha256)
    with same, pytest.raises(BoardError, match="has 1 corrections in effect, and cannot stand on the leaderboard"):
        enter.make_entry(folder)


def test_the_command_corrects_lists_and_scores(folder: Path) -> None:
    run_ = str(folder)
    assert f"{run_} has no corrections." in hthor("correct", run_)
    before = sorted(folder.iterdir())
    words = ("correct", run_, "5", "--void", "--reason", CABLE, "--by", "A. Lee", "--date", "2026-07-01")
    assert "nothing was written" in hthor(*words, "--dry-run")
    assert sorted(folder.iterdir()) == before
    said = hthor(*words)
    assert "correction 1 was added" in said
    assert "A. Lee, 2026-07-01" in said
    assert "5 (" in said
    assert "differs from" in (again := hthor("score", run_))
    assert "1 correction is in effect" in again
    assert "voided by correction 1, does not count: session 0, trial 5" in hthor("runs", "view", run_)
    document = json.loads(hthor("correct", run_, "--json"))
    assert document["schema"] == corrections.SCHEMA
    assert [(one["correction"]["what"], one["in_effect"]) for one in document["corrections"]] == [("void", True)]
    hthor("correct", run_, "--withdraw", "1", "--reason", "it was another trial")
    assert "void, not in effect" in hthor("correct", run_)
    assert "stored again" in hthor("score", run_)
    assert "needs a reason" in hthor("correct", run_, "6", "--void", code=2)


def test_a_result_without_corrections_says_nothing_of_them(folder: Path) -> None:
    assert b"corrections" not in jsonio.pretty(aggregate.rescore(folder)[1])
