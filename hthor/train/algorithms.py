"""The algorithms of `hthor train` by name, and their settings."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Any, Literal

import msgspec
from msgspec import structs

from hthor.agents.skills.savn_network import PAPER, NetworkConfig
from hthor.errors import HthorError, UnknownName
from hthor.train import bc, savn
from hthor.train.loop import Learner, LoopConfig

Profile = Literal["slim", "paper"]
_NETWORKS: dict[Profile, NetworkConfig] = {"slim": NetworkConfig(), "paper": PAPER}
_ALGORITHMS: dict[str, tuple[Learner[Any], type[LoopConfig], bool]] = {
    "savn": (savn.learn, savn.Config, True),
    "a2c": (savn.learn, savn.Config, False),
    "bc": (bc.learn, bc.Config, False),
}
"""How each learns, its configuration, and whether its network adapts."""


def make(
    name: str, settings: Iterable[str] = (), profile: Profile = "slim", **options: Any
) -> tuple[Learner[Any], LoopConfig]:
    """An algorithm and its configuration.

    Args:
        profile: of the network. settings: other values, each as "KEY=VALUE", such as "entropy=0.02" or
            "network.hidden=256".
        options: fields of the configuration.

    Raises:
        UnknownName: when there is no such algorithm or setting. HthorError: when a value does not fit.
    """
    if name not in _ALGORITHMS:
        raise UnknownName("algorithm", name, tuple(_ALGORITHMS))
    learner, config_type, adapts = _ALGORITHMS[name]
    network = _NETWORKS[profile] if adapts else structs.replace(_NETWORKS[profile], updates=0)
    config = config_type(network=network, **options)
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
