"""Finds an asset's kind and size by its id: one of hthor's own assets, or one in an asset database."""

import importlib.util
import os
from collections.abc import Iterable, Iterator
from pathlib import Path

from hthor import catalog
from hthor.catalog import procthor
from hthor.catalog.procthor import Asset
from hthor.errors import HouseError

VARIABLE = "HTHOR_ASSETS"
DATABASE = "asset-database.json"
_HINT = (
    f"give one with assets=..., set {VARIABLE} to its path, or put '{DATABASE}' or 'databases/{DATABASE}' beside the "
    "house file; it comes with ProcTHOR's databases"
)


class Assets:
    """Finds kind and size by asset id; reads an asset database only for a foreign id.

    Args:
        beside: the house file; its folder and parent folders are searched.
        given: a database, or a folder with a database, that takes precedence; None to search.
    """

    def __init__(self, beside: Path, given: Path | None = None) -> None:
        self._beside, self._given = beside, given
        self._rows: dict[str, Asset] | None = None
        self._source: Path | None = None

    def find(self, asset: str, file: str, field: str) -> Asset:
        """Kind and size [m].

        Raises:
            HouseError: names ``file`` and ``field`` when the id is unknown or its size is not positive; names the
                database when that is damaged.
        """
        own = catalog.own_asset(asset)
        if own is not None:
            kind, size, variant = own
            if min(size) <= 0.0:
                raise HouseError(file, field, f"the size in '{asset}' must be positive in all three directions")
            return Asset(kind=kind.name, size=size, variant=variant)
        rows = self._database()
        if asset in rows:
            return rows[asset]
        if self._source is None:
            raise HouseError(file, field, f"unknown asset '{asset}', and no asset database was found; {_HINT}")
        raise HouseError(file, field, f"unknown asset '{asset}': neither ours nor in {self._source}")

    def excerpt(self, ids: Iterable[str]) -> bytes:
        """The database rows of these assets, as a database of its own; empty when all are hthor's own assets.

        Raises:
            HouseError: as for `find`; names the database.
        """
        foreign = {id for id in ids if catalog.own_asset(id) is None}
        if not foreign:
            return b""
        self._database()
        return procthor.excerpt(self._source, foreign) if self._source is not None else b""

    def _database(self) -> dict[str, Asset]:
        if self._rows is None:
            self._source = self._given_database() or next(filter(Path.is_file, _places(self._beside)), None)
            self._rows = procthor.read(self._source) if self._source is not None else {}
        return self._rows

    def _given_database(self) -> Path | None:
        """The database that the caller or the environment names, which must exist; None when neither names one."""
        variable = os.environ.get(VARIABLE, "")
        named = self._given if self._given is not None else Path(variable) if variable else None
        if named is None:
            return None
        path = next(filter(Path.is_file, (named, *_inside(named))), None)
        if path is None:
            origin = "assets" if self._given is not None else VARIABLE
            raise HouseError(str(named), "$", f"no asset database there, though {origin} names it")
        return path


def _inside(folder: Path) -> tuple[Path, Path]:
    return folder / "databases" / DATABASE, folder / DATABASE


def _places(house: Path) -> Iterator[Path]:
    for folder in house.resolve().parents:
        yield from _inside(folder)
    here = Path.cwd()
    for folder in (here, *here.parents):
        yield folder / "shared" / "houses" / "databases" / DATABASE
    spec = importlib.util.find_spec("procthor")
    for place in (spec.submodule_search_locations or ()) if spec is not None else ():
        yield from _inside(Path(place))
