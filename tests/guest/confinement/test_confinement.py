"""What a guest may read is listed so that nothing secret is on the list; the filter is sound for its one machine."""

from __future__ import annotations

import functools
import struct
import subprocess
import sys
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from law_cases import cases
from msgspec.structs import replace

from hthor.errors import UnknownName
from hthor.guest.confinement import (
    LEVELS,
    SERVED,
    Policy,
    calls,
    check_level,
    namespaces,
    paths,
    seccomp,
    suffices,
)


def covered(path: Path, allowed: tuple[str, ...]) -> bool:
    """Whether a rule for one of these reaches a file."""
    real = path.resolve()
    return not {real, *real.parents}.isdisjoint(_resolved(allowed))


@functools.cache
def _resolved(allowed: tuple[str, ...]) -> frozenset[Path]:
    return frozenset(Path(one).resolve() for one in allowed)


@pytest.fixture
def agent(tmp_path: Path) -> Path:
    for name in ("home/agent.py", "home/weights/w.npz", "home/runs/x/trials.jsonl", "home/suite.json", "else/salt.txt"):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("")
    (tmp_path / "home" / "way_out").symlink_to(tmp_path / "else")
    (tmp_path / "home" / "way_in").symlink_to(tmp_path / "home" / "weights")
    return tmp_path / "home" / "agent.py"


def test_an_agent_reads_its_folder_but_for_what_is_hidden(agent: Path) -> None:
    home = agent.parent
    allowed = paths.readable_paths(str(agent), str(home), [str(home / "suite.json")])
    assert covered(agent, allowed)
    assert covered(home / "weights" / "w.npz", allowed)
    for secret in (home / "runs" / "x" / "trials.jsonl", home / "suite.json", home.parent / "else" / "salt.txt"):
        assert not covered(secret, allowed), secret


ROOMS = {"agents", "catalog", "comms", "geometry", "guest", "houses", "navigation", "types"}
"""Folders of this package that agents are made with. Of `houses` neither the houses nor the generator."""
SECRET = ("world", "humans", "tasks", "eval", "report", "calibration", "leaderboard", "looks", "commands")


def test_agents_can_read_only_the_rooms_that_they_are_made_with(agent: Path) -> None:
    allowed = paths.readable_paths(str(agent), str(agent.parent), [])
    ours = [Path(one) for one in allowed if Path(one).is_relative_to(paths.PACKAGE)]
    assert {
        one.relative_to(paths.PACKAGE).parts[0] for one in ours if one.parent != paths.PACKAGE or one.is_dir()
    } == ROOMS
    assert paths.PACKAGE not in ours
    assert paths.PACKAGE / "houses" not in ours
    for room in SECRET:
        for path in (paths.PACKAGE / room).rglob("*"):
            assert not covered(path, allowed), path
    documents = [path for path in paths.PACKAGE.rglob("*.json") if not {"catalog", "agents"} & {*path.parts}]
    assert len(documents) > 10
    for path in [*documents, *(paths.PACKAGE / "houses" / "generator").rglob("*.py")]:
        assert not covered(path, allowed), path


IMPORTED = """
import contextlib, importlib, sys
from hthor.errors import MissingExtra
for name in NAMES:
    with contextlib.suppress(MissingExtra):
        importlib.import_module(name)
print("\\n".join(module.__file__ for name, module in sys.modules.items() if name.partition(".")[0] == "hthor"))
"""


def test_all_that_agents_import_of_this_package_can_be_read(agent: Path) -> None:
    names = [
        ".".join(path.relative_to(paths.PACKAGE.parent).with_suffix("").parts).removesuffix(".__init__")
        for room in ("agents", "navigation", "guest/client", "guest/supervisor", "houses/space", "catalog", "comms")
        for path in sorted((paths.PACKAGE / room).rglob("*.py"))
    ]
    code = IMPORTED.replace("NAMES", repr(names))
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    allowed = paths.readable_paths(str(agent), str(agent.parent), [])
    files = done.stdout.splitlines()
    assert len(files) > len(names)
    for file in files:
        assert covered(Path(file), allowed), file


def test_levels_are_ordered_and_named() -> None:
    assert [suffices(level, "L2") for level in LEVELS] == [False, True, True]
    assert not suffices(SERVED, "L1")
    with pytest.raises(UnknownName, match=r"unknown isolation level 'l2'\. Did you mean 'L2'"):
        check_level("l2")


def verdict(code: bytes, number: int, *values: int, machine: int = 0xC000003E) -> int:
    """What the filter's instructions come to for a call, worked out as the kernel does."""
    data = struct.pack("<IIQ6Q", number, machine, 0, *(*values, 0, 0, 0, 0, 0, 0)[:6])
    lines = list(struct.iter_unpack("<HBBI", code))
    at = word = 0
    while True:
        operation, then, otherwise, value = lines[at]
        at += 1
        if operation == 0x06:
            return int(value)
        if operation == 0x20:
            (word,) = struct.unpack_from("<I", data, value)
            continue
        if operation == 0x54:
            word &= value
            continue
        holds = {0x15: word == value, 0x35: word >= value, 0x45: bool(word & value)}[operation]
        at += then if holds else otherwise


ALLOW, REFUSE, ABSENT, DONE, NO_TERMINAL, KILL = 0x7FFF0000, 0x50001, 0x50026, 0x50000, 0x50019, 0x80000000
CALLS = {
    ALLOW: [
        (0,),
        (1,),
        (9,),
        (53, 1, 0x80801),
        (56, 0x3D0F00),
        (62, 77, 0),
        (62, 77, 14),
        (234, 77, 78, 6),
        (302, 0),
        (302, 77, 7, 0),
        (302, 0, 7, 0x7FFF12345678),
        (302, 0, 0, 0),
        (72, 3, 4),
        (72, 3, 1030),
        (157, 15),
        (327, 3, 1, 1, 0, 0, 0),
        (28, 0, 1, 4),
        (16, 0, 0x5421),
    ],
    REFUSE: [
        (53, 1, 2),
        (53, 1, 5),
        (53, 1, 0x80802),
        (53, 2, 1),
        (56, 0x1200011),
        (62, 76),
        (62, 2**32 - 1),
        *((62, 77, number) for number in (1, 2, 3, 9, 15)),
        *((234, 77, 78, number) for number in (1, 2, 3, 9, 15)),
        (234, 76),
        (302, 5),
        (302, 0, 0, 0x7FFF12345678),
        (302, 77, 0, 0x7FFF00000000),
        (302, 0, 15, 1),
        *((72, 3, command) for command in (8, 10, 15, 1024, 1026, 1031, 1033, 1036, 1038, 1040)),
        (157, 1, 0),
        (157, 4, 0),
    ],
    DONE: [(73, 3, 2), (72, 3, 6), (72, 3, 7), (72, 3, 37), (72, 3, 38), (162,), (221, 3), (28, 0, 1, 21)],
    ABSENT: [(435,), (319,), (27,), (451,)],
    NO_TERMINAL: [(16, 0, 0x5412), (16, 3, 0x40086602), (16, 3, 0x40087602), (16, 3, 0x4004667F)],
    0x5005F: [(327, 3, 1, 1, 0, 0, 8), (285,)],
    KILL: [(0x40000000 | 39,)],
}


@pytest.mark.parametrize("answer", CALLS)
def test_the_filter_does_what_it_says(answer: int) -> None:
    code = seccomp.filter_program(77)
    for call in CALLS[answer]:
        assert verdict(code, *call) == answer, call


def test_every_call_of_the_tables_is_answered_as_they_say() -> None:
    code = seccomp.filter_program(77)
    assert {verdict(code, number) for number in calls.DENIED.values()} == {REFUSE}
    assert {verdict(code, number) for number in calls.IGNORED.values()} == {DONE}
    assert verdict(code, 0, machine=0x40000003) == KILL


@pytest.mark.parametrize("driven", [False, True])
@given(command=st.integers(0, 2**32 - 1))
def test_no_command_changes_what_stays_with_a_file_or_a_terminal(driven: bool, command: int) -> None:
    answer = verdict(seccomp.filter_program(77, driven=driven), 16, 3, command)
    if (command >> 8 & 0xFF) in calls.FILE_IOCTLS or command in calls.TERMINAL_IOCTLS:
        assert answer == NO_TERMINAL
    elif driven or command in calls.IOCTLS:
        assert answer == ALLOW
    else:
        assert answer == NO_TERMINAL


@settings(max_examples=cases(60))
@given(st.binary(min_size=24, max_size=24), st.integers(0, 191))
def test_a_program_is_started_by_a_word_and_by_no_other(word: bytes, bit: int) -> None:
    spoken = struct.unpack("<3Q", word)
    wrong = struct.unpack("<3Q", (int.from_bytes(word, "little") ^ 1 << bit).to_bytes(24, "little"))
    code = seccomp.filter_program(77, word)
    assert verdict(code, 59, 1, 2, 3, *spoken) == ALLOW
    assert verdict(code, 59, 1, 2, 3, *wrong) == REFUSE
    assert verdict(code, 322, 1, 2, 3, *spoken) == REFUSE, "execveat has no word"
    assert verdict(seccomp.filter_program(77), 59, 1, 2, 3, *spoken) == REFUSE, "without a word nothing is started"


def test_gpus_are_let_through_where_they_are_asked_for(tmp_path: Path) -> None:
    for name in ("nvidia0", "nvidiactl", "nvidia-uvm", "sda"):
        (tmp_path / name).touch()
    found = paths.gpu_devices(str(tmp_path))
    assert [Path(path).name for path in found] == ["nvidia-uvm", "nvidia0", "nvidiactl"]
    policy = Policy(level="L3", read=(), listed=(), scratch="/tmp/x", memory_mb=1, disk_mb=1)
    assert "--dev-bind-try" not in namespaces.bwrap_command(policy, ["true"])
    words = namespaces.bwrap_command(replace(policy, devices=found), ["true"])
    assert [words[at + 1] for at, word in enumerate(words) if word == "--dev-bind-try"] == list(found)


def test_an_agent_in_a_second_checkout_reads_neither_its_suites_nor_its_houses(tmp_path: Path) -> None:
    other = tmp_path / "checkout"
    secrets = [
        *(paths.PACKAGE / "tasks").rglob("smoke*.json"),
        *(paths.PACKAGE / "houses").rglob("alder.json"),
    ]
    assert len(secrets) > 1
    copies = [other / "hthor" / path.relative_to(paths.PACKAGE) for path in secrets]
    for path, copy in zip(secrets, copies, strict=True):
        copy.parent.mkdir(parents=True, exist_ok=True)
        copy.write_bytes(path.read_bytes())
    (other / "agent.py").write_text("")
    allowed = paths.readable_paths(str(other / "agent.py"), str(other), [])
    assert covered(other / "agent.py", allowed)
    for path in copies:
        assert not covered(path, allowed), path
