"""Suites made from a secret salt, in newly generated houses.

Everything is derived from the salt and the suite's name: each house and its tasks have their own roots, and ids
that reveal nothing. So the same salt gives the same bytes, and knowing one house does not help to predict the next.
"""

import functools
import itertools
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import msgspec
from msgspec import Struct

from hthor import jsonio
from hthor.errors import HthorError, TaskError
from hthor.houses import generator, loader
from hthor.houses.checks.house_rules import Finding
from hthor.houses.generator import attempt
from hthor.houses.generator.attempt import AttemptFailed
from hthor.houses.generator.draws import Dice
from hthor.houses.generator.floorplan.room_specs import choose_spec
from hthor.houses.generator.furnishing.requirements import draw_requirements
from hthor.tasks.generation import standard
from hthor.tasks.generation.standard import IsPossible
from hthor.tasks.generation.suite_specs import SuiteSpec, by_count
from hthor.tasks.suite import SuiteFile, encode_suite, in_turn, make_suite
from hthor.tasks.suites import commitment, library
from hthor.tasks.suites.commitment import COMMITMENT, Commitment, Salt
from hthor.types import HouseSpec, TaskSpec

VERSION = 1
"""Increased when the same salt gives a different suite."""
SUITE = "suite.json"
ROOMS = (4, 5, 5, 4, 6, 4, 5, 7, 6, 5)
"""Numbers of rooms of each ten houses in a row, distributed as those of the ten scenes."""
SEARCHES = 0.26
"""The share of searches among the tasks of a house, as in the suite ``standard``."""
_TRIES = 40


class SuiteOrder(Struct, frozen=True, kw_only=True):
    """A suite to be made: its name, and the numbers of houses and of tasks in all of them."""

    name: str
    houses: int
    tasks: int


MapHouses = Callable[[Callable[["HouseOrder"], "HouseTasks"], Iterable["HouseOrder"]], Iterable["HouseTasks"]]
"""Works like `map`, in this process or in several."""


class Proof(Struct, frozen=True, kw_only=True):
    """Checks the draws: ``house`` returns the findings about a house, ``task`` whether a task can be done in it."""

    house: Callable[[HouseSpec], Sequence[Finding]]
    task: IsPossible


class HouseOrder(Struct, frozen=True, kw_only=True):
    """One house to be made: its opaque id, pairs of roots to try (house, tasks), and how many tasks of each kind."""

    suite: str
    house: str
    rooms: int
    roots: tuple[tuple[int, int], ...]
    counts: tuple[tuple[str, int], ...]


class HouseTasks(Struct, frozen=True, kw_only=True):
    """One house that was made: its file and its tasks."""

    house: str
    file: bytes
    tasks: tuple[TaskSpec, ...]


def write_suite(
    order: SuiteOrder, salt: Salt, folder: Path, files: Mapping[str, bytes], made_with: Mapping[str, str]
) -> Path:
    """Write a suite's files and the commitment to them and to the salt; returns the commitment's path."""
    for path, data in files.items():
        jsonio.write(folder / path, data)
    jsonio.write(folder / COMMITMENT, jsonio.pretty(make_commitment(order, salt, files, made_with)))
    return folder / COMMITMENT


def make_commitment(
    order: SuiteOrder, salt: Salt, files: Mapping[str, bytes], made_with: Mapping[str, str]
) -> Commitment:
    """The commitment to a suite's files and salt."""
    return Commitment(
        name=order.name,
        salt=salt.commitment(),
        houses=order.houses,
        tasks=order.tasks,
        suite_sha256=msgspec.json.decode(files[SUITE], type=SuiteFile).sha256,
        files=commitment.hash_files(files),
        made_with={"houses": str(generator.VERSION), "official": str(VERSION), **made_with},
    )


def make_files(order: SuiteOrder, salt: Salt, proof: Proof, each: MapHouses = map) -> dict[str, bytes]:
    """The files of a suite by their path in its folder: ``suite.json`` and ``houses/*.json``.

    Raises:
        HthorError: when the order is impossible.
    """
    parts = list(each(functools.partial(make_house_tasks, proof=proof), house_orders(order, salt)))
    columns = [[_named(task, order, salt, number) for number, task in enumerate(one.tasks)] for one in parts]
    suite = make_suite(order.name, VERSION, tuple(in_turn(columns)))
    return {SUITE: encode_suite(suite), **{f"houses/{one.house}.json": one.file for one in parts}}


def house_orders(order: SuiteOrder, salt: Salt) -> tuple[HouseOrder, ...]:
    """The houses to be made for an order, with their ids and roots derived from the salt.

    Raises:
        HthorError: when the order is impossible.
    """
    _check(order)
    found = []
    for number in range(order.houses):
        tasks = order.tasks // order.houses + (number < order.tasks % order.houses)
        searches = round(SEARCHES * tasks)
        counts = (("object_goal_navigation", searches), ("mobile_manipulation", tasks - searches))
        names = [(order.name, sort, number) for sort in ("house", "tasks")]
        found.append(
            HouseOrder(
                suite=order.name,
                house="h" + salt.word(12, order.name, "house id", number),
                rooms=ROOMS[number % len(ROOMS)],
                roots=tuple((salt.root(*names[0], lap), salt.root(*names[1], lap)) for lap in range(_TRIES)),
                counts=tuple((kind, count) for kind, count in counts if count),
            )
        )
    return tuple(found)


def make_house_tasks(lot: HouseOrder, proof: Proof) -> HouseTasks:
    """One house and its tasks, from the first root that gives a valid house with room for all of them.

    Raises:
        HthorError: when no root gives such a house.
    """
    problem = ""
    for house_root, tasks_root in lot.roots:
        try:
            file = jsonio.pretty(_document(lot.rooms, Dice(house_root)))
            house = loader.house_from_document(msgspec.json.decode(file), lot.house)
            if flaw := next((str(finding) for finding in proof.house(house) if finding.severity == "error"), ""):
                raise HthorError(flaw)
            spec = SuiteSpec(name=lot.suite, version=VERSION, root=tasks_root, houses=(), orders=by_count(*lot.counts))
            tasks = tuple(standard.make_tasks(spec, house, "new", proof.task))
            return HouseTasks(house=lot.house, file=file, tasks=tasks)
        except (AttemptFailed, HthorError) as error:
            problem = str(error)
    raise HthorError(f"none of {len(lot.roots)} roots gave a house of {lot.rooms} rooms; the last failed: {problem}")


def _document(rooms: int, dice: Dice) -> dict[str, Any]:
    """A house file's document; it names the generator's version, but not the root."""
    return attempt.build_document(
        choose_spec(rooms, dice, None), draw_requirements(None, dice.of("wants")), dice, {"version": generator.VERSION}
    )


def differences(
    folder: Path, held: Commitment, salt: Salt, proof: Proof, each: MapHouses = map
) -> Iterator[tuple[str, str]]:
    """Make a suite again from its salt and compare: pairs of a file and a problem."""
    if salt.commitment() != held.salt:
        yield COMMITMENT, f"commits to another salt: {held.salt[:10]}..., this one's is {salt.commitment()[:10]}..."
        return
    made = make_files(SuiteOrder(name=held.name, houses=held.houses, tasks=held.tasks), salt, proof, each)
    digests = commitment.hash_files(made)
    for path in sorted(digests.keys() | held.files.keys()):
        there = (folder / path).read_bytes() if (folder / path).is_file() else b""
        if path not in held.files:
            yield path, "is made from the salt, but is not in the commitment"
        elif path not in made:
            yield path, "is in the commitment, but is not made from the salt"
        elif digests[path] != held.files[path]:
            yield path, "made again, differs from what was committed to" + (_first(there, made[path]) if there else "")
    suite = msgspec.json.decode(made[SUITE], type=SuiteFile).sha256
    if suite != held.suite_sha256:
        yield COMMITMENT, f"suite_sha256 is {held.suite_sha256[:10]}..., the salt gives {suite[:10]}..."


def _first(there: bytes, made: bytes) -> str:
    """The first line in which two files differ."""
    lines = itertools.zip_longest(there.splitlines(), made.splitlines())
    number = next((number for number, (one, two) in enumerate(lines, 1) if one != two), 0)
    return f": line {number} is the first that differs" if number else ""


def _named(task: TaskSpec, order: SuiteOrder, salt: Salt, number: int) -> TaskSpec:
    """The task under an opaque id, which shows neither its kind nor its position."""
    word = salt.word(12, order.name, "task id", task.house, number)
    return msgspec.structs.replace(task, id=f"{order.name}/{task.house}/{word}")


def _check(order: SuiteOrder) -> None:
    if not re.fullmatch(r"[a-z0-9][a-z0-9-]{0,40}", order.name):
        valid = "small letters, digits and hyphens, at most 41"
        raise HthorError(f"'{order.name}' cannot be a suite's name; valid: {valid}, such as official-2027a.")
    if order.houses < 1 or order.tasks < order.houses:
        problem = f"{order.tasks} tasks in {order.houses} houses"
        raise HthorError(f"a suite needs a house or more and a task or more in each; asked for: {problem}.")


def check_name(name: str) -> None:
    """Check that no suite of hthor's own has the name.

    Raises:
        HthorError: when such a suite exists.
    """
    if name in library.suite_names():
        raise HthorError(f"'{name}' is a suite of hthor's own; choose another name, such as official-2027a.")


def check_salt_outside(path: Path, folder: Path) -> None:
    """Check that a salt is not in the folder that will be published.

    Raises:
        TaskError: when it is in that folder.
    """
    if path.resolve().is_relative_to(folder.resolve()):
        raise TaskError(str(path), "$", f"the salt is in {folder}, which will be published; keep it elsewhere")
