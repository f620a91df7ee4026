"""Every form of agent is read by one reader; a program in any language is held and judged like a Python agent."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import levels
import numpy as np
import pytest
from msgspec import structs

from hthor import guest
from hthor.errors import AgentError, UnknownName
from hthor.guest import Guest, GuestConfig, GuestFault, load_info
from hthor.guest.agent import manifest, reference
from hthor.guest.confinement import paths
from hthor.guest.protocol import wire
from hthor.types import (
    Action,
    BodySpec,
    Briefing,
    Camera,
    Close,
    Detection,
    Drive,
    Drop,
    Job,
    Message,
    Move,
    Observation,
    Open,
    Outcome,
    Pick,
    Place,
    Pose,
    Receipt,
    Rotate,
    Scan,
    Send,
    ThingState,
    Wait,
)
from tests.support.guest_agents import BRIEFING, HEAD, Sensors, agent, living, look

PACKAGE = Path(guest.__file__).parents[1]
EXAMPLES = Path(__file__).resolve().parents[2] / "examples"


RECORDS = (Briefing, BodySpec, Job, Observation, Outcome, Receipt, Message, ThingState, Detection, Scan, Camera, Pose)
MESSAGES = (wire.Ready, wire.Begin, wire.Done, wire.Look, wire.Ask, wire.Given, wire.Acted, wire.Failed, wire.End)
ACTIONS = (Action, Move, Rotate, Pick, Place, Drop, Open, Close, Wait, Drive, Send)


class Walled(Sensors):
    """Something is close on every side."""

    def scan(self) -> Scan:
        return structs.replace(super().scan(), ranges=np.full(61, 0.2))


def at(level: str) -> str:
    levels.need(level)
    return level


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("frontir", "unknown agent 'frontir'. Did you mean 'frontier'?"),
        ("my_agent", "Did you mean 'my_agent.py'?"),
        ("my_agent.py::Agent", "Did you mean 'my_agent.py:Agent'?"),
        ("some.package", "Did you mean 'some.package:Agent'?"),
        ("no_such_module:Agent", "there is no module 'no_such_module'"),
        ("command:perl x.pl", "Did you mean 'cmd:perl x.pl'?"),
        ("cmd:", "names no program"),
        ("cmd:'perl", "No closing quotation"),
        ("cmd:no-such-program x", "the program 'no-such-program' was not found"),
        ("cmd:./my_agent.py", "is not executable"),
        ("http://gpu:8765", "Did you mean 'ws://gpu:8765'?"),
        ("ws://gpu", "Did you mean 'ws://gpu:PORT'?"),
        ("ws://gpu:port", "Did you mean 'ws://gpu:PORT'?"),
        ("ws://me:secret@gpu:1", "without user, password"),
    ],
)
def test_a_wrong_form_is_answered_by_the_right_one(
    text: str, told: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("my_agent.py").touch()
    with pytest.raises((UnknownName, AgentError)) as caught:
        reference.parse_reference(text)
    assert told in str(caught.value)
    if isinstance(caught.value, UnknownName):
        assert "cmd:PROGRAM ARGS, ws://HOST:PORT[/PATH]" in str(caught.value)


def test_a_reference_means_the_same_in_every_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("my_agent.py").write_text("x = 1\n")
    Path("tool").write_text("#!/usr/bin/env -S perl -w\nexit 0;\n")
    Path("tool").chmod(0o755)
    texts = ("my_agent.py:Agent", "cmd:./tool --fast", "cmd:perl my_agent.py", "ws://gpu:8765/frontier")
    read = [reference.parse_reference(text) for text in texts]
    assert [one.source for one in read] == [
        "my_agent.py:Agent",
        "cmd:perl -w tool --fast",
        "cmd:perl my_agent.py",
        "ws://gpu:8765/frontier",
    ]
    hashes = [one.sha256 for one in read]
    monkeypatch.chdir("/")
    assert [reference.parse_reference(one.text).sha256 for one in read] == hashes
    (tmp_path / "my_agent.py").write_text("x = 2\n")
    changed = [one.sha256 != before for one, before in zip(read, hashes, strict=True)]
    assert changed == [True, False, True, False]


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "minds").mkdir()
    (tmp_path / "minds" / "__init__.py").touch()
    (tmp_path / "minds" / "speed.py").write_text("FORWARD = 0.25\n")
    (tmp_path / "minds" / "careful.py").write_text(
        f"{HEAD}from minds.speed import FORWARD\n{agent('return Action(motion=Move(forward=FORWARD))')}"
    )
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_module_is_imported_by_its_name(package: Path) -> None:
    with Guest("minds.careful:Agent") as mind:
        info = mind.load()
        for _ in range(2):
            mind.begin(BRIEFING)
            assert mind.act(look()) == Action(motion=Move(forward=0.25))
    assert (info.name, info.source) == ("minds.careful:Agent", "minds.careful:Agent")
    assert info.sha256 == manifest.file_sha256(package / "minds" / "careful.py")
    assert "minds" not in sys.modules
    with pytest.raises(AgentError, match="no agent class 'Brave'"):
        load_info("minds.careful:Brave")


def test_a_module_that_hides_behind_another_is_refused(package: Path) -> None:
    (package / "minds" / "__init__.py").write_text(
        "import sys\nimport minds.speed\nsys.modules['minds.careful'] = minds.speed\n"
    )
    with pytest.raises(AgentError, match=r"another file of this name was imported.*speed\.py"):
        load_info("minds.careful:Agent")


@pytest.mark.parametrize("level", levels.EVERY)
@pytest.mark.parametrize("words", [f"{sys.executable} wire_agent.py", "perl wire_agent.pl"], ids=["python", "perl"])
def test_the_examples_of_the_wire_play(level: str, words: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(EXAMPLES)
    with Guest(f"cmd:{words}", config=GuestConfig(isolation=at(level))) as mind:
        assert mind.load().isolation.level == level
        for _ in range(2):
            mind.begin(BRIEFING)
            action = mind.act(look())
            assert action.motion == Move(forward=0.3)
            assert mind.act(look(1, Walled())).motion == Rotate(yaw=0.7)


@pytest.mark.parametrize("words", [f"{sys.executable} wire_agent.py", "perl wire_agent.pl"], ids=["python", "perl"])
def test_the_examples_of_the_wire_answer_what_they_know(words: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(EXAMPLES)
    by_kind = Message(id=3, sender="human2", tick=1, text="Where is it?", object="apple", to="robot", question=True)
    in_words = structs.replace(by_kind, object="", text="Where is the APPLE, please?")
    with Guest(f"cmd:{words}", config=GuestConfig(isolation="L1")) as mind:
        mind.begin(BRIEFING)
        for question in (by_kind, in_words):
            action = mind.act(look(0, inbox=(question,)))
            answer = Send(text="I saw the apple there.", object="apple", position=(1.0, 2.0, 0.8), answers=3)
            assert (action.motion, action.say) == (Move(forward=0.3), answer)
        mug = structs.replace(by_kind, object="mug", text="Where is the mug? Not the apple.")
        no_question = structs.replace(by_kind, question=False)
        said = mind.act(look(1, inbox=(mug, no_question), receipt=Receipt(message=0, status="sent", tick=0))).say
        assert said is None


@pytest.mark.parametrize("record", [*RECORDS, *MESSAGES, *ACTIONS])
def test_the_page_of_the_wire_leaves_nothing_out(record: Any) -> None:
    page = (EXAMPLES.parent / "docs" / "wire.md").read_text()
    tags = [record.__struct_config__.tag] if record.__struct_config__.tag else []
    missing = [name for name in (*tags, *record.__struct_fields__) if f"`{name}`" not in page]
    assert not missing


PERL = (EXAMPLES / "wire_agent.pl").read_text().partition("say_it({ type => 'ready'")[0]


@pytest.fixture
def perl(tmp_path: Path) -> Callable[[str, str], str]:
    """A command whose program does something in its first look."""

    def write(act: str, ready: str = "") -> str:
        path = tmp_path / "home" / "agent.pl"
        path.parent.mkdir(exist_ok=True)
        path.write_text(
            PERL
            + f"my $looks = 0;\nsay_it({{ type => 'ready', wire => \\2{ready} }});\n"
            + "while ((my $message = hear())->{type} ne 'end') {\n"
            + "  if ($message->{type} eq 'begin') { say_it({ type => 'done' }); next }\n"
            + f"  $looks += 1;\n  {act}\n"
            + "  my $wait = { type => 'wait', seconds => \\($looks * 1.0) };\n"
            + "  say_it({ type => 'acted', action => { motion => $wait } });\n}\n"
        )
        return f"cmd:perl {path}"

    return write


@pytest.mark.parametrize("level", levels.CONFINED)
def test_a_hostile_program_comes_to_nothing(level: str, perl: Callable[..., str], tmp_path: Path) -> None:
    (tmp_path / "salt.txt").write_text("pepper")
    attacks = {
        "fork": "defined(my $pid = fork) and die 'BREACH';",
        "exec": "{ no warnings; exec '/bin/true'; }",
        "system": "system('true') == 0 and die 'BREACH';",
        "the word is not known": "my $true = '/bin/true'; syscall(59, $true, 0, 0, 1, 2, 3) == 0 and die 'BREACH';",
        "socket": "socket(my $s, 2, 1, 0) and die 'BREACH';",
        "read": f"open(my $f, '<', '{tmp_path}/salt.txt') and die 'BREACH';",
        "read a suite": f"open(my $f, '<', '{PACKAGE}/tasks/suites/smoke.json') and die 'BREACH';",
        "write at home": f"open(my $f, '>', '{tmp_path}/home/x') and die 'BREACH';",
        "signal": "kill(0, getppid()) and die 'BREACH';",
        "environment": "exists $ENV{HTHOR_SALT} and die 'BREACH';",
        "scratch": "open(my $f, '>', \"$ENV{TMPDIR}/x\") or die 'no scratch folder';",
    }
    with Guest(perl("\n".join(attacks.values())), config=GuestConfig(isolation=at(level))) as mind:
        mind.begin(BRIEFING)
        assert mind.act(look()) == Action(motion=Wait(seconds=1.0)), mind.log


@pytest.mark.parametrize(
    ("act", "kind", "told"),
    [
        ("sleep 60;", "timeout", "no answer within"),
        ("print 'x' x 100000;", "oversized", "2021161080 bytes"),
        ("print pack('V/a*', 'hello');", "garbage", "not a message"),
        ("say_it({ type => 'done' });", "garbage", "answered by Done"),
        ("say_it({ type => 'ask', what => 'walls' });", "garbage", "'walls'"),
        ("say_it({ type => 'failed', kind => 'glory', detail => 'x' });", "garbage", "x"),
        ("say_it({ type => 'failed', kind => 'raised', detail => 'out of ideas' });", "raised", "out of ideas"),
        ("exit 3;", "died", "status 3"),
        ("exit 0;", "died", "ended before it had answered act"),
        ("kill 'SEGV', $$;", "died", "SIGSEGV"),
        ("print STDERR 'la' x 1000000; die 'enough';", "died", "status"),
    ],
)
def test_every_misdeed_of_a_program_is_a_fault(perl: Callable[..., str], act: str, kind: str, told: str) -> None:
    with Guest(perl(f"{act}"), step_s=0.5, bank_s=0.0) as mind:
        mind.begin(BRIEFING)
        with pytest.raises(GuestFault) as caught:
            mind.act(look())
        assert (caught.value.kind, told in str(caught.value)) == (kind, True), str(caught.value)
        assert len(caught.value.log) <= 16 << 10
        mind.begin(BRIEFING)


def test_a_program_leaves_nothing_behind_where_it_may_fork(perl: Callable[..., str]) -> None:
    with Guest(perl("if (!fork) { setpgrp; sleep 600 }"), config=GuestConfig(isolation="L1")) as mind:
        mind.begin(BRIEFING)
        mind.act(look())
        group = mind._process.pid if mind._process else 0
        mind.begin(BRIEFING)
        assert mind.act(look()) == Action(motion=Wait(seconds=1.0))
    assert not living(group)


@pytest.mark.parametrize("persistent", [False, True])
def test_a_program_has_a_process_a_trial_unless_it_says_otherwise(perl: Callable[..., str], persistent: bool) -> None:
    ended = "if ($message->{type} eq 'end') { next }"
    text = perl("")
    path = Path(text.split()[-1])
    if persistent:
        source = path.read_text().replace("'ready', ", "'ready', persistent => 'YES', ")
        source = source.replace(
            "return pack('CN/a*', 0xdb, $value);", "return $value eq 'YES' ? \"\\xc3\" : pack('CN/a*', 0xdb, $value);"
        )
        source = source.replace(
            "while ((my $message = hear())->{type} ne 'end') {", f"while (my $message = hear()) {{ {ended}"
        )
        path.write_text(source)
    with Guest(text) as mind:
        assert mind.load().persistent is persistent
        for _ in range(2):
            mind.begin(BRIEFING)
            last: Any = mind.act(look()).motion
        assert last.seconds == (2.0 if persistent else 1.0)


def test_an_agent_that_asks_for_gpus_gets_what_there_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(paths, "gpu_devices", lambda: ("/dev/null",))
    monkeypatch.setenv("CUDA_VISIBLE_DEVICES", "3")
    path = tmp_path / "my_agent.py"
    act = "print('sees', os.environ.get('CUDA_VISIBLE_DEVICES'))\nreturn Action()"
    for asks, seen in (("", "sees None"), ("gpus = 0.5", "sees 3")):
        path.write_text(HEAD + agent(act).replace("class Agent:", f"class Agent:\n    {asks or 'pass'}"))
        with Guest(path) as mind:
            assert mind.load().gpus == (0.5 if asks else 0.0)
            mind.begin(BRIEFING)
            mind.act(look())
            assert seen in mind.log
