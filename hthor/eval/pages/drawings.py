"""Every figure of a report by its name, with what it shows in words; knows nothing of where it will stand."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from matplotlib.figure import Figure
from msgspec import Struct

from hthor.eval.pages.figures import parted, scores, spent, trial_map, trust, uplift
from hthor.eval.pages.findings import Findings
from hthor.eval.record import Record
from hthor.types import HouseSpec


class Drawing(Struct, frozen=True, kw_only=True, eq=False):
    """A figure, its name as a file's, and what it shows for those who cannot see it."""

    name: str
    words: str
    figure: Figure


class Scene(Struct, frozen=True, kw_only=True, eq=False):
    """What a map is drawn of: a trial, the same person's without a robot if there is one, and the house."""

    record: Record
    alone: Record | None
    house: HouseSpec


def draw(found: Findings, scenes: Sequence[Scene]) -> Iterator[Drawing]:
    """The figures in the page's order; those that would be empty are left out.

    Args:
        scenes: of ``found.shown``, one each in that order; none where houses are not at hand.
    """
    yield Drawing(
        name="scores",
        words="Success, time-weighted success, adoption",
        figure=scores.figure(found),
    )
    if found.uplift:
        yield Drawing(name="uplift", words="Differences to no robot with 95 % intervals", figure=uplift.figure(found))
    yield Drawing(name="time-spent", words="Box plots of the time spent", figure=spent.figure(found.spent, found.arms))
    if found.trust:
        yield Drawing(
            name="trust", words="Mean trust by trial of the session", figure=trust.figure(found.trust, found.arms)
        )
    levels = [one for one in found.splits if one.word != "scene"]
    if levels:
        said = " and ".join(one.word for one in levels)
        yield Drawing(name="difficulty", words=f"Success by {said}", figure=parted.figure(levels, found.arms))
    rooms = [one for one in found.splits if one.word == "scene"]
    if rooms:
        yield Drawing(name="scenes", words="Success by scene", figure=parted.figure(rooms, found.arms, ranked=True))
    if found.by_people is not None:
        people = [found.by_people]
        yield Drawing(name="people", words="Success by kind of person", figure=parted.figure(people, found.arms))
    for number, (one, scene) in enumerate(zip(found.shown, scenes, strict=False), 1):
        words = f"Map of {one.task} with {one.arm}, one of its {one.rank} trials"
        figure = trial_map.figure(scene.record, scene.house, scene.alone)
        yield Drawing(name=f"map-{number:02d}-{one.key}", words=words, figure=figure)
