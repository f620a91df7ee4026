"""Checkpoints of networks: a folder with `config.json` and `model.safetensors`. Needs the extra ``torch``."""

from __future__ import annotations

from pathlib import Path

from msgspec import Struct

from hthor import documents, jsonio
from hthor.agents.skills.savn_network import Network, NetworkConfig
from hthor.errors import HthorError, MissingExtra

try:
    import safetensors.torch as tensors
    from safetensors import SafetensorError
except ModuleNotFoundError as error:
    raise MissingExtra("SAVN", "torch") from error

CONFIG, WEIGHTS = "config.json", "model.safetensors"
SCHEMA = "hthor.checkpoint/1"
_HINT = f"A checkpoint is a folder with {CONFIG} and {WEIGHTS}."


class CheckpointConfig(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What a checkpoint's `config.json` says.

    Attributes:
        network: the sizes of the network and how it adapts. classes: what the numbers of its cells and goals stand for.
    """

    schema: str
    network: NetworkConfig
    classes: tuple[str, ...]


class Checkpoint(Struct, frozen=True, kw_only=True, eq=False):
    """A network and the classes that its numbers stand for."""

    network: Network
    classes: tuple[str, ...]


def save(folder: Path, checkpoint: Checkpoint) -> None:
    """Write a checkpoint; each of its two files is replaced in one step.

    Raises:
        OSError: when a file cannot be written.
    """
    config = CheckpointConfig(schema=SCHEMA, network=checkpoint.network.config, classes=checkpoint.classes)
    weights = {name: value.detach().cpu().contiguous() for name, value in checkpoint.network.state_dict().items()}
    jsonio.write(folder / WEIGHTS, tensors.save(weights))
    jsonio.write(folder / CONFIG, jsonio.pretty(config))


def load(folder: Path) -> Checkpoint:
    """Read a checkpoint.

    Raises:
        HthorError: when a file is missing or damaged, or the two do not belong together.
    """
    config = _read_config(folder / CONFIG)
    path = folder / WEIGHTS
    try:
        network = Network(config.network)
        network.load_state_dict(tensors.load(_read(path)))
    except (SafetensorError, RuntimeError) as error:
        first = str(error).strip().replace("\n\t", " ")
        raise HthorError(f"{path} does not hold the weights that {CONFIG} beside it describes: {first}") from None
    return Checkpoint(network=network.eval(), classes=config.classes)


def _read_config(path: Path) -> CheckpointConfig:
    config = documents.read(path, CheckpointConfig, HthorError, schema=SCHEMA, hint=_HINT)
    if config.network.classes != len(config.classes):
        problem = f"names {len(config.classes)} classes, but its network is for {config.network.classes}"
        raise HthorError.in_file(str(path), "classes", problem)
    return config


def _read(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        raise HthorError(f"{path} cannot be read: {error.strerror}; {_HINT}") from None
