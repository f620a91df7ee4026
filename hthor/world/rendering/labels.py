"""The numbers of owners in a segmentation, shuffled for every episode so that a number alone carries no information.

Numbers in alphabetic order would reveal names, and constant numbers would identify a thing from one trial to the next;
a camera sees neither.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from hthor import seeds

CODE_PART = "pictures"


class SegmentationLabels:
    """The numbers of the owners of what is drawn.

    Args:
        names: of all owners, in the order in which they are counted where pictures are drawn.

    Attributes:
        names: the same names in the order of the numbers that pictures show.
    """

    def __init__(self, names: Sequence[str]) -> None:
        self._counted, self._seed = tuple(names), -1
        self.names: tuple[str, ...] = ()
        self._shown = np.zeros(0, np.int32)

    def draw(self, seed: int) -> None:
        """Shuffle the numbers for an episode; equal seeds give equal numbers."""
        if self.names and seed == self._seed:
            return
        root = seeds.derive(seed, "segmentation")
        self.names, self._seed = tuple(sorted(self._counted, key=lambda name: seeds.draw(root, name))), seed
        number = {name: index for index, name in enumerate(self.names)}
        self._shown = np.array([*(number[name] for name in self._counted), -1], np.int32)

    def of(self, numbers: Any) -> Any:
        """(H, W) int32, as pictures show what was counted so; -1 stays."""
        return self._shown[numbers]
