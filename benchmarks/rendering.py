"""Pictures: by profile, size and channel, from the person's eyes while they walk."""

from __future__ import annotations

import itertools
import math
import statistics
from collections.abc import Iterator, Sequence

from benchmarks.scenes import Scene, walk
from benchmarks.table import Clock, Row
from hthor.errors import RenderingUnavailable
from hthor.types import HUMAN, Pose

SIZES = (64, 128, 224, 300)
CHANNELS = ("rgb", "depth", "segmentation")
_VIEWS, _APART_M = 8, 0.6
BAR = 150.0


def rows(scenes: Sequence[Scene], profiles: Sequence[str], sizes: Sequence[int]) -> Iterator[Row]:
    """Frames a second of CPU time: the median over the scenes of the mean over views along a walk."""
    places = [(scene, _views(scene)) for scene in scenes]
    for profile in profiles:
        try:
            for scene, views in places:
                _cost(scene, views[:1], profile, CHANNELS, 64)
        except RenderingUnavailable as error:
            yield Row(part="rendering", what=f"{profile}", value=None, unit="frames/s", remark=str(error))
            continue
        for size, channels in itertools.product(sizes, [*((one,) for one in CHANNELS), CHANNELS[:2], CHANNELS]):
            cost = statistics.median(_cost(scene, views, profile, channels, size) for scene, views in places)
            promised = profile == "fast" and size == 128 and channels == CHANNELS[:2]
            yield Row(
                part="rendering",
                what=f"{profile} {size}x{size} {' + '.join(channels)}",
                value=1000.0 / cost,
                unit="frames/s",
                bar=BAR if promised else None,
                at_least=True,
                remark="OpenGL, in software where there is no GPU" if profile == "nice" else "",
            )


def _views(scene: Scene) -> list[Pose]:
    """Poses of the person along their walk, but for those where a robot stands at its end."""
    world, poses = scene.world, []
    way = iter(walk(scene, 600))
    world.reset(scene.task)
    following = next(way, None)
    for tick in range(600):
        while following is not None and following[0] == tick:
            world.start(following[1], following[2])
            following = next(way, None)
        world.advance()
        if tick % (600 // _VIEWS) == 0:
            poses.append(world.pose(HUMAN))
    others = [other for seat, other in world.poses().items() if seat != HUMAN]
    return [one for one in poses if all(math.hypot(one.x - other.x, one.y - other.y) > _APART_M for other in others)]


def _cost(scene: Scene, views: Sequence[Pose], profile: str, channels: Sequence[str], size: int) -> float:
    """CPU time [ms] of one view, all channels."""
    world = scene.world
    clock = Clock()
    for pose in views:
        world.teleport(HUMAN, pose)
        for channel in channels:
            world.picture(HUMAN, channel, (size, size), profile=profile)
    return clock() / len(views)
