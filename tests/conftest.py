"""What several tests share: where the repository is, and the sample houses that may lie beside it."""

from __future__ import annotations

import functools
import gc
import os
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import law_cases
import pytest
from durations import (  # noqa: F401  hooks of pytest
    pytest_addoption,
    pytest_collection_modifyitems,
    pytest_fixture_setup,
    pytest_runtest_logreport,
    pytest_runtest_makereport,
    pytest_sessionfinish,
)
from hypothesis import settings

from hthor import code_identity

os.environ.setdefault("NUMBA_CACHE_DIR", str(code_identity.compiled()))  # before anything that is compiled is imported

_OUTSIDE = re.compile(r"\bL3\b|bwrap|bubblewrap|chromium|\bnode\b|hthor\.guest|guest_fakes|Guest\(|import guest\b")
"""A file of tests in which one of these stands may depend on programs that not every machine has."""
gc.set_threshold(50_000, 10, 10)  # thousands of tests stay in memory: searching them so often took 8 % of the time
settings.register_profile("hthor", deadline=None, derandomize=True, max_examples=law_cases.cases(100))
settings.register_profile("explore", deadline=None)
settings.load_profile(law_cases.PROFILE)

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


@pytest.fixture(scope="module", autouse=True)
def shared_worlds() -> Iterator[None]:
    """Trials in this process share the worlds of the houses that ship with hthor: each takes a third of a second.

    A trial does not depend on those before it in its world, which `test_real_episode`, where they share none, and the
    main job's tests show.
    """
    from hthor.trials import Sources, TrialRunner

    begin = TrialRunner.__init__

    def begin_with_worlds(
        self: TrialRunner, sources: Sources | None = None, pool: Any = None, worlds: Any = None, loop: Any = None
    ) -> None:
        if worlds is None and (sources is None or not (sources.robot_paths or sources.houses or sources.assets)):
            worlds = process_worlds()
        begin(self, sources, pool, worlds, loop)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(TrialRunner, "__init__", begin_with_worlds)
        yield


@functools.cache
def process_worlds() -> Any:
    from hthor.trials import Worlds

    return Worlds(most_bytes=600_000_000)


@pytest.fixture(scope="module")
def no_workers() -> Iterator[None]:
    """Sessions of evaluations are run in this process, which saves starting others."""
    import eval_fakes

    with pytest.MonkeyPatch.context() as patch:
        eval_fakes.play_here(patch)
        yield


def pytest_configure(config: pytest.Config) -> None:
    config.addinivalue_line("markers", "outside: may depend on bubblewrap, a browser or Node; see scripts/bare_path.sh")


def pytest_itemcollected(item: pytest.Item) -> None:
    """Mark the tests that may go otherwise on a machine without these programs."""
    if _mentions_outside(item.path):
        item.add_marker("outside")


@functools.cache
def _mentions_outside(path: Path) -> bool:
    return _OUTSIDE.search(path.read_text(encoding="utf-8")) is not None
