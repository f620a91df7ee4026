"""Runs of the last release, kept in `last_release`, become runs of log 1.0 that say the same."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import msgspec
import pytest

from hthor import jsonio
from hthor.errors import RunError, RunLocked
from hthor.eval.migration import conversion, migrate, old_format
from hthor.eval.records import trial_log, trial_record
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.results import aggregate
from hthor.types.events import Attempt, Note, Offer, Picked, Sent, Thought

OLD = Path(__file__).parent / "last_release"
RUNS = ("collect", "slow")
"""Two robots with the oracle; a slow and failing robot whose thinking counted."""


@pytest.fixture
def runs(tmp_path: Path) -> Path:
    shutil.copytree(OLD, tmp_path / "runs")
    return tmp_path / "runs"


def old_lines(name: str) -> list[dict[str, Any]]:
    return [json.loads(line) for line in (OLD / name / "trials.jsonl").read_bytes().splitlines()]


def contents(folder: Path) -> dict[str, bytes]:
    files = (path for path in folder.rglob("*") if path.is_file() and path.name != ".lock")
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}


def test_metrics_are_those_that_the_last_release_computed(runs: Path) -> None:
    migrate.migrate([runs])
    for name in RUNS:
        for old, new in zip(old_lines(name), RunFolder(runs / name).records(), strict=True):
            assert {key: value for key, value in old["metrics"].items() if value != new.metrics[key]} == {}


def test_records_say_what_the_old_ones_said(runs: Path) -> None:
    migrate.migrate([runs])
    for name in RUNS:
        for old, new in zip(old_lines(name), RunFolder(runs / name).records(), strict=True):
            (person,) = new.spec.humans
            assert (person.model, person.sha256) == (old["spec"]["human"], old["spec"]["human_sha256"])
            assert new.spec.session == person.participant == old["spec"]["participant"]
            assert new.ratings == {"human": old["trust"]}
            assert (new.ticks, new.met, new.progress, new.idle) == tuple(
                old[key] for key in ("ticks", "met", "progress", "idle")
            )
            assert [len(path) for path in new.paths.values()] == [len(path) for path in old["paths"].values()]
            assert sorted(event.kind for event in new.events if not isinstance(event, Thought)) == sorted(
                event["kind"].replace("confirmed", "accepted") for event in old["events"] if event["kind"] != "thought"
            )
            assert [entry.kind for entry in new.journal] == [entry["kind"] for entry in old["journal"]]
            for kind in (Picked, Sent, Offer, Attempt):
                flat = [
                    {**event["data"], "tick": event["tick"]}
                    for event in old["events"] + old["journal"]
                    if event["kind"] == kind.__struct_config__.tag
                ]
                same = [one for one in (*new.events, *new.journal) if isinstance(one, kind)]
                for before, after in zip(flat, same, strict=True):
                    held = msgspec.to_builtins(after)
                    before = {key: value for key, value in before.items() if value not in ("", None)}
                    assert {"confirm": "accept"}.get(before.get("answer", ""), before.get("answer")) == held.get(
                        "answer"
                    )
                    assert {key: held[key] for key in before if key != "answer"} == {
                        key: tuple(value) if isinstance(value, list) else value
                        for key, value in before.items()
                        if key != "answer"
                    }


def test_late_actions_are_logged_when_they_took_effect(runs: Path) -> None:
    migrate.migrate([runs / "slow"])
    for old, new in zip(old_lines("slow"), RunFolder(runs / "slow").records(), strict=True):
        assert new.spec.clock == "charged"
        before = [event for event in old["events"] if event["kind"] == "thought"]
        after = [event for event in new.events if isinstance(event, Thought)]
        assert [(event.tick, event.ticks) for event in after] == [
            (event["tick"] + event["data"]["ticks"], event["data"]["ticks"]) for event in before
        ]
        assert [event.tick for event in new.events] == sorted(event.tick for event in new.events)


def has_all(new: object, old: object) -> bool:
    """Whether every value of an old document is in a new one, which may have more names."""
    if isinstance(old, dict) and isinstance(new, dict):
        return all(name in new and has_all(new[name], value) for name, value in old.items())
    return new == old


def test_files_of_a_run_belong_together_again_and_the_old_ones_are_kept(runs: Path) -> None:
    done = migrate.migrate([runs])
    assert [(Path(one.path).name, one.trials, one.converted) for one in done.done] == [
        ("collect", 2, 2),
        ("slow", 3, 3),
    ]
    for one in done.done:
        folder = Path(one.path)
        run = RunFolder(folder)
        assert [trial_record.key(record.spec) for record in run.records()] == [record.key for record in run.records()]
        for kept in map(Path, one.kept):
            name = str(kept.relative_to(folder)).replace(".before-1.0", "")
            assert kept.read_bytes() == (OLD / folder.name / name).read_bytes()
    _, result, stored = aggregate.rescore(runs / "collect")
    assert result == stored
    assert not (runs / "slow" / "result.json").exists(), "there was none"
    old = json.loads((OLD / "collect" / "result.json").read_bytes())
    new = json.loads((runs / "collect" / "result.json").read_bytes())
    assert {name for name in old if not has_all(new[name], old[name])} == {"hashes", "schema"}, (
        "more metrics may be new"
    )
    (report,) = (runs / "slow" / "faults").glob("*.json")
    failed = next(record for record in RunFolder(runs / "slow").records() if record.faults)
    document = json.loads(report.read_bytes())
    assert report.stem == document["key"] == failed.key
    assert failed.key in document["again"]
    assert document["session"] == failed.spec.session


def test_twice_is_once(runs: Path) -> None:
    migrate.migrate([runs])
    before = contents(runs)
    again = migrate.migrate([runs])
    assert contents(runs) == before
    assert all(not one.converted and not one.kept and not one.result for one in again.done)


def test_a_dry_run_writes_nothing(runs: Path) -> None:
    found = migrate.migrate([runs], dry=True)
    assert contents(runs) == contents(OLD)
    assert [one.converted for one in found.done] == [2, 3]


@pytest.mark.parametrize("after", range(7))
def test_what_was_interrupted_is_finished_by_the_same_command(
    after: int, runs: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    migrate.migrate([shutil.copytree(runs, tmp_path / "whole")])
    write, count = jsonio.write_parts, [0]

    def killed(*arguments: Any) -> None:
        if count[0] == after:
            raise KeyboardInterrupt
        count[0] += 1
        write(*arguments)

    monkeypatch.setattr(jsonio, "write_parts", killed)
    with pytest.raises(KeyboardInterrupt):
        migrate.migrate([runs])
    monkeypatch.undo()
    migrate.migrate([runs])
    assert contents(runs) == contents(tmp_path / "whole")


def test_a_baseline_in_a_runs_folder_and_a_log_in_any_folder_are_found(runs: Path, tmp_path: Path) -> None:
    shutil.move(runs / "slow", runs / "collect" / "control")
    done = migrate.migrate([runs / "collect", runs / "collect"], dry=True).done
    assert [one.path for one in done] == [str(runs / "collect"), str(runs / "collect" / "control")]
    (runs / "collect" / "run.json").unlink()
    shutil.rmtree(runs / "collect" / "control")
    (one,) = migrate.migrate([runs / "collect"], dry=True).done
    assert one.path == str(runs / "collect" / "trials.jsonl")


def test_a_log_without_its_run_is_converted_too(runs: Path) -> None:
    log = runs / "alone.jsonl"
    shutil.copy(OLD / "slow" / "trials.jsonl", log)
    with log.open("ab") as file:
        file.write(b'{"key":"torn')
    (one,) = migrate.migrate([log]).done
    assert (one.trials, one.converted, one.kept) == (3, 3, (str(runs / "alone.before-1.0.jsonl"),))
    migrate.migrate([runs / "slow"])
    assert log.read_bytes() == (runs / "slow" / "trials.jsonl").read_bytes()


def test_a_run_that_lacks_trials_keeps_no_result(runs: Path) -> None:
    log = runs / "collect" / "trials.jsonl"
    log.write_bytes(log.read_bytes().splitlines(keepends=True)[0])
    (one,) = migrate.migrate([runs / "collect"]).done
    assert (one.trials, one.result) == (1, "incomplete")
    assert not (runs / "collect" / "result.json").exists()


def sealed(line: dict[str, Any]) -> bytes:
    """An old line with the right key and checksum."""
    body = {name: value for name, value in line.items() if name != "check"}
    return trial_record.sealed(msgspec.json.encode({**body, "key": jsonio.sha256(body["spec"])[:16]}))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda line: line["events"][1]["data"].pop("object"), "line 2: events[1]"),
        (lambda line: line["events"][0].update(kind="waved"), "line 2: events[0]"),
        (lambda line: line["journal"][2]["data"].update(chosen="x"), "line 2: journal[2].chosen"),
        (lambda line: line["spec"].pop("human"), "line 2: spec"),
        (lambda line: line.update(trust="high"), "line 2: trust"),
    ],
)
def test_what_cannot_be_converted_is_named(change: Any, words: str, runs: Path) -> None:
    log = runs / "collect" / "trials.jsonl"
    first, second = old_lines("collect")
    second["events"].sort(key=lambda event: event["kind"] != "picked")
    change(second)
    log.write_bytes(sealed(first) + sealed(second))
    before = contents(runs)
    with pytest.raises(RunError) as caught:
        migrate.migrate([runs])
    assert str(caught.value).startswith(f"{log}, {words}")
    assert contents(runs) == before, "nothing is written unless everything can be converted"


def test_damage_is_not_converted(runs: Path) -> None:
    log = runs / "collect" / "trials.jsonl"
    log.write_bytes(log.read_bytes().replace(b'"met":true', b'"met":false'))
    with pytest.raises(RunError, match=r"line \d: check: .* is not the line's checksum"):
        migrate.migrate([runs])


def test_folders_without_runs_other_versions_and_foreign_files_are_refused(runs: Path, tmp_path: Path) -> None:
    with pytest.raises(RunError, match="is not there"):
        migrate.migrate([tmp_path / "no"])
    (tmp_path / "empty").mkdir()
    with pytest.raises(RunError, match="holds no run and no log"):
        migrate.migrate([tmp_path / "empty"])
    config = runs / "slow" / "run.json"
    config.write_text(json.dumps({"schema": "hthor.run/3"}))
    with pytest.raises(RunError, match=r"run.json: schema: is 'hthor.run/3', 'hthor migrate' converts 'hthor.run/4'"):
        migrate.migrate([runs])
    assert contents(runs / "collect") == contents(OLD / "collect"), "all or nothing"
    kept = runs / "collect" / "trials.before-1.0.jsonl"
    kept.write_text("mine")
    with pytest.raises(RunError, match="is there already and is not a copy"):
        migrate.migrate([runs / "collect"])


def test_a_run_that_is_being_played_is_left_alone(runs: Path) -> None:
    with trial_log.TrialLog(runs / "empty"):
        shutil.copy(runs / "slow" / "run.json", runs / "empty")
        with pytest.raises(RunLocked):
            migrate.migrate([runs / "empty"])


def test_entries_of_a_model_of_ones_own_become_notes() -> None:
    data = {"questions": 3, "model": "m", "shares": [0.5, 0.5]}
    made = conversion.convert_entry(old_format.OldEvent(tick=0, seat="human", kind="language_model", data=data))
    assert made == Note(
        tick=0, seat="human", topic="language_model", values={"questions": 3, "model": "m", "shares": "[0.5,0.5]"}
    )
