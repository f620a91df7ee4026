"""Logs that a later version wrote are read: what is not known is left out, and said once."""

from __future__ import annotations

from pathlib import Path

import msgspec
import pytest

from hthor.eval.records import trial_record


def rewrite(log: Path) -> None:
    """Give every line two events of kinds that this version does not know."""
    lines = []
    for line in log.read_bytes().splitlines():
        document = msgspec.json.decode(line)
        del document["check"]
        document["schema"] = "hthor.trial/2.1"
        document["events"].insert(0, {"kind": "waved", "tick": 0, "seat": "human", "hand": "left"})
        document["journal"].append({"kind": "pulse", "tick": 0, "seat": "human", "beats": [1.0, 1.1]})
        lines.append(trial_record.sealed(msgspec.json.encode(document)))
    log.write_bytes(b"".join(lines))


def test_a_command_says_once_what_it_left_out(hthor, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    run = tmp_path / "run"
    assert hthor("eval", "--agent", "none", "--suite", "fake", "--out", str(run), "--quiet").code == 0
    rewrite(run / "trials.jsonl")
    for command in ("score", "report"):
        said = hthor(command, str(run))
        assert said.code == 0
        words = (
            "has 40 events of kinds that this version of hthor does not know (20 pulse, 20 waved); they were left out."
        )
        assert said.err.count(f"note: {run / 'trials.jsonl'} {words}") == 1


def test_a_merged_log_has_the_bytes_that_were_written(hthor, tmp_path: Path) -> None:
    shards = [tmp_path / f"run-shard-{number}-of-2" for number in (1, 2)]
    for number, shard in enumerate(shards, 1):
        words = ("--agent", "none", "--suite", "fake", "--shard", f"{number}/2", "--out", str(tmp_path / "run"))
        assert hthor("eval", *words, "--quiet").code == 0
        rewrite(shard / "trials.jsonl")
    said = hthor("merge", *map(str, shards), "--out", str(tmp_path / "whole"))
    assert said.code == 0
    written = [line for shard in shards for line in (shard / "trials.jsonl").read_bytes().splitlines()]
    assert sorted((tmp_path / "whole" / "trials.jsonl").read_bytes().splitlines()) == sorted(written)
