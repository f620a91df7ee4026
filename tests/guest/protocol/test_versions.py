"""An agent of another version of the protocol learns, before its first trial, what to change."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import pytest

from hthor.errors import AgentError
from hthor.guest import Guest, GuestConfig
from hthor.guest.protocol import versions, wire
from hthor.types import Action, Drive, Reply, Send
from tests.support.guest_agents import BRIEFING, HEAD, agent, look

ROOT = Path(__file__).resolve().parents[3]
PROGRAM = (ROOT / "examples" / "wire_agent.py").read_text()
CHANGED = ('"confirmed"', '"accepted"', "`teammates`", "`inbox`", "`head`", "`drive`", "docs/wire.md#changes")


def old_program(tmp_path: Path, ready: str) -> str:
    """The example as it was made for another version."""
    path = tmp_path / "old_agent.py"
    path.write_text(PROGRAM.replace('"wire": 2, ', ready))
    assert PROGRAM.count('"wire": 2, ') == 1
    return f"cmd:{sys.executable} {path}"


@pytest.mark.parametrize("ready", ["", '"wire": 1, '])
def test_an_agent_of_the_first_version_is_told_what_to_change(ready: str, tmp_path: Path) -> None:
    with Guest(old_program(tmp_path, ready), config=GuestConfig(isolation="L1")) as guest:
        with pytest.raises(AgentError) as caught:
            guest.load()
        said = str(caught.value)
        assert "uses version 1 of the protocol (as every agent does whose `ready` has no `wire`), but this" in said
        assert not [word for word in (*CHANGED, f'"wire": {versions.VERSION}') if word not in said]
        assert "agent serve" not in said
        assert guest.pid == 0, "it must not run on"


def test_a_newer_agent_is_refused_with_a_reason(tmp_path: Path) -> None:
    told = r"uses version 99 of the protocol, but .* up to 2: update hthor here, or"
    guest = Guest(old_program(tmp_path, '"wire": 99, '), config=GuestConfig(isolation="L1"))
    with pytest.raises(AgentError, match=told):
        guest.begin(BRIEFING)


def test_a_server_that_speaks_an_old_version_only_needs_a_new_hthor() -> None:
    assert "only hthor has to be updated there" in versions.describe_mismatch(1, served=True)
    assert versions.describe_mismatch(versions.VERSION) == ""


def test_the_page_tells_what_has_changed() -> None:
    page = (ROOT / "docs" / "wire.md").read_text()
    _, _, changes = page.partition("\n## Changes\n")
    assert not [word for word in CHANGED[:-1] if word.strip('"') not in changes]
    assert f"`wire` = {versions.UNSTATED} |" in page
    assert f"version {versions.VERSION}" in page


def test_a_python_agent_needs_nothing(tmp_path: Path) -> None:
    path = tmp_path / "my_agent.py"
    path.write_text(HEAD + agent("return Action(motion=Drive(forward=0.4, yaw=1.0))"))
    with Guest(path) as guest:
        guest.begin(BRIEFING)
        assert guest.act(look()).motion == Drive(forward=0.4, yaw=1.0)


@pytest.mark.parametrize(
    ("action", "kind", "field"),
    [
        (Action(motion=Drive(forward=float("nan"))), "not_finite", "Drive.forward"),
        (Action(motion=Drive(left=float("-inf"))), "not_finite", "Drive.left"),
        (Action(motion=Drive(yaw=1.1e12)), "garbage", "Drive.yaw"),
        (Action(motion=Drive(pitch=-2e300)), "garbage", "Drive.pitch"),
        (Action(say=Send(text="", answers=2**62)), "garbage", "Send.answers"),
        (Action(say=Reply(message=-(2**62), accept=True)), "garbage", "Reply.message"),
        (Action(say=Send(text="", to="x" * 300)), "oversized", "Send.to"),
    ],
)
def test_numbers_of_the_new_fields_are_checked(action: Action, kind: str, field: str) -> None:
    found = wire.find_action_fault(action)
    assert found is not None
    assert (found[0], found[1].partition(" ")[0]) == (kind, field)


def test_what_is_within_the_limits_is_taken() -> None:
    drive = Drive(forward=1e12, left=-1e12, yaw=100.0, pitch=-9.0)
    say = Send(text="x" * 9000, to="human2", question=True, answers=0)
    assert wire.find_action_fault(Action(motion=drive, say=say)) is None


def test_every_version_says_what_it_changed() -> None:
    for version in range(versions.UNSTATED, versions.VERSION):
        assert re.search(r"What has changed: \S+ .*\. Adapt", versions.describe_mismatch(version))
