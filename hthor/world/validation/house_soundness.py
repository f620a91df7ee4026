"""All checks of a house: the rules on its plan, and those that need the physics engine."""

from collections.abc import Iterator

from hthor.houses.checks import thing_rules
from hthor.houses.checks.findings import Finding, error
from hthor.houses.checks.house_checks import check
from hthor.types import HouseSpec
from hthor.world.model import door_geometry
from hthor.world.validation.drop_test import drop_findings
from hthor.world.validation.penetration import penetration_findings


def check_soundness(house: HouseSpec, radius: float = 0.25) -> tuple[Finding, ...]:
    """All faults of a generated house for bodies up to this radius [m]; errors come first.

    The rules of `hthor.houses.checks.house_checks`, applied strictly, ``swing-free`` for the leaves in its doorways
    too, then ``penetration`` and ``surface-takes``.
    """
    plain = check(house, radius, strict=True)
    found = (*plain, *_leaves(house), *penetration_findings(house), *drop_findings(house))
    return tuple(sorted(found, key=lambda finding: finding.severity != "error"))


def _leaves(house: HouseSpec) -> Iterator[Finding]:
    for leaf in door_geometry.doorway_leaves(house):
        for finding in thing_rules.check_swing(house, leaf.thing, leaf.parts, leaf.joints, "door"):
            yield error(finding.rule, finding.where, finding.problem)
