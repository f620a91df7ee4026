"""Goals that are met by stopping: only by standing still, where it counts, for long enough."""

from hthor.episode.standstill import Standstill
from hthor.types import Pose, Snapshot


def seen(tick, **pose):
    return Snapshot(tick=tick, poses={"human": Pose(**pose)}, things={}, in_view={}, holding={})


def test_whoever_stands_still_has_stopped_and_whoever_walks_or_turns_has_not():
    stand = Standstill("human", 3)
    assert [stand.lasts(seen(tick, x=0.0, y=0.0)) for tick in range(5)] == [False, False, False, True, True]
    assert not stand.lasts(seen(5, x=0.1, y=0.0))
    assert not stand.lasts(seen(8, x=0.1, y=0.0, yaw=0.2))
    assert stand.lasts(seen(11, x=0.1, y=0.0, yaw=0.2, head=1.0))


def test_a_stop_elsewhere_does_not_count():
    stand = Standstill("human", 3)
    stand.lasts(seen(0, x=0.0, y=0.0))
    stand.leave()
    assert not stand.lasts(seen(9, x=0.0, y=0.0))
