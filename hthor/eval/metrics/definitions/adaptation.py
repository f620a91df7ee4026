"""How often and how far robots changed their own policy during a trial."""

import functools
import statistics

from hthor.eval.metrics.metric import Metric, Trial
from hthor.types.events import Adapted


def adaptations(trial: Trial) -> float | None:
    """How often robots adapted their policy during the trial; only trials in which one did."""
    return len(_divergences(trial)) or None


def adaptation_divergence(trial: Trial) -> float | None:
    """How far adaptation moved robots' policies [nats], the mean over the trial's adaptations.

    By what the robot says: the divergence of its next action's probabilities from those without any adaptation.
    """
    found = _divergences(trial)
    return statistics.fmean(found) if found else None


def _divergences(trial: Trial) -> list[float]:
    return [event.divergence for event in trial.log.events if isinstance(event, Adapted)]


_adapts = functools.partial(Metric, section="bodies", needs_robot=True, optional=True)

METRICS = (
    _adapts("adaptations", "adaptations", adaptations, rank=720),
    _adapts("adaptation_divergence", "divergence by adaptation", adaptation_divergence, decimals=4, rank=730),
)
