"""Built-in agents that are made of files besides their code, and users' own checkpoints for them.

A copy of the package gets one more built-in agent, which waits as many seconds as its weights say.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import levels
import pytest

import hthor

TINY = '''
"""Waits as long as its weights say."""

import json
from pathlib import Path

from hthor.types import Action, Wait


class Agent:
    ingredients = ("tiny/weights.json",)

    def __init__(self, checkpoint: str = "", longer: float = 0.0):
        self.place, self.longer = Path(checkpoint or Path(__file__).with_name("tiny")), longer

    def begin(self, briefing):
        self.seconds = json.loads((self.place / "weights.json").read_text()) + self.longer

    def act(self, observation):
        return Action(motion=Wait(seconds=self.seconds))
'''
SCRIPT = """
import json
import guest_agents
from hthor.errors import HthorError
from hthor.trials import robot_team
from hthor.guest import Guest, GuestConfig
from hthor.guest.agent.inputs import parse_inputs

def identity(text, *args):
    try:
        info = robot_team.load_agent_info(text, GuestConfig(isolation="L1", inputs=parse_inputs(args)))
    except HthorError as error:
        return {"error": str(error)}
    files = [file.path for file in info.manifest.files] if info.manifest else []
    return {"name": info.ref.name, "source": info.ref.source, "sha256": info.ref.sha256, "files": files}

def waits(text, level):
    with Guest(text, config=GuestConfig(isolation=level)) as guest:
        guest.begin(guest_agents.BRIEFING)
        return guest.act(guest_agents.look()).motion.seconds
"""


@pytest.fixture(scope="module")
def copy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a copy of the package that has the agent ``tiny``, and a user's weights in ``own``."""
    folder = tmp_path_factory.mktemp("copy")
    ignored = shutil.ignore_patterns("__pycache__")
    shutil.copytree(Path(hthor.__file__).parent, folder / "hthor", ignore=ignored)
    (folder / "hthor/agents/tiny.py").write_text(TINY)
    for place, seconds in (("hthor/agents/tiny", 0.5), ("own", 2.0)):
        (folder / place).mkdir()
        (folder / place / "weights.json").write_text(str(seconds))
    return folder


def run(copy: Path, *lines: str) -> list[Any]:
    """The values of these expressions in the copy."""
    code = f"{SCRIPT}\nprint(json.dumps([{', '.join(lines)}]))"
    tests = Path(__file__).parents[1]
    paths = os.pathsep.join(map(str, (copy, tests.parent, tests / "support")))
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=copy,
        env={**os.environ, "PYTHONPATH": paths},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    found: list[Any] = json.loads(done.stdout)
    return found


def test_the_files_of_a_built_in_agent_are_part_of_its_identity(copy: Path) -> None:
    weights = copy / "hthor/agents/tiny/weights.json"
    (before,) = run(copy, "identity('tiny')")
    assert (before["name"], before["source"], before["files"]) == ("tiny", "hthor.agents.tiny", [])
    kept = weights.read_text()
    try:
        weights.write_text("0.75")
        (changed,) = run(copy, "identity('tiny')")
        weights.unlink()
        (missing,) = run(copy, "identity('tiny')")
    finally:
        weights.write_text(kept)
    assert changed["sha256"] != before["sha256"]
    assert "weights.json of the built-in agent 'tiny' cannot be read" in missing["error"]
    assert run(copy, "identity('tiny')") == [before]


def test_a_checkpoint_of_the_user_s_own_makes_an_agent_of_its_own(copy: Path) -> None:
    shipped, own, same, unknown, absent, empty, frontier = run(
        copy,
        "identity('tiny')",
        "identity('tiny:own')",
        "identity('tiny', 'checkpoint=./own')",
        "identity('tiny', 'chekpoint=./own')",
        "identity('tiny:nowhere')",
        "identity('tiny:')",
        "identity('frontier', 'checkpoint=./own')",
    )
    assert (own["name"], own["source"]) == ("tiny-own", "tiny:own")
    assert {"tiny.py", "../own/weights.json"} <= set(own["files"])
    assert same["name"] == "tiny-checkpoint-own"
    assert "../own/weights.json" in same["files"]
    assert len({shipped["sha256"], own["sha256"], same["sha256"]}) == 3
    assert "Did you mean 'checkpoint'" in unknown["error"]
    assert "there is no file or folder 'nowhere'" in absent["error"]
    assert "Write tiny:CHECKPOINT, or tiny for its own" in empty["error"]
    assert frontier["name"] == "frontier"


@pytest.mark.parametrize("level", levels.EVERY)
def test_weights_travel_into_isolation(copy: Path, level: str) -> None:
    levels.need(level)
    assert run(copy, f"waits('tiny:own', '{level}')", f"waits('tiny:', '{level}')") == [2.0, 0.5]
