# ruff: noqa: F811  fixtures are imported, and named by tests
"""The leaderboard: whole runs only, the same bytes always, and whatever is changed in an entry is named."""

from __future__ import annotations

import io
import json
import os
import shutil
import subprocess
import tarfile
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Literal
from unittest import mock

import eval_fakes as fakes
import jsonschema
import msgspec
import numpy as np
import pytest
from board_fakes import COUNT, board, code, committed, contents, entry_of, kept, runs, whole  # noqa: F401
from hypothesis import given
from hypothesis import strategies as st

from benchmarks import forging
from hthor import code_identity, jsonio, tasks
from hthor.errors import HthorError, RunError
from hthor.eval.config import run_config
from hthor.eval.records.run_folder import RunFolder
from hthor.guest.agent import manifest
from hthor.leaderboard import board_check, enter, publish
from hthor.leaderboard.entries import column_packing, entry_metrics, files, overrides, trial_outcomes
from hthor.leaderboard.page import page
from hthor.leaderboard.ranking import admission, listing
from hthor.leaderboard.submission import archive, submission
from hthor.leaderboard.verify import replay, verify

# ------------------------------------------------------------------------------------------------------- entries


def test_a_run_of_other_people_is_refused_in_one_sentence_that_says_what_would_do(runs: Path, tmp_path: Path):
    with mock.patch.object(overrides, "suite_size", return_value=60), pytest.raises(HthorError) as refused:
        enter.add_runs(runs / "helper", tmp_path / "board")
    said = str(refused.value)
    assert "was played with --participants 2, and cannot stand on the leaderboard" in said
    assert "each of the 60 tasks of 'fake' done once, by 6 people; this run has 20 trials" in said
    assert "Play it again without this option" in said
    assert "\n" not in said, "no list of mismatches"
    assert not (tmp_path / "board").exists()


def test_half_and_twice_the_people_of_a_shipped_suite_are_a_setting_of_its_own():
    plan, _ = fakes.run_of(COUNT)
    smoke = tasks.load_suite("smoke")
    suite = run_config.SuiteRef(name="smoke", version=str(smoke.version), sha256=smoke.sha256)
    for participants, trials, found in ((6, 60, {}), (2, 20, {"participants": "2"}), (12, 120, {"participants": "12"})):
        some = msgspec.structs.replace(plan, suite=suite, participants=participants, trials=trials)
        assert overrides.overridden_settings(some) == found


def test_twice_is_once_in_any_order_and_the_control_comes_too(whole: Path, runs: Path, tmp_path: Path):
    other = committed(tmp_path / "other")
    for name in ("clumsy", "helper", "clumsy"):
        enter.add_runs(runs / name, other)
    publish.build_board(other)
    assert contents(other) == contents(whole)
    assert [path.name.partition("-")[0] for path in files.entry_paths(other)] == ["clumsy", "helper", "silent"]


def test_every_file_is_as_the_schema_says(whole: Path):
    schema = json.loads((whole / "schema.json").read_bytes())
    jsonschema.Draft202012Validator.check_schema(schema)
    valid = jsonschema.Draft202012Validator(schema)
    for path in (*files.entry_paths(whole), whole / "leaderboard.json"):
        document = json.loads(path.read_bytes())
        valid.validate(document)
        assert not valid.is_valid({**document, "extra": 1})
    assert board_check.check_board(whole) == []
    assert publish.differences(whole) == []


def test_the_boards_own_files_are_in_order(root: Path):
    assert [one.line for one in publish.differences(root / "leaderboard")] == []


def test_parts_and_departures_are_refused(runs: Path, tmp_path: Path):
    part = shutil.copytree(runs / "helper", tmp_path / "part")
    lines = (part / "trials.jsonl").read_bytes().splitlines(keepends=True)
    (part / "trials.jsonl").write_bytes(b"".join(lines[:7]))
    with pytest.raises(RunError, match=r"lacks 13 of its 20 trials.*hthor eval --agent helper\.py .*--seed 0 "):
        enter.add_runs(part, tmp_path / "board")
    alone = shutil.copytree(runs / "helper", tmp_path / "elsewhere" / "helper")
    with pytest.raises(RunError, match="has no baseline"):
        enter.add_runs(alone, tmp_path / "board")
    with pytest.raises(RunError, match=r"it has no run\.json"):
        enter.add_runs(tmp_path / "elsewhere" / "helper" / "none", tmp_path / "board")
    plan = msgspec.json.decode((runs / "helper" / "run.json").read_bytes(), type=type(fakes.run_of(COUNT)[0]))
    assert overrides.overridden_settings(plan, ("scout",)) == {}
    seat = msgspec.structs.replace(plan.robots[0], detector="ideal", robot="mine")
    other = msgspec.structs.replace(plan, participants=1, robots=(seat,))
    assert overrides.overridden_settings(other, ("tender",)).keys() == {"participants", "detector", "robot", "robots"}
    with (
        mock.patch.object(code_identity, "code_sha256", return_value="56" * 32),
        pytest.raises(RunError, match="code_"),
    ):
        enter.add_runs(runs / "helper", tmp_path / "board")
    assert not (tmp_path / "board").exists()


def test_what_is_refused_leaves_the_board_as_it_was(runs: Path, tmp_path: Path):
    with pytest.raises(files.BoardError, match=r"to no suite of hthor"):
        enter.add_runs(runs, tmp_path / "board")
    assert not (tmp_path / "board").exists()


def test_a_board_that_is_not_there_is_not_in_order(whole: Path, tmp_path: Path):
    for look in (board_check.check_board, publish.build_board, publish.rescore):
        with pytest.raises(files.BoardError, match="not a folder"):
            look(tmp_path / "board")
    with pytest.raises(files.BoardError, match="is not a file"):
        verify.verify_entry(whole, whole, replay.Request(word="chance"))


def test_a_column_that_cannot_be_read_is_named_with_its_file(board: Path):
    path = files.entry_paths(board)[0]
    held = json.loads(path.read_bytes())
    held["trials"]["time"] += "AAAA"
    path.write_text(json.dumps(held))
    for look in (publish.rescore, publish.build_board):
        with pytest.raises(files.BoardError, match=rf"{path.name}: trials\.time: "):
            look(board)
    assert "trials.time" in [one.field for one in board_check.check_board(board)]


# -------------------------------------------------------------------------------------------------- what is changed

CHANGES = {
    "metrics.sr.mean": ("metrics.sr", lambda one: one["metrics"]["sr"].update(mean=0.99)),
    "metrics.sr.ci95": ("metrics.sr.ci95[0]", lambda one: one["metrics"]["sr"].update(ci95=[0.0, 1.0])),
    "usefulness": ("metrics.usefulness.mean", lambda one: one["metrics"]["usefulness"].update(mean=0.5)),
    "messages": ("counts.messages", lambda one: one["counts"].update(messages=3)),
    "twsr": (
        "metrics.twsr.mean",
        lambda one: one["metrics"]["twsr"].update(mean=one["metrics"]["twsr"]["mean"] + 1e-3),
    ),
    "splits": ("splits.kind.mobile_manipulation.sr.mean", lambda one: _split(one).update(mean=0.123)),
    "uplift": ("uplift.sr.difference", lambda one: one["uplift"]["sr"].update(difference=0.9)),
    "control": ("uplift.control", lambda one: one["uplift"].update(control="0" * 64)),
    "faults": ("counts.faults", lambda one: one["counts"].update(faults=7)),
    "kinds of faults": ("counts.faults_by_kind", lambda one: one["counts"]["faults_by_kind"].clear()),
    "successes": ("counts.successes", lambda one: one["counts"].update(successes=0)),
    "a bit": ("hashes.merkle", lambda one: one["trials"].update(met=column_packing.pack_bits(np.ones(COUNT)))),
    "bits beyond": ("trials.met", lambda one: one["trials"].update(met=column_packing.pack_bits(np.ones(COUNT + 4)))),
    "too few": ("trials.twsr", lambda one: one["trials"].update(twsr="AAAA")),
    "too much": (
        "trials.twsr",
        lambda one: one["trials"].update(twsr=column_packing.pack_numbers(np.full(COUNT, 10**6 + 1), 3)),
    ),
    "label": ("trials.labels.split.of", lambda one: one["trials"]["labels"]["split"].update(of="9" * COUNT)),
    "seed": ("hashes.run", lambda one: one["run"].update(seed=5)),
    "trials": ("run.trials", lambda one: one["run"].update(trials=19)),
    "suite": ("run.suite.sha256", lambda one: one["run"]["suite"].update(sha256="0" * 64)),
    "detector": ("run", lambda one: one["run"]["robots"][0].update(detector="ideal")),
    "reference": ("reference", lambda one: one.update(reference=True)),
    "isolation": ("isolation", lambda one: one.update(isolation=None)),
    "id": ("id", lambda one: one.update(id="helper-fake-0123456789")),
    "overrides": ("overrides", lambda one: one.update(overrides={"limit": "9"})),
    "unknown field": ("note", lambda one: one.update(note="hello")),
    "brought verification": ("verification", lambda one: one.update(verification={"tier": "V1", "passed": True})),
    "missing field": ("mode", lambda one: one.pop("mode")),
    "type": ("run.seed", lambda one: one["run"].update(seed="0")),
    "hash": ("hashes.run", lambda one: one["hashes"].update(run="xyz")),
}


def _split(one: dict) -> dict:
    return one["splits"]["kind"]["mobile_manipulation"]["sr"]


@pytest.mark.parametrize("change", CHANGES)
def test_what_was_changed_is_named(board: Path, change: str):
    field, spoil = CHANGES[change]
    path = entry_of(board, "clumsy" if change in ("splits", "kinds of faults") else "helper")
    document = json.loads(path.read_bytes())
    spoil(document)
    path.write_bytes(jsonio.pretty(document))
    found = board_check.check_board(board)
    assert field in {one.field for one in found}
    assert {one.file for one in found} == {str(path)}
    with pytest.raises(files.BoardError, match=r"helper|clumsy"):
        publish.build_board(board)


def test_all_problems_are_listed(board: Path):
    path = entry_of(board, "helper")
    document = json.loads(path.read_bytes())
    document["metrics"]["sr"]["mean"] = 0.99
    document["counts"]["faults"] = 7
    document["run"]["seed"] = 3
    path.write_bytes(jsonio.pretty(document))
    (board / "entries" / "rubbish.json").write_text("{")
    fields = [one.field for one in board_check.check_board(board)]
    assert {"metrics.sr.mean", "counts.faults", "hashes.run", "$"} <= set(fields)


def test_another_spelling_is_refused_and_can_be_fixed(board: Path, whole: Path):
    path = entry_of(board, "helper")
    path.write_text(json.dumps(json.loads(path.read_bytes())))
    assert [one.field for one in board_check.check_board(board)] == [board_check.SPELLING]
    assert board_check.fix_forms(files.entry_paths(board)) == [path]
    assert contents(board) == contents(whole)
    (board / "leaderboard.json").write_bytes(b"{}")
    assert [one.file for one in publish.differences(board)] == [str(board / "leaderboard.json")]


def test_a_forger_who_makes_all_follow_passes_the_laws_but_not_an_old_verification(board: Path):
    path = entry_of(board, "helper")
    control = files.read_entry(entry_of(board, "silent"))
    true = files.read_entry(path)
    lie = forging.forged(true, 0.2, control)
    files.write_document(path, lie)
    assert board_check.check_board(board) == []  # all of it follows from its trials, which never were
    assert kept(true).verification_of(true) is not None
    assert kept(true).verification_of(lie) is None


def test_numbers_of_older_statistics_are_worked_out_anew(board: Path, whole: Path):
    for path in files.entry_paths(board):
        entry = files.read_entry(path)
        sr = msgspec.structs.replace(entry.metrics.sr, ci95=(0.0, 1.0))
        files.write_document(
            path, msgspec.structs.replace(entry, metrics=msgspec.structs.replace(entry.metrics, sr=sr))
        )
    assert board_check.check_board(board) != []
    assert publish.rescore(board) == files.entry_paths(board)
    assert contents(board) == contents(whole)
    assert publish.rescore(board) == []


@pytest.mark.parametrize("tier", ["V1", "V2"])
def test_one_false_outcome_in_twenty_is_caught_by_two_hundred_trials(tier: Literal["V1", "V2"]):
    assert forging.caught(tier, 0.05, 30) == 30
    assert forging.caught(tier, 0.0, 3) == 0


# -------------------------------------------------------------------------------------------------- list and page


def test_ranks_follow_from_entries_alone(whole: Path):
    entries = [files.read_entry(path) for path in files.entry_paths(whole)]
    taken = admission.load_admission(whole)
    assert jsonio.pretty(listing.make_board(entries, taken=taken)) == (whole / "leaderboard.json").read_bytes()
    found = listing.make_board(entries, kept(*entries), taken)
    assert listing.make_board(entries[::-1], kept(*entries), taken) == found
    (section,) = found.sections
    ranks = {row.name: row.ranks for row in section.rows}
    assert ranks["no robot"] is None
    helper, clumsy = (ranks[name] for name in ("helper", "clumsy"))
    assert helper is not None
    assert clumsy is not None
    assert helper.sr.rank == clumsy.sr.rank == 1  # twenty trials tell nobody apart, and the board says so
    assert clumsy.sr.interval == (1, 2)
    assert [id.partition("-")[0] for id in clumsy.sr.ties] == ["helper"]
    rates = [row.sr.mean for row in section.rows]
    assert rates == sorted(rates, reverse=True)


def test_only_what_can_be_compared_is_ranked_together(whole: Path):
    entries = [files.read_entry(path) for path in files.entry_paths(whole)]
    other = msgspec.structs.replace(entries[0], mode="charged")
    older = msgspec.structs.replace(entries[0], run=msgspec.structs.replace(entries[0].run, code_sha256="56" * 32))
    assert len(listing.make_board([*entries, other, older]).sections) == 3


def test_the_page_says_what_the_list_says_and_needs_nothing_else(whole: Path):
    entries = [files.read_entry(path) for path in files.entry_paths(whole)]
    text = page.render(listing.make_board(entries, kept(*entries), admission.load_admission(whole)))
    for stranger in ("http:", "https:", "src=", "@import", "url(", "fetch"):
        assert stranger not in text
    for word in (
        "no robot",
        "helper",
        "cannot tell apart",
        "1–2",
        "prefers-color-scheme:dark",
        "n 20, could have seen",
    ):
        assert word in text
    assert "no ranked entry yet" in page.render(listing.make_board([]))


@pytest.mark.skipif(shutil.which("chromium") is None, reason="Chromium is not installed")
def test_a_browser_shows_the_page_without_complaint(whole: Path, tmp_path: Path):
    options = ["--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--enable-logging=stderr"]
    options += [f"--user-data-dir={tmp_path / 'browser'}", "--dump-dom", f"file://{whole / 'index.html'}"]
    done = subprocess.run(["chromium", *options], capture_output=True, text=True, timeout=900, check=True)
    assert ":CONSOLE" not in done.stderr
    assert 'tabindex="0"' in done.stdout  # the script that sorts has run


# ---------------------------------------------------------------------------------------------------- small parts


@given(st.lists(st.integers(0, 2**24 - 1), min_size=1, max_size=40))
def test_columns_come_back(values: list[int]):
    column = np.array(values)
    assert column_packing.unpack_numbers(column_packing.pack_numbers(column, 3), len(values), 3).tolist() == values
    odd = column % 2 == 1
    assert (column_packing.unpack_bits(column_packing.pack_bits(odd), len(values)) == odd).all()
    small = [value % column_packing.LABELS_MAX for value in values]
    assert (
        column_packing.unpack_labels(column_packing.pack_labels(small), len(values), column_packing.LABELS_MAX).tolist()
        == small
    )


@given(st.lists(st.binary(max_size=6), min_size=1, max_size=12), st.data())
def test_no_row_can_be_changed_moved_or_left_out(rows: list[bytes], data: st.DataObject):
    root = trial_outcomes.merkle_root(rows)
    place = data.draw(st.integers(0, len(rows) - 1))
    assert trial_outcomes.merkle_root([*rows[:place], rows[place] + b"x", *rows[place + 1 :]]) != root
    assert trial_outcomes.merkle_root(rows[:place] + rows[place + 1 :]) != root
    assert trial_outcomes.merkle_root([*rows, rows[place]]) != root
    turned = rows[::-1]
    assert (trial_outcomes.merkle_root(turned) == root) == (turned == rows)


def test_what_an_entry_says_of_people_is_how_they_were_dealt():
    for count in (1, 9, 20, 33):
        _, dealt = fakes.run_of(count)
        whose = [session.number for session in dealt for _ in session.trials]
        assert entry_metrics.trial_participants(count, len(dealt)) == whose


# --------------------------------------------------------------------------------------------------- submissions


@pytest.fixture
def handed_in(tmp_path: Path) -> Path:
    folder = tmp_path / "submissions" / "mine"
    folder.mkdir(parents=True)
    (folder / "agent.py").write_text("class Agent: ...\n")
    (folder / "submission.json").write_text('{"name": "My agent", "authors": ["A"], "licence": "MIT"}')
    return folder


def test_a_submission_is_read(handed_in: Path):
    found = submission.read_submission(handed_in)
    assert (found.name, found.agent.name, found.agent.deterministic) == ("mine", "My agent", True)


def _touched(path: Path) -> Path:
    path.touch()
    return path


SPOILT: dict[str, tuple[Callable[[Path], object], str]] = {
    "link": (lambda at: (at / "README.md").symlink_to("/etc/passwd"), "is a link"),
    "hidden": (lambda at: (at / ".env").write_bytes(b"1"), "no leading ."),
    "deep link": (lambda at: [(at / "more").mkdir(), (at / "more" / "x").symlink_to("/etc")], "is a link"),
    "compiled": (lambda at: (at / "helper.pyc").write_bytes(b"1"), "submit the sources"),
    "cache": (lambda at: (at / "__pycache__").mkdir(), "submit the sources"),
    "space": (lambda at: (at / "my weights.bin").write_bytes(b"1"), "a name has"),
    "pipe": (lambda at: os.mkfifo(at / "pipe"), "neither a file nor a folder"),
    "capitals": (lambda at: [(at / name).write_text("") for name in ("a.bin", "A.bin")], "differ only in capitals"),
    "many": (lambda at: [(at / f"w{n}.bin").touch() for n in range(submission.MAX_FILES)], "files; at most"),
    "binary": (lambda at: (at / "agent.py").write_bytes(b"\xff\xfe"), "is not text"),
    "zero": (lambda at: (at / "agent.py").write_bytes(b"a\0b"), "zero byte"),
    "large": (lambda at: os.truncate(_touched(at / "w.bin"), submission.MAX_BYTES + 1), "at most"),
    "no agent": (lambda at: (at / "agent.py").unlink(), "is missing"),
    "no name": (lambda at: (at / "submission.json").write_text("{}"), "name"),
    "field": (lambda at: (at / "submission.json").write_text('{"name": "x", "rank": 1}'), "rank"),
    "no json": (lambda at: (at / "submission.json").write_text("{"), "not JSON"),
}


@pytest.mark.parametrize("how", SPOILT)
def test_what_is_no_submission_is_refused(handed_in: Path, how: str):
    spoil, told = SPOILT[how]
    spoil(handed_in)
    assert any(told in one.line for one in submission.submission_problems(handed_in))
    with pytest.raises(HthorError, match="mine"):
        submission.read_submission(handed_in)


def test_names_of_submissions(handed_in: Path):
    other = handed_in.rename(handed_in.with_name("Mine !"))
    assert any("cannot be a submission's name" in one.problem for one in submission.submission_problems(other))


def test_the_entry_is_of_the_file_that_was_handed_in(handed_in: Path, runs: Path, tmp_path: Path):
    played = submission.list_files(handed_in)
    mine = shutil.copytree(runs, tmp_path / "runs") / "helper"
    plan = RunFolder(mine).config
    ref = plan.robots[0].agent
    about = manifest.make_manifest(ref.name, ref.source, {}, [one for one in played if one.path == "agent.py"])
    plan = msgspec.structs.replace(plan, agents=(msgspec.structs.replace(about, sha256=ref.sha256),))
    jsonio.write(mine / "run.json", jsonio.pretty(plan))
    board = committed(tmp_path / "board")
    ((entry, path), *_) = [
        one for one in enter.add_runs(mine, board, submission.read_submission(handed_in)) if one[0].submission == "mine"
    ]
    assert entry.files == played
    assert entry.agents == plan.agents
    assert not board_check.check_board(board, [path], submissions=handed_in.parent)
    (handed_in / "agent.py").write_text("class Agent: pass\n")
    with pytest.raises(files.BoardError, match=r"agents\[0\]\.files: differs from .*agent\.py is another file"):
        enter.add_runs(mine, board, submission.read_submission(handed_in))
    found = board_check.check_board(board, [path], submissions=handed_in.parent)
    assert [(one.field, "agent.py has changed" in one.problem) for one in found] == [("files", True)]
    files.write_document(path, msgspec.structs.replace(entry, files=entry.files[1:]))
    assert "agents[0].files" in {one.field for one in board_check.check_board(board, [path])}
    files.write_document(path, msgspec.structs.replace(entry, agents=()))
    assert "agents" in {one.field for one in board_check.check_board(board, [path])}


def _zipped(folder: Path, path: Path) -> Path:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as held:
        for one in sorted(folder.rglob("*"), reverse=True):
            held.write(one, Path(folder.name) / one.relative_to(folder))
    return path


def _tarred(folder: Path, path: Path) -> Path:
    with tarfile.open(path, "w:gz") as held:
        for one in sorted(folder.iterdir()):
            held.add(one, one.name)
    return path


def test_an_archive_is_the_same_submission_as_its_folder(handed_in: Path, tmp_path: Path):
    (handed_in / "weights").mkdir()
    (handed_in / "weights" / "net.bin").write_bytes(bytes(range(256)) * 99)
    wanted = submission.read_submission(handed_in)
    for path in (_zipped(handed_in, tmp_path / "mine.zip"), _tarred(handed_in, tmp_path / "mine.tar.gz")):
        with submission.submission_folder(path) as folder:
            found = submission.read_submission(folder)
            assert (found.name, found.files, found.agent) == (wanted.name, wanted.files, wanted.agent)
        assert not folder.exists()


class _Evil(tarfile.TarInfo):
    def __init__(self, name: str, kind: bytes = tarfile.REGTYPE, target: str = "") -> None:
        super().__init__(name)
        self.type, self.linkname = kind, target


HOSTILE = {
    "parent": (_Evil("../out.txt"), "leads out of"),
    "absolute": (_Evil("/tmp/out.txt"), "leads out of"),
    "deep parent": (_Evil("a/../../out.txt"), "leads out of"),
    "backslash": (_Evil("..\\out.txt"), "leads out of"),
    "link": (_Evil("x", tarfile.SYMTYPE, "/etc/passwd"), "is a link"),
    "hard link": (_Evil("x", tarfile.LNKTYPE, "agent.py"), "is a link"),
    "device": (_Evil("x", tarfile.CHRTYPE), "not a plain file"),
    "twice": (_Evil("agent.py"), "is there twice"),
    "through a file": (_Evil("agent.py/x"), "cannot be unpacked"),
}


@pytest.mark.parametrize("how", HOSTILE)
def test_a_hostile_archive_writes_nothing_outside_and_leaves_nothing(handed_in: Path, tmp_path: Path, how: str):
    member, told = HOSTILE[how]
    path = _tarred(handed_in, tmp_path / "mine.tar.gz")
    with tarfile.open(path, "w:gz") as held:
        held.add(handed_in / "agent.py", "agent.py")
        held.addfile(member, io.BytesIO())
    before = set(tmp_path.rglob("*"))
    with pytest.raises(files.BoardError, match=told):
        archive.unpack(path, tmp_path / "new" / "mine", most_bytes=1000, most_files=10)
    assert set(tmp_path.rglob("*")) == before | {tmp_path / "new"}


def test_an_archive_is_bounded_by_what_it_unpacks_to(tmp_path: Path):
    folder = tmp_path / "big"
    folder.mkdir()
    (folder / "zeros.bin").write_bytes(bytes(1 << 20))
    for path in (_zipped(folder, tmp_path / "big.zip"), _tarred(folder, tmp_path / "big.tar.gz")):
        assert path.stat().st_size < 10_000
        with pytest.raises(files.BoardError, match="too large: at most 1000 bytes"):
            archive.unpack(path, tmp_path / "new", most_bytes=1000, most_files=10)
        with pytest.raises(files.BoardError, match="exceeds the number of files"):
            archive.unpack(path, tmp_path / "new", most_bytes=1 << 21, most_files=0)
        path.write_bytes(path.read_bytes()[:200])
        with pytest.raises(files.BoardError, match="cannot be unpacked"):
            archive.unpack(path, tmp_path / "new", most_bytes=1 << 21, most_files=10)
        assert not (tmp_path / "new").exists()
