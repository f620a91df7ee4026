"""The page about Gymnasium: its code runs, and its tables are complete."""

from __future__ import annotations

import doctest
from pathlib import Path

import pages
import pytest

pytest.importorskip("gymnasium", reason="needs the extra learn")
pytest.importorskip("pettingzoo", reason="needs the extra learn")

from hthor.agents.skills.learner.state import state_fields
from hthor.envs import AssistEnv


@pytest.fixture(scope="module")
def page(root: Path) -> str:
    return (root / "docs" / "gymnasium.md").read_text(encoding="utf-8")


def test_its_code_runs(page: str) -> None:
    test = doctest.DocTestParser().get_doctest(pages.only_code(page), {}, "gymnasium.md", "docs/gymnasium.md", 0)
    assert len(test.examples) > 20
    words: list[str] = []
    assert doctest.DocTestRunner(verbose=False).run(test, out=words.append).failed == 0, "".join(words)


def test_its_tables_have_every_field_and_action(page: str) -> None:
    for field in state_fields(1):
        name = field.name.replace(" 1", " N")
        assert f"| `{name}` | {field.stop - field.start} |" in page
    for action in AssistEnv(robot="tender").actions:
        assert f"`{action.replace(' 1', ' N')}`" in page
