"""A detector that errs: it misses small things, more of them at a distance, and shows some that are not there."""

from __future__ import annotations

from collections.abc import Sequence

from hthor import catalog
from hthor.agents.skills.semantic_cells import FAR_M
from hthor.errors import MissingExtra

try:
    import torch
    from torch import Tensor
except ModuleNotFoundError as error:
    raise MissingExtra("SAVN", "torch") from error

MISS, MISS_PER_M, FALSE_ALARM = 0.03, 0.06, 0.001
"""The chance to miss a small thing in a cell, at no distance and per metre, and the chance that a cell shows one that
is not there. Real detectors lose small things with distance; the sizes are assumptions."""


class DetectorNoise:
    """Draws what a detector makes of cells.

    Args:
        classes: of the cells. device: where the tensors are.
    """

    def __init__(self, classes: Sequence[str], device: torch.device) -> None:
        small = torch.tensor([name in catalog.TARGETS for name in classes], device=device)
        self.small, self._small_classes = small, torch.nonzero(small).squeeze(1)

    def __call__(self, shown: Tensor, behind: Tensor, ranges: Tensor, generator: torch.Generator) -> Tensor:
        """(B, cells) int64, the classes that it reports.

        Args:
            shown, behind: (B, cells) int64, see `hthor.agents.skills.semantic_cells.Cells`.
            ranges: (B, cells), from 0 to 1 for `FAR_M`.
        """
        chance = torch.rand(shown.shape, generator=generator, device=shown.device)
        missed = self.small[shown] & (chance < MISS + MISS_PER_M * FAR_M * ranges)
        seen = torch.where(missed, behind, shown)
        extra = (chance - (1.0 - FALSE_ALARM)) / FALSE_ALARM
        which = (extra * len(self._small_classes)).long().clamp(0, len(self._small_classes) - 1)
        return torch.where(extra > 0.0, self._small_classes[which], seen)
