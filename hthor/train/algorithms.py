"""The algorithms of `hthor train` by name, and their settings."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from typing import Any

import msgspec

from hthor.agents.skills.savn_network import NetworkConfig
from hthor.errors import HthorError, UnknownName
from hthor.train import bc, savn
from hthor.train.loop import Learner, LoopConfig


def _a2c(**options: Any) -> savn.Config:
    """The configuration of SAVN for a network that never adapts."""
    return savn.Config(network=NetworkConfig(updates=0), **options)


_ALGORITHMS: dict[str, tuple[Learner[Any], Callable[..., LoopConfig]]] = {
    "savn": (savn.learn, savn.Config),
    "a2c": (savn.learn, _a2c),
    "bc": (bc.learn, bc.Config),
}


def make(name: str, settings: Iterable[str] = (), **options: Any) -> tuple[Learner[Any], LoopConfig]:
    """An algorithm and its configuration.

    Args:
        settings: other values, each as "KEY=VALUE", such as "entropy=0.02" or "network.hidden=256".
        options: fields of the configuration.

    Raises:
        UnknownName: when there is no such algorithm or setting. HthorError: when a value does not fit.
    """
    if name not in _ALGORITHMS:
        raise UnknownName("algorithm", name, tuple(_ALGORITHMS))
    learner, make_config = _ALGORITHMS[name]
    config = make_config(**options)
    for setting in settings:
        key, equals, value = setting.partition("=")
        if not equals:
            raise HthorError(f"a setting is written KEY=VALUE, such as entropy=0.02; got {setting!r}")
        config = _set(config, key, value)
    return learner, config


def _set(config: LoopConfig, key: str, value: str) -> LoopConfig:
    document = msgspec.to_builtins(config)
    network = document["network"]
    known = [*(name for name in document if name != "network"), *(f"network.{name}" for name in network)]
    if key not in known:
        raise UnknownName("setting", key, known)
    where, _, name = key.rpartition(".")
    fields = network if where else document
    fields[name] = re.sub(r"^(-?)\.", r"\g<1>0.", value)  # .5 is how people write it
    try:
        return msgspec.convert(document, type(config), strict=False)
    except msgspec.ValidationError as error:
        raise HthorError(f"{key}={value}: {error}") from None
