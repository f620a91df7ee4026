"""How long tests take: `--record-durations` measures it, `--quick` leaves out the tests that take long.

`tests/durations.json` lists the tests of more than a tenth of a second, with the seconds of their slowest case. The
time of a test is that of its call and of all fixtures that it uses, those included that are made once for many tests:
it would wait for them if it ran alone. Tests that are not listed are quick, or new.
"""

from __future__ import annotations

import json
import time
from collections.abc import Generator
from pathlib import Path

import pytest

FILE = Path(__file__).resolve().parents[1] / "durations.json"
QUICK_S, SLOW_S = 0.1, 2.0
_fixtures_s: dict[pytest.FixtureDef[object], float] = {}
_measured_s: dict[str, float] = {}


def pytest_addoption(parser: pytest.Parser) -> None:
    group = parser.getgroup("durations")
    group.addoption("--quick", action="store_true", help=f"only tests that were measured to take at most {QUICK_S} s")
    group.addoption("--record-durations", action="store_true", help=f"write {FILE.name}")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Mark the slow tests, and leave out what is not quick."""
    seconds = json.loads(FILE.read_bytes()) if FILE.exists() else {}
    for item in items:
        if seconds.get(_name(item.nodeid), 0.0) > SLOW_S:
            item.add_marker("slow")
    if config.getoption("--quick"):
        longer = [item for item in items if _name(item.nodeid) in seconds]
        config.hook.pytest_deselected(items=longer)
        items[:] = [item for item in items if _name(item.nodeid) not in seconds]


@pytest.hookimpl(wrapper=True)
def pytest_fixture_setup(fixturedef: pytest.FixtureDef[object]) -> Generator[None, object, object]:
    begin = time.perf_counter()
    try:
        return (yield)
    finally:
        _fixtures_s[fixturedef] = time.perf_counter() - begin


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(
    item: pytest.Item, call: pytest.CallInfo[None]
) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Hand the test's time to the process that writes the file, which may be another."""
    if call.when == "call" and isinstance(item, pytest.Function):
        definitions = item._fixtureinfo.name2fixturedefs.values()
        made = sum(_fixtures_s.get(one[-1], 0.0) for one in definitions)
        item.user_properties.append(("seconds", call.duration + made))
    return (yield)


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    if report.when == "call":
        name, seconds = _name(report.nodeid), dict(report.user_properties).get("seconds")
        if isinstance(seconds, float):
            _measured_s[name] = max(seconds, _measured_s.get(name, 0.0))


def pytest_sessionfinish(session: pytest.Session) -> None:
    if session.config.getoption("--record-durations") and not hasattr(session.config, "workerinput"):
        longer = {name: round(seconds, 1) for name, seconds in sorted(_measured_s.items()) if seconds > QUICK_S}
        FILE.write_text(json.dumps(longer, indent=1) + "\n")


def _name(nodeid: str) -> str:
    """The test function of an item, without its case."""
    return nodeid.partition("[")[0]
