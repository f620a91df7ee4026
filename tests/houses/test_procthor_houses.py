"""Houses in the manner of ProcTHOR's: each is refused with the field, or is what its file says and can be played in."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path
from typing import Any

import pytest
from procthor_houses import DATABASE, GRAVE_FAULTS, SMALL_FAULTS, procthor_house

from hthor import catalog, houses
from hthor.errors import HouseError
from hthor.houses import laying
from hthor.houses.assets import DATABASE as DATABASE_FILE
from hthor.houses.checks.house_checks import check
from hthor.houses.checks.house_rules import is_sound
from hthor.tasks.generation import custom_suite
from hthor.tasks.generation.custom_suite import Recipe
from hthor.trials import TrialRunner, make_session
from hthor.trials.sources import Sources
from hthor.types import HouseSpec
from hthor.world import World

MANY, FEW = 150, 10
FIELD = re.compile(r"(?:rooms|walls|doors|windows|objects)\[\d+\]|metadata\.agent")
SEEDS = [seed if seed < FEW else pytest.param(seed, marks=pytest.mark.nightly) for seed in range(MANY)]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("procthor")
    (made / DATABASE_FILE).write_text(json.dumps(DATABASE))
    return made


def written(folder: Path, seed: int, spoil: bool = True) -> tuple[Path, Any]:
    path = folder / f"house-{seed}.json"
    document, _ = procthor_house(seed, spoil)
    path.write_text(json.dumps(document))
    return path, document


def loaded(path: Path) -> tuple[HouseSpec | None, Any]:
    try:
        return houses.load(path), None
    except HouseError as error:
        return None, error


def sound_house(path: Path) -> HouseSpec | None:
    """The house, or None if it is refused; a refusal names the field."""
    house, error = loaded(path)
    if house is None:
        assert error.file == str(path)
        assert FIELD.match(error.field), error
        assert len(str(error).splitlines()) == 1
        return None
    findings = check(house, 0.2)
    assert all(FIELD.match(finding.field) for finding in findings if finding.severity == "error"), findings
    return house if is_sound(findings) else None


@pytest.mark.parametrize("seed", SEEDS)
def test_a_house_is_refused_with_the_field_or_can_be_played_in(folder: Path, seed: int) -> None:
    path, document = written(folder, seed)
    house = sound_house(path)
    if house is None:
        return
    _check_start(house)
    _check_warnings(house, document)
    tasks = custom_suite.make_tasks(Recipe(name="own", tasks=2, seed=seed), house)
    session = make_session(tasks, agent=("frontier", "oracle")[seed % 2], seed=seed)
    for played in TrialRunner(Sources(houses=str(folder))).play(session):
        assert played.log.faults == ()
        assert played.log.ticks > 0


def _check_start(house: HouseSpec) -> None:
    """The person stands exactly where the file says: nobody is moved in silence."""
    world = World(house)
    world.reset()
    pose = world.pose("human")
    assert (pose.x, pose.y, pose.pitch) == (house.start.x, house.start.y, house.start.pitch)


def _check_warnings(house: HouseSpec, document: Any) -> None:
    """Every thing that is not as in the file, or cannot be picked up, is reported, and nothing else is."""
    found: dict[str, set[str]] = {}
    for finding in check(house, 0.2):
        found.setdefault(finding.rule, set()).add(finding.where)
    assert found.get("thing-tilted", set()) == set(_tilted(document["objects"]))
    small = {thing.id for thing in house.things if thing.parent and catalog.kind(thing.kind).pickable}
    free = {thing.id for thing in laying.movable_objects(house)}
    assert found.get("thing-fixed", set()) == small - free


def _tilted(rows: list[Any]) -> list[str]:
    mine = [row["id"] for row in rows if any(abs(math.remainder(row["rotation"][axis], 360)) > 1 for axis in "xz")]
    return mine + [id for row in rows for id in _tilted(row.get("children") or [])]


def test_most_houses_without_faults_are_sound(folder: Path) -> None:
    count = sum(sound_house(written(folder, 1000 + seed, spoil=False)[0]) is not None for seed in range(20))
    assert count >= 15


def test_all_faults_occur_and_the_same_seed_gives_the_same_house() -> None:
    made = [procthor_house(seed) for seed in range(MANY)]
    assert {fault for _, faults in made for fault in faults} == {*SMALL_FAULTS, *GRAVE_FAULTS}
    assert made[7] == procthor_house(7)
