"""All checks of a house, on its floor plan and in the physics engine; generates homes until one passes."""

from collections.abc import Iterator
from typing import Any

from msgspec import Struct

from hthor.errors import HthorError
from hthor.houses import generator, loader
from hthor.houses.checks import house_rules
from hthor.houses.checks.house_checks import check
from hthor.houses.checks.house_rules import Finding, error, is_sound
from hthor.types import HouseSpec
from hthor.world.model import door_geometry
from hthor.world.validation.physics_checks import drop_findings, penetration_findings

RADIUS_M = 0.25
"""[m] Radius of the widest body that a home is checked for."""
ATTEMPTS = 20
"""How many homes are generated from one seed before giving up."""


def check_soundness(house: HouseSpec, radius: float = 0.25) -> tuple[Finding, ...]:
    """All faults of a generated house for bodies up to this radius [m]; errors come first.

    Checked are the rules of `hthor.houses.checks.house_checks`, applied strictly; ``swing-free`` also for the doors in
    doorways; then ``penetration`` and ``surface-takes``.
    """
    plain = check(house, radius, strict=True)
    found = (*plain, *_leaves(house), *penetration_findings(house), *drop_findings(house))
    return tuple(sorted(found, key=lambda finding: finding.severity != "error"))


def _leaves(house: HouseSpec) -> Iterator[Finding]:
    for leaf in door_geometry.doorway_leaves(house):
        for finding in house_rules.check_swing(house, leaf.thing, leaf.parts, leaf.joints, "door"):
            yield error(finding.rule, finding.where, finding.problem)


class ValidHome(Struct, frozen=True, kw_only=True):
    """A sound home, as a ``document`` in ProcTHOR's schema and as a ``house``.

    ``attempt`` is the number of homes of this seed that were rejected before it. ``refused`` has the errors of the
    homes that passed the generator's rules but failed these checks, ``findings`` the remaining findings of this home.
    """

    seed: int
    rooms: int
    attempt: int
    document: dict[str, Any]
    house: HouseSpec
    findings: tuple[Finding, ...]
    refused: tuple[Finding, ...] = ()


def home_name(seed: int, rooms: int) -> str:
    """The default name of a home."""
    return f"home-{rooms}-{seed}"


def generate_valid_home(seed: int, rooms: int) -> ValidHome:
    """The first sound home of a seed; equal arguments give equal documents.

    Raises:
        HthorError: when homes with this number of rooms cannot be made, or no attempt is sound.
    """
    refused: list[Finding] = []
    attempt = 0
    while attempt < ATTEMPTS:
        document = generator.generate(seed, rooms, first=attempt, tries=ATTEMPTS - attempt)
        attempt = int(document["metadata"]["generator"]["attempt"])
        house = loader.house_from_document(document, home_name(seed, rooms))
        findings = check_soundness(house, RADIUS_M)
        if is_sound(findings):
            return ValidHome(
                seed=seed,
                rooms=rooms,
                attempt=attempt,
                document=document,
                house=house,
                findings=findings,
                refused=tuple(refused),
            )
        refused += (finding for finding in findings if finding.severity == "error")
        attempt += 1
    found = f"seed {seed} gave no sound home of {rooms} rooms in {ATTEMPTS} attempts"
    raise HthorError(f"{found}; of the last: {refused[-1]}. Choose another seed")
