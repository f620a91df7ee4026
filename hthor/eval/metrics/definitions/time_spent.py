"""Time spent on the task, and time in which the human did nothing."""

from hthor import rules
from hthor.eval.metrics.metric import DIGITS, LOWER, SECONDS, Metric, Trial
from hthor.types import HUMAN


def time_spent(trial: Trial) -> float:
    """Seconds spent; a trial that was not solved counts with its time limit."""
    return round(trial.log.ticks * rules.TICK_S, DIGITS) if trial.log.met else trial.spec.task.time_limit


def idle(trial: Trial) -> float | None:
    """Seconds in which the human's body did nothing."""
    return trial.log.idle[HUMAN] * rules.TICK_S if HUMAN in trial.log.idle else None


METRICS = (
    Metric("time_s", "time spent", time_spent, "time", unit=SECONDS, better=LOWER, rank=50, main=True, timed=True),
    Metric("idle_s", "human idle", idle, unit=SECONDS, rank=110, timed=True),
)
