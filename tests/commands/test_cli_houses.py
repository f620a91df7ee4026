"""What `hthor houses` says and returns."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from command_line import Said

from hthor import houses


def _data(said: Said):
    assert said.code == 0, said.err
    return json.loads(said.out)


@pytest.fixture
def name() -> str:
    return houses.names()[0]


def test_the_list_counts_rooms_floor_and_things(hthor):
    rows = _data(hthor("houses", "list", "--json"))
    assert [row["name"] for row in rows] == list(houses.names())
    table = hthor("houses", "list").out
    for row in rows:
        assert len(row["rooms"]) >= 4
        assert f"{row['area_m2']:.0f}" in table
        assert str(row["things"]) in table


def test_a_lenient_check_and_a_strict_one(hthor, samples):
    file = str(samples[0])
    assert hthor("houses", "check", file).code == 0
    strict = hthor("houses", "check", file, "--strict")
    assert strict.code == 1
    assert "judged strictly" in strict.out
    assert "(thing-floats, objects[" in strict.out


def test_a_full_check_asks_the_engine(hthor, samples):
    document = json.loads(hthor("houses", "check", str(samples[0]), "--full", "--json").out)
    assert not document["sound"]
    assert document["radius"] == 0.25
    assert "penetration" in {finding["rule"] for finding in document["findings"]}


def test_many_warnings_are_cut_short_and_counted(hthor, tmp_path: Path, name: str):
    document = json.loads((Path(houses.__file__).parent / "data" / f"{name}.json").read_bytes())
    for number in range(7):
        row = {"id": f"in-wall-{number}", "assetId": "hthor_bin_60x60x40", "position": {"x": 0.0, "y": 0.2, "z": 2.0}}
        document["objects"].append(row)
    path = tmp_path / "mine.json"
    path.write_text(json.dumps(document))
    said = hthor("houses", "check", str(path))
    assert "in-wall-3" in said.out
    assert "in-wall-4: reaches" not in said.out
    assert "3 more (thing-in-wall)" in said.out


def test_a_house_from_above(hthor, tmp_path: Path, name: str):
    path = tmp_path / "from above.png"
    assert hthor("houses", "show", name, "--out", str(path), "--scale", "10").out.strip() == str(path)
    assert path.read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
    wrong = hthor("houses", "show", name, "--out", str(tmp_path / "x.jpg"))
    assert wrong.code == 2
    assert ".png" in wrong.err


def test_a_census_side_by_side(hthor, samples):
    columns = _data(hthor("houses", "census", str(samples[0]), "--json"))
    assert [column["houses"] for column in columns] == [len(houses.names()), 1]
    said = hthor("houses", "census", str(samples[0]))
    assert said.code == 0
    assert "given (1)" in said.out
    assert "start to receptacle, m" in said.out


def test_a_house_is_made_proved_and_made_again(hthor, tmp_path: Path):
    path = tmp_path / "deep" / "mine.json"
    said = hthor("houses", "generate", "--seed", "3", "--rooms", "4", "--out", str(path))
    assert said.code == 0
    assert said.out.startswith(f"{path}: 4 rooms, ")
    assert "sound" in said.out
    assert hthor("houses", "check", str(path), "--full").code == 0
    again = hthor("houses", "generate", "--seed", "3", "--rooms", "4", "--out", "-")
    assert again.out.encode() == path.read_bytes()
    assert "standard output: 4 rooms" in again.err


def test_several_houses_go_into_a_folder(hthor, tmp_path: Path):
    rows = _data(hthor("houses", "generate", "--seed", "4", "--count", "2", "--out", str(tmp_path), "--json"))
    assert [(row["seed"], len(row["rooms"])) for row in rows] == [(4, 4), (5, 5)]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["home-4-4.json", "home-5-5.json"]
    for row in rows:
        assert houses.load(row["file"]).sha256 == row["sha256"]
        assert row["sound"]


@pytest.mark.parametrize(
    ("words", "hints"),
    [
        (("show", "hazle"), ("unknown house 'hazle'",)),
        (("census", "hazle"), ("unknown house 'hazle'",)),
        (("generate", "--rooms", "3"), ("--rooms", "greater than or equal to 4")),
        (("generate", "--seed", "-1"), ("--seed",)),
        (("generate", "--count", "2", "--out", "-"), ("--out", "folder")),
        (("generate", "--json", "--out", "-"), ("--json",)),
        (("generat",), ("No such command 'generat'", "generate")),
    ],
)
def test_mistakes_are_told(hthor, words: tuple[str, ...], hints: tuple[str, ...]):
    said = hthor("houses", *words)
    assert said.code == 2
    assert said.out == "" or "--json" in words
    for hint in hints:
        assert hint in said.err


def test_the_commands_wake_nothing_heavy():
    code = "import sys, hthor.cli\nassert not {'numpy', 'numba', 'mujoco', 'cv2', 'rich.table'} & set(sys.modules)"
    subprocess.run([sys.executable, "-c", code], check=True, timeout=900)


@pytest.mark.parametrize("within", [False, True])
def test_a_name_in_utf_8_is_found_in_every_locale(tmp_path: Path, name: str, within: bool):
    """In the locale C with ``PYTHONUTF8=0``, Python reads names as ASCII."""
    folder = tmp_path / "mes maisons à moi"
    folder.mkdir()
    (folder / "日本.json").write_bytes((Path(houses.__file__).parent / "data" / f"{name}.json").read_bytes())
    where, what = (folder, "日本.json") if within else (tmp_path, f"{folder}/日本.json")
    env = {**os.environ, "LC_ALL": "C", "PYTHONUTF8": "0"}
    command = [sys.executable, "-m", "hthor", "houses", "check", what, "--json"]
    done = subprocess.run(command, cwd=where, env=env, capture_output=True, timeout=900, check=False)
    assert (done.returncode, done.stderr) == (0, b"")
    assert json.loads(done.stdout)["house"] == what
