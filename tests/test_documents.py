"""Whatever a damaged file holds, its reader raises its own error, which names the file."""

from __future__ import annotations

import copy
import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any
from unittest import mock

import board_fakes
import jsonschema
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from law_cases import cases

from hthor import code_identity, documents, jsonio, log_corrections
from hthor.calibration import evidence, targets
from hthor.calibration.simulation import session_store
from hthor.catalog import procthor
from hthor.errors import HouseError, HthorError, PopulationError, RunError, TaskError
from hthor.eval.records import platform, run_isolation, trial_log
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.results import result_file
from hthor.eval.runner import fault_report
from hthor.guest import Isolation
from hthor.houses import schema as house_file
from hthor.humans.models import _logged_trials
from hthor.humans.population import kinds, population_file, resolve
from hthor.leaderboard import board_check, schema
from hthor.leaderboard.entries import files as board_files
from hthor.leaderboard.entries.files import BoardError
from hthor.leaderboard.submission import submission
from hthor.looks.pack import PackError, store
from hthor.report.analysis import run_provenance
from hthor.tasks.suites import commitment, library

DEEP = 100_000
DAMAGES = {
    "nothing": b"",
    "no JSON": b"{",
    "no UTF-8": b'{"schema": "\xff\xfe"}',
    "nothing but bytes": bytes(range(256)),
    "nested arrays": b"[" * DEEP + b"]" * DEEP,
    "nested objects": b'{"a":' * DEEP + b"0" + b"}" * DEEP,
    "a little too deep": b"[" * 1500 + b"]" * 1500,
    "a number": b"1e999",
    "NaN": b'{"schema": NaN}',
    "another record": b'{"schema": "hthor.other/1"}',
    "no text": b'{"schema": 3}',
}


def _lines(read: Callable[[Path], Any]) -> Callable[[Path], Any]:
    """A reader of a file of lines, given a line that is whole."""

    def reader(path: Path) -> Any:
        path.write_bytes(path.read_bytes().replace(b"\n", b" ") + b"\n")
        return read(path)

    return reader


READERS: dict[str, tuple[str, type[HthorError], Callable[[Path], Any]]] = {
    "run": ("run.json", RunError, lambda path: RunFolder(path.parent).config),
    "result": ("result.json", RunError, lambda path: result_file.load_result(path.parent)),
    "trials": ("trials.jsonl", RunError, _lines(lambda path: list(trial_log.read(path)))),
    "isolation": ("isolation.json", RunError, lambda path: run_isolation.load_isolation(path.parent)),
    "platform": ("platform.json", RunError, lambda path: platform.load(path.parent)),
    "platform of a report": ("platform.json", RunError, lambda path: run_provenance._platforms(_Run(path.parent))),
    "faults": ("faults.json", RunError, fault_report.load_fault_report),
    "population": ("pop.json", PopulationError, lambda path: population_file._read(path)),
    "people": ("pop.json", HthorError, lambda path: resolve.resolve_humans(str(path))),
    "kind of people": ("quick.json", PopulationError, kinds.load),
    "corrections": (log_corrections.NAME, RunError, _lines(lambda path: log_corrections.load(path.parent))),
    "past trials": ("past.jsonl", HthorError, _lines(lambda path: _logged_trials._read(str(path)))),
    "suite": ("suite.json", TaskError, library.read_suite),
    "commitment": ("commitment.json", TaskError, commitment.load_commitment),
    "revealed": ("revealed.json", TaskError, lambda path: commitment.read_revealed_salt(path.parent)),
    "house": ("house.json", HouseError, lambda path: house_file.read_house_file(path, str(path))),
    "asset database": ("assets.json", HouseError, procthor.read),
    "pack": (store.LIST, PackError, lambda path: store.Pack(path.parent)),
    "entry": ("entry.json", BoardError, board_files.read_entry),
    "targets": ("targets.json", HthorError, targets.load_targets),
    "evidence": ("validation.json", RunError, evidence.load_evidence),
    "sessions": ("sessions.jsonl", RunError, _lines(lambda path: list(session_store.read_outcomes(path)))),
}


class _Run:
    """As much of a report's run as is asked for its platforms."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder


@pytest.mark.parametrize("damage", DAMAGES)
@pytest.mark.parametrize("reader", READERS)
def test_every_reader_refuses_damage_with_its_own_error(reader: str, damage: str, tmp_path: Path):
    name, error, read = READERS[reader]
    path = tmp_path / name
    path.write_bytes(DAMAGES[damage])
    with pytest.raises(error) as caught:
        read(path)
    assert path.stem in str(caught.value)
    assert len(str(caught.value)) < 1000


@pytest.mark.parametrize("damage", DAMAGES)
def test_damaged_entries_and_submissions_are_problems(damage: str, tmp_path: Path):
    path = tmp_path / "entry.json"
    path.write_bytes(DAMAGES[damage])
    assert [one.file for one in board_check.form_problems(path)] == [str(path)]
    handed = tmp_path / "mine"
    handed.mkdir()
    (handed / "agent.py").write_text("class Agent: ...\n")
    (handed / "submission.json").write_bytes(DAMAGES[damage])
    assert {one.file for one in submission.submission_problems(handed)} >= {str(handed / "submission.json")}


@pytest.mark.parametrize("damage", DAMAGES)
def test_damage_that_is_only_looked_at_raises_nothing(damage: str, tmp_path: Path):
    path = tmp_path / "result.json"
    path.write_bytes(DAMAGES[damage])
    assert not result_file.is_outdated(path)
    assert documents.schema_of(path) in ("", "hthor.other/1")


def test_a_level_of_isolation_that_does_not_exist_is_refused(tmp_path: Path):
    (tmp_path / "isolation.json").write_text('{"level": "L9"}')
    with pytest.raises(RunError, match=r"isolation\.json: .*level is 'L9', valid are served, L1, L2, L3"):
        run_isolation.load_isolation(tmp_path)
    with pytest.raises(RunError, match="L9"):
        run_isolation.weakest_isolation(tmp_path, Isolation(level="L1"), "L2")


def test_the_error_names_file_and_field(tmp_path: Path):
    path = tmp_path / "kind.json"
    path.write_text('{"schema": "hthor.kind/1", "name": 3}')
    with pytest.raises(PopulationError) as caught:
        documents.read(path, kinds.PopulationKind, PopulationError)
    assert caught.value.file == str(path)
    assert caught.value.field == "name"
    assert re.search("Expected `str`", caught.value.problem)


def test_every_file_is_read_by_the_one_reader(root: Path):
    """A decoder that is called elsewhere would not be guarded: what does not decode files of ours is listed."""
    listed = {
        "hthor/documents.py",
        "hthor/catalog/priors/__init__.py",  # these ship with hthor
        "hthor/tasks/arrangement/commonsense_places.py",
        "hthor/eval/doctor/reproducibility.py",
        "hthor/tasks/generation/secret_suites.py",  # made a moment before
        "hthor/tasks/suites/suite_files.py",
        "hthor/eval/doctor/run_checks.py",  # the output of a process of ours
        "hthor/houses/schema.py",  # names line and column
    }
    found = {
        path.relative_to(root).as_posix()
        for path in (root / "hthor").rglob("*.py")
        if re.search(r"msgspec\.json\.decode\(|json\.loads?\(", path.read_text())
    }
    assert found <= listed


# ------------------------------------------------------------------------------------------- the schema of entries


def _places(document: Any, where: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """The path of every value of a document."""
    parts = (
        document.items() if isinstance(document, dict) else enumerate(document) if isinstance(document, list) else ()
    )
    return [where, *(place for name, part in parts for place in _places(part, (*where, name)))]


_VALUES = (None, 0, -1, 1.5, 2**70, "", "x", "L9", "served", [], {}, True, "0" * 64)


@pytest.fixture(scope="module")
def entry(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The file of a made-up entry."""
    with mock.patch.object(code_identity, "code_sha256", return_value="34" * 32):
        board = board_fakes.filled(board_fakes.play(tmp_path_factory.mktemp("runs")), tmp_path_factory.mktemp("board"))
    return board_fakes.entry_of(board, "helper")


@settings(max_examples=cases(150))
@given(data=st.data())
def test_the_schema_is_kept_without_a_library_for_schemas(
    data: st.DataObject, entry: Path, tmp_path_factory: pytest.TempPathFactory
):
    source = entry
    document = json.loads(source.read_bytes())
    place = data.draw(st.sampled_from(_places(document)[1:]))
    changed = copy.deepcopy(document)
    holder = changed
    for step in place[:-1]:
        holder = holder[step]
    how = data.draw(st.sampled_from(("set", "drop", "add")))
    if how == "set":
        holder[place[-1]] = data.draw(st.sampled_from(_VALUES))
    elif how == "drop":
        del holder[place[-1]]
    elif isinstance(holder, dict):
        holder["more"] = 1
    path = tmp_path_factory.mktemp("entries") / source.name
    path.write_bytes(jsonio.pretty(changed))
    valid = jsonschema.Draft202012Validator(schema.document_schema("Entry")).is_valid(changed)
    assert valid <= (
        not [one for one in board_check.form_problems(path) if one.field not in ("id", board_check.SPELLING)]
    )
    if not valid:
        assert list(board_check.form_problems(path))
