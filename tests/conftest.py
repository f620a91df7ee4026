"""What several tests share: where the repository is, and the sample houses that may lie beside it."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from hthor.eval import provenance

os.environ.setdefault("NUMBA_CACHE_DIR", str(provenance.compiled()))  # before anything that is compiled is imported

ROOT = Path(__file__).resolve().parents[1]
SAMPLES = ROOT.parent / "shared" / "houses"


@pytest.fixture(scope="session")
def root() -> Path:
    return ROOT


@pytest.fixture(scope="session")
def samples() -> list[Path]:
    """The sample houses, which are not part of the project."""
    files = sorted(SAMPLES.glob("*.json"))
    if not files:
        pytest.skip(f"no sample houses in {SAMPLES.parent.name}/{SAMPLES.name} beside the repository")
    return files
