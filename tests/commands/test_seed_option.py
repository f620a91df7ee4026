"""A seed is a whole number from 0: wherever a user gives one, any other is refused in one sentence."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import pytest
import typer
from hypothesis import given
from hypothesis import strategies as st
from typer.testing import CliRunner

import hthor
from hthor import houses, seeds
from hthor.calibration.from_logs import run as from_logs
from hthor.calibration.pipeline import config as calibration
from hthor.calibration.validation import plan
from hthor.cli import app
from hthor.errors import HthorError
from hthor.eval.config.options import EvalOptions
from hthor.houses import generator
from hthor.humans.population import describe, resolve
from hthor.tasks import load_suite
from hthor.tasks.generation import custom_suite
from hthor.trials import make_session
from hthor.world import World
from hthor.world.validation import house_soundness


def _options(command: Any, words: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], Any]]:
    """Every option of every command that takes a seed."""
    for name, below in getattr(command, "commands", {}).items():
        yield from _options(below, (*words, name))
    yield from ((words, option) for option in command.params if option.name == "seed")


SEEDED = list(_options(typer.main.get_command(app)))


@pytest.mark.parametrize("words", [" ".join(words) for words, _ in SEEDED])
def test_every_command_that_takes_a_seed_refuses_a_negative_one(words: str) -> None:
    done = CliRunner().invoke(app, [*words.split(), "--seed", "-1"])
    assert done.exit_code == 2
    assert "--seed" in done.output
    assert "greater than or equal to 0" in " ".join(done.output.replace("│", " ").split())


def test_there_are_commands_with_seeds() -> None:
    assert {("eval",), ("live",), ("calibrate",), ("houses", "generate"), ("tasks", "make"), ("train", "savn")} <= {
        words for words, _ in SEEDED
    }


def _world(seed: Any) -> None:
    World("elder").reset(seed=seed)


def _task(seed: Any) -> None:
    task = next(task for task in load_suite("smoke").tasks)
    World(task.house, objects=[(one.id, one.kind) for one in task.objects]).reset(task, seed=seed)


TAKERS: dict[str, Callable[[Any], object]] = {
    "World.reset": _world,
    "World.reset with a task": _task,
    "generator.generate": lambda seed: generator.generate(seed, 4),
    "generate_valid_home": lambda seed: house_soundness.generate_valid_home(seed, 4),
    "custom_suite.make_tasks": lambda seed: custom_suite.make_tasks(
        custom_suite.Recipe(name="mine", tasks=1, seed=seed), houses.load("elder")
    ),
    "make_session": lambda seed: make_session(load_suite("smoke").tasks[:1], agent="frontier", seed=seed),
    "evaluate": lambda seed: hthor.evaluate(agent="none", suite="smoke", seed=seed),
    "EvalOptions": lambda seed: hthor.evaluate(agent="none", humans="proxy", seed=seed, dry_run=True),
    "sample_participants": lambda seed: describe.sample_participants(resolve.resolve_humans("proxy"), 1, seed),
    "calibration": lambda seed: calibration.resolve_options(calibration.CalibrationOptions(seed=seed)),
    "calibration from logs": lambda seed: from_logs.estimate_from_logs([], "proxy", None, print, seed=seed),  # type: ignore[arg-type]
    "validation": lambda seed: plan.planned_runs(plan.ValidationOptions(seed=seed)),
}


@pytest.mark.parametrize("taker", TAKERS)
@pytest.mark.parametrize("seed", [-1, 2**63])
def test_everything_that_takes_a_seed_refuses_what_is_none(taker: str, seed: int) -> None:
    with pytest.raises(HthorError, match="seed") as caught:
        TAKERS[taker](seed)
    assert caught.value.exit_code == 2
    assert len(str(caught.value).splitlines()) == 1


@given(st.one_of(st.integers(max_value=-1), st.integers(min_value=2**63), st.floats(), st.text(), st.booleans()))
def test_nothing_else_is_a_seed(value: object) -> None:
    with pytest.raises(HthorError, match="a seed must be a whole number from 0"):
        seeds.check_seed(value)


@given(st.integers(0, 2**63 - 1))
def test_every_whole_number_from_0_is_a_seed(value: int) -> None:
    assert seeds.check_seed(value) == value


def test_eval_takes_its_seed_from_0() -> None:
    assert EvalOptions(agent=("none",)).seed == 0
