"""A population: weighted draws of participants' mean parameters, and how far participants differ.

The draws express the uncertainty of the mean, the random effects how participants differ from it. A participant is one
draw, picked by weight, plus random effects. Neither depends on the robots: all robots meet the same participants.
"""

from __future__ import annotations

import bisect
import hashlib
import io
import zipfile
from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from typing import Any, Literal

import msgspec
import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from hthor import jsonio, rules, seeds
from hthor.humans.population import parameter_registry, parameters, participant
from hthor.humans.population.distributions import Prior
from hthor.humans.population.parameter_registry import Grade
from hthor.humans.population.parameters import Parameters

Floats = NDArray[np.float64]

IDENTIFIED_FROM = 0.4
"""[ratio] Least contraction (1 - variance of posterior / variance of prior, in quantiles of the prior) of a parameter
that counts as identified. Our choice."""
WEAKLY_IDENTIFIED_FROM = 0.1
"""[ratio] Least contraction of a weakly identified parameter. Our choice: sampling alone makes about .05."""


class PopulationColumn(Struct, frozen=True, kw_only=True):
    """One column of a population: its entry in the registry, and how far the data determine it (``contraction``).

    ``effect`` times the draw's ``sigma`` is the standard deviation between participants, on the ``scale``.
    """

    name: str
    unit: str
    meaning: str
    prior: Prior
    level: Literal["population", "population and person"]
    effect: float
    scale: Literal["log", "logit", "plain"]
    fitted: bool
    grade: Grade
    source: str
    contraction: float

    @property
    def word(self) -> str:
        """Whether the data determine the parameter, in words."""
        if self.contraction >= IDENTIFIED_FROM:
            return "identified"
        return "weakly identified" if self.contraction >= WEAKLY_IDENTIFIED_FROM else "not identified"


class Validity(Struct, frozen=True, kw_only=True):
    """The data and settings of a population's fit; it may not fit under others. Empty if it was fitted to no data.

    Attributes:
        simulation: `hthor.rules.SIMULATION`.
        mind: `hthor.humans.population.parameter_registry.PROXY_VERSION`.
        settings: settings that influence the fit: the robot's name, speed, ranges and detector.
    """

    suite: str = ""
    suite_sha256: str = ""
    targets: str = ""
    targets_sha256: str = ""
    simulation: int = rules.SIMULATION
    mind: int = parameter_registry.PROXY_VERSION
    rules_sha256: str = msgspec.field(default_factory=rules.sha256)
    settings: dict[str, str | float] = {}


class Population(Struct, frozen=True, kw_only=True, eq=False, dict=True):
    """Weighted draws of population means.

    Attributes:
        specs: one for each column of ``draws``.
        draws: (D, P) float64, in the units of ``specs``.
        log_weight: (D,) float64, natural logarithms of weights that add up to 1.
        fixed: values of the parameters that have no column.
        statistics: the data of the fit; ``design_effects``: their variance over that of independent trials.
        figures: further numbers about the fit, such as effective draws or coverage.
        notes: cautions for its users, one sentence each.
        missing: parameters of this version that the file does not have and that change what people do at their
            defaults, which stand in.
    """

    name: str
    purpose: str
    specs: tuple[PopulationColumn, ...]
    draws: Floats
    log_weight: Floats
    fixed: dict[str, float]
    seed: int
    command: str
    statistics: tuple[str, ...] = ()
    design_effects: dict[str, float] = {}
    figures: dict[str, float] = {}
    notes: tuple[str, ...] = ()
    validity: Validity = msgspec.field(default_factory=Validity)
    missing: tuple[str, ...] = ()

    def __repr__(self) -> str:
        return f"Population({self.name!r}, {len(self.draws)} draws, {self.sha256[:10]})"

    @staticmethod
    def make(
        name: str,
        draws: Any,
        log_weight: Any = None,
        *,
        purpose: str,
        seed: int,
        command: str,
        names: Sequence[str] | None = None,
        fixed: Parameters | None = None,
        statistics: Sequence[str] = (),
        design_effects: Mapping[str, float] | None = None,
        figures: Mapping[str, float] | None = None,
        notes: Sequence[str] = (),
        validity: Validity | None = None,
    ) -> Population:
        """A new population with the current registry's units, priors, effects, grades and sources.

        Args:
            draws: (D, P) in physical units, one column for each name.
            log_weight: (D,), up to a constant; None when all draws count the same.
            names: names of the columns, by default of every free parameter.
            fixed: values of the other parameters, by default their defaults.

        Raises:
            ValueError: when shapes do not fit, a value is out of its parameter's range, or no weight is left.
        """
        columns = parameter_registry.free_parameter_names() if names is None else tuple(names)
        table = np.array(draws, dtype=np.float64)
        raw = np.zeros(len(table)) if log_weight is None else np.array(log_weight, dtype=np.float64)
        if problem := array_problem(columns, table, raw):
            raise ValueError(f"{problem[0]}: {problem[1]}")
        top = float(raw.max())
        weight = raw - (top + float(np.log(np.exp(raw - top).sum())))
        others = msgspec.structs.asdict(fixed or Parameters())
        return Population(
            name=name,
            purpose=purpose,
            specs=tuple(_spec(column, table[:, k], weight) for k, column in enumerate(columns)),
            draws=table,
            log_weight=weight,
            fixed={key: value for key, value in others.items() if key not in columns},
            seed=seed,
            command=command,
            statistics=tuple(statistics),
            design_effects=dict(design_effects or {}),
            figures=dict(figures or {}),
            notes=tuple(notes),
            validity=validity or Validity(),
        )

    @property
    def names(self) -> tuple[str, ...]:
        """The columns of the draws."""
        return tuple(spec.name for spec in self.specs)

    @cached_property
    def weights(self) -> Floats:
        """(D,), adding up to 1."""
        return np.exp(self.log_weight)

    @property
    def ess(self) -> float:
        """Effective number of draws."""
        return float(1.0 / (self.weights**2).sum())

    @cached_property
    def arrays(self) -> bytes:
        """The NPZ file's bytes."""
        return encode_npz(
            {
                "draws": self.draws.astype("<f8"),
                "log_weight": self.log_weight.astype("<f8"),
                "names": np.array(self.names, dtype="<U32"),
            }
        )

    @cached_property
    def sha256(self) -> str:
        """Hash of everything that decides how participants behave, without descriptions.

        Parameters that change nothing at their defaults do not count there.
        """
        usual = Parameters()
        fixed = {
            name: value
            for name, value in self.fixed.items()
            if not (name in parameters.NEUTRAL and value == getattr(usual, name))
        }
        return jsonio.sha256(
            {
                "arrays": hashlib.sha256(self.arrays).hexdigest(),
                "effects": [(spec.name, spec.effect, spec.scale) for spec in self.specs],
                "fixed": fixed,
            }
        )

    def parameters(self, row: int) -> Parameters:
        """The means in draw number ``row``."""
        return Parameters(**self.fixed, **dict(zip(self.names, self.draws[row].tolist(), strict=True)))

    def pick(self, seed: int, index: int) -> int:
        """The draw of participant ``index`` of the study with this seed."""
        mark = seeds.draw(participant.participant_root(seed, index), "population")
        return min(bisect.bisect_right(self._cumulated, mark * self._cumulated[-1]), len(self._cumulated) - 1)

    def draw_traits(
        self, seed: int, index: int, change: Callable[[Parameters], Parameters] | None = None
    ) -> Parameters:
        """Parameters of participant ``index`` of this study: a draw, after any ``change``, plus random effects."""
        mean = self.parameters(self.pick(seed, index))
        return participant.add_random_effects(
            change(mean) if change else mean, participant.participant_root(seed, index), self.specs
        )

    def mean(self) -> Parameters:
        """The weighted mean of the draws."""
        return Parameters(**self.fixed, **dict(zip(self.names, (self.weights @ self.draws).tolist(), strict=True)))

    def quantiles(self, levels: Sequence[float] = (0.05, 0.5, 0.95)) -> Floats:
        """Weighted quantiles of every column, (levels, P)."""
        columns = []
        for values in self.draws.T:
            order = np.argsort(values, kind="stable")
            weight = self.weights[order]
            columns.append(np.interp(levels, np.cumsum(weight) - weight / 2.0, values[order]))
        return np.array(columns).T

    @cached_property
    def _cumulated(self) -> list[float]:
        return list(np.cumsum(self.weights).tolist())


def encode_npz(arrays: Mapping[str, NDArray[Any]], compression: int = zipfile.ZIP_STORED) -> bytes:
    """Arrays as an NPZ file's bytes, without the time of writing that numpy would put into it."""
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as archive:
        for name, array in arrays.items():
            member = io.BytesIO()
            np.lib.format.write_array(member, np.ascontiguousarray(array), version=(1, 0), allow_pickle=False)
            archive.writestr(zipfile.ZipInfo(f"{name}.npy"), member.getvalue(), compression)
    return file.getvalue()


def array_problem(names: Sequence[str], draws: Floats, log_weight: Floats) -> tuple[str, str] | None:
    """The problem of a population's arrays: the field and a description; None if they are valid."""
    if draws.ndim != 2 or draws.shape[1] != len(names) or not len(draws):
        return "draws", f"the shape is {draws.shape}; expected one row or more of {len(names)} columns"
    if log_weight.shape != (len(draws),):
        return "log_weight", f"the shape is {log_weight.shape}; expected ({len(draws)},), one a draw"
    if np.isnan(log_weight).any() or not np.isfinite(log_weight.max()):
        return "log_weight", "every weight must be a number below infinity, and one at least above minus infinity"
    for column, name in enumerate(names):
        for row in np.unique([draws[:, column].argmin(), draws[:, column].argmax()]).tolist():
            if problem := parameters.range_problem(name, float(draws[row, column])):
                return f"draws[{row}].{name}", problem
    return None


def _spec(name: str, values: Floats, log_weight: Floats) -> PopulationColumn:
    known = parameter_registry.parameter(name)
    if known.prior is None:
        raise ValueError(f"names: '{name}' has no prior, so it cannot be a column")
    weight, quantiles = np.exp(log_weight), np.array([known.prior.cdf(value) for value in values.tolist()])
    mean = float(weight @ quantiles)
    return PopulationColumn(
        **msgspec.structs.asdict(known),
        level="population and person" if known.effect else "population",
        contraction=round(1.0 - 12.0 * float(weight @ (quantiles - mean) ** 2), 4),
    )
