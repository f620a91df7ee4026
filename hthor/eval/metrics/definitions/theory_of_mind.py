"""How well robots know people's minds: their predictions (`Predicted`) against what people had in mind (`Believed`)."""

import functools
import math
import statistics
from collections.abc import Iterator, Mapping

from hthor.episode.recording.episode_log import EpisodeLog
from hthor.eval.metrics.metric import HIGHER, SHARE, Metric, Trial
from hthor.types.events import Believed, Predicted


def belief_match(trial: Trial) -> float | None:
    """How well robots knew where people expected objects to be; the mean over all predictions of places.

    One prediction scores the overlap of two distributions over places: the one that the robot predicted and the one
    that the person had in mind. It is 1 minus their total variation distance, with all places that neither names as one
    more place. Only simulated people tell what they have in mind.
    """
    scores = [score for _, score in belief_scores(trial.log)]
    return statistics.mean(scores) if scores else None


def belief_scores(log: EpisodeLog) -> list[tuple[int, float]]:
    """The tick and the overlap, 0 to 1, of each prediction of places."""
    return [
        (said.tick, _overlap(said.places, true.places))
        for said, true in _pairs(log)
        if said.places and said.object and true.object == said.object
    ]


def activity_match(trial: Trial) -> float | None:
    """How well robots knew what people were about to do: the mean probability given to what they did.

    Activities are "search", "fetch apple" and so on. Only simulated people tell what they are doing.
    """
    scores = [said.next.get(true.next, 0.0) for said, true in _pairs(trial.log) if said.next]
    return statistics.mean(scores) if scores else None


def _pairs(log: EpisodeLog) -> Iterator[tuple[Predicted, Believed]]:
    """Every prediction with the true belief at that moment.

    Each prediction has one entry in the journal, in the same order. They are paired from the end, because the journal
    also has the phases before the task itself, of which the metrics know nothing.
    """
    said: dict[tuple[str, str], list[Predicted]] = {}
    true: dict[tuple[str, str], list[Believed]] = {}
    for event in log.events:
        if isinstance(event, Predicted):
            said.setdefault((event.person, event.object), []).append(event)
    for entry in log.journal:
        if isinstance(entry, Believed):
            true.setdefault((entry.seat, entry.object), []).append(entry)
    pairs: list[tuple[Predicted, Believed]] = []
    for about, predictions in said.items():
        pairs += zip(reversed(predictions), reversed(true.get(about, ())), strict=False)
    yield from sorted(pairs, key=lambda pair: pair[0].tick)


def _overlap(said: Mapping[str, float], true: Mapping[str, float]) -> float:
    shared = math.fsum(min(share, true.get(place, 0.0)) for place, share in said.items())
    elsewhere = min(1.0 - math.fsum(said.values()), 1.0 - math.fsum(true.values()))
    return min(1.0, max(0.0, shared + max(0.0, elsewhere)))


_match = functools.partial(Metric, unit=SHARE, better=HIGHER, section="messages", needs_robot=True, optional=True)

METRICS = (
    _match("belief_match", "beliefs of people known", belief_match, rank=700),
    _match("activity_match", "activities of people known", activity_match, rank=710),
)
