"""The suite `standard` and the houses that it adds: what is promised of them is counted from the files themselves."""

from __future__ import annotations

import itertools
import math
from collections import Counter
from pathlib import Path

import pytest

from hthor import catalog, houses, jsonio, tasks
from hthor.catalog import priors
from hthor.houses import names
from hthor.houses.generator import shipped
from hthor.tasks.generation import standard
from hthor.tasks.kinds.mobile_manipulation import TEMPLATES
from hthor.tasks.suite import encode_suite
from hthor.tasks.suites import library
from hthor.tasks.validate import validate

SUITE = tasks.load_suite("standard")
FIND, MOVE = "object_goal_navigation", "mobile_manipulation"
LEVELS, SPLITS = ("easy", "medium", "hard"), ("seen", "new")
PAGE = (Path(__file__).parents[2] / "docs" / "suites.md").read_text(encoding="utf-8")


HOUSES = tuple(houses.load(name) for name in (*names(), *names("unseen")))
KINDS = {house.id: {thing.id: thing.kind for thing in house.things} for house in HOUSES}


# ------------------------------------------------------------------------------------------------ the other houses


def test_the_unseen_houses_stand_beside_the_scenes_and_are_none_of_them():
    own = houses.names("unseen")
    assert own == standard.UNSEEN == tuple(recipe.name for recipe in shipped.UNSEEN)
    assert len(own) == len(set(own) - set(houses.names())) == 10
    assert len(houses.names()) == 10
    assert len({house.sha256 for house in HOUSES}) == len({house.rooms for house in HOUSES}) == 20


def test_they_differ_from_the_scenes_in_nothing_but_in_being_new():
    assert Counter(recipe.rooms for recipe in shipped.UNSEEN) == Counter(scene.rooms for scene in shipped.SCENES)
    seeds = [recipe.seed for recipe in shipped.UNSEEN]
    assert seeds == list(range(seeds[0], seeds[0] + 10))  # in a row: none was picked out
    for recipe in shipped.UNSEEN:
        house = houses.load(recipe.name)
        assert len(house.rooms) == recipe.rooms
        kinds = {thing.kind for thing in house.things}
        assert kinds >= set(catalog.RECEPTACLES)
        assert kinds.isdisjoint(catalog.TARGETS)


@pytest.mark.parametrize(
    "name",
    [
        name if number < 2 else pytest.param(name, marks=pytest.mark.nightly)
        for number, name in enumerate(houses.names("unseen"))
    ],
)
def test_each_is_sound(name):
    assert houses.check(houses.load(name), 0.25, strict=True) == ()


def test_one_is_made_again_byte_for_byte():
    recipe = shipped.UNSEEN[3]
    file = Path(houses.__file__).parent / "unseen" / f"{recipe.name}.json"
    assert jsonio.pretty(shipped.make_house(recipe)) == file.read_bytes()


def test_the_others_are_written_where_one_says(tmp_path: Path, capsys, monkeypatch):
    monkeypatch.setattr(shipped, "SCENES", ())
    monkeypatch.setattr(shipped, "UNSEEN", shipped.UNSEEN[:1])
    shipped.main([str(tmp_path)])
    assert capsys.readouterr().out == f"{tmp_path / 'aspen'}.json\n"
    assert houses.load(tmp_path / "aspen.json").sha256 == houses.load("aspen").sha256


# ------------------------------------------------------------------------------------------------------- the suite


def test_it_has_two_thousand_distinct_tasks_a_hundred_a_house():
    assert len(SUITE.tasks) == len({task.id for task in SUITE.tasks}) == 2000
    assert Counter(task.house for task in SUITE.tasks) == dict.fromkeys((*names(), *names("unseen")), 100)
    assert len({jsonio.canonical((task.house, task.objects)) for task in SUITE.tasks}) == 2000
    assert Counter((task.house, task.kind) for task in SUITE.tasks) == {
        (house.id, kind): count for house in HOUSES for kind, count in ((FIND, 26), (MOVE, 74))
    }
    share = 565 / (565 + 1583)  # of searches among the paper's tasks
    assert all(abs(26 / 100 - share) <= abs(other / 100 - share) for other in (25, 27))


def test_no_two_of_its_tasks_are_alike():
    for house in HOUSES:
        own = [task for task in SUITE.tasks if task.house == house.id]
        assert not any(standard.are_alike(one, two) for one, two in itertools.combinations(own, 2))


def test_the_split_is_between_the_ten_scenes_and_the_others():
    assert {(task.house in names(), task.split) for task in SUITE.tasks} == {(True, "seen"), (False, "new")}


def test_every_stratum_has_tasks_in_either_split_and_of_either_kind():
    counts = Counter((task.split, task.kind, task.difficulty) for task in SUITE.tasks)
    assert min(counts[split, kind, level] for split in SPLITS for kind in (FIND, MOVE) for level in LEVELS) >= 20
    assert sum(counts.values()) == sum(counts[key] for key in itertools.product(SPLITS, (FIND, MOVE), LEVELS))
    by_house = Counter((task.house, task.difficulty) for task in SUITE.tasks)
    assert min(by_house[house.id, level] for house in HOUSES for level in LEVELS) >= 5


def test_every_template_and_every_target_comes_as_often_as_any_other_in_every_house():
    counts = Counter((task.house, task.kind, task.goal.target, task.goal.destination) for task in SUITE.tasks)
    for house in HOUSES:
        templates = [counts[house.id, MOVE, target, place] for target in TEMPLATES for place in TEMPLATES[target]]
        searches = [counts[house.id, FIND, target, ""] for target in TEMPLATES]
        assert (sum(templates), sum(searches)) == (74, 26)
        assert max(templates) - min(templates) <= 1
        assert max(searches) - min(searches) <= 1


def relation(placement, task):
    """The triplet by which an object was placed."""
    kinds = KINDS[task.house] | {other.id: other.kind for other in task.objects}
    if placement.near:
        return placement.kind, "near", kinds[placement.near]
    return placement.kind, placement.relation, kinds[placement.support]


def expected(house):
    """How often each triplet is to be drawn for one arrangement of the house."""
    kinds = {*KINDS[house.id].values(), *catalog.TARGETS}
    rows = [row for row in priors.triplets() if row.reference in kinds]
    total = Counter()
    for row in rows:
        total[row.target] += row.weight
    return {(row.target, row.relation, row.reference): row.weight / total[row.target] for row in rows}


def test_everything_is_where_the_priors_expect_it():
    """Not to the last: what must not lie where it is to be brought, or has no room, lies elsewhere."""
    found = Counter(relation(placement, task) for task in SUITE.tasks for placement in task.objects)
    wanted = Counter()
    for house in HOUSES:
        wanted.update({row: 100 * share for row, share in expected(house).items()})
    assert found.keys() == wanted.keys()
    assert len(found) == 65
    apart = sum(abs(found[row] - wanted[row]) for row in wanted) / 2
    assert apart < 0.05 * sum(wanted.values())
    about = {
        relation(placement, task)
        for task in SUITE.tasks
        for placement in task.objects
        if placement.id == task.goal.target
    }
    assert len(about) == 65


def test_tasks_that_follow_one_another_are_in_different_houses():
    for first in range(0, 2000, 20):
        assert len({task.house for task in SUITE.tasks[first : first + 20]}) == 20


def test_all_of_it_can_be_run():
    validate(SUITE, "standard")
    for task in SUITE.tasks:
        assert 0.0 < task.t_star < task.time_limit
        assert len({(pose.x, pose.y) for pose in (task.human_start, *task.robot_starts)}) == 5
        assert all(
            math.dist((pose.x, pose.y), (task.human_start.x, task.human_start.y)) > 1 for pose in task.robot_starts
        )


@pytest.mark.parametrize("name", ["juniper", "aspen"])
def test_a_slice_is_made_again_byte_for_byte(name):
    split = "seen" if name in names() else "new"
    made = list(itertools.islice(standard.make_tasks(standard.SPEC, houses.load(name), split), 3))
    held = [task for task in SUITE.tasks if task.house == name][:3]
    assert [jsonio.canonical(task) for task in made] == [jsonio.canonical(task) for task in held]


def test_the_file_is_as_the_suite_is_written_and_small_enough_to_ship():
    data = library.suite_path("standard").read_bytes()
    assert data == encode_suite(SUITE)
    assert len(data) < 4_000_000


# --------------------------------------------------------------------------------------------------------- the page


def test_the_page_tells_what_can_be_counted():
    counts = Counter((task.split, task.kind, task.difficulty) for task in SUITE.tasks)
    for split in SPLITS:
        for kind, words in ((FIND, "navigation"), (MOVE, "manipulation")):
            cells = [counts[split, kind, level] for level in LEVELS]
            assert f"| {split} | {words} | {' | '.join(map(str, cells))} | {sum(cells)} |" in PAGE
    total = [sum(task.difficulty == level for task in SUITE.tasks) for level in LEVELS]
    assert f"| both | both | {' | '.join(map(str, total))} | 2000 |" in PAGE
    assert SUITE.sha256[:10] in PAGE
    for recipe in shipped.UNSEEN:
        house = houses.load(recipe.name)
        assert f"| {recipe.name} | {recipe.seed} | {recipe.rooms} |" in PAGE
        assert f"| {len(house.things)} |" in PAGE
