"""Houses in three dimensions: all of them is in the picture, marks are where things are, figures say what they show."""

from __future__ import annotations

import math
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from law_cases import cases
from matplotlib.colors import to_rgba
from matplotlib.patches import Polygon
from matplotlib.text import Text
from typer.testing import CliRunner

from hthor import houses, tasks
from hthor.cli import app
from hthor.errors import HthorError
from hthor.report.drawing import figure_file
from hthor.report.drawing.overviews import framing, graph_panels, pipeline_figure, rearrangement_figure
from hthor.tasks.arrangement import scene_graph
from hthor.types import TaskSpec
from hthor.world import World

SIZE = (400, 300)


def task(id: str) -> TaskSpec:
    return next(one for one in tasks.load_suite(id.partition("/")[0]).tasks if one.id == id)


def world(spec: TaskSpec) -> World:
    made = World(spec.house, objects=[(placed.id, placed.kind) for placed in spec.objects])
    made.reset(spec)
    return made


@pytest.fixture(scope="module")
def elder() -> World:
    return world(task("rearrange/elder/01"))


@settings(max_examples=cases(40))
@given(st.sampled_from(houses.names()), st.floats(0.0, 2.0 * math.pi), st.sampled_from([SIZE, (300, 400), (320, 256)]))
def test_a_whole_house_is_in_the_picture_and_fills_it(name: str, azimuth: float, size: tuple[int, int]) -> None:
    house = houses.load(name)
    viewpoint = framing.frame_house(house, azimuth, size)
    corners = np.array([(*corner, z) for room in house.rooms for corner in room.polygon for z in (0.0, 1.6)])
    shown = viewpoint.project(corners, size)[:, :2]
    assert (shown >= 0.0).all()
    assert (shown <= np.array(size) - 1.0).all()
    spread = (shown.max(axis=0) - shown.min(axis=0)) / size
    assert spread.max() > 0.9
    middle = (shown.max(axis=0) + shown.min(axis=0)) / 2 / size
    assert np.abs(middle - 0.5).max() < 0.05


def test_angles_are_well_apart_and_show_more_than_others_do(elder: World) -> None:
    spec = task("rearrange/elder/01")
    points = [placed.position for placed in spec.objects]
    chosen = framing.best_azimuths(elder, points, 3)
    assert chosen == framing.best_azimuths(elder, points, 3)
    for one, other in combinations(chosen, 2):
        assert abs((one - other + math.pi) % (2 * math.pi) - math.pi) >= math.radians(75) - 1e-9

    def seen(azimuth: float) -> int:
        return int(framing.visible(elder, framing.frame_house(elder.house, azimuth, SIZE), points).sum())

    others = [0.1 + turn * 2.0 * math.pi / 3.0 for turn in range(3)]
    assert sum(map(seen, chosen)) >= sum(map(seen, others))


def test_what_is_below_a_floor_is_hidden(elder: World) -> None:
    viewpoint = framing.frame_house(elder.house, 1.0, SIZE)
    x, y, _ = task("rearrange/elder/01").objects[0].position
    assert framing.visible(elder, viewpoint, [(x, y, 3.0), (x, y, -1.0)]).tolist() == [True, False]


def test_places_before_and_after_are_those_of_the_task() -> None:
    spec = task("rearrange/elder/01")
    found = rearrangement_figure.shuffled_targets(spec)
    assert len(found) == 6
    for job, target in zip(spec.goal.jobs, found, strict=True):
        placed = next(one for one in spec.objects if one.id == job.target)
        assert (target.before, target.after, target.kind) == (job.place, placed.position, placed.kind)
    assert {target.kind for target in found if target.moved} == {"lettuce", "remote_control", "mug"}
    for other in ("tidy/maple/02", "paper/alder/manipulation-01", "carry/rowan/01"):
        with pytest.raises(HthorError, match="no places from before a shuffle"):
            rearrangement_figure.shuffled_targets(task(other))


def test_a_rearrangement_is_drawn_from_three_angles_in_gold_and_red(elder: World) -> None:
    made = rearrangement_figure.rearrangement_figure(task("rearrange/elder/01"), elder)
    assert len(made.axes) == rearrangement_figure.ANGLES == 3
    for ax in made.axes:
        boxes = [to_rgba(patch.get_facecolor())[:3] for patch in ax.patches if isinstance(patch, Polygon)]
        gold, red = (to_rgba(shade)[:3] for shade in (rearrangement_figure.BEFORE, rearrangement_figure.AFTER))
        assert (boxes.count(gold), boxes.count(red)) == (6, 6)
        assert len(ax.texts) == 6 + 3, "six names, and an arrow for each target that was moved"
        box = ax.get_window_extent()
        wide, high = ax.images[0].get_size()[::-1]
        assert box.width / box.height == pytest.approx(wide / high, rel=0.03), "pixels are square"
    told = "\n".join(text.get_text() for text in made.findobj(Text))
    for words in ("3 of 6 targets were moved", "before the shuffle", "after the shuffle", "lettuce", "remote control"):
        assert words in told
    assert figure_file.encode(made, "svg") == figure_file.encode(made, "svg")


def test_the_scene_graph_of_a_task_is_the_one_that_it_was_made_from() -> None:
    """Ids of searches name the triplet that was given; the placements record it."""
    checked, homes = 0, {name: houses.load(name) for name in houses.names()}
    for spec in tasks.load_suite("navigation").tasks:
        target, relation, reference = spec.id.rpartition("/")[2].split("-")
        found = scene_graph.read_graph(spec.objects, homes[spec.house])[target]
        assert (found.relation, found.reference) == (relation, reference), spec.id
        checked += 1
    assert checked == 565


def test_the_pipeline_shows_priors_relations_and_scene() -> None:
    spec = task("paper/alder/manipulation-01")
    made = pipeline_figure.pipeline_figure(spec, world(spec))
    priors, relations, scene = made.axes
    assert len(priors.lines) == 65
    strong = [line for line in priors.lines if line.get_alpha() == 1.0]
    assert len(strong) == 6, "one relation of each target"
    names = [text.get_text() for text in priors.texts]
    assert {"apple", "remote control", "fridge", "television"} <= set(names)
    faint = {text.get_text() for text in priors.texts if text.get_color() == graph_panels.ABSENT}
    kinds = {thing.kind.replace("_", " ") for thing in houses.load(spec.house).things}
    assert faint
    assert not faint & kinds
    told = [text.get_text() for text in relations.texts]
    assert told.count("near") == 4
    assert told.count("on") == 2
    assert "bowl" in told
    assert {text.get_text() for text in scene.texts} >= {"apple", "mug", "book", "tomato"}
    assert len(scene.images) == 1


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["paper/alder/manipulation-01", "--angles"], "no places from before a shuffle"),
        (["rearrange/elder/01", "--angles", "--pipeline"], "give one of them"),
        (["rearrange/elder/01", "--angles", "--out", "x.gif"], "must end in .png, .svg or .pdf"),
        (["rearrange/elder/01", "--out", "x.jpeg"], "must end in .png, .svg or .pdf"),
    ],
)
def test_mistakes_are_told(words: list[str], told: str) -> None:
    done = CliRunner().invoke(app, ["tasks", "draw", *words])
    assert done.exit_code != 0
    assert told in str(done.exception) + done.output
