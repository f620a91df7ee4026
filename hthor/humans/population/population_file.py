"""Populations in files: NAME.npz has the draws, NAME.json next to it describes them.

Equal populations give equal bytes.
"""

import hashlib
import io
import zipfile
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from msgspec import Struct

from hthor import documents, jsonio
from hthor.errors import PopulationError, UnknownName
from hthor.humans.population import parameters, prior_population
from hthor.humans.population.parameters import Parameters
from hthor.humans.population.population import Population, PopulationColumn, Validity, array_problem

SCHEMA = "hthor.population/1"
FOLDER = Path(__file__).parents[1] / "populations"
PRIOR_POPULATION = "literature"
"""The population without a file: drawn from the current priors."""
CALIBRATED_POPULATION = "study"
"""The population calibrated to the published user study."""
_STEMS = {CALIBRATED_POPULATION: "paper"}
"""Populations whose file has another name, so that its bytes and hashes stay the same; both names are accepted."""
_ROUNDING = 1e-6
"""[weight] Largest difference between the sum of a file's weights and 1. Our choice."""
_DAMAGED = (
    "it was changed or cut off after it was written; restore both files, or make them again with 'hthor calibrate'"
)


class Arrays(Struct, frozen=True, kw_only=True):
    """The NPZ file that belongs to a JSON file."""

    draws: int
    effective: float
    sha256: str


class Document(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The JSON file; fields as in `Population`."""

    schema: str = SCHEMA
    name: str
    purpose: str
    parameters: tuple[PopulationColumn, ...]
    fixed: dict[str, float]
    statistics: tuple[str, ...]
    design_effects: dict[str, float]
    figures: dict[str, float]
    notes: tuple[str, ...]
    validity: Validity
    seed: int
    command: str
    arrays: Arrays


_SHARED = tuple(name for name in Document.__struct_fields__ if name not in ("schema", "parameters", "arrays"))
"""Fields that are in a `Population` by the same name."""


def names() -> tuple[str, ...]:
    """The populations that ship with hthor."""
    return tuple(sorted({PRIOR_POPULATION, *(population_name(path.stem) for path in FOLDER.glob("*.json"))}))


def population_name(name: str) -> str:
    """The name of the population with this name or file stem."""
    return next((word for word, stem in _STEMS.items() if stem == name), name)


def load_population(name_or_path: str | Path) -> Population:
    """A population by name, or by the path of either of its two files.

    Raises:
        UnknownName: when no population has that name.
        PopulationError: when a file is missing, damaged or not a population's, or a value is out of its range.
    """
    word = population_name(str(name_or_path))
    if word in names():
        return _shipped(word)
    path = Path(word)
    if path.suffix not in (".npz", ".json"):
        raise UnknownName("population", word, names(), "A path to a population's file (.npz or .json) works too.")
    return _read(path.with_suffix(".json"))


def save_population(population: Population, path: Path) -> Path:
    """Write PATH.npz and then PATH.json, which has the hash of PATH.npz; returns the JSON's path."""
    path = path.with_suffix("") if path.suffix in (".npz", ".json") else path
    data = population.arrays
    document = Document(
        **{name: getattr(population, name) for name in _SHARED},
        parameters=population.specs,
        arrays=Arrays(
            draws=len(population.draws), effective=round(population.ess, 3), sha256=_sha256(population.arrays)
        ),
    )
    jsonio.write(path.with_name(f"{path.name}.npz"), data)
    jsonio.write(written := path.with_name(f"{path.name}.json"), jsonio.pretty(document))
    return written


@cache
def _shipped(name: str) -> Population:
    if name == PRIOR_POPULATION:
        return prior_population.make_prior_population()
    return _read(FOLDER / f"{_STEMS.get(name, name)}.json")


def _read(path: Path) -> Population:
    document = documents.parse(_bytes(path), Document, PopulationError, shown=str(path), schema=SCHEMA, hint=_DAMAGED)
    numbers = path.with_suffix(".npz")
    draws, log_weight = _arrays(numbers, document)
    columns = [spec.name for spec in document.parameters]
    known = parameters.parameter_names()
    given = (*columns, *document.fixed)
    for field, name in (*(("parameters", name) for name in columns), *(("fixed", name) for name in document.fixed)):
        if name not in known:
            raise PopulationError(
                str(path), field, f"this version has no parameter '{name}'; make the population again"
            )
        if given.count(name) > 1:
            raise PopulationError(str(path), field, f"'{name}' is there twice")
    for name, value in document.fixed.items():
        if problem := parameters.range_problem(name, value):
            raise PopulationError(str(path), f"fixed.{name}", problem)
    if bad := array_problem(columns, draws, log_weight):
        raise PopulationError(str(numbers), *bad)
    with np.errstate(over="ignore"):
        total = float(np.exp(log_weight).sum())
    if abs(total - 1.0) > _ROUNDING:
        raise PopulationError(str(numbers), "log_weight", f"the weights add up to {total:g}; expected 1")
    defaults = tuple(name for name in known if name not in given)
    missing = tuple(name for name in defaults if name not in parameters.NEUTRAL)
    shared = {name: getattr(document, name) for name in _SHARED}
    shared["fixed"] = {**document.fixed, **{name: getattr(Parameters(), name) for name in defaults}}
    return Population(**shared, specs=document.parameters, draws=draws, log_weight=log_weight, missing=missing)


def _arrays(path: Path, document: Document) -> tuple[Any, Any]:
    """Draws and weights from the NPZ file whose hash is in the document."""
    data = _bytes(path)
    if (digest := _sha256(data)) != document.arrays.sha256:
        there = document.arrays.sha256[:10]
        raise PopulationError(str(path), "$", f"it hashes to {digest[:10]}, the JSON file says {there}: {_DAMAGED}")
    try:
        with np.load(io.BytesIO(data), allow_pickle=False) as archive:
            arrays = {name: archive[name] for name in ("names", "draws", "log_weight")}
    except KeyError as error:
        raise PopulationError(str(path), str(error).strip("'\"").split(" ")[0], f"is missing; {_DAMAGED}") from None
    except (ValueError, EOFError, OSError, zipfile.BadZipFile) as error:
        raise PopulationError(str(path), "$", f"is not an NPZ archive: {error}; {_DAMAGED}") from None
    columns = [spec.name for spec in document.parameters]
    if (names := arrays["names"].tolist()) != columns:
        raise PopulationError(str(path), "names", f"are {names}, the JSON file lists {columns}")
    for name in ("draws", "log_weight"):
        if arrays[name].dtype != np.dtype("<f8"):
            raise PopulationError(str(path), name, f"has the type {arrays[name].dtype}, expected float64")
    return arrays["draws"], arrays["log_weight"]


def _bytes(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        hint = "a population has two files, NAME.npz and NAME.json, side by side"
        raise PopulationError(str(path), "$", f"cannot be read: {error.strerror}; {hint}") from None


def _sha256(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()
