"""Agents given as classes: their word for the command line, and the file of a class that is in none."""

from __future__ import annotations

import linecache
import sys
from pathlib import Path
from types import ModuleType

import pytest

from hthor.agents import frontier, silent
from hthor.api.agent_class import agent_word
from hthor.errors import AgentError


@pytest.fixture
def cells(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    """Runs cells of a notebook, as it would: each is a file of its own in the memory of its lines."""
    main = ModuleType("__main__")
    monkeypatch.setitem(sys.modules, "__main__", main)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    count = 0

    def run(*texts: str) -> ModuleType:
        nonlocal count
        for text in texts:
            count += 1
            name = f"<cell {count}>"
            monkeypatch.setitem(linecache.cache, name, (len(text), None, text.splitlines(keepends=True), name))
            exec(compile(text, name, "exec"), vars(main))
        return main

    return run


AGENT = """
class Walker:
    def begin(self, briefing):
        self.steps = 0

    def act(self, now):
        return {}
"""


def _loaded(word: str) -> dict[str, object]:
    space: dict[str, object] = {"__name__": "written"}
    exec(Path(word).read_text(), space)
    return space


def test_words_and_files_stay_as_they_are():
    assert agent_word("cmd:node x.js") == "cmd:node x.js"
    assert agent_word(Path("a/x.py")) == "a/x.py"


def test_a_class_of_a_module_is_named_by_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    assert agent_word(frontier.Agent) == "frontier"
    assert agent_word(silent.Agent) == "none"
    (tmp_path / "mine_here.py").write_text(AGENT.format("1"))
    monkeypatch.syspath_prepend(str(tmp_path))
    import mine_here

    assert agent_word(mine_here.Walker) == f"{tmp_path}/mine_here.py:Walker"
    monkeypatch.delitem(sys.modules, "mine_here")


def test_a_class_of_a_notebook_becomes_a_file_with_all_that_it_uses(cells):
    main = cells(
        "import math\nimport os.path as places\nfrom collections import OrderedDict as Kept\nSIZES = {'a': (1, 2.5)}\n",
        "def half(x):\n    return other(x) / 2\n\ndef other(x):\n    return half if x is None else SIZES['a'][1] * x\n",
        "class Base:\n    def begin(self, briefing):\n        self.kept = Kept()\n",
        "import functools\n\n@functools.total_ordering\nclass Walker(Base):\n    unused = 1\n\n"
        "    def __lt__(self, x):\n        return False\n\n    def act(self, now):\n        size = math.pi\n"
        "        return half(3), places.sep, size\n",
        "size = object()\n",
    )
    word = agent_word(main.Walker)
    space = _loaded(word)
    walker = space["Agent"]
    assert walker is space["Walker"]
    one = walker()  # type: ignore[operator]
    one.begin(None)
    assert one.act(None) == main.Walker().act(None)
    assert not (one < one)
    assert "size = object" not in Path(word).read_text()
    assert agent_word(main.Walker) == word, "the same sources are the same agent"


def test_another_source_is_another_file(cells):
    first = agent_word(cells("STEP = 1\n", AGENT.replace("{}", "STEP")).Walker)
    second = agent_word(cells("STEP = 2\n").Walker)
    third = agent_word(cells(AGENT.replace("{}", "STEP + 1")).Walker)
    assert len({first, second, third}) == 3
    assert [_loaded(word)["STEP"] for word in (first, second, third)] == [1, 2, 2]
    assert {Path(word).name for word in (first, second, third)} == {"Walker.py"}


@pytest.mark.parametrize(
    ("before", "words"),
    [
        ("USED = object()", "agent Walker uses 'USED', an object of the type object.*agent_args"),
        ("USED = [float('inf')]", "agent Walker uses 'USED', an object of the type list"),
        ("USED = open", None),
        ("USED = len", None),
    ],
)
def test_what_cannot_be_written_is_told_with_its_name(cells, before: str, words: str | None):
    main = cells(before, AGENT.replace("{}", "USED"))
    if words is None:
        assert _loaded(agent_word(main.Walker))["USED"] is main.USED
        return
    with pytest.raises(AgentError, match=words):
        agent_word(main.Walker)


def test_what_is_no_class_of_its_own_is_told(cells):
    main = cells("def make():\n    class Inner:\n        def act(self, now): ...\n    return Inner\n")
    with pytest.raises(AgentError, match="define the class at the top level"):
        agent_word(main.make())
    bare = type("Bare", (), {"__module__": "__main__"})
    with pytest.raises(AgentError, match="Bare: the source that defines it was not found"):
        agent_word(bare)
    with pytest.raises(AgentError, match="give the class Walker, not an object of it"):
        agent_word(cells(AGENT).Walker())
