"""Proof that a house is one to live in: every rule, the engine's among them; knows nothing of how it was made."""

from __future__ import annotations

from collections.abc import Iterator

from hthor.houses import thing_rules
from hthor.houses.check import check
from hthor.houses.findings import Finding, error
from hthor.types import HouseSpec
from hthor.world import leaves
from hthor.world.penetration import penetrations
from hthor.world.trial_drop import drops


def prove(house: HouseSpec, radius: float = 0.25) -> tuple[Finding, ...]:
    """Everything that is wrong with a house of our own for bodies up to this radius [m]; errors come first.

    The rules of `hthor.houses.check`, judged strictly, ``swing-free`` for the leaves in its doorways too, then
    ``penetration`` and ``surface-takes``.
    """
    plain = check(house, radius, strict=True)
    found = (*plain, *_leaves(house), *penetrations(house), *drops(house))
    return tuple(sorted(found, key=lambda finding: finding.severity != "error"))


def _leaves(house: HouseSpec) -> Iterator[Finding]:
    for leaf in leaves.of_house(house):
        for finding in thing_rules.swing(house, leaf.thing, leaf.parts, leaf.joints, "door"):
            yield error(finding.rule, finding.where, finding.problem)
