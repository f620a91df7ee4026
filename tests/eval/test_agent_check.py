"""`hthor agent check` finds what breaks the contract, says where and what to do, and passes what `agent new` writes."""

from __future__ import annotations

import json
import math
import sys
from pathlib import Path
from typing import Any

import pytest

from hthor import cli
from hthor.errors import HthorError
from hthor.eval.agent_check import checks, criteria

pytestmark = pytest.mark.usefixtures("no_workers")

HEAD = "import random, time\nfrom hthor.types import *\n"
AGENTS = {
    "raises": (
        "class Agent:\n    def begin(self, briefing):\n        self.steps = 0\n    def act(self, observation):\n"
        "        self.steps += 1\n        if self.steps > 9:\n            return {}['where']\n"
        "        return Action(motion=Rotate(yaw=0.5))\n",
        {"acts": ("broken", "KeyError: 'where'")},
    ),
    "fails at once": (
        "class Agent:\n    def begin(self, briefing): ...\n    def act(self, observation):\n        return None\n",
        {"begins": ("ok", ""), "acts": ("broken", "wrong_type, step 1, after 0.0 s")},
    ),
    "leaks": (
        "class Agent:\n    persistent = True\n    trials = 0\n    def begin(self, briefing):\n"
        "        Agent.trials += 1\n"
        "    def act(self, observation):\n        return Action(motion=Rotate(yaw=0.1 * Agent.trials))\n",
        {"deterministic": ("ok", ""), "keeps nothing": ("broken", "differs at step 1 (tick 0)")},
    ),
    "gambles": (
        "class Agent:\n    def begin(self, briefing):\n        self.dice = random.SystemRandom()\n"
        "    def act(self, observation):\n        return Action(motion=Rotate(yaw=self.dice.random()))\n",
        {"deterministic": ("broken", "differs at step 1 (tick 0)")},
    ),
    "boasts": (
        "class Agent:\n    def begin(self, briefing):\n        self.target = briefing.target\n"
        "    def act(self, observation):\n        print('thinking ' * 100)\n"
        "        say = Send(text='here', object=self.target) if observation.tick == 50 else None\n"
        "        return Action(say=say)\n",
        {"acts": ("ok", "all legal"), "deterministic": ("ok", "every byte the same"), "keeps nothing": ("ok", "")},
    ),
    "spams": (
        "class Agent:\n    def begin(self, briefing):\n        self.target = briefing.target\n"
        "    def act(self, observation):\n        return Action(say=Send(text='I see it.', object=self.target))\n",
        {"acts": ("ok", ""), "fast enough": ("ok", " % of the trial's 30 s")},
    ),
    "stands": (
        "class Agent:\n    def begin(self, briefing): ...\n    def act(self, observation):\n"
        "        return Action(motion=Rotate(yaw=0.5))\n",
        {"acts": ("ok", "")},
    ),
    "does not load": (
        "class Agent:\n    def begin(self):\n",
        {"loads": ("broken", "agent.py:4"), "acts": ("skipped", "")},
    ),
}


@pytest.fixture
def check(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Any:
    def run(*words: object) -> tuple[int, str]:
        monkeypatch.setattr(sys, "argv", ["hthor", "agent", *map(str, words)])
        try:
            cli.main()
            code = 0
        except SystemExit as end:
            code = int(end.code or 0)
        return code, capsys.readouterr().out

    monkeypatch.setenv("COLUMNS", "200")
    for slow in ("_SLOW_LOAD_S", "_SLOW_BEGIN_S"):  # on a busy machine everything is slow
        monkeypatch.setattr(criteria, slow, math.inf)
    return run


def test_what_agent_new_writes_is_sound(check: Any, tmp_path: Path) -> None:
    assert check("new", tmp_path / "mine.py")[0] == 0
    code, out = check("check", tmp_path / "mine.py")
    assert code == 0, out
    assert "sound    next:  hthor eval --agent" in out
    assert "broken" not in out
    assert "warning" not in out


def test_the_agent_of_the_readme_is_sound_and_warned_of_nothing(check: Any, root: Path) -> None:
    """The one that the README shows is the one in examples/."""
    file = root / "examples" / "wanderer.py"
    blocks = (root / "README.md").read_text(encoding="utf-8").split("```python\n")[1:]
    assert any(file.read_text(encoding="utf-8").endswith(block.partition("```")[0]) for block in blocks)
    code, out = check("check", file)
    assert code == 0, out
    assert "broken" not in out
    assert "warning" not in out


def test_a_program_is_checked_like_a_file(check: Any) -> None:
    words = f"cmd:{sys.executable} {Path(__file__).parents[2] / 'examples' / 'wire_agent.py'}"
    code, out = check("check", words)
    assert code == 0, out
    assert f"sound    next:  hthor eval --agent '{words}' --humans proxy" in out


def test_what_ships_needs_no_check() -> None:
    with pytest.raises(HthorError, match="'oracle' ships with hthor"):
        checks.check_agent("oracle")


@pytest.mark.parametrize("name", AGENTS)
def test_each_check_finds_what_it_is_there_for(name: str, check: Any, tmp_path: Path) -> None:
    body, expected = AGENTS[name]
    (tmp_path / "agent.py").write_text(HEAD + body)
    code, out = check("check", tmp_path / "agent.py", "--json")
    report = json.loads(out)
    found = {one["check"]: one for one in report["findings"]}
    for what, (status, told) in expected.items():
        assert (found[what]["status"], told in found[what]["told"]) == (status, True), found[what]
        assert bool(found[what]["advice"]) == (status == "broken")
    broken = any(status == "broken" for status, _ in expected.values())
    assert (code, report["sound"]) == ((4, False) if broken else (0, True))
    notes = "; ".join(one["told"] for one in report["findings"] if one["check"] == "note")
    if name == "spams":
        assert "messages in 30 s: " in notes
        assert "covered by the next one" in notes
        assert "the same as the one before" in notes
    if name == "stands":
        assert "it stood on one spot for 30 of 30 s; it never sent a message" in notes
    if name == "boasts":
        assert "it prints much; it never moved; 2 of 2 messages" in notes
        assert report["isolation"]["level"] in ("L1", "L2", "L3")
        assert 0 < report["figures"]["step_ms_median"] <= report["figures"]["step_ms_p99"]
        assert report["figures"]["memory_mb"] > 5
