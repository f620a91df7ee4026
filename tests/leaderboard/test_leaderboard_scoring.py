# ruff: noqa: F811  fixtures are imported, and named by tests
"""How entries are scored is apart from how their trials were played: it refutes nobody, and can be made anew."""

from __future__ import annotations

import json
from pathlib import Path
from unittest import mock

import msgspec
import pytest
from board_fakes import board, code, contents, entry_of, kept, runs, whole  # noqa: F401
from typer.testing import CliRunner

from hthor import code_identity
from hthor.cli import app
from hthor.leaderboard import board_check, enter, publish
from hthor.leaderboard.entries import files, trial_outcomes
from hthor.leaderboard.entries.files import BoardError
from hthor.leaderboard.page import page
from hthor.leaderboard.ranking import admission, listing
from hthor.leaderboard.verify import replay, verify

OTHER = "78" * 32


def _listed(board: Path) -> str:
    return CliRunner().invoke(app, ["leaderboard", "list", "--board", str(board)], catch_exceptions=False).output


def test_the_board_shows_both_hashes(whole: Path):
    (section,) = json.loads((whole / "leaderboard.json").read_bytes())["sections"]
    assert (section["code"], section["scoring"]) == ("34" * 32, code_identity.scoring_sha256())
    text = (whole / "index.html").read_text()
    assert all(digest[:10] in text for digest in (section["code"], section["scoring"]))
    for path in files.entry_paths(whole):
        entry = files.read_entry(path)
        assert entry.run.code_sha256 == section["code"]
        assert entry.scoring_sha256 == section["scoring"]


def test_another_scoring_version_leaves_a_board_in_order_and_rescoring_brings_it_up_to_date(
    board: Path, monkeypatch: pytest.MonkeyPatch
):
    before = {path: files.read_entry(path).digest for path in files.entry_paths(board)}
    assert "scored by" not in _listed(board)
    monkeypatch.setattr(code_identity, "scoring_sha256", lambda: OTHER)
    assert publish.differences(board) == []
    assert f"not by the present one, {OTHER[:10]}" in _listed(board)
    assert publish.rescore(board) == files.entry_paths(board)
    assert publish.measured_otherwise(board) == []
    publish.build_board(board)
    assert "scored by" not in _listed(board)
    for path, digest in before.items():
        assert files.read_entry(path).scoring_sha256 == OTHER
        assert files.read_entry(path).digest == digest, "what was verified is still verified"


def test_entries_of_different_scoring_versions_are_not_ranked_together(whole: Path):
    entries, taken = [files.read_entry(path) for path in files.entry_paths(whole)], admission.load_admission(whole)
    (helper,) = [one for one in entries if one.agent.name == "helper"]
    other = msgspec.structs.replace(helper, scoring_sha256=OTHER)
    rest = [one for one in entries if one is not helper]
    found = listing.make_board([*rest, other], kept(*entries), taken)
    assert sorted((one.scoring, len(one.rows)) for one in found.sections) == sorted(
        [(OTHER, 1), (code_identity.scoring_sha256(), 2)]
    )
    assert page.render(found).count("until &#x27;hthor leaderboard rescore&#x27; brings them together") == 2
    rows = {row.name: row for section in found.sections for row in section.rows}
    assert (rows["helper"].ranks, rows["helper"].unranked) == (None, "to be rescored")
    assert rows["clumsy"].ranks is not None


def test_outcomes_of_other_metrics_are_no_refutation_and_are_measured_again_from_the_log(board: Path, runs: Path):
    good, path = contents(board), entry_of(board, "helper")
    entry = files.read_entry(path)
    older = msgspec.structs.replace(entry, trials=msgspec.structs.replace(entry.trials, metrics_sha256=OTHER))
    files.write_document(path, older)
    (problem,) = board_check.check_board(board)
    assert problem.line.endswith(
        f"scoring_sha256: is the present one, but 'trials' was measured by other metrics, {OTHER[:10]}"
    )
    older = msgspec.structs.replace(older, scoring_sha256=OTHER)
    files.write_document(path, older)
    with pytest.raises(BoardError, match=r"trials\.metrics_sha256: .* measured by other metrics"):
        verify.verify_entry(path, board, replay.Request(word="chance"))
    assert publish.measured_otherwise(board) == [path]
    publish.rescore(board)
    assert files.read_entry(path).scoring_sha256 is msgspec.UNSET, "no single version scored it"
    assert board_check.check_board(board) == []
    enter.add_runs(runs / "helper", board)
    publish.build_board(board)
    assert contents(board) == good


def test_another_log_does_not_replace_an_entry(board: Path, runs: Path):
    path = entry_of(board, "helper")
    entry = files.read_entry(path)
    other = msgspec.structs.replace(
        entry,
        trials=msgspec.structs.replace(entry.trials, metrics_sha256=OTHER),
        hashes=msgspec.structs.replace(entry.hashes, trials=OTHER),
    )
    files.write_document(path, other)
    with pytest.raises(BoardError, match="is not overwritten"):
        enter.add_runs(runs / "helper", board)


def test_the_metrics_of_the_columns_are_those_that_count():
    with mock.patch.object(code_identity, "modules_sha256") as hashed:
        trial_outcomes.metrics_sha256.__wrapped__()
    (names,) = hashed.call_args.args
    kept = {name.rpartition(".")[2] for name in names}
    assert kept == {"trial_metrics", "communication", "success", "time_spent", "trust"}
