"""What the profile "paper" of SAVN sees with: a small network that turns a robot's colour picture into features.

The published robot reads the last map of a network for photographs, 512 numbers in each of 7 x 7 cells. This encoder
is trained on the simulator's own pictures (`hthor.train.encoder`) to name what each cell shows and how far off it is.
In between it has 32 numbers a cell, a code of one byte each, so that the codes of whole houses can be kept. Needs the
extra ``torch``.
"""

from __future__ import annotations

from pathlib import Path

from hthor.agents.skills.semantic_cells import GRID
from hthor.errors import HthorError, MissingExtra

try:
    import safetensors.torch as tensors
    import torch
    from safetensors import SafetensorError
    from torch import Tensor, nn
    from torch.nn import functional as F  # noqa: N812
except ModuleNotFoundError as error:
    raise MissingExtra("SAVN", "torch") from error

WEIGHTS = "encoder.safetensors"
"""The file of an encoder in its folder."""
CODE = 32
"""Numbers in a cell's code."""
_LEVELS = 255.0
_WIDTHS = (24, 48, 64, 64)
"""Channels of the convolutions, each of which halves the picture."""


class PictureEncoder(nn.Module):
    """Codes and features of pictures of any size, and what they say.

    Args:
        classes: of things that a cell can show. channels: features of a cell.
    """

    def __init__(self, classes: int, channels: int) -> None:
        super().__init__()
        sizes = zip((3, *_WIDTHS), _WIDTHS, strict=False)
        self.shrink = nn.ModuleList(nn.Conv2d(few, many, 3, stride=2, padding=1) for few, many in sizes)
        self.code = nn.Conv2d(_WIDTHS[-1], CODE, 3, padding=1)
        self.expand = nn.Linear(CODE, channels)
        self.classes = nn.Linear(channels, classes)
        self.range = nn.Linear(channels, 1)

    def compress(self, pictures: Tensor) -> Tensor:
        """The codes of pictures (B, height, width, 3) uint8, (B, cells, 32) from 0 to 1."""
        x = pictures.permute(0, 3, 1, 2).to(self.code.weight.dtype) / _LEVELS - 0.5
        for layer in self.shrink:
            x = F.relu(layer(x))
        x = torch.sigmoid(self.code(F.adaptive_avg_pool2d(x, GRID)))
        return x.flatten(2).mT

    def encode(self, pictures: Tensor) -> Tensor:
        """The same as bytes, (B, cells, 32) uint8."""
        with torch.no_grad():
            return (self.compress(pictures) * _LEVELS).round().to(torch.uint8)

    def features(self, codes: Tensor) -> Tensor:
        """(B, cells, channels) of codes, of bytes or from 0 to 1."""
        dtype = self.expand.weight.dtype
        codes = codes.to(dtype) / _LEVELS if codes.dtype == torch.uint8 else codes
        return F.relu(self.expand(codes))

    def read(self, features: Tensor) -> tuple[Tensor, Tensor]:
        """Logits of the class that each cell shows (B, cells, classes), and its range (B, cells), 1 for `FAR_M`."""
        return self.classes(features), self.range(features).squeeze(2)


def read_file(folder: Path) -> PictureEncoder:
    """The encoder in a folder of a training.

    Raises:
        HthorError: when there is none, or the file is damaged.
    """
    path = folder / WEIGHTS
    try:
        return load(path.read_bytes(), str(path))
    except OSError as error:
        raise HthorError(
            f"{path} cannot be read: {error.strerror}; 'hthor train encoder --out {folder}' makes one"
        ) from None


def dump(encoder: PictureEncoder) -> bytes:
    """The weights in single precision, the same bytes for the same weights."""
    held = encoder.state_dict()
    data: bytes = tensors.save({name: held[name].detach().float().cpu().contiguous() for name in sorted(held)})
    return data


def load(data: bytes, shown: str = "this") -> PictureEncoder:
    """The encoder that `dump` wrote.

    Args:
        shown: what errors call it, such as the file's name.

    Raises:
        HthorError: when the data are damaged, or not an encoder's.
    """
    try:
        held = tensors.load(data)
        encoder: PictureEncoder = PictureEncoder(len(held["classes.bias"]), len(held["expand.bias"]))
        encoder.load_state_dict(held)
    except (SafetensorError, KeyError, RuntimeError) as error:
        first = str(error).strip().replace("\n\t", " ")
        raise HthorError(f"{shown} does not hold the weights of an encoder of pictures: {first}") from None
    return encoder
