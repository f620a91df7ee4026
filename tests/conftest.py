"""What several tests share: where the repository is, and the sample houses that may lie beside it."""

from __future__ import annotations

import functools
import os
import re
from pathlib import Path

import pytest
from hypothesis import settings

from hthor import code_identity

os.environ.setdefault("NUMBA_CACHE_DIR", str(code_identity.compiled()))  # before anything that is compiled is imported

_OUTSIDE = re.compile(r"\bL3\b|bwrap|bubblewrap|chromium|\bnode\b|hthor\.guest|guest_fakes|Guest\(|import guest\b")
"""A file of tests in which one of these stands may depend on programs that not every machine has."""
settings.register_profile("hthor", deadline=None, derandomize=True)  # a change breaks a test, or it does not
settings.register_profile("explore", deadline=None)  # other cases each time: HYPOTHESIS_PROFILE=explore make test
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "hthor"))

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


def pytest_configure(config: pytest.Config) -> None:
    config.addinivalue_line("markers", "outside: may depend on bubblewrap, a browser or Node; see scripts/bare_path.sh")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark the tests that may go otherwise on a machine without these programs."""
    for item in items:
        if _mentions_outside(item.path):
            item.add_marker("outside")


@functools.cache
def _mentions_outside(path: Path) -> bool:
    return _OUTSIDE.search(path.read_text(encoding="utf-8")) is not None
