"""Populations: who is drawn out of them, their files, and what is said of a file that is no good."""

from __future__ import annotations

import io
import json
import math
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from law_cases import cases

from hthor import seeds
from hthor.errors import HthorError, PopulationError, UnknownName
from hthor.humans.population import (
    distributions,
    parameter_registry,
    parameters,
    participant,
    population_file,
    prior_population,
)
from hthor.humans.population.parameters import Parameters
from hthor.humans.population.population import Population, Validity

NAMES = ("v_pace", "a0", "mu0", "sigma")
ROWS = [[0.4, 1.0, 0.5, 0.3], [0.5, 2.0, 0.6, 0.1], [0.7, -1.0, 0.2, 0.2]]


LOG_WEIGHT = (0.0, math.log(2.0), -math.inf)


def made(rows: Any = ROWS, log_weight: Any = LOG_WEIGHT, **more: Any) -> Population:
    about: dict[str, Any] = {"purpose": "three draws", "seed": 7, "command": "a test", "names": NAMES, **more}
    return Population.make("few", rows, log_weight, **about)


def test_weights_add_up_and_what_weighs_nothing_is_never_drawn():
    few = made()
    assert few.weights == pytest.approx([1 / 3, 2 / 3, 0.0])
    assert few.ess == pytest.approx(9 / 5)
    picked = [few.pick(0, index) for index in range(900)]
    assert picked.count(0) == pytest.approx(300, abs=45)
    assert picked.count(2) == 0
    assert few.mean().v_pace == pytest.approx(0.4 / 3 + 1.0 / 3)
    assert few.mean().t_read == Parameters().t_read


def test_a_participant_is_a_draw_and_random_effects_upon_it():
    few = made()
    row = few.pick(3, 5)
    assert few.draw_traits(3, 5) == participant.add_random_effects(
        few.parameters(row), participant.participant_root(3, 5), few.specs
    )
    assert few.draw_traits(3, 5) != few.parameters(row)
    assert few.draw_traits(3, 5) == made().draw_traits(3, 5)
    assert len({few.draw_traits(3, index).v_pace for index in range(20)}) == 20
    own = few.draw_traits(3, 5)  # only what people differ in is their own
    differing = {spec.name for spec in few.specs if spec.effect}
    for name, value in msgspec.structs.asdict(few.parameters(row)).items():
        assert (getattr(own, name) != value) == (name in differing)


def test_people_are_spread_as_sigma_says():
    rows = [[0.5, 2.0, 0.55, 0.3]]
    one = made(rows, None)
    people = [one.draw_traits(0, index) for index in range(600)]
    assert np.std([math.log(p.v_pace) for p in people]) == pytest.approx(0.3 * 0.5, rel=0.1)
    assert np.std([p.a0 for p in people]) == pytest.approx(0.3 * 2.0, rel=0.1)
    assert np.std([math.log(p.mu0 / (1 - p.mu0)) for p in people]) == pytest.approx(0.3 * 2.0, rel=0.1)


def test_quantiles_heed_weights():
    values = np.linspace(0.3, 0.9, 1001)
    rows = np.column_stack([values, np.full(1001, 2.0), np.full(1001, 0.5), np.full(1001, 0.2)])
    even = made(rows, None)
    assert even.quantiles((0.25, 0.5))[:, 0] == pytest.approx([0.45, 0.6], abs=1e-3)
    upper = made(rows, np.where(values > 0.6, 0.0, -40.0))
    assert upper.quantiles((0.5,))[0, 0] == pytest.approx(0.75, abs=2e-3)


def test_contraction_tells_what_was_learnt():
    points = [[(i + 0.5) / 400 for _ in parameter_registry.free_parameter_names()] for i in range(400)]
    prior = Population.make("p", parameter_registry.from_quantiles(points), purpose="", seed=0, command="")
    assert all(abs(spec.contraction) < 0.01 for spec in prior.specs)
    assert {spec.word for spec in prior.specs} == {"not identified"}
    weight = [-(((u[0] - 0.5) / 0.1) ** 2) / 2 for u in points]
    post = Population.make("q", parameter_registry.from_quantiles(points), weight, purpose="", seed=0, command="")
    assert post.specs[0].contraction == pytest.approx(1 - 12 * 0.1**2, abs=0.01)
    assert post.specs[0].word == "identified"


@given(
    st.lists(
        st.floats(0.001, 0.999),
        min_size=len(parameter_registry.free_parameter_names()),
        max_size=len(parameter_registry.free_parameter_names()),
    )
)
@settings(max_examples=cases(30))
def test_the_cube_and_the_units_are_one_to_one(point: list[float]):
    values = parameter_registry.from_quantiles([point])
    assert parameter_registry.to_quantiles(values)[0] == pytest.approx(point, abs=1e-9)
    assert parameter_registry.parameters_at(point) == Parameters(
        **dict(zip(parameter_registry.free_parameter_names(), values[0].tolist(), strict=True))
    )
    assert not [
        text
        for name, x in zip(parameter_registry.free_parameter_names(), values[0], strict=True)
        if (text := parameters.range_problem(name, x))
    ]


def test_tables_of_other_shapes_are_refused():
    with pytest.raises(
        ValueError,
        match="expected a table with 31 columns" if len(parameter_registry.free_parameter_names()) == 31 else "columns",
    ):
        parameter_registry.from_quantiles([[0.5, 0.5]])
    with pytest.raises(ValueError, match=r"draws: the shape is \(3, 4\); expected one row or more of 3 columns"):
        made(names=NAMES[:3])
    with pytest.raises(ValueError, match=r"log_weight: the shape is \(2,\)"):
        made(log_weight=(0.0, 0.0))
    with pytest.raises(ValueError, match="one at least above minus infinity"):
        made(log_weight=(-math.inf,) * 3)
    with pytest.raises(UnknownName, match=r"unknown parameter 'v_pase'\. Did you mean 'v_pace'"):
        made(names=("v_pase", *NAMES[1:]))


@pytest.mark.parametrize(
    ("column", "value"), [(0, 0.0), (0, -1.0), (0, math.nan), (1, 60.0), (2, 1.01), (3, -0.1), (3, math.inf)]
)
def test_values_out_of_range_are_refused(column: int, value: float):
    rows = [list(row) for row in ROWS]
    rows[1][column] = value
    with pytest.raises(
        ValueError, match=rf"draws\[1\]\.{NAMES[column]}: .* is out of range; {NAMES[column]} lies from"
    ):
        made(rows)


def test_every_parameter_has_a_range_that_holds_its_default():
    assert set(parameters.parameter_names()) >= set(parameter_registry.free_parameter_names())
    for name in parameters.parameter_names():
        assert parameters.range_problem(name, getattr(Parameters(), name)) == ""
        low, high = parameters.parameter_range(name)
        assert parameters.clamp(name, low - 1.0) == low
        assert parameters.clamp(name, high + 1.0) == high
    for group in (parameters._POSITIVE, parameters._SHARES, parameters._SIGNALS, parameters._LOGITS):
        assert set(group) <= set(parameters.parameter_names())


# ------------------------------------------------------------------------------------------------------------ files


def test_saved_and_loaded_it_is_the_same(tmp_path: Path):
    first = made(
        statistics=("sr none",),
        design_effects={"sr none": 1.7},
        figures={"ess": 2.5},
        notes=("a note",),
        validity=Validity(suite="paper", suite_sha256="ab" * 32, settings={"robot": "scout", "speed_m_s": 1.8}),
        fixed=Parameters(p_slip=0.5),
    )
    path = population_file.save_population(first, tmp_path / "pop.npz")
    assert path == tmp_path / "pop.json"
    for word in (path, str(tmp_path / "pop.npz")):
        again = population_file.load_population(word)
        assert again.sha256 == first.sha256
        assert again.specs == first.specs
        assert again.validity == first.validity
        assert again.fixed == first.fixed
        assert again.fixed["p_slip"] == 0.5
        assert (again.statistics, again.design_effects, again.figures, again.notes, again.seed, again.command) == (
            *(("sr none",), {"sr none": 1.7}, {"ess": 2.5}, ("a note",), 7, "a test"),
        )
        assert [again.draw_traits(1, k) for k in range(5)] == [first.draw_traits(1, k) for k in range(5)]
        assert again.missing == ()


def test_the_same_population_is_the_same_bytes(tmp_path: Path):
    for folder in ("one", "two"):
        population_file.save_population(made(), tmp_path / folder / "pop")
    for name in ("pop.npz", "pop.json"):
        assert (tmp_path / "one" / name).read_bytes() == (tmp_path / "two" / name).read_bytes()
    with zipfile.ZipFile(tmp_path / "one" / "pop.npz") as archive:
        assert {entry.date_time for entry in archive.infolist()} == {(1980, 1, 1, 0, 0, 0)}
    assert np.load(tmp_path / "one" / "pop.npz")["names"].tolist() == list(NAMES)
    assert sorted(path.name for path in (tmp_path / "one").iterdir()) == ["pop.json", "pop.npz"]


def test_the_hash_is_of_what_makes_people_and_of_nothing_else():
    assert made(purpose="other words", notes=("more",), seed=8, command="x").sha256 == made().sha256
    assert made(fixed=Parameters(p_slip=0.03)).sha256 != made().sha256
    rows = [list(row) for row in ROWS]
    rows[0][0] += 1e-12
    assert made(rows).sha256 != made().sha256


def test_the_json_file_says_what_each_column_is(tmp_path: Path):
    document = json.loads(population_file.save_population(made(), tmp_path / "pop").read_bytes())
    assert document["schema"] == "hthor.population/1"
    (pace, *_) = document["parameters"]
    assert pace["name"] == "v_pace"
    assert pace["unit"] == "m/s"
    assert pace["prior"]["type"] == "log-uniform"
    assert pace["level"] == "population and person"
    assert {"effect", "scale", "grade", "source", "fitted", "contraction", "meaning"} <= set(pace)
    assert set(document["fixed"]) == set(parameters.parameter_names()) - set(NAMES)
    assert {"simulation", "mind", "rules_sha256", "suite_sha256", "targets_sha256", "settings"} <= set(
        document["validity"]
    )
    assert document["arrays"]["draws"] == 3


def _edit(path: Path, change: Callable[[dict[str, Any]], object]) -> None:
    document = json.loads(path.read_bytes())
    change(document)
    path.write_text(json.dumps(document))


def _swap(path: Path, **arrays: Any) -> None:
    """Other numbers in the archive, and the JSON file in agreement with them."""
    with np.load(path.with_suffix(".npz")) as archive:
        held = {name: archive[name] for name in archive.files} | arrays
    file = io.BytesIO()
    np.savez(file, **{name: value for name, value in held.items() if value is not None})
    path.with_suffix(".npz").write_bytes(file.getvalue())
    _edit(path, lambda document: document["arrays"].update(sha256=population_file._sha256(file.getvalue())))


def test_a_damaged_file_is_named_with_its_field(tmp_path: Path):
    def refused(spoil: Callable[[Path], object], *words: str) -> None:
        path = population_file.save_population(made(), tmp_path / "pop")
        spoil(path)
        with pytest.raises(PopulationError) as caught:
            population_file.load_population(path)
        for word in words:
            assert word in str(caught.value)

    npz = tmp_path / "pop.npz"
    data = made().arrays
    refused(lambda _: npz.write_bytes(data[:-40]), "pop.npz: $: it hashes to", "changed or cut off")
    refused(lambda _: npz.unlink(), "pop.npz: $: cannot be read", "NAME.npz and NAME.json, side by side")
    refused(lambda path: path.unlink(), "pop.json: $: cannot be read")
    refused(lambda path: path.write_bytes(path.read_bytes()[:200]), "pop.json: $: is not JSON")
    refused(lambda path: path.write_text('{"schema": "hthor.run/3"}'), "schema: is 'hthor.run/3'")
    refused(lambda path: path.write_text("[1, 2]"), "pop.json: $:")
    refused(lambda path: _edit(path, lambda d: d.pop("seed")), "missing required field `seed`")
    refused(lambda path: _edit(path, lambda d: d["parameters"][1].update(effect="x")), "parameters[", "effect")
    refused(lambda path: _edit(path, lambda d: d["fixed"].update(p_slip=1.5)), "fixed.p_slip: 1.5 is out of range")
    refused(
        lambda path: _edit(path, lambda d: d["fixed"].update(wings=2.0)), "fixed: this version has no parameter 'wings'"
    )
    refused(lambda path: _edit(path, lambda d: d["fixed"].update(v_pace=0.4)), "'v_pace' is there twice")
    refused(lambda path: _edit(path, lambda d: d.update(extra=1)), "extra")
    refused(lambda path: _swap(path, draws=None), "draws: is missing")
    refused(lambda path: _swap(path, names=np.array(["a", "b", "c", "d"])), "names: are ['a', 'b', 'c', 'd']")
    refused(lambda path: _swap(path, draws=np.array(ROWS, dtype=np.float32)), "draws: has the type float32")
    refused(lambda path: _swap(path, draws=np.array(ROWS)[:, :3]), "draws: the shape is (3, 3)")
    refused(lambda path: _swap(path, draws=np.array(ROWS) * 9), "pop.npz: draws[1].mu0", "mu0 lies from 0 to 1")
    refused(lambda path: _swap(path, log_weight=np.zeros(2)), "log_weight: the shape is (2,)")
    refused(lambda path: _swap(path, log_weight=np.array([0.0, 800.0, 0.0])), "log_weight: the weights add up to inf")
    refused(lambda path: _swap(path, log_weight=np.zeros(3)), "log_weight: the weights add up to 3; expected 1")
    refused(lambda path: _edit(path, lambda d: d["parameters"][0]["prior"].update(high=0)), "parameters[0].prior: a ")
    refused(lambda path: _swap(path, draws=np.array([{}], dtype=object)), "pop.npz: $: is not an NPZ archive")


def test_what_a_newer_version_added_is_at_its_default_and_said(tmp_path: Path):
    path = population_file.save_population(made(), tmp_path / "pop")
    _edit(path, lambda document: document["fixed"].pop("p_slip"))
    again = population_file.load_population(path)
    assert again.missing == ("p_slip",)
    assert again.mean().p_slip == Parameters().p_slip


def test_unknown_names_are_answered_with_the_nearest():
    with pytest.raises(UnknownName, match=r"unknown population 'litrature'\. Did you mean 'literature'"):
        population_file.load_population("litrature")
    assert issubclass(PopulationError, HthorError)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: distributions.Uniform(1.0, 1.0), "needs low below high"),
        (lambda: distributions.LogUniform(0.0, 1.0), "needs low above 0"),
        (lambda: distributions.LogUniform(2.0, 1.0), "below high"),
        (lambda: distributions.Normal(0.0, 0.0), "needs sd above 0"),
        (lambda: distributions.HalfNormal(-1.0), "needs sd above 0"),
        (lambda: distributions.LogNormal(0.0, 1.0), "needs median above 0"),
        (lambda: distributions.Beta(1.0, math.nan), "needs b above 0"),
    ],
)
def test_a_prior_that_is_no_distribution_is_refused(make: Any, words: str):
    with pytest.raises(ValueError, match=words):
        make()


def test_the_literature_is_the_priors():
    held = population_file.load_population("literature")
    assert held is population_file.load_population("literature")
    assert held.names == parameter_registry.free_parameter_names()
    assert held.sha256 == prior_population.make_prior_population().sha256
    for column, spec in enumerate(held.specs):
        values = held.quantiles((0.05, 0.5, 0.95))[:, column]
        assert [spec.prior.cdf(value) for value in values] == pytest.approx([0.05, 0.5, 0.95], abs=2e-3)
    points = parameter_registry.to_quantiles(held.draws)
    shared = np.corrcoef(points.T) - np.eye(len(held.specs))
    assert np.abs(shared).max() < 0.2
    assert held.validity.suite_sha256 == ""


@pytest.mark.parametrize("name", population_file.names())
def test_every_population_that_ships_loads_and_draws(name: str):
    held = population_file.load_population(name)
    assert population_file.population_name(held.name) == name
    assert held.missing == ()
    assert held.purpose
    for index in range(50):
        for parameter, value in msgspec.structs.asdict(held.draw_traits(seeds.derive(0, name), index)).items():
            assert parameters.range_problem(parameter, value) == ""
