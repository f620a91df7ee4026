"""All metrics, found by the files of `hthor.eval.metrics.definitions`, in the order of tables."""

from collections.abc import Iterable
from typing import Any

import msgspec
from msgspec import Struct

from hthor import plugins
from hthor.errors import UnknownName
from hthor.eval.metrics.metric import Metric


def _find() -> tuple[Metric, ...]:
    found = [metric for file in plugins.names("metric") for metric in plugins.load("metric", file)]
    twice = {metric.name for metric in found if [one.name for one in found].count(metric.name) > 1}
    if twice:
        raise ValueError(f"two metrics are called {sorted(twice)[0]}; every metric needs a name of its own")
    return tuple(sorted(found, key=lambda metric: metric.rank))


METRICS = _find()
SINGLE = tuple(metric for metric in METRICS if not metric.by_seat)
"""Metrics with one value per trial."""
BY_SEAT = tuple(metric for metric in METRICS if metric.by_seat)
MAIN = tuple(metric for metric in SINGLE if metric.main)
"""The metrics that every table of results has, and that runs are compared in."""
_BY_NAME = {metric.name: metric for metric in METRICS}


def define_record(
    name: str, base: type[Struct], module: str, *, single: object, default: object, by_seat: type[Any]
) -> type[Any]:
    """A record with a field for each metric, of the type ``single`` with its default, or of the type ``by_seat``."""

    def field(metric: Metric) -> tuple[str, object, object]:
        if metric.several:
            return metric.name, by_seat | msgspec.UnsetType, msgspec.UNSET
        if metric.by_seat:
            return metric.name, by_seat, msgspec.field(default_factory=dict)
        return metric.name, single, default

    fields: list[Any] = [field(metric) for metric in METRICS]
    return msgspec.defstruct(name, fields, bases=(base,), module=module, frozen=True, kw_only=True)


def modules(names: Iterable[str]) -> list[str]:
    """The modules that define these metrics, for a hash of their code."""
    return sorted({get(name).formula.__module__ for name in names})


def get(name: str) -> Metric:
    """The metric of this name; raises UnknownName when no metric has it."""
    if name not in _BY_NAME:
        raise UnknownName("metric", name, tuple(_BY_NAME))
    return _BY_NAME[name]
