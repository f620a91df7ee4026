"""The leaderboard: whole runs only, the same bytes always, and every file as the schema says."""

from __future__ import annotations

import json
from pathlib import Path

import eval_fakes as fakes
import jsonschema
import pytest

from hthor.errors import RunError
from hthor.eval import board, progress, run


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("runs")
    for name in ("helper", "clumsy", "silent"):
        plan, dealt = fakes.run_of(10, name=name, absent=name == "silent")
        run.evaluate(plan, dealt, fakes.player, folder=folder / name, jobs=1, watch=progress.Silent())
    return {path.name: path for path in folder.iterdir()}


@pytest.fixture(scope="module")
def valid(root: Path) -> jsonschema.Draft202012Validator:
    schema = json.loads((root / "leaderboard" / "schema.json").read_text())
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


def _files(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*.json")}


def test_twice_is_once_and_order_does_not_matter(tmp_path: Path, runs: dict[str, Path]):
    for name in ("helper", "clumsy", "silent", "helper"):
        board.add(runs[name], tmp_path / "one")
    for name in ("silent", "helper", "clumsy"):
        board.add(runs[name], tmp_path / "two")
    assert _files(tmp_path / "one") == _files(tmp_path / "two")
    assert len(_files(tmp_path / "one")) == 4


def test_every_file_is_as_the_schema_says(tmp_path: Path, runs: dict[str, Path], valid):
    for folder in runs.values():
        board.add(folder, tmp_path)
    for data in _files(tmp_path).values():
        valid.validate(json.loads(data))
    entries = json.loads((tmp_path / "leaderboard.json").read_bytes())["entries"]
    rates = [entry["metrics"]["sr"]["mean"] for entry in entries]
    assert rates == sorted(rates, reverse=True)
    for entry in entries:
        several = [entry["metrics"].pop(name) for name in ("work", "hindered_by")]
        for estimate in (*entry["metrics"].values(), *(one for named in several for one in named.values())):
            assert estimate["n"] == 0 or estimate["ci95"][0] <= estimate["mean"] <= estimate["ci95"][1]


def test_the_schema_takes_nothing_more(tmp_path: Path, runs: dict[str, Path], valid):
    _, path = board.add(runs["helper"], tmp_path)
    entry = json.loads(path.read_bytes())
    for spoilt in ({**entry, "extra": 1}, {**entry, "seed": "0"}, {k: v for k, v in entry.items() if k != "hashes"}):
        assert not valid.is_valid(spoilt)


def test_the_boards_own_files_are_valid_and_canonical(root: Path, valid, tmp_path: Path):
    files = _files(root / "leaderboard")
    for name, data in files.items():
        if name != "schema.json":
            valid.validate(json.loads(data))
            (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
            (tmp_path / name).write_bytes(data)
    board.rebuild(tmp_path)
    assert (tmp_path / "leaderboard.json").read_bytes() == files["leaderboard.json"]


def test_a_part_of_a_run_is_refused_with_the_command_that_finishes_it(tmp_path: Path, runs: dict[str, Path]):
    part = tmp_path / "part"
    part.mkdir()
    (part / "run.json").write_bytes((runs["helper"] / "run.json").read_bytes())
    lines = (runs["helper"] / "trials.jsonl").read_bytes().splitlines(keepends=True)
    (part / "trials.jsonl").write_bytes(b"".join(lines[:7]))
    with pytest.raises(RunError, match=r"lacks 3 of its 10 trials.*hthor eval --agent helper\.py .*--seed 0 "):
        board.add(part, tmp_path / "board")
    assert not (tmp_path / "board").exists()


def test_what_is_no_run_is_refused(tmp_path: Path):
    with pytest.raises(RunError, match=r"not a run's folder: it has no run\.json"):
        board.add(tmp_path, tmp_path / "board")
