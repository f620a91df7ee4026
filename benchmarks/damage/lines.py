"""Command lines made up at random from the commands that there are, and the files of a playground."""

from __future__ import annotations

import random
import typing
from collections.abc import Iterator
from typing import Any

from scripts import cli_reference

OUTSIDE = {
    "hthor assets build": "loads a package from the network",
    "hthor priors build": "needs a language model",
    "hthor agent serve": "serves until it is stopped",
}
"""Commands that are only asked for their help."""
FILES = (
    *("few.json", "official", "official/commitment.json", "official/suite.json", "salt.txt", "runs", "runs/silent"),
    *("runs/oracle", "runs/oracle/trials.jsonl", "runs/oracle/run.json", "runs/nowhere", "paper.json", "paper.npz"),
    *("slow.json", "targets.json", "house.json", "board", "board/entries", "submissions", "submissions/mine"),
    *("submissions/mine/agent.py", "my_robot.py", "put_away.py", ".", "..", "/", "/dev/null", "no such file", "out"),
)
NAMES = (
    *("silent", "frontier", "oracle", "proxy", "paper", "literature", "kinds", "bracket", "smoke", "standard", "hazel"),
    *(
        "alder",
        "scout",
        "tender",
        "puck",
        "tall",
        "small",
        "collect",
        "ideal",
        "noisy",
        "auto",
        "L1",
        "L2",
        "L3",
        "hard",
    ),
    *("mug", "apple", "cmd:true", "cmd:", "ws://127.0.0.1:9", "ws://", "x.py:Agent", "a.b:C", "1/2", "0/0", "scout:"),
    *("tall:oracle,small:oracle", ":", "miss=0.5", "miss=nan", "paper@paper", "replay:runs/oracle", "0.7,0.8", "local"),
    *("smoke/hazel/manipulation-01", "2/1", "5%", "101%", "process", "ray", "local:2", "2026-01-01"),
)
NUMBERS = ("0", "1", "2", "-1", "3.5", "nan", "inf", "-inf", "1e309", "1e-320", "99999999999999999999", "0x10", "١", "")
RUBBISH = (
    *("", " ", "-", "--", "---", "\t", "\n", "é", "\u202e", "🤖", "a" * 3000, "%s", "{}", "$HOME", "'", "[red]x[/]"),
    *("../../../etc/passwd", "a/b/c", "file:///etc", "*.json", "~", "-h", "--jsn", "-1", "\udcff", "nan", "@", "#"),
)
_SMALL = {"jobs": ("1", "0", "-1", "2", "many"), "participants": ("1", "0", "-3", "2"), "houses": ("1", "0", "-1")}
_SMALL |= {"tasks": ("1", "0", "-2"), "count": ("1", "0", "-1"), "sessions": ("1", "0"), "sample": ("0", "1", "x")}
_SMALL |= {"n": ("0", "1", "3", "-1"), "generated": ("0", "1", "-1"), "rooms": ("4", "0", "99", "-1")}
_OUT = {"out": ("out", "out/a/b", "few.json", "few.json/x", "/dev/null", "/dev/null/x", "", "/proc/x", "runs/oracle")}


def lines(dice: random.Random, count: int) -> Iterator[tuple[str, ...]]:
    """So many lines, without the program's name."""
    known = list(cli_reference.leaves())
    for _ in range(count):
        name, command = dice.choice(known)
        words = name.split()[1:]
        if name in OUTSIDE:
            yield (*words, "--help")
        else:
            yield (*words, *_arguments(command, dice))


def _arguments(command: Any, dice: random.Random) -> list[str]:
    words: list[str] = []
    for one in cli_reference.options(command):
        if one.param_type_name == "argument":
            for _ in range(dice.choice((0, 1, 1, 1, 1, 2))):
                words.append(_value(one, dice))
        elif one.is_flag:
            if one.name == "dry_run" or dice.random() < 0.25:
                words.append(dice.choice((one.opts[0], one.opts[0], *one.secondary_opts)))
        elif dice.random() < (0.9 if one.name in _SMALL else 0.35):
            words += [one.opts[0], _value(one, dice)]
    if dice.random() < 0.1:
        words.insert(dice.randrange(len(words) + 1), dice.choice(RUBBISH))
    if dice.random() < 0.05 and words:
        words.pop()
    return words


def _value(one: Any, dice: random.Random) -> str:
    """A value for a parameter: mostly of its sort, sometimes of no sort at all."""
    if dice.random() < 0.15:
        return dice.choice(RUBBISH)
    if one.name in _SMALL:
        return dice.choice(_SMALL[one.name])
    if one.name in _OUT:
        return dice.choice(_OUT[one.name])
    kinds = {getattr(kind, "__name__", "") for kind in _kinds(one.type_descriptor.annotation)}
    if kinds & {"int", "float"} and dice.random() < 0.8:
        return dice.choice(NUMBERS)
    pool = FILES if "Path" in kinds else NAMES
    return dice.choice(pool if dice.random() < 0.7 else (*FILES, *NAMES, *NUMBERS))


def _kinds(annotation: Any) -> Iterator[Any]:
    """The plain types in an annotation such as ``list[Path] | None``."""
    inner = typing.get_args(annotation)
    if not inner:
        yield annotation
    for part in inner:
        yield from _kinds(part)
