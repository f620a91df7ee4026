"""All figures of a report by name, each with a description in words."""

from collections.abc import Iterator, Sequence

from matplotlib.figure import Figure
from msgspec import Struct

from hthor.eval.records.scored_trial import ScoredTrial
from hthor.report.analysis.document import Findings
from hthor.report.drawing import trial_trace
from hthor.report.page.figures import breakdown, scores, session, trial_map
from hthor.types import HouseSpec

PAIRS_MOST = 15
"""With more comparisons than this, the figure shows only those with no robot, and the table shows all."""


class NamedFigure(Struct, frozen=True, kw_only=True, eq=False):
    """A figure, its name, which is also its file's name, and a description for people who cannot see it."""

    name: str
    words: str
    figure: Figure


class MapScene(Struct, frozen=True, kw_only=True, eq=False):
    """The content of a map: a trial, the same people's trial without a robot if there is one, and the house."""

    record: ScoredTrial
    alone: ScoredTrial | None
    house: HouseSpec


def draw_figures(found: Findings, scenes: Sequence[MapScene]) -> Iterator[NamedFigure]:
    """The figures in the page's order; those that would be empty are left out.

    Args:
        scenes: one for each trial of ``found.shown``, in that order; empty if the houses are not available.
    """
    yield from _of_runs(found)
    yield from _of_parts(found)
    if scenes and found.shown:
        seats = list(dict.fromkeys(seat for scene in scenes for seat in scene.record.paths))
        alone = any(scene.alone is not None for scene in scenes)
        destined = any(trial_trace.destinations(scene.record.spec, scene.house) for scene in scenes)
        failed = any(scene.record.faults for scene in scenes)
        words = "What lines and marks on the maps mean"
        legend = trial_map.legend(seats, alone=alone, destined=destined, failed=failed)
        yield NamedFigure(name="legend", words=words, figure=legend)
    for number, (one, scene) in enumerate(zip(found.shown, scenes, strict=False), 1):
        words = f"Map of {one.task} with {one.arm}, one of its {one.rank} trials"
        figure = trial_map.figure(scene.record, scene.house, scene.alone)
        yield NamedFigure(name=f"map-{number:02d}-{one.key}", words=words, figure=figure)


def _of_runs(found: Findings) -> Iterator[NamedFigure]:
    yield NamedFigure(
        name="scores",
        words="Success, time-weighted success and adoption of every run, with 95 % intervals",
        figure=scores.scores_figure(found),
    )
    pairs = found.comparisons if len(found.comparisons) <= PAIRS_MOST else found.uplift
    if pairs:
        words = "Differences between runs, with 95 % intervals"
        yield NamedFigure(name="compared", words=words, figure=scores.comparison_figure(pairs, found.arms))
    words = "Box plots of the time spent, and the share of trials solved by each second"
    yield NamedFigure(name="time-spent", words=words, figure=session.time_figure(found.spent, found.arms))
    if found.trust:
        words = "Mean trust by trial of the session, with standard errors"
        yield NamedFigure(name="trust", words=words, figure=session.trust_figure(found.trust, found.arms))
    speaking = [arm for arm in found.arms if (arm.scores["sent"].mean or 0.0) > 0.0]
    if speaking:
        words = "What became of the robots' messages, how soon they were useful, how often they interrupted"
        yield NamedFigure(name="channel", words=words, figure=session.communication_figure(speaking))


def _of_parts(found: Findings) -> Iterator[NamedFigure]:
    levels = [one for one in found.splits if one.word != "scene"]
    if levels:
        said = " and ".join(one.word for one in levels)
        yield NamedFigure(name="difficulty", words=f"Success by {said}", figure=breakdown.figure(levels, found.arms))
    rooms = [one for one in found.splits if one.word == "scene"]
    if rooms:
        yield NamedFigure(
            name="scenes", words="Success by scene", figure=breakdown.figure(rooms, found.arms, ranked=True)
        )
    if found.by_people is not None:
        people = [found.by_people]
        yield NamedFigure(name="people", words="Success by kind of person", figure=breakdown.figure(people, found.arms))
