"""What the stages of a calibration made, kept so that a later command need not make it again.

A product is kept with the hash of all that it was made from. When that has changed, the product is made anew.
"""

from __future__ import annotations

import pickle
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from hthor import jsonio

_T = TypeVar("_T")
_KEY_LENGTH = 64


class ArtifactCache:
    """Products of one calibration.

    Args:
        folder: where they lie; only files that this program wrote there are read.
        key: hash of everything that the products are made from, 64 hexadecimal digits.
    """

    def __init__(self, folder: Path, key: str) -> None:
        self._folder, self._key = folder, key

    def kept(self, name: str, make: Callable[[], _T]) -> _T:
        """The product of this name: the one that lies here, if it was made from the same, else a new one."""
        path = self._folder / f"{name}.pkl"
        if path.exists():
            data = path.read_bytes()
            if data[:_KEY_LENGTH] == self._key.encode():
                there: _T = pickle.loads(data[_KEY_LENGTH:])
                return there
        made = make()
        jsonio.write(path, self._key.encode() + pickle.dumps(made, protocol=5))
        return made
