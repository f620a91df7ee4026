"""Calibrations from the first session to the population: real sessions few, and statistics on made-up ones."""

from __future__ import annotations

import hashlib
import io
import json
from pathlib import Path

import calibration_fakes as fakes
import eval_fakes
import msgspec
import numpy as np
import pytest
from rich.console import Console
from typer.testing import CliRunner

from hthor import tasks
from hthor.calibration.emulator import emulator
from hthor.calibration.pipeline import config, run, stages, terminal
from hthor.calibration.simulation import design_points, session_simulation, session_store, simulate, trial_table
from hthor.cli import app
from hthor.errors import HthorError, MissingExtra, RunError, UnknownName
from hthor.eval.runner import progress
from hthor.humans.population import parameter_registry, population_file
from hthor.tasks.suite import make_suite
from hthor.trials import TrialRunner
from hthor.trials.sessions import make_sessions, make_setup

PAPER = tasks.load_suite("paper")
TINY = make_suite("tiny", 1, tuple(task for task in PAPER.tasks if task.house == "elder")[:2])


# -------------------------------------------------------------------------------------------------------- real sessions


def _train(folder, count, jobs=1, suite=TINY):
    points = design_points.sobol_points(count, len(parameter_registry.free_parameter_names()), 3, "training")
    return simulate.simulate_sessions(points, suite, 3, folder, jobs, progress.Silent(), "training")


@pytest.fixture(scope="module")
def trained(tmp_path_factory):
    folder = tmp_path_factory.mktemp("trained")
    with pytest.MonkeyPatch.context() as patch:  # in this process; that workers play the same has a test of its own
        eval_fakes.play_here(patch)
        return folder, _train(folder, 3)


def _same(first, second):
    return all(np.array_equal(getattr(first, name), getattr(second, name)) for name in ("points", *trial_table.COLUMNS))


def test_a_session_is_one_persons_trials_in_each_condition_in_turn(trained):
    _, made = trained
    assert made.condition.tolist() == [0, 0, 1, 1, 2, 2]
    assert made.index.tolist() == [0, 1] * 3
    assert sorted(made.task[:2].tolist()) == [0, 1]
    assert made.point.tolist() == [0, 0, 1, 1, 2, 2]
    assert made.points.shape == (3, len(parameter_registry.free_parameter_names()))
    alone = made.condition == 0
    assert (made.trust[alone] == 0).all()
    assert ((made.trust[~alone] >= 1) & (made.trust[~alone] <= 7)).all()
    assert (made.messages[alone] == 0).all()
    assert (made.ticks[~made.met] == 900).all()
    assert (made.picked[made.met] >= 0).all()
    assert ((made.accepted >= 0) == made.adopted).all()
    assert (made.shown[made.adopted] <= made.accepted[made.adopted]).all()


def test_more_workers_and_an_interruption_give_the_same_table(trained, tmp_path):
    folder, made = trained
    lines = (folder / session_store.FILE).read_bytes().splitlines(keepends=True)
    (tmp_path / session_store.IDENTITY).write_bytes((folder / session_store.IDENTITY).read_bytes())
    (tmp_path / session_store.FILE).write_bytes(
        lines[2] + lines[0][:50]
    )  # the third was done first, the next one cut short
    assert _same(_train(tmp_path, 3, jobs=2), made)


def test_a_larger_table_goes_on_from_a_smaller_and_nothing_is_played_twice(trained, monkeypatch):
    folder, made = trained
    monkeypatch.setattr(simulate, "run_all_sessions", lambda *_, **__: pytest.fail("it was all played before"))
    assert _same(_train(folder, 3), made)
    assert _same(_train(folder, 2), made.take(made.session < 2)) is False  # the points are fewer
    assert _train(folder, 2).ticks.tolist() == made.ticks[:4].tolist()


def test_a_changed_world_is_refused(trained, monkeypatch):
    folder, _ = trained
    known = session_store.trials_identity(TINY)
    changed = session_store.TrialIdentity(parts={**known.parts, "the person": "x"})
    monkeypatch.setattr(session_store, "trials_identity", lambda _: changed)
    with pytest.raises(RunError, match=r"another world or person: the person"):
        _train(folder, 3)


def test_a_session_is_what_an_evaluation_would_have_played():
    """The same person out of the same population meets the same trials, whoever asks."""
    from hthor.episode import play
    from hthor.humans.models.proxy import Model
    from hthor.humans.population import participant
    from hthor.humans.population.participant import Participant, participant_root

    point = design_points.sobol_points(1, len(parameter_registry.free_parameter_names()), 0, "x")[0]
    one = simulate.make_session_spec(TINY, session_store.trials_identity(TINY), 5, 0, point.tolist(), 1)
    stage, setup = TrialRunner(), make_setup(["mobile_manipulation"], agent="frontier")
    rows = list(session_simulation.run_session(one, TINY, setup, stage))

    dealt = make_sessions(TINY, agent="frontier", seed=5, participants=1)[0]
    traits = participant.add_random_effects(parameter_registry.parameters_at(point.tolist()), participant_root(5, 0))
    human, logs = Model(Participant(seed=5, number=0, traits=traits)), []
    with stage.enter(dealt) as company:
        for trial in dealt.trials:
            logs.append((trial, play(trial, stage.world(trial), {"human": human}, company.ready_agents())))
    for row, (trial, log) in zip(rows, logs, strict=True):
        told = dict(zip(session_simulation.OUTCOMES, row, strict=True))
        assert TINY.tasks[told["task"]].id == trial.task.id
        assert (told["met"], told["trust"]) == (log.met, log.ratings["human"])
        assert told["ticks"] == (log.ticks if log.met else 900)
        assert told["messages"] == sum(event.kind == "sent" for event in log.events)


def test_every_condition_meets_hands_alike():
    """Which third of the tasks a session gets says nothing of its condition."""
    pairs = [(number % 3, simulate.assign_condition(number)) for number in range(9)]
    assert len(set(pairs)) == 9


# --------------------------------------------------------------------------------------------------- whole calibrations


@pytest.fixture(scope="module", autouse=True)
def cheap():
    """As small as it can be: what is found is not looked at too closely."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(config, "QUICK", msgspec.structs.replace(config.QUICK, members=2, proposals=1 << 12, draws=200))
        yield


@pytest.fixture
def made_up(monkeypatch):
    monkeypatch.setattr(simulate, "simulate_sessions", fakes.sessions)
    monkeypatch.setattr(simulate, "simulate_studies", fakes.whole)


@pytest.fixture(scope="module")
def calibrated(tmp_path_factory):
    """A calibration that is done: its folder, and what it found."""
    folder = tmp_path_factory.mktemp("calibrated") / "first"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(simulate, "simulate_sessions", fakes.sessions)
        patch.setattr(simulate, "simulate_studies", fakes.whole)
        found = run.run_calibration(_options(folder), terminal.SilentProgress())
    return folder, found


def _options(folder, **more):
    return config.CalibrationOptions(out=Path(folder), quick=True, jobs=1, sessions=60, **more)


def _bytes(folder):
    names = ("population.json", "population.npz", "evidence.json", "result.json", "training.npz", "studies.npz")
    return {name: hashlib.sha256((folder / name).read_bytes()).hexdigest() for name in names}


def test_the_same_seed_gives_the_same_bytes_and_another_others(made_up, calibrated, tmp_path):
    folder, found = calibrated
    assert run.run_calibration(_options(tmp_path / "again"), terminal.SilentProgress()) == found
    assert _bytes(tmp_path / "again") == _bytes(folder)
    assert (
        run.run_calibration(_options(tmp_path / "other", seed=1, until="training"), terminal.SilentProgress()) is None
    )
    other = stages.CalibrationStages(
        config.resolve_options(_options(tmp_path / "other", seed=1)), terminal.SilentProgress()
    )
    assert not np.array_equal(other.training.met, trial_table.load_table(folder / "training.npz").met)


def test_products_are_kept_and_what_was_learned_is_told(made_up, calibrated, monkeypatch):
    folder, found = calibrated
    before = _bytes(folder)
    monkeypatch.setattr(emulator, "fit_emulator", lambda *_, **__: pytest.fail("it was fitted before"))
    assert run.run_calibration(_options(folder), terminal.SilentProgress()) == found
    assert _bytes(folder) == before

    people = population_file.load_population(folder / "population.json")
    assert people.sha256 == found.population_sha256
    assert people.names == parameter_registry.free_parameter_names()
    assert people.validity.suite_sha256 == PAPER.sha256
    assert people.validity.settings["robot"] == "scout"
    assert "(inferred)" in " ".join(people.statistics)
    learned = {one.name: one for one in found.parameters}
    assert learned["v_pace"].recovery > 0.7  # the made-up people's success hangs on it
    assert learned["v_pace"].contraction > 0.05
    assert learned["tau_seen"].word == "not identified"
    shown = {row.figure: row for row in found.figures}
    assert len(shown) == 8
    for row in shown.values():
        assert row.posterior.high - row.posterior.low < row.prior.high - row.prior.low + 3.0
    nearer = [abs(r.posterior.median - r.published) <= abs(r.prior.median - r.published) + 1.0 for r in shown.values()]
    assert sum(nearer) >= 6


def test_the_command_ends_with_1_when_a_gate_is_not_passed(made_up, calibrated, monkeypatch):
    folder, _ = calibrated
    words = ["calibrate", "--quick", "--quiet", "--sessions", "60", "--out", str(folder)]
    good = CliRunner().invoke(app, [*words, "--json"])
    document = json.loads(good.stdout)
    assert good.exit_code == (0 if all(gate["passed"] for gate in document["gates"]) else 1)
    assert document["population_sha256"] == population_file.load_population(folder / "population.npz").sha256

    from hthor.calibration.diagnostics import acceptance

    monkeypatch.setattr(acceptance, "QUICK", msgspec.structs.replace(acceptance.QUICK, z_sd=(5.0, 6.0)))
    bad = CliRunner().invoke(app, words)
    assert bad.exit_code == 1
    assert "FAILED" in bad.stdout


def test_each_stage_is_told_of(made_up, tmp_path):
    heard = io.StringIO()
    teller = terminal.PrintedProgress(Console(file=heard, width=100), live=False)
    with teller.watch("training") as watch:
        watch.begin(3, 1)
        watch.played(True, False)
        watch.played(False, False)
    with teller.work("emulator"):
        pass
    assert "training: 3 trials, 1 of them played before" in heard.getvalue()
    assert "success 50 %" in heard.getvalue()
    assert "emulator" not in heard.getvalue()  # it took no time worth telling


def test_a_calibration_may_stop_after_a_stage(made_up, tmp_path, monkeypatch):
    monkeypatch.setattr(simulate, "simulate_studies", lambda *_: pytest.fail("it was to stop before"))
    assert run.run_calibration(_options(tmp_path, until="training"), terminal.SilentProgress()) is None
    monkeypatch.setattr(simulate, "simulate_studies", fakes.whole)
    assert (
        run.run_calibration(_options(tmp_path, until="correction"), terminal.SilentProgress()) is None
    )  # a small one has none
    with pytest.raises(UnknownName, match=r"stage 'trainings'\. Did you mean 'training'"):
        run.run_calibration(_options(tmp_path, until="trainings"), terminal.SilentProgress())


def test_wrong_input_is_told_before_anything_is_done(tmp_path, monkeypatch):
    with pytest.raises(UnknownName, match="suite 'papers'"):
        config.resolve_options(config.CalibrationOptions(suite="papers"))
    with pytest.raises(HthorError, match="one set of published results"):
        config.resolve_options(config.CalibrationOptions(targets=("paper", "paper")))
    monkeypatch.setitem(__import__("sys").modules, "sklearn", None)
    with pytest.raises(MissingExtra, match=r"hthor\[calibration\]"):
        run.run_calibration(_options(tmp_path), terminal.SilentProgress())


def test_a_folder_that_is_called_like_a_target_is_not_taken_for_logs(tmp_path, monkeypatch):
    from hthor.commands import calibrate

    monkeypatch.chdir(tmp_path)
    for name in ("paper", "mine"):
        (tmp_path / name).mkdir()
    asked = []
    monkeypatch.setattr(calibrate, "_fit_logs", lambda targets, *_: asked.append(targets))
    monkeypatch.setattr(run, "run_calibration", lambda options, _: asked.append(options.targets))
    for name in ("paper", "mine"):
        CliRunner().invoke(app, ["calibrate", "--target", name, "--quiet"])
    assert asked == [("paper",), ("mine",)]
