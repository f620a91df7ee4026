"""A metric is one record: a file that is added is seen everywhere, and docs/metrics.md is made from the records."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import eval_fakes as fakes
import msgspec
import pytest

from hthor import code_identity, jsonio, plugins
from hthor.errors import UnknownName
from hthor.eval.metrics import registry, trial_metrics
from hthor.eval.records import trial_record
from hthor.eval.results.result_file import RunResult, Scores
from scripts import metrics_reference

pytestmark = pytest.mark.usefixtures("no_workers")

DOCS = Path(__file__).parents[2] / "docs" / "metrics.md"
ADDED = '''
"""How often the human spoke with its hands."""

from hthor.eval.metrics.metric import LOWER, Metric, Trial, Unit


def gestures(trial: Trial) -> float:
    """Gestures a minute that the human made while it worked."""
    return trial.log.ticks / 100.0


HERTZ = Unit(name="Hz", difference="Hz")
METRICS = (
    Metric("gestures_per_min", "human gestures", gestures, unit=HERTZ, better=LOWER, main=True),
)
'''
SCRIPT = """
import json, sys
from pathlib import Path
from typer.testing import CliRunner
from hthor import code_identity
from hthor.cli import app
import metrics_reference
from hthor.eval.records import trial_record
from hthor.report.analysis import build, load_runs
from hthor.report.page import page

alone, helper, docs = map(Path, sys.argv[1:])
def typed(*words):
    said = CliRunner().invoke(app, [str(word) for word in words], env={"COLUMNS": "200"}, catch_exceptions=False)
    assert said.exit_code == 0, said.output
    return said.output
found = build.build_findings(load_runs.load_runs([alone, helper]))
print(json.dumps({
    "score": typed("score", helper),
    "compare": typed("compare", alone, helper),
    "json": json.loads(typed("compare", alone, helper, "--json")),
    "page": page.render(found, {}),
    "docs": metrics_reference.page(docs.read_text()),
    "code": code_identity.code_sha256(["proxy"], ["mobile_manipulation"]),
    "scoring": code_identity.scoring_sha256(),
}))
"""


def _run(folder: Path, name: str, *, absent: bool = False) -> Path:
    """A whole run's folder without playing it."""
    plan, dealt = fakes.run_of(20, name=name, absent=absent)
    jsonio.write(folder / "run.json", jsonio.pretty(plan))
    records = [trial_record.make_record(trial, fakes.episode(trial)) for one in dealt for trial in one.trials]
    jsonio.write(folder / "trials.jsonl", b"".join(map(trial_record.encode, records)))
    return folder


def test_a_metric_is_added_by_one_file(tmp_path: Path) -> None:
    # compiled files go along, which saves compiling all modules again
    ignored = shutil.ignore_patterns("data", "unseen", "suites.json")
    shutil.copytree(code_identity.PACKAGE, tmp_path / "hthor", ignore=ignored)
    (tmp_path / "hthor" / "eval" / "metrics" / "definitions" / "gestures.py").write_text(ADDED)
    alone, helper = _run(tmp_path / "alone", "silent", absent=True), _run(tmp_path / "helper", "helper")
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT, str(alone), str(helper), str(DOCS)],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": f"{tmp_path}{os.pathsep}{DOCS.parents[1] / 'scripts'}"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    seen = json.loads(done.stdout)
    trials = [json.loads(line) for line in (helper / "trials.jsonl").read_bytes().splitlines()]
    mean = round(sum(trial["ticks"] for trial in trials) / 100.0 / len(trials), 6)
    assert json.loads((helper / "result.json").read_bytes())["metrics"]["gestures_per_min"]["mean"] == mean
    assert re.search(rf"human gestures +{mean:.1f} Hz", seen["score"])
    assert "human gestures [Hz]" in seen["compare"]
    assert seen["json"]["pairs"][0]["differences"]["gestures_per_min"]["second"] == mean
    assert f"<span>{mean:.1f}</span>" in seen["page"]
    assert "human gestures [Hz]" in seen["page"]
    assert (
        "| `gestures_per_min` | human gestures | Gestures a minute that the human made while it worked. |"
        in seen["docs"]
    )
    assert seen["code"] == code_identity.code_sha256(["proxy"], ["mobile_manipulation"]), "it changes no trial"
    assert seen["scoring"] != code_identity.scoring_sha256()
    assert json.loads((helper / "result.json").read_bytes())["hashes"]["scoring"] == seen["scoring"]


def test_the_table_in_the_docs_is_made_from_the_records() -> None:
    text = DOCS.read_text(encoding="utf-8")
    assert metrics_reference.page(text) == text, "run: python scripts/metrics_reference.py docs/metrics.md"
    with pytest.raises(ValueError, match="lacks the line"):
        metrics_reference.page("no table")


def test_every_metric_is_found_and_says_what_it_is() -> None:
    assert {metric.name for metric in registry.METRICS} == set(trial_metrics.TrialMetrics.__struct_fields__)
    assert Scores.__struct_fields__ == trial_metrics.TrialMetrics.__struct_fields__
    for metric in registry.METRICS:
        assert registry.get(metric.name) is metric
        assert metric.doc
        assert not metric.main or metric.better
    with pytest.raises(UnknownName, match="twsr"):
        registry.get("twrs")


def test_metrics_count_in_the_hash_of_code() -> None:
    sources = code_identity.ours()
    roots = [plugins.module_name("metric", name) for name in plugins.names("metric")]
    counted = {module.rpartition(".")[2] for module in sources.closure(roots)}
    assert {"success", "communication", "interference", "metric"} <= counted


def test_a_result_with_fewer_or_more_metrics_is_readable() -> None:
    """A result of another version: what it lacks has no value, what only it has is left out."""
    estimate = {"mean": 0.5, "ci95": None, "n": 1}
    some = msgspec.json.decode(msgspec.json.encode({"sr": estimate, "gestures": estimate}), type=Scores)
    assert (some["sr"].mean, some["twsr"].n, some.by_seat("work")) == (0.5, 0, {})
    assert RunResult.__struct_fields__.count("metrics") == 1
