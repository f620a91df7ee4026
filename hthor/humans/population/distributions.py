"""Prior distributions as data."""

import math
from statistics import NormalDist
from typing import Any

from msgspec import Struct

_NORMAL = NormalDist()


class Uniform(Struct, tag="uniform", frozen=True):
    """Uniform between ``low`` and ``high``."""

    low: float
    high: float

    def __post_init__(self) -> None:
        if not -math.inf < self.low < self.high < math.inf:
            raise ValueError(f"a uniform prior needs low below high; got low {self.low} and high {self.high}")

    def quantile(self, u: float) -> float:
        return self.low + u * (self.high - self.low)

    def cdf(self, x: float) -> float:
        return min(1.0, max(0.0, (x - self.low) / (self.high - self.low)))


class LogUniform(Struct, tag="log-uniform", frozen=True):
    """A number between ``low`` and ``high`` whose logarithm is uniform."""

    low: float
    high: float

    def __post_init__(self) -> None:
        if not 0.0 < self.low < self.high < math.inf:
            got = f"got low {self.low} and high {self.high}"
            raise ValueError(f"a log-uniform prior needs low above 0 and below high; {got}")

    def quantile(self, u: float) -> float:
        return self.low * math.exp(u * math.log(self.high / self.low))

    def cdf(self, x: float) -> float:
        return min(1.0, max(0.0, math.log(x / self.low) / math.log(self.high / self.low)))


class Normal(Struct, tag="normal", frozen=True):
    """Normal around ``mean`` with standard deviation ``sd``."""

    mean: float
    sd: float

    def __post_init__(self) -> None:
        _positive("a normal prior", sd=self.sd)

    def quantile(self, u: float) -> float:
        return self.mean + self.sd * _NORMAL.inv_cdf(u)

    def cdf(self, x: float) -> float:
        return _NORMAL.cdf((x - self.mean) / self.sd)


class HalfNormal(Struct, tag="half-normal", frozen=True):
    """The absolute value of a normal number around 0 with standard deviation ``sd``."""

    sd: float

    def __post_init__(self) -> None:
        _positive("a half-normal prior", sd=self.sd)

    def quantile(self, u: float) -> float:
        return self.sd * _NORMAL.inv_cdf(0.5 + 0.5 * u)

    def cdf(self, x: float) -> float:
        return 2.0 * _NORMAL.cdf(max(0.0, x) / self.sd) - 1.0


class LogNormal(Struct, tag="log-normal", frozen=True):
    """A number whose logarithm is normal around the logarithm of ``median`` with standard deviation ``sd``."""

    median: float
    sd: float

    def __post_init__(self) -> None:
        _positive("a log-normal prior", median=self.median, sd=self.sd)

    def quantile(self, u: float) -> float:
        return self.median * math.exp(self.sd * _NORMAL.inv_cdf(u))

    def cdf(self, x: float) -> float:
        return _NORMAL.cdf(math.log(x / self.median) / self.sd)


class Beta(Struct, tag="beta", frozen=True):
    """Beta with counts ``a`` and ``b``, between 0 and 1."""

    a: float
    b: float

    def __post_init__(self) -> None:
        _positive("a beta prior", a=self.a, b=self.b)

    def quantile(self, u: float) -> float:
        return float(_special().betaincinv(self.a, self.b, u))

    def cdf(self, x: float) -> float:
        return float(_special().betainc(self.a, self.b, min(1.0, max(0.0, x))))


Prior = Uniform | LogUniform | Normal | HalfNormal | LogNormal | Beta


def _positive(what: str, **given: float) -> None:
    for name, value in given.items():
        if not 0.0 < value < math.inf:
            raise ValueError(f"{what} needs {name} above 0; got {value}")


def _special() -> Any:
    from scipy import special

    return special
