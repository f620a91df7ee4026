"""The log on disk: torn tails are cut, damage is named, and there is one writer."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import eval_fakes as fakes
import pytest

from hthor import jsonio
from hthor.errors import RunError, RunLocked
from hthor.eval.records import trial_log, trial_record


def _lines(count: int = 4) -> list[tuple[str, bytes]]:
    trials = fakes.run_of(10)[1][0].trials[:count]
    made = [trial_record.make_record(trial, fakes.episode(trial)) for trial in trials]
    return [(one.key, trial_record.encode(one)) for one in made]


def _written(folder: Path) -> Path:
    with trial_log.TrialLog(folder) as book:
        for key, line in _lines():
            assert book.append(key, line)
    return folder / "trials.jsonl"


def test_a_trial_is_written_once(tmp_path: Path):
    path = _written(tmp_path)
    with trial_log.TrialLog(tmp_path) as book:
        assert not any(book.append(key, line) for key, line in _lines())
    assert path.read_bytes() == b"".join(line for _, line in _lines())


@pytest.mark.parametrize("cut", [1, 2, 30, 500])
def test_a_torn_last_line_is_cut(tmp_path: Path, cut: int):
    path = _written(tmp_path)
    whole = path.read_bytes()
    path.write_bytes(whole[:-cut])
    assert len(list(trial_log.read(path))) == 3
    with trial_log.TrialLog(tmp_path) as book:
        assert book.torn == len(_lines()[-1][1]) - cut
        assert book.append(*_lines()[-1])
    assert path.read_bytes() == whole


@pytest.mark.parametrize("first", [0, 1, 3])
def test_a_hole_of_zeros_is_cut_with_what_follows(tmp_path: Path, first: int):
    path = _written(tmp_path)
    lines = [line for _, line in _lines()]
    start = sum(map(len, lines[:first]))
    with path.open("r+b") as file:
        file.seek(start + 20)
        file.write(bytes(300))
    with trial_log.TrialLog(tmp_path) as book:
        assert len(book) == first
        assert book.torn == sum(map(len, lines[first:]))
        assert [book.append(key, line) for key, line in _lines()].count(True) == 4 - first
    assert path.read_bytes() == b"".join(lines)


def test_damage_in_the_middle_names_file_line_and_field(tmp_path: Path):
    path = _written(tmp_path)
    lines = path.read_bytes().splitlines(keepends=True)
    lines[1] = lines[1].replace(b'"met":', b'"mat":')
    path.write_bytes(b"".join(lines))
    with pytest.raises(RunError, match=r"trials\.jsonl, line 2: met: is missing.*Delete that line"):
        trial_log.TrialLog(tmp_path)
    with pytest.raises(RunError, match="line 2"):
        list(trial_log.read(path))


def test_a_damaged_log_is_not_touched_and_not_left_locked(tmp_path: Path):
    path = _written(tmp_path)
    data = path.read_bytes().replace(b'"met":', b'"mat":', 1)
    path.write_bytes(data)
    for _ in range(2):
        with pytest.raises(RunError):
            trial_log.TrialLog(tmp_path)
    assert path.read_bytes() == data


def test_a_changed_value_fails_the_check(tmp_path: Path):
    path = _written(tmp_path)
    path.write_bytes(path.read_bytes().replace(b'"ticks":', b'"ticks":1', 1))
    with pytest.raises(RunError, match=r"line 1: check: "):
        list(trial_log.read(path))


def test_a_second_writer_is_refused_with_the_first_ones_number(tmp_path: Path):
    script = (
        "import sys; from pathlib import Path; from hthor.eval.records.trial_log import TrialLog\n"
        "with TrialLog(Path(sys.argv[1])): print('locked', flush=True); sys.stdin.read()"
    )
    with subprocess.Popen(
        [sys.executable, "-c", script, str(tmp_path)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as other:
        assert other.stdout is not None
        assert other.stdout.readline() == "locked\n"
        with pytest.raises(RunLocked, match=f"process {other.pid} on ") as caught:
            trial_log.TrialLog(tmp_path)
        assert caught.value.exit_code == 75
        other.communicate()
    trial_log.TrialLog(tmp_path).close()


def test_what_is_written_is_on_the_disk_within_a_quarter_of_a_second(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    now, synced = [100.0], []
    monkeypatch.setattr(trial_log.time, "monotonic", lambda: now[0])
    monkeypatch.setattr(trial_log.os, "fdatasync", lambda _: synced.append(now[0]))
    with trial_log.TrialLog(tmp_path) as book:
        book.append(*_lines()[0])
        while not synced:
            now[0] += trial_log.BEAT_S  # how often whoever writes looks whether it is time
            book.sync(due=True)
        assert now[0] - 100.0 <= trial_log.SYNC_S + 1e-9
        now[0] += 9.0
        book.sync(due=True)
        assert len(synced) == 1


def test_folders_are_known_to_the_disk_before_what_is_in_them(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    known: list[tuple[str, set[str]]] = []

    def fsync(handle: int) -> None:
        path = Path(os.readlink(f"/proc/self/fd/{handle}"))
        if path.is_dir():
            known.append((path.name, {entry.name for entry in path.iterdir()}))

    monkeypatch.setattr(os, "fsync", fsync)
    with trial_log.TrialLog(tmp_path / "runs" / "mine") as book:
        jsonio.write(book.path.with_name("run.json"), b"{}")
    steps = [
        (tmp_path.name, {"runs"}),
        ("runs", {"mine"}),
        ("mine", {".lock", "trials.jsonl"}),
        ("mine", {".lock", "trials.jsonl", "run.json"}),
    ]
    assert known == steps
