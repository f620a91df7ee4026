"""How long one person's hands take, from the attempts in the journal or else from what everybody could see."""

from __future__ import annotations

from collections.abc import Sequence
from statistics import median

from hthor import rules
from hthor.calibration.from_logs.trial_features import TrialFeatures
from hthor.calibration.person.measure import Measure, share, typical, unknown
from hthor.calibration.person.walking import Practice

_LEAST = 3


def hands(trials: Sequence[TrialFeatures], practice: Practice) -> list[Measure]:
    """The parameters of handling."""
    return [_duration(trials, practice), _misses(trials)]


def _duration(trials: Sequence[TrialFeatures], practice: Practice) -> Measure:
    name = "t_manip"
    done = [(one.index, each) for one in trials for each in one.attempts if not each.cut]
    if len(done) < _LEAST:
        words = f"there were {len(done)} things picked up, put down, opened or closed; it takes {_LEAST}"
        return unknown(name, "s", words)
    seen = any(each.seen for _, each in done)
    how = "from the last step to the thing in or out of the hand, without turning" if seen else "attempts of the hands"
    times = [each.seconds * practice.factor(index) for index, each in done]
    if median(each.seconds for _, each in done) <= rules.HANDLING_S:
        least = rules.HANDLING_S
        return Measure(name=name, unit="s", value=least, low=0.0, high=least, bound="at most", n=len(done), how=how)
    value, low, high = typical(times, error=practice.error([index for index, _ in done]))
    return Measure(name=name, unit="s", value=value, low=low, high=high, n=len(done), how=how)


def _misses(trials: Sequence[TrialFeatures]) -> Measure:
    name = "p_fail"
    known = [each for one in trials for each in one.attempts if not each.cut and not each.seen]
    if len(known) < _LEAST:
        return unknown(name, "", "a page offers only what the hand can do, so it shows no misses")
    value, low, high = share(sum(each.missed for each in known), len(known))
    return Measure(name=name, unit="", value=value, low=low, high=high, n=len(known), how="misses among attempts")
