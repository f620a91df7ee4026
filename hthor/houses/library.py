"""Houses by name: those that come with hthor, and those in the folder of a suite or a run."""

from importlib import resources
from pathlib import Path
from typing import Literal

from msgspec import Struct

from hthor import jsonio
from hthor.errors import UnknownName
from hthor.houses import loader, schema
from hthor.houses.assets import DATABASE, Assets
from hthor.houses.checks import structure
from hthor.types import HouseSpec

_OWN = {
    name: Path(str(resources.files("hthor.houses").joinpath(folder)))
    for name, folder in (("scenes", "data"), ("unseen", "unseen"))
}


class HouseLibrary(Struct, frozen=True, kw_only=True):
    """Finds houses by name: first among those that come with hthor, then in ``folder``, if it is not None.

    A suite and a run have a library of their own houses; it can be sent to another process. A task has its house's
    hash, so that any other house is refused.
    """

    folder: Path | None = None

    def load(self, name_or_path: str | Path, assets: Path | None = None) -> HouseSpec:
        """A house by name, or from a ProcTHOR house file, JSON schema 1.0.0.

        Args:
            name_or_path: one of `names`, of either group; the name of a house in ``folder``; or the path of a file.
            assets: a ProcTHOR asset database, or the folder with it, for files with foreign assets. If it is None, the
                database is searched where the environment variable HTHOR_ASSETS says, then next to the file and in
                the folders above, in ``shared/houses/databases`` of any folder above the current one, and in an
                installed ``procthor`` package.

        Raises:
            UnknownName: when it is neither a name nor a file.
            HouseError: when the file cannot be used; names the file and the field.
        """
        path, file = self._locate(str(name_or_path))
        document, house = schema.read_house_file(path, file)
        structure.validate_structure(house, file)
        return loader.convert_house(house, path.stem, jsonio.sha256(document), file, Assets(path, assets))

    def _locate(self, given: str) -> tuple[Path, str]:
        """The path of a house's file, and its name in errors."""
        folders = [*_OWN.values(), *(() if self.folder is None else (self.folder,))]
        if given and given == Path(given).name:  # a name, not a path in disguise
            for folder in folders:
                if (folder / f"{given}.json").is_file():
                    return folder / f"{given}.json", f"{given}.json"
        path = Path(given)
        if path.suffix == ".json" or path.is_file():
            return path, given
        known = [*names(), *names("unseen")]
        if self.folder is not None:
            known += [file.stem for file in sorted(self.folder.glob("*.json")) if file.name != DATABASE]
        raise UnknownName("house", given, known, "Or give the path of a ProcTHOR house file (.json).")


OURS = HouseLibrary()
"""Only the houses that come with hthor."""


def load(name_or_path: str | Path, assets: Path | None = None) -> HouseSpec:
    """A house that comes with hthor, by name, or a house from a file: `HouseLibrary.load` without a folder."""
    return OURS.load(name_or_path, assets)


def names(group: Literal["scenes", "unseen"] = "scenes") -> tuple[str, ...]:
    """The houses that come with hthor: the benchmark's ten scenes, or the ten ``unseen`` houses."""
    return tuple(sorted(path.stem for path in _OWN[group].glob("*.json")))
