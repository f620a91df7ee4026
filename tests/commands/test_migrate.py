"""`hthor migrate`, and what the other commands say to runs of the last release and make of migrated ones."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from hthor.calibration.from_logs import trial_features
from hthor.errors import HthorError
from hthor.eval.migration import migrate
from hthor.humans.models import _logged_trials

OLD = Path(__file__).parents[1] / "eval" / "last_release"


@pytest.fixture
def runs(tmp_path: Path) -> Path:
    shutil.copytree(OLD, tmp_path / "runs")
    return tmp_path / "runs"


@pytest.mark.parametrize(
    "command",
    [
        ("score", "{run}"),
        ("replay", "{run}", "0"),
        ("report", "{run}"),
        ("runs", "view", "{run}"),
        ("compare", "{run}", "{run}"),
        ("merge", "{run}", "--out", "{out}"),
        ("leaderboard", "add", "{run}"),
        ("calibrate", "--target", "{run}", "--out", "{out}"),
        ("calibrate", "--target", "{run}/trials.jsonl", "--out", "{out}"),
    ],
)
def test_other_commands_refuse_old_runs_in_a_sentence_that_says_what_to_do(hthor, command, runs, tmp_path):
    run = runs / "collect"
    said = hthor(*(word.format(run=run, out=tmp_path / "out") for word in command))
    assert said.code == 2
    assert f"by an older version of hthor; 'hthor migrate {run}' converts it." in said.err


def test_people_are_replayed_from_migrated_logs_only(runs):
    with pytest.raises(HthorError, match=r"by an older version of hthor; 'hthor migrate"):
        _logged_trials.read_logged_trials(str(runs / "collect"))
    migrate.migrate([runs])
    (trials,) = _logged_trials.read_logged_trials(str(runs / "slow" / "trials.jsonl")).values()
    assert [len(list(trial.hand_actions())) > 0 for trial in trials] == [False, True, False]
    assert [trial.rating for trial in trials] == [trial.ratings["human"] for trial in trials]


def test_it_says_what_it_did(hthor, runs):
    would = hthor("migrate", str(runs), "--dry-run")
    assert "2 of 2 trials would be converted to log 1.0" in would.out
    done = hthor("migrate", str(runs))
    assert "2 of 2 trials converted to log 1.0. result.json was computed again." in done.out
    assert "kept as faults.before-1.0, trials.before-1.0.jsonl, run.before-1.0.json." in done.out
    again = json.loads(hthor("migrate", str(runs), "--json").out)
    assert again["schema"] == "hthor.migrate/1"
    assert [one["converted"] for one in again["done"]] == [0, 0]


def test_migrated_runs_are_scored_drawn_and_calibrated_with(hthor, runs, tmp_path):
    migrate.migrate([runs])
    assert "equal to" in hthor("score", str(runs / "collect")).err
    assert hthor("replay", str(runs / "collect"), "0", "--out", str(tmp_path / "trial.png")).code == 0
    assert (tmp_path / "trial.png").read_bytes().startswith(b"\x89PNG")
    both = [runs / "collect", runs / "slow"]
    found = trial_features.extract_features(trial_features.read_sessions(both))
    assert len(found) == 5
    assert sum(len(one.choices) for one in found) > 10
    targets = [word for run in both for word in ("--target", str(run))]
    assert hthor("calibrate", *targets, "--out", str(tmp_path / "fit")).code == 0
    assert (tmp_path / "fit" / "population.npz").is_file()
