"""Every free parameter of the proxy: unit, prior, source, and which data could identify it."""

from collections.abc import Callable
from functools import cache
from typing import Literal

import numpy as np
from msgspec import Struct
from numpy.typing import ArrayLike, NDArray

from hthor.errors import UnknownName
from hthor.humans.population.distributions import Beta, HalfNormal, LogNormal, LogUniform, Normal, Prior, Uniform
from hthor.humans.population.parameters import Parameters

PROXY_VERSION = 1
"""[version] Version of the proxy, raised when a participant with the same parameters would behave differently. A
population fitted to another version may not fit this one. Our choice."""

Floats = NDArray[np.float64]

Grade = Literal["A", "A-", "B", "B-", "C", "own"]
"""A: identified by the published numbers (A-: weakly); B: by logs of sessions (B-: weakly); C: by the literature only;
own: our choice, without data."""


class Parameter(Struct, frozen=True, kw_only=True):
    """One parameter, by its name in `hthor.humans.population.parameters`.

    Attributes:
        prior: None for a number that is fixed at its default; ``source`` is the source of the prior.
        effect: spread between participants in units of ``sigma``; 0 for none.
        scale: whether the effect is added to the logarithm, the logit or the number itself.
        fitted: whether calibration on the published results moves it; others are drawn from their priors.
        grade: which data could identify it.
    """

    name: str
    unit: str
    meaning: str
    source: str
    grade: Grade
    prior: Prior | None = None
    effect: float = 0.0
    scale: Literal["log", "logit", "plain"] = "log"
    fitted: bool = False


def _free(name: str, unit: str, prior: Prior, grade: Grade, meaning: str, source: str, **more: object) -> Parameter:
    return Parameter(name=name, unit=unit, prior=prior, grade=grade, meaning=meaning, source=source, **more)  # type: ignore[arg-type]


PARAMETERS: tuple[Parameter, ...] = (
    _free(
        "v_pace",
        "m/s",
        LogUniform(0.25, 1.0),
        "A",
        "stick speed under way",
        "1.0 m/s is the default of Unity's XR toolkit and the avatar's full stick",
        effect=0.5,
        fitted=True,
    ),
    _free("stop_every", "s", LogUniform(1.5, 12.0), "B", "time under way between stops to look", "our choice"),
    _free("stop_s", "s", LogUniform(0.3, 1.5), "B", "length of a stop to look", "our choice"),
    _free(
        "omega",
        "rad/s",
        LogUniform(0.8, 3.0),
        "B",
        "speed of turning",
        "60 to 180 degrees a second; Blandino et al. 2021",
        effect=0.5,
    ),
    _free(
        "k_map",
        "",
        Uniform(1.0, 2.0),
        "A-",
        "slowing while following a map",
        "arrows beat mini-maps in a VR maze (2026)",
        fitted=True,
    ),
    _free(
        "lam0",
        "1/s",
        LogUniform(0.1, 3.0),
        "A-",
        "rate of noticing",
        "about three fixations a second; Koopman's law of random search",
        effect=1.0,
        fitted=True,
    ),
    _free(
        "a50",
        "rad",
        Uniform(0.02, 0.067),
        "C",
        "visual angle at which noticing is half as fast",
        "a thing of 10 cm seen from 1.5 to 5 m",
    ),
    _free("clutter", "", HalfNormal(0.15), "C", "how much things close by slow noticing", "our choice"),
    _free(
        "tau_mem",
        "s",
        LogUniform(20.0, 600.0),
        "C",
        "forgetting that a place was searched",
        "ACT-R decay; Li, Aivar, Tong and Hayhoe 2018",
    ),
    _free("tau_seen", "s", LogUniform(60.0, 1200.0), "C", "forgetting where something was seen", "ACT-R decay"),
    _free(
        "w_prior",
        "",
        Beta(3.0, 2.0),
        "B-",
        "share of common knowledge in beliefs",
        "semantics against evidence (CR:PI 2021)",
    ),
    _free("beta", "", LogUniform(0.5, 6.0), "B", "Luce exponent of choices", "Kryven et al. 2024", effect=1.0),
    _free(
        "kappa",
        "",
        Uniform(0.3, 1.0),
        "B",
        "exponent of time in what an option is worth",
        "people under-weigh time (JOV 2550962)",
    ),
    _free("t_dwell", "s", LogUniform(0.7, 5.0), "B", "looking at a receptacle from close by", "our choice", effect=1.0),
    _free("t_on", "s", Uniform(0.5, 4.0), "B", "delay of the first movement", "our choice"),
    _free(
        "t_manip",
        "s",
        LogUniform(1.0, 10.0),
        "B",
        "one attempt with the hands",
        "Viola 2022; Fernandez 2022",
        effect=1.0,
        fitted=True,
    ),
    _free("p_fail", "", Beta(2.0, 10.0), "B", "chance that an attempt misses", "5 to 20 % an attempt"),
    _free("t_notice", "s", LogNormal(1.5, 0.4), "B", "noticing a message", "Rzayev 2019: 1 to 3 s"),
    _free(
        "t_read",
        "s",
        LogNormal(3.0, 0.25),
        "B",
        "reading twelve words",
        "Brysbaert 2019: 238 words a minute",
        effect=1.0,
    ),
    _free(
        "a0",
        "logit",
        Normal(2.0, 1.0),
        "A-",
        "willingness to accept",
        "our choice",
        effect=2.0,
        scale="plain",
        fitted=True,
    ),
    _free("a_trust", "logit", HalfNormal(4.0), "B", "willingness by trust", "Chen et al. 2018, 2020"),
    _free("a_gain", "logit", HalfNormal(0.5), "B", "willingness by the time to be saved", "Mangalindan et al. 2024"),
    _free("a_load", "logit", HalfNormal(1.0), "B", "unwillingness by work in hand", "Mangalindan et al. 2024"),
    _free("a_again", "logit", Normal(0.5, 0.5), "B", "unwillingness by earlier refusals", "our choice"),
    _free("mu0", "", Beta(5.5, 4.5), "B", "mean trust at first", "Guo and Yang 2021", effect=2.0, scale="logit"),
    _free("n0", "counts", LogUniform(2.0, 20.0), "B", "firmness of that trust", "Guo and Yang 2021"),
    _free("w_s", "counts", LogUniform(0.3, 4.0), "B", "what a success adds to trust", "Guo and Yang 2021", fitted=True),
    _free(
        "w_f",
        "counts",
        LogUniform(0.3, 4.0),
        "B",
        "what a failure takes from trust",
        "Guo and Yang 2021; Yang, Schemanske and Searle 2021",
    ),
    _free("tau_s", "s", LogUniform(10.0, 60.0), "B-", "how fast the worth of help fades", "HumanTHOR"),
    _free("sigma", "", Uniform(0.05, 0.5), "B", "how much people differ", "our choice"),
    _free("learn", "", Uniform(0.0, 0.4), "B", "gain by practice", "10 to 30 % over ten trials"),
)
"""All free parameters, in the order of a population's columns."""


def free_parameter_names() -> tuple[str, ...]:
    """Names of the free parameters, in order."""
    return tuple(parameter.name for parameter in PARAMETERS)


@cache
def _by_name() -> dict[str, Parameter]:
    return {parameter.name: parameter for parameter in PARAMETERS}


def parameter(name: str) -> Parameter:
    """The free parameter of this name.

    Raises:
        UnknownName: when no free parameter has this name.
    """
    if name not in _by_name():
        raise UnknownName("parameter", name, free_parameter_names())
    return _by_name()[name]


def parameters_at(point: tuple[float, ...] | list[float]) -> Parameters:
    """The population at a point of the unit cube: each coordinate is a quantile of its parameter's prior."""
    values = {p.name: p.prior.quantile(u) for p, u in zip(PARAMETERS, point, strict=True) if p.prior is not None}
    return Parameters(**values)


def from_quantiles(points: ArrayLike) -> Floats:
    """Populations at points of the unit cube, in physical units: (N, P) to (N, P), see `parameters_at`."""
    return _by_column(points, [p.prior.quantile for p in PARAMETERS if p.prior is not None])


def to_quantiles(values: ArrayLike) -> Floats:
    """Quantiles of populations in their priors: the inverse of `from_quantiles`."""
    return _by_column(values, [p.prior.cdf for p in PARAMETERS if p.prior is not None])


def _by_column(table: ArrayLike, functions: list[Callable[[float], float]]) -> Floats:
    array = np.asarray(table, dtype=np.float64)
    if array.ndim != 2 or array.shape[1] != len(functions):
        raise ValueError(f"expected a table with {len(functions)} columns, got the shape {array.shape}")
    values = [[f(x) for f, x in zip(functions, row, strict=True)] for row in array.tolist()]
    return np.array(values).reshape(array.shape)
