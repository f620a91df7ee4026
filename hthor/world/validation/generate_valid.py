"""Generates homes until one passes all checks."""

from typing import Any

from msgspec import Struct

from hthor.errors import HthorError
from hthor.houses import generator, loader
from hthor.houses.checks.findings import Finding, is_sound
from hthor.types import HouseSpec
from hthor.world.validation.house_soundness import check_soundness

RADIUS_M = 0.25
"""[m] Radius of the broadest body that a home is checked for."""
ATTEMPTS = 20
"""How many homes of one seed are tried."""


class ValidHome(Struct, frozen=True, kw_only=True):
    """A home that is sound: its ``document`` in ProcTHOR's schema, and the same as a ``house``.

    ``attempt`` counts from 0: how many homes of this seed were rejected before it. ``refused`` holds the errors of
    those that the generator had passed and the proof refused, ``findings`` what is left to say of this one.
    """

    seed: int
    rooms: int
    attempt: int
    document: dict[str, Any]
    house: HouseSpec
    findings: tuple[Finding, ...]
    refused: tuple[Finding, ...] = ()


def home_name(seed: int, rooms: int) -> str:
    """What a home is called unless it is given another name."""
    return f"home-{rooms}-{seed}"


def generate_valid_home(seed: int, rooms: int) -> ValidHome:
    """The first sound home of a seed; equal arguments give equal documents.

    Raises:
        HthorError: when the number of rooms is none that can be made, or no attempt is sound.
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
    raise HthorError(f"{found}; of the last: {refused[-1]}. Take another seed")
