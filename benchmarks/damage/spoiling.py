"""Ways to damage a file; each takes its bytes and chance, and gives other bytes."""

from __future__ import annotations

import hashlib
import io
import json
import random
import zlib
from collections.abc import Callable
from typing import Any

import msgspec
import numpy as np

from hthor import jsonio
from hthor.eval.records import trial_record
from hthor.tasks.suite import Suite
from hthor.types import TrialSpec

Spoil = Callable[[bytes, random.Random], bytes]

VALUES: tuple[Any, ...] = (
    *(None, True, False, 0, -1, 3, 2**31, 2**63, 2**70, -(2**70), 10**400, 1e308, -1e308, 1e-320, 0.5, float("nan")),
    *(float("inf"), "", "x", "nan", "../../etc/passwd", "/dev/zero", "\x00", "\ud800", "é", "L9", "{}", "x" * 5000),
    *("{rubbish}", "%s", "$\\frac{1}{$", "[red]", [], {}, [[]], [None], {"": 0}, [0] * 1000),
)


def cut(data: bytes, dice: random.Random) -> bytes:
    """The file ends early."""
    return data[: dice.randrange(len(data) + 1)]


def flip(data: bytes, dice: random.Random) -> bytes:
    """Some bytes are others."""
    held = bytearray(data)
    for _ in range(dice.choice((1, 3, 20))):
        if held:
            held[dice.randrange(len(held))] = dice.randrange(256)
    return bytes(held)


def insert(data: bytes, dice: random.Random) -> bytes:
    """Something stands where it does not belong."""
    place = dice.randrange(len(data) + 1)
    what = dice.choice((b"\x00" * 40, b"\xff\xfe", b"\n\n", b"[" * 2000, b"NaN", b'"', b"\xed\xa0\x80", b"1e999"))
    return data[:place] + what + data[place:]


def replace(_data: bytes, dice: random.Random) -> bytes:
    """Another file altogether."""
    deep = dice.choice((500, 1500, 100_000))
    return dice.choice(
        (
            *(b"", b"{}", b"[]", b"null", b"0", b'""', b"{", b"NaN", b"\n", b"\xef\xbb\xbf{}", dice.randbytes(300)),
            *(b"[" * deep + b"]" * deep, b'{"a":' * deep + b"1" + b"}" * deep, b'{"schema":"hthor.other/1"}'),
        )
    )


def change(data: bytes, dice: random.Random) -> bytes:
    """One value of a JSON document is another, is missing, is there twice, or has company."""
    try:
        document = json.loads(data)
    except ValueError:
        return flip(data, dice)
    places = list(_places(document))
    if not places:
        return replace(data, dice)
    for _ in range(dice.choice((1, 1, 1, 3))):
        holder, name = dice.choice(places)
        if isinstance(holder, list) and name >= len(holder):
            continue
        how = dice.randrange(6)
        if how == 0 and isinstance(holder, dict):
            holder.pop(name, None)
        elif how == 1 and isinstance(holder, dict):
            holder[dice.choice(("more", "", "schema", "seed"))] = dice.choice(VALUES)
        elif how == 2 and isinstance(holder, list):
            holder.append(holder[0] if holder else None)
        elif how == 3 and isinstance(holder, list):
            holder.clear()
        elif how == 4:
            other, key = dice.choice(places)
            holder[name] = other.get(key) if isinstance(other, dict) else None
        else:
            holder[name] = dice.choice(VALUES)
    try:
        return json.dumps(document).encode()
    except ValueError:  # it holds itself
        return replace(data, dice)


def _places(document: Any) -> Any:
    """Every holder of a value with the value's name in it."""
    if isinstance(document, dict | list):
        names = list(document) if isinstance(document, dict) else range(len(document))
        for name in names:
            yield document, name
            yield from _places(document[name])


def mended_line(data: bytes, dice: random.Random) -> bytes:
    """One record of a log is changed, and its key and checksum say that it is whole."""
    lines = data.splitlines(keepends=True)
    number = dice.randrange(len(lines))
    spoiled = change(lines[number], dice)
    try:
        document = json.loads(spoiled)
        if isinstance(document, dict) and isinstance(document.get("spec"), dict) and dice.random() < 0.9:
            spec = msgspec.convert(document["spec"], TrialSpec)
            document["key"] = trial_record.key(spec)
        body = json.dumps({**document, "check": None}).encode().rpartition(b', "check": null')[0]
    except (ValueError, TypeError, OverflowError, RecursionError):
        body = spoiled.strip()[:-1]
    lines[number] = body + b',"check":"%08x"}\n' % zlib.crc32(body)
    return b"".join(lines)


def mended_suite(data: bytes, dice: random.Random) -> bytes:
    """A suite is changed, and its hash is that of what it holds now."""
    spoiled = change(data, dice)
    try:
        held = msgspec.json.decode(spoiled, type=Suite)
        document = json.loads(spoiled)
        document["sha256"] = jsonio.sha256(held.tasks)
        return json.dumps(document).encode()
    except (ValueError, TypeError, OverflowError, RecursionError):
        return spoiled


def arrays(data: bytes, dice: random.Random) -> bytes:
    """Arrays of an archive have other numbers, shapes, types or names."""
    with np.load(io.BytesIO(data)) as archive:
        held = {name: archive[name] for name in archive.files}
    name = dice.choice(sorted(held))
    array = held[name]
    how = dice.randrange(6)
    if how == 0:
        del held[name]
    elif how == 1:
        held[name] = array[: dice.randrange(len(array))]
    elif how == 2:
        held[name] = array.astype("<U8") if array.dtype.kind == "f" else array[:0]
    elif how == 3:
        held["more"] = array
    elif array.dtype.kind == "f":
        array = array.copy()
        array.flat[dice.randrange(array.size)] = dice.choice((np.nan, np.inf, -np.inf, 1e308, -1e308, -1.0))
        held[name] = array
    else:
        held[name] = np.array([dice.choice(VALUES[16:])] * len(array))
    file = io.BytesIO()
    np.savez(file, **held)
    return file.getvalue()


def source(data: bytes, dice: random.Random) -> bytes:
    """A Python file no longer says what it should."""
    lines = data.splitlines(keepends=True)
    how = dice.randrange(5)
    if how == 0:
        del lines[dice.randrange(len(lines))]
    elif how == 1:
        lines.insert(
            0, dice.choice((b"1/0\n", b"import nowhere\n", b"raise SystemExit(3)\n", b"\x00\n", b"\xff = 1\n"))
        )
    elif how == 2:
        return b"(" * 500 + b")" * 500
    elif how == 3:
        return b"# nothing\n"
    else:
        return flip(data, dice)
    return b"".join(lines)


JSON: tuple[Spoil, ...] = (cut, flip, insert, replace, change, change, change)
LOG: tuple[Spoil, ...] = (cut, flip, insert, mended_line, mended_line, mended_line)
SUITE: tuple[Spoil, ...] = (*JSON, mended_suite, mended_suite, mended_suite)
TABLE: tuple[Spoil, ...] = (cut, flip, arrays, arrays)
SOURCE: tuple[Spoil, ...] = (cut, source, source)


def hash_again(population: bytes, table: bytes) -> bytes:
    """A population's document with the hash of another table."""
    document = json.loads(population)
    document["arrays"]["sha256"] = hashlib.sha256(table).hexdigest()
    return jsonio.pretty(document)
