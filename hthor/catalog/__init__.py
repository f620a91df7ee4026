"""The catalogue of all kinds of things: size, mass, affordances, form."""

import re

from hthor.catalog import kinds, priors
from hthor.catalog.kind import Family, Form, Kind
from hthor.errors import UnknownName
from hthor.types import Vec3

__all__ = ["RECEPTACLES", "TARGETS", "Family", "Form", "Kind", "kind", "names", "own_asset", "priors"]

RECEPTACLES = tuple(kind.name for kind in kinds.RECEPTACLES)
"""The benchmark's eight receptacles, by name."""
TARGETS = tuple(kind.name for kind in kinds.TARGETS)
"""The benchmark's six target objects, by name."""

_KINDS = {kind.name: kind for kind in (*kinds.RECEPTACLES, *kinds.TARGETS, *kinds.HOUSEHOLD)}
_ASSET = re.compile(r"hthor_([a-z_]+?)(?:_(\d+)x(\d+)x(\d+))?(?:_v(\d+))?")


def names() -> tuple[str, ...]:
    """The names of all kinds: receptacles, then targets, then all other household things."""
    return tuple(_KINDS)


def kind(name: str) -> Kind:
    """The kind with this name.

    Raises:
        UnknownName: when no kind has this name.
    """
    try:
        return _KINDS[name]
    except KeyError:
        raise UnknownName("kind of thing", name, _KINDS) from None


def own_asset(asset: str) -> tuple[Kind, Vec3, int] | None:
    """Kind, size [m] and variant of one of hthor's own asset ids, None for any other id.

    Own ids are ``hthor_<kind>``, and for another size ``hthor_<kind>_<width>x<depth>x<height>`` in whole centimetres;
    ``_v<number>`` at the end gives the variant.
    """
    match = _ASSET.fullmatch(asset)
    if match is None or match[1] not in _KINDS:
        return None
    found, variant = _KINDS[match[1]], int(match[5] or 0)
    if match[2] is None:
        return found, found.size, variant
    return found, (int(match[2]) / 100.0, int(match[3]) / 100.0, int(match[4]) / 100.0), variant
