"""The page about the simulator by hand is true: its examples do what it shows, and every call it names is there."""

from __future__ import annotations

import doctest
import re
from pathlib import Path

import pages
import pytest

from hthor.world import World
from hthor.world.actor import Actor

FAMILIES = (
    "Environment configuration",
    "Agent control",
    "Perception and monitoring",
    "Communication",
)


@pytest.fixture(scope="module")
def page(root: Path) -> str:
    return (root / "docs" / "simulator.md").read_text(encoding="utf-8")


def section(page: str, title: str) -> str:
    return re.split(r"^## ", page.split(f"\n## {title}\n", 1)[1], maxsplit=1, flags=re.MULTILINE)[0]


def calls(page: str, title: str) -> list[tuple[str, str]]:
    """(owner, name) of every call in a section's table: "world" or "actor", and the method or attribute."""
    found = []
    for row in re.findall(r"^\| (`.*?) \|", section(page, title), flags=re.MULTILINE):
        owner = ""
        for code in re.findall(r"`([^`]+)`", row):
            whole, name = re.match(r"(\w*)\.?(\w*)", code).groups()
            if whole == "World":
                found.append(("world", name or "__init__"))
                continue
            owner = whole or owner
            found.append((owner, name))
    return list(dict.fromkeys(found))


def test_the_page_s_examples_do_what_it_shows(page: str) -> None:
    code = pages.only_code(page)
    test = doctest.DocTestParser().get_doctest(code, {}, "simulator.md", "docs/simulator.md", 0)
    assert len(test.examples) >= 70
    assert page.count("```python") == len(re.findall(r"```python\n>>> ", page)), "a block that nobody runs"
    words: list[str] = []
    runner = doctest.DocTestRunner(verbose=False)
    result = runner.run(test, out=words.append)
    assert result.failed == 0, "".join(words)


@pytest.mark.parametrize("title", FAMILIES)
def test_every_call_of_a_table_is_there_and_shown(page: str, title: str) -> None:
    listed, shown = calls(page, title), pages.only_code(page)
    assert len(listed) >= 5
    for owner, name in listed:
        kind = {"world": World, "actor": Actor}[owner]
        thing = kind if name == "__init__" else getattr(kind, name, None)
        assert thing is not None or re.search(rf"^        {name}: ", kind.__doc__, re.MULTILINE), f"no {owner}.{name}"
        assert thing is None or thing.__doc__, f"{owner}.{name} says nothing of what it does"
        if name != "__init__":
            assert re.search(rf"\.{name}\b", shown), f"no example calls {owner}.{name}"


def test_there_are_two_dozen_calls_in_four_families(page: str) -> None:
    every = [call for title in FAMILIES for call in calls(page, title)]
    assert len(every) == len(set(every))
    assert len(every) >= 24


def test_nothing_public_of_a_body_is_missing_from_the_page(page: str) -> None:
    listed = {name for title in FAMILIES for owner, name in calls(page, title) if owner == "actor"}
    assert listed == {name for kind in Actor.__mro__[:-1] for name in vars(kind) if not name.startswith("_")}
