"""People in the house: the seam where a proxy or a live person sits, and what a proxy is made of."""

from __future__ import annotations


def fingerprint(name: str) -> str:
    """Hash of everything that people of this name are made of: their model, and every number of their population.

    Args:
        name: as `hthor.humans.population.resolve.find` reads it.

    Raises:
        UnknownName: when there are no such people.
    """
    from hthor.humans.population import resolve

    return resolve.find(name).sha256
