"""How long people had the parts of their display shown: the panel with a message, and the map of where its sender is.

Times follow from the log's events, see `hthor.comms.display`. In logs from before people could hide them, the panel was
shown until the answer and the map until the end.
"""

import functools
import statistics

from hthor import rules
from hthor.comms import display
from hthor.comms.display import Part
from hthor.eval.metrics.metric import SECONDS, Metric, Trial


def panel_shown(trial: Trial) -> float:
    """Seconds for which the human had the panel with a message on the display; with several people, their mean."""
    return _seconds(trial, "panel")


def map_shown(trial: Trial) -> float:
    """Seconds for which the human had the map on the display; with several people, their mean."""
    return _seconds(trial, "map")


def _seconds(trial: Trial, part: Part) -> float:
    log = trial.log
    spans = [display.shown_spans(log.events, seat, log.ticks)[part] for seat in trial.people]
    return statistics.fmean(sum(end - begin for begin, end in own) for own in spans) * rules.TICK_S


_display = functools.partial(Metric, section="messages", unit=SECONDS, needs_robot=True, timed=True)

METRICS = (
    _display("panel_shown_s", "panel shown", panel_shown, rank=320),
    _display("map_shown_s", "map shown", map_shown, rank=330),
)
