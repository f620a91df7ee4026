"""Products of a calibration's stages, stored so that a later command need not compute them again.

A product is stored with the hash of everything that it was made from; when that has changed, it is made again.
"""

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
        folder: where they are stored; only files that this program wrote there are read.
        key: hash of everything that the products are made from, 64 hexadecimal digits.
    """

    def __init__(self, folder: Path, key: str) -> None:
        self._folder, self._key = folder, key

    def get(self, name: str, make: Callable[[], _T]) -> _T:
        """The product of this name: the stored one if it was made from the same inputs, else a new one."""
        path = self._folder / f"{name}.pkl"
        if path.exists():
            data = path.read_bytes()
            if data[:_KEY_LENGTH] == self._key.encode():
                stored: _T = pickle.loads(data[_KEY_LENGTH:])
                return stored
        product = make()
        jsonio.write(path, self._key.encode() + pickle.dumps(product, protocol=5))
        return product
