"""Time spent on the task, and time in which people did nothing."""

import statistics

from hthor import rules
from hthor.eval.metrics.metric import DIGITS, LOWER, SECONDS, Metric, Trial


def time_spent(trial: Trial) -> float:
    """Seconds spent; a trial that was not solved counts with its time limit."""
    return round(trial.log.ticks * rules.TICK_S, DIGITS) if trial.log.met else trial.spec.task.time_limit


def idle(trial: Trial) -> float | None:
    """Seconds in which the human's body did nothing; with several people, the mean of theirs."""
    seconds = idle_by_person(trial)
    return statistics.fmean(seconds.values()) if seconds else None


def idle_by_person(trial: Trial) -> dict[str, float]:
    """Seconds in which each person's body did nothing; only with several people."""
    return {seat: trial.log.idle[seat] * rules.TICK_S for seat in trial.people if seat in trial.log.idle}


METRICS = (
    Metric("time_s", "time spent", time_spent, "time", unit=SECONDS, better=LOWER, rank=50, main=True, timed=True),
    Metric("idle_s", "human idle", idle, unit=SECONDS, rank=110, timed=True),
    Metric("idle_by", "idle", idle_by_person, unit=SECONDS, rank=930, timed=True, by_seat=True, several=True),
)
