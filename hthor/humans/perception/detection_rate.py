"""How fast a participant notices things in view.

The rate is lam0 / (1 + (a50 / angle)^2) * exp(-(ecc / ecc_sd)^2 / 2) * share * exp(-clutter * beside). Independent
glimpses at a rate make the time to notice exponential (Koopman 1956). Studies of visual search agree that the time is
long for things that are small, off the middle of the view, half hidden or crowded; each factor's form is our choice.
"""

import math
from functools import cache

from hthor import catalog
from hthor.humans.memory.subgoals import object_kind
from hthor.humans.population.parameters import Parameters
from hthor.types import Pose, Vec3

_USUAL_M = 0.1
"""[m] Size of an object of unknown kind. Our choice."""


def detection_rate(traits: Parameters, angle: float, ecc: float, share: float = 1.0, beside: int = 0) -> float:
    """Rate [1/s] at which a small thing is noticed when a ``share`` of 0 to 1 of it is in view.

    ``angle`` [rad] is its size over its distance, above 0, ``ecc`` [rad] its angle off the direction of the head,
    ``beside`` the number of other small things that appear close to it.
    """
    small, aside = traits.a50 / angle, ecc / traits.ecc_sd
    return traits.lam0 * share / (1.0 + small * small) * math.exp(-0.5 * aside * aside - traits.clutter * beside)


def apparent_size(size: Vec3) -> float:
    """The size [m] that counts for the eye: the side of a square with the area of the largest face of a box."""
    _, middle, longest = sorted(size)
    return math.sqrt(middle * longest)


@cache
def expected_size(target: str) -> float:
    """The usual size [m] of objects of this kind, `_USUAL_M` for an unknown kind."""
    kind = object_kind(target)
    return apparent_size(catalog.kind(kind).size) if kind in catalog.names() else _USUAL_M


class Head:
    """Where the eyes are [m] and which way the head points."""

    __slots__ = ("ahead", "eye")

    def __init__(self, pose: Pose, eye: float) -> None:
        flat = math.cos(pose.pitch)
        self.eye = pose.x, pose.y, eye
        self.ahead = flat * math.cos(pose.yaw), flat * math.sin(pose.yaw), math.sin(pose.pitch)

    def to(self, point: Vec3) -> tuple[float, float]:
        """Distance [m] of a point, and its angle [rad] off the direction of the head."""
        (x, y, z), (ex, ey, ez), (ux, uy, uz) = point, self.eye, self.ahead
        dx, dy, dz = x - ex, y - ey, z - ez
        far = math.sqrt(dx * dx + dy * dy + dz * dz) or 1e-9
        return far, math.acos(max(-1.0, min(1.0, (dx * ux + dy * uy + dz * uz) / far)))


class PlaceDetection:
    """How fast a thing of ``size`` [m] would be noticed at a point, alone and in full view.

    The same law as `detection_rate`, written for speed: it is evaluated for all furniture in view at every glimpse.
    """

    __slots__ = ("_aside", "_most", "_small")

    def __init__(self, traits: Parameters, size: float) -> None:
        self._most, self._small, self._aside = traits.lam0, (traits.a50 / size) ** 2, 0.5 / traits.ecc_sd**2

    def rate(self, head: Head, point: Vec3) -> float:
        """Rate [1/s] at a point [m]."""
        (x, y, z), (ex, ey, ez), (ux, uy, uz) = point, head.eye, head.ahead
        dx, dy, dz = x - ex, y - ey, z - ez
        far2 = dx * dx + dy * dy + dz * dz + 1e-18
        along = (dx * ux + dy * uy + dz * uz) / math.sqrt(far2)
        ecc = math.acos(along) if -1.0 < along < 1.0 else 0.0 if along > 0.0 else math.pi
        return self._most / (1.0 + self._small * far2) * math.exp(-self._aside * ecc * ecc)
