"""People in the house: the seam where a proxy or a live person sits, and what a proxy is made of.

Knows nothing of worlds, robots' minds or scoring.
"""

from __future__ import annotations

from typing import Any

from hthor import jsonio, plugins


def fingerprint(name: str) -> str:
    """Hash of a human model: its name and every parameter of its population.

    Args:
        name: the model's file name. Its class may have a ``parameters`` record; a model without one has only a name.

    Raises:
        UnknownName: when there is no such model.
    """
    model: Any = plugins.load("human model", name)
    return jsonio.sha256({"model": name, "parameters": getattr(model, "parameters", None)})
