"""One library of furniture (.sh3f, a zip): its catalogue and the files of its models."""

import io
import re
import zipfile
from pathlib import PurePosixPath
from typing import NamedTuple

from hthor.looks.pack.store import PackError

_CATALOGUE = "PluginFurnitureCatalog.properties"
_LINE = re.compile(r"(\w+)#(\d+)\s*=\s*(.*)")
_ESCAPE = re.compile(r"\\u([0-9a-fA-F]{4})")


class Entry(NamedTuple):
    """A model's line in the catalogue. ``size`` [m] is (width, depth, height); ``rotation`` has 9 numbers of a matrix.

    ``path`` is the path of its OBJ file, without a leading slash.
    """

    model: str
    title: str
    author: str
    path: str
    size: tuple[float, float, float]
    rotation: tuple[float, ...]


class Library:
    """A library, read from its bytes.

    Raises:
        PackError: if the bytes are not a library.
    """

    def __init__(self, name: str, data: bytes) -> None:
        self.name = name
        try:
            self._zip = zipfile.ZipFile(io.BytesIO(data))
            text = self._zip.read(_CATALOGUE).decode("latin-1")
        except (zipfile.BadZipFile, KeyError) as error:
            raise PackError(f"library '{name}' cannot be read ({error}). Get the package again.") from None
        self._files = set(self._zip.namelist())
        self.entries = {entry.model: entry for entry in _entries(name, text)}

    def entry(self, model: str) -> Entry:
        """The catalogue line of a model.

        Raises:
            PackError: if the library has no such model.
        """
        if model not in self.entries:
            raise PackError(f"library '{self.name}' has no model '{model}'; it is a different version than expected.")
        return self.entries[model]

    def has(self, path: str) -> bool:
        """Whether the library has a file of this path."""
        return path in self._files

    def read(self, path: str) -> bytes:
        """The content of a file.

        Raises:
            PackError: if the file is missing or broken.
        """
        try:
            return self._zip.read(path)
        except (KeyError, zipfile.BadZipFile, RuntimeError, OSError) as error:
            raise PackError(f"library '{self.name}': {path} cannot be read ({error}).") from None


def _entries(library: str, text: str) -> list[Entry]:
    rows: dict[int, dict[str, str]] = {}
    for line in text.splitlines():
        match = _LINE.match(line.strip())
        if match:
            value = _ESCAPE.sub(lambda code: chr(int(code[1], 16)), match[3].strip())
            rows.setdefault(int(match[2]), {})[match[1]] = value
    entries = []
    for number, row in sorted(rows.items()):
        if not row.get("model", "").lower().endswith(".obj"):
            continue
        try:
            entries.append(_entry(row))
        except (KeyError, ValueError) as error:
            raise PackError(f"library '{library}': model number {number} has a bad line ({error}).") from None
    return entries


def _entry(row: dict[str, str]) -> Entry:
    path = row["model"].lstrip("/")
    width, depth, height = (float(row[name]) / 100.0 for name in ("width", "depth", "height"))
    if min(width, depth, height) <= 0.0:
        raise ValueError("a size that is not positive")
    rotation = tuple(float(number) for number in row.get("modelRotation", "1 0 0 0 1 0 0 0 1").split())
    if len(rotation) != 9:
        raise ValueError("a rotation that is not nine numbers")
    return Entry(
        model=PurePosixPath(path).parent.name,
        title=row["name"],
        author=row.get("creator", "unknown"),
        path=path,
        size=(width, depth, height),
        rotation=rotation,
    )
