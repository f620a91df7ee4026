"""The files of a user's own suite: the tasks, copies of the houses, and their excerpt of an asset database."""

import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import msgspec
from msgspec import Struct

from hthor import houses, jsonio
from hthor.errors import HouseError, HthorError
from hthor.houses import schema
from hthor.houses.assets import DATABASE, Assets
from hthor.tasks.suite import encode_suite, in_turn, make_suite
from hthor.tasks.suites import library
from hthor.types import TaskSpec

SUITE = "suite.json"
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.-]{0,60}")


class HouseSource(Struct, frozen=True, kw_only=True):
    """A house to make tasks in: the name or path that loads it, and its file if it is the user's own, else None."""

    given: str
    file: Path | None


def find_sources(given: Sequence[str]) -> tuple[HouseSource, ...]:
    """The requested houses, each given by the name of one of hthor's houses or the path of a house file.

    Raises:
        UnknownName, HouseError: as `hthor.houses.load`.
        HthorError: when two have the same name, or a file has the name of one of hthor's own houses.
    """
    ours = {*houses.names(), *houses.names("unseen")}
    found = [HouseSource(given=one, file=None if one in ours else Path(one)) for one in given]
    names = [houses.load(one.given).id for one in found]
    for number, (one, name) in enumerate(zip(found, names, strict=True)):
        if one.file is not None and name in ours:
            raise HthorError(
                f"{one.given} has the name of one of hthor's own houses, '{name}'; give the file another name."
            )
        if name in names[:number]:
            raise HthorError(
                f"two of the houses are called '{name}'; give each house once, and each file its own name."
            )
    return tuple(found)


def check_name(name: str) -> str:
    """The name itself, if it is valid for a new suite.

    Raises:
        HthorError: when it is not valid.
    """
    if not _NAME.fullmatch(name):
        raise HthorError(f"'{name}' cannot be a suite's name; valid: letters, digits, '-', '_' and '.', at most 61.")
    if name in library.suite_names():
        raise HthorError(f"'{name}' is a suite of hthor's own; choose another name, such as my-{name}.")
    return name


def make_files(
    name: str, version: int, found: Sequence[HouseSource], columns: Sequence[Sequence[TaskSpec]]
) -> dict[str, bytes]:
    """The files of a suite by their path in its folder: the suite, its houses, an excerpt of an asset database.

    ``columns`` are the tasks of each of the houses ``found``.
    """
    suite = make_suite(name, version, tuple(in_turn(columns)))
    own = {f"houses/{one.file.stem}.json": one.file for one in found if one.file is not None}
    made = {SUITE: encode_suite(suite), **{path: file.read_bytes() for path, file in own.items()}}
    database = _excerpt(list(own.values()))
    return {**made, **({f"houses/{DATABASE}": database} if database else {})}


def write_files(out: Path, made: Mapping[str, bytes]) -> Path:
    """Write a suite's files, the houses first; returns the path of the suite.

    ``out`` is ``mine.json``, with its houses in ``mine.houses``; or a folder, with the suite in ``suite.json``.
    """
    single = out.suffix == ".json"
    for path, data in sorted(made.items(), key=lambda item: item[0] == SUITE):
        folder, _, name = path.rpartition("/")
        place = out.with_suffix(".houses") if single else out / "houses"
        jsonio.write(place / name if folder else out if single else out / SUITE, data)
    return out


def check_unused(out: Path) -> None:
    """Check that the path of a new suite is free.

    Raises:
        HthorError: when a file or folder is there.
    """
    for path in (out, out.with_suffix(".houses")) if out.suffix == ".json" else (out,):
        if path.exists() and (path.is_file() or any(path.iterdir())):
            raise HthorError(f"{path} exists. Choose another path with --out, or delete it.")


def _excerpt(own: Sequence[Path]) -> bytes:
    """The rows of asset databases that the user's own houses need; each house may have its own database."""
    types: dict[str, dict[str, Any]] = {}
    for path in own:
        document, _ = schema.read_house_file(path, str(path))
        data = Assets(path).excerpt(_assets(document["objects"]))
        for name, rows in msgspec.json.decode(data or b"{}").items():
            for row in rows:
                known = types.setdefault(name, {}).setdefault(row["assetId"], row)
                if known != row:
                    problem = f"asset '{row['assetId']}' has another size than in another of the houses"
                    raise HouseError(str(path), "objects", problem)
    return jsonio.pretty({name: [rows[id] for id in sorted(rows)] for name, rows in types.items()}) if types else b""


def _assets(objects: Sequence[Any]) -> Iterator[str]:
    for one in objects:
        yield one["assetId"]
        yield from _assets(one.get("children") or ())
