"""The record of the options: its defaults, the checks of values, and the way to the command line and to runs."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Annotated

import pytest
import typer
from hypothesis import given
from hypothesis import strategies as st
from msgspec import Struct
from typer.testing import CliRunner

from hthor import jsonio
from hthor.cli import app
from hthor.commands.options import takes_options
from hthor.errors import UnknownName
from hthor.eval.config import cli_command, option, study_design
from hthor.eval.config.option import Option
from hthor.eval.config.options import EvalOptions
from hthor.eval.planning.resolve import resolve
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.runner import engines
from hthor.guest.confinement import AUTO
from hthor.humans.population.resolve import PROXY
from hthor.types import cameras, detector_specs
from hthor.types.specs import LOCKSTEP

WORDS = st.text("abc./=@ ", min_size=1, max_size=6).filter(lambda word: word.strip() == word)

COMMAND = typer.main.get_command(app).commands["eval"]  # type: ignore[attr-defined]


def test_defaults_are_the_words_of_the_modules_that_read_them():
    one = EvalOptions()
    assert one.humans == (PROXY,)
    assert (one.detector, one.camera) == (detector_specs.OWN, cameras.OWN)
    assert (one.engine, one.isolation) == (engines.LOCAL, AUTO)
    assert (one.clock, one.design) == (LOCKSTEP, study_design.PAIRED)


def _values(one: option.Field) -> st.SearchStrategy[object]:
    """Values that an option takes."""
    kind = one.types[0]
    if one.choices:
        value: st.SearchStrategy[object] = st.sampled_from(one.choices)
    elif kind in (int, float):
        least = 0 if one.about.least is None else one.about.least
        value = st.integers(int(least) + 1, 3000).map(kind)
    else:
        value = {bool: st.booleans(), str: WORDS, Path: WORDS.map(Path)}[kind]
    return st.lists(value, min_size=1, max_size=3).map(tuple) if one.repeated else value


@given(st.fixed_dictionaries({}, optional={name: _values(one) for name, one in option.fields(EvalOptions).items()}))
def test_the_command_line_of_options_gives_these_options(given: dict[str, object]):
    options = option.make_record(EvalOptions, given)
    read = COMMAND.make_context("eval", option.command_words(options)).params
    known = option.fields(EvalOptions)
    assert option.make_record(EvalOptions, {name: value for name, value in read.items() if name in known}) == options
    assert option.make_record(EvalOptions, {name: getattr(options, name) for name in known}) == options


def test_an_option_is_declared_once():
    class Toasting(Struct, frozen=True, kw_only=True):
        slices: Annotated[int, Option(help="How many slices.", least=1, short="s")] = 2
        bread: Annotated[tuple[str, ...], Option(help="The bread.", default="white")] = ()
        warm: Annotated[bool, Option(help="Keep it warm.", negatable=True)] = True

    seen: list[Toasting] = []
    toast = typer.Typer()

    @toast.command()
    @takes_options(Toasting)
    def make(loud: bool = False, **given: object) -> None:
        assert loud
        seen.append(option.make_record(Toasting, given))

    runner = CliRunner()
    assert runner.invoke(toast, ["-s", "3", "--bread", "rye", "--bread", "oat", "--no-warm", "--loud"]).exit_code == 0
    assert seen == [Toasting(slices=3, bread=("rye", "oat"), warm=False)]
    assert runner.invoke(toast, ["--slices", "0"]).exit_code == 2
    said = runner.invoke(toast, ["--help"]).stdout
    assert all(words in said for words in ("How many slices.", "The bread.", "--no-warm", "(white)", "x>=1"))


def test_what_is_resolved_has_no_word_left_to_look_up(tmp_path: Path):
    out = tmp_path / "x"
    found = resolve(EvalOptions(agent=("none", "oracle"), suite="smoke", limit=12, max_faults="25%", out=out))
    assert [run.folder.path for run in found.runs] == [out / "none", out / "oracle"]
    assert found.allowed_faults(12) == 3.0
    assert found.baseline_of[out / "oracle"] is found.runs[0]
    assert found.baselines == ()
    assert len({id(run.engine) for run in found.runs}) == 2, "an engine that was drained plays nothing more"
    assert not out.exists()
    with pytest.raises(UnknownName, match="unknown engine 'rai'"):
        resolve(EvalOptions(agent=("oracle",), engine="rai"))


@pytest.mark.slow
@pytest.mark.parametrize(
    "given",
    [
        {"agent": "oracle", "suite": "smoke", "limit": 12, "camera": "thor", "camera_size": "64x48", "seed": 3},
        {"agent": "frontier", "suite": "paper", "house": ["alder", "birch"], "difficulty": "easy", "clock": "charged"},
        {"robots": "tall:oracle,small:frontier", "suite": "smoke", "detector": "noisy", "humans": "greedy,proxy"},
        {"agent": ["oracle", "frontier"], "suite": "smoke", "design": "between", "participants": 12, "name": "study"},
        {"agent": "oracle", "suite": "smoke", "participants": 4, "shard": "2/4", "robot": "tall"},
        {"agent": "oracle", "suite": "smoke", "limit": 10, "trial_limit": 900.5, "isolation": "L1", "max_faults": "5%"},
    ],
)
def test_the_command_of_a_configuration_gives_this_configuration(
    given: dict[str, object], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.chdir(tmp_path)
    known = option.fields(EvalOptions)
    for run in resolve(option.make_record(EvalOptions, given)).runs:
        words = shlex.split(cli_command.resume_command(run.folder.path, run.config))
        assert words[:2] == ["hthor", "eval"]
        read = {name: value for name, value in COMMAND.make_context("eval", words[2:]).params.items() if name in known}
        again = resolve(option.make_record(EvalOptions, read)).runs
        assert run.config in [one.config for one in again]
        assert run.folder.path in [one.folder.path for one in again]


def test_what_changes_no_trial_is_kept_and_makes_no_other_run(tmp_path: Path):
    plain, kept = (
        resolve(EvalOptions(agent=("oracle",), suite="smoke", limit=10, control=False, **more)).runs[0].config  # type: ignore[arg-type]
        for more in ({}, {"trial_limit": 900.0, "max_faults": "5%", "jobs": 2})
    )
    assert kept.options == {"trial_limit": 900.0, "max_faults": "5%"}
    assert b"options" not in jsonio.pretty(plain)
    assert (kept.sha256, kept.folder_name, kept.untitled) == (plain.sha256, plain.folder_name, plain)
    RunFolder(tmp_path / "run").write_config(plain)
    RunFolder(tmp_path / "run").check_free(kept)
    assert " --trial-limit 900 --max-faults 5%" in cli_command.resume_command(tmp_path, kept)
