"""Furniture packs: made of a tiny library in a tiny Debian package, read, drawn from, and refused when broken."""

from __future__ import annotations

import io
import json
import tarfile
import zipfile
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
import world_house as tiny
from hypothesis import given
from hypothesis import strategies as st
from typer.testing import CliRunner

from hthor import catalog
from hthor.cli import app
from hthor.errors import MissingExtra, UnknownName
from hthor.looks import pack as packs
from hthor.looks.pack import PackError, debian, fitting, making, obj, picks, thinning
from hthor.looks.pack.picks import CC0, CC_BY, LICENCES, Pick
from hthor.types import Vec3

PICKS = (
    Pick("dining_table", CC0, "table"),
    Pick("sofa", CC0, "settee"),
    Pick("mug", CC_BY, "cup", 1),
    Pick("fridge", CC0, "table"),
    Pick("bed", CC0, "table"),
)
CATALOGUE = """
id=Tiny
name#1=Table
category#1=Living room
model#1=/tiny/table/table.obj
width#1=120
depth#1=80
height#1=70
creator#1=Ann
name#2=Settee
model#2=/tiny/settee/settee.obj
width#2=180
depth#2=90
height#2=80
creator#2=Ben
"""
CATALOGUE_BY = "name#1=Cup\nmodel#1=/by/cup/cup.obj\nwidth#1=8\ndepth#1=12\nheight#1=10\ncreator#1=C\\u00e9cile\n"


def boxes(*spans: tuple[Vec3, Vec3], material: str = "wood") -> str:
    """An OBJ file of boxes, y up, front towards +z."""
    lines = ["mtllib tiny.mtl", "vt 0 0", "vt 1 1", f"usemtl {material}"]
    for number, (lo, hi) in enumerate(spans):
        corners = [(x, y, z) for x in (lo[0], hi[0]) for y in (lo[1], hi[1]) for z in (lo[2], hi[2])]
        lines += [f"v {x} {y} {z}" for x, y, z in corners]
        quads = ((1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4))
        lines += ["f " + " ".join(f"{corner + 8 * number}/1" for corner in quad) for quad in quads]
    return "\n".join(lines)


TABLE = boxes(((0, 65, 0), (120, 70, 80)), ((5, 0, 5), (12, 65, 12)), ((108, 0, 68), (115, 65, 75)))
SETTEE = boxes(((0, 0, 0), (180, 40, 90)), ((0, 40, 0), (180, 80, 22)), ((0, 40, 0), (15, 60, 90)))


def library(catalogue: str, files: dict[str, bytes]) -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        for name, data in {"PluginFurnitureCatalog.properties": catalogue, **files}.items():
            archive.writestr(zipfile.ZipInfo(name), data)  # without the time, so that it is the same every time
    return buffer.getvalue()


def libraries() -> dict[str, bytes]:
    _, picture = cv2.imencode(".png", np.full((700, 300, 3), (10, 120, 200), np.uint8))
    wood = b"newmtl wood\nKd 0.5 0.3 0.1\nmap_Kd wood.png\n"
    free = {
        "tiny/table/table.obj": TABLE.encode(),
        "tiny/table/tiny.mtl": wood,
        "tiny/table/wood.png": picture.tobytes(),
        "tiny/settee/settee.obj": SETTEE.encode(),
        "tiny/settee/tiny.mtl": b"newmtl wood\nKd 0.2 0.2 0.6\n",
    }
    cup = {"by/cup/cup.obj": boxes(((0, 0, 0), (8, 10, 12))).encode()}
    return {CC0: library(CATALOGUE, free), CC_BY: library(CATALOGUE_BY, cup)}


def deb(members: dict[str, bytes]) -> bytes:
    """A Debian package: an ar archive with a tar archive in it."""
    buffer = io.BytesIO()
    with tarfile.open(fileobj=buffer, mode="w:xz") as archive:
        for name, data in members.items():
            info = tarfile.TarInfo(f"./usr/share/sweethome3d/furniture/{name}")
            info.size = len(data)
            archive.addfile(info, io.BytesIO(data))
    parts = b"!<arch>\n"
    for name, data in (("debian-binary", b"2.0\n"), ("data.tar.xz", buffer.getvalue())):
        parts += (
            f"{name:<16}{0:<12}{0:<6}{0:<6}{'100644':<8}{len(data):<10}`\n".encode() + data + b"\n" * (len(data) % 2)
        )
    return parts


def make(folder: Path, *, cc_by: bool = False) -> making.ConvertedModel:
    return making.convert_models(libraries(), "tiny.deb", folder, "tiny", cc_by=cc_by, picks=PICKS)


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> making.ConvertedModel:
    return make(tmp_path_factory.mktemp("packs") / "tiny", cc_by=True)


# ------------------------------------------------------------------------------------------------------------- building


def test_a_debian_package_is_read(tmp_path: Path) -> None:
    file = tmp_path / "tiny.deb"
    file.write_bytes(deb({f"{name}.sh3f": data for name, data in libraries().items()}))
    files, source = debian.libraries(file)
    assert files == libraries()
    assert source == "tiny.deb"


def test_what_was_taken_and_what_was_not_is_said(built: making.ConvertedModel) -> None:
    assert built.pack.kinds == ("dining_table", "mug", "sofa")
    reasons = {skipped.pick.kind: skipped.reason for skipped in built.skipped}
    assert reasons["fridge"] == "a fridge opens, which no model of a pack can do"
    assert "too far from" in reasons["bed"]


def test_only_public_domain_unless_asked(tmp_path: Path) -> None:
    pack = make(tmp_path / "free").pack
    assert pack.kinds == ("dining_table", "sofa")
    assert pack.contents.licences == ("CC0-1.0",)
    assert not (tmp_path / "free" / "ATTRIBUTION.md").exists()


def test_every_model_has_a_licence_row(built: making.ConvertedModel) -> None:
    rows = (built.pack.folder / "LICENCES.md").read_text()
    for model in built.pack.contents.models:
        assert f"| {model.kind} | {model.title} | {model.author} | {model.licence} | {model.source} |" in rows
        assert model.licence in {licence for licence, _ in LICENCES.values()}
    attribution = (built.pack.folder / "ATTRIBUTION.md").read_text()
    assert '"Cup" by Cécile, CC-BY-3.0 (https://creativecommons.org/licenses/by/3.0/)' in attribution
    assert "Table" not in attribution


def test_every_pick_s_library_has_a_licence_and_every_kind_exists() -> None:
    assert {pick.library for pick in picks.PICKS} == set(LICENCES)
    assert {pick.kind for pick in picks.PICKS} <= set(catalog.names())
    assert len({(pick.kind, pick.library, pick.model) for pick in picks.PICKS}) == len(picks.PICKS)


def test_the_same_library_gives_the_same_pack(built: making.ConvertedModel, tmp_path: Path) -> None:
    again = make(tmp_path / "again", cc_by=True).pack
    assert again.sha256 == built.pack.sha256
    for name in ("pack.json", "meshes.npz"):
        assert (again.folder / name).read_bytes() == (built.pack.folder / name).read_bytes()


def test_a_pack_is_written_over_and_nothing_is_left_lying_about(tmp_path: Path) -> None:
    make(tmp_path / "one", cc_by=True)
    make(tmp_path / "one")
    assert not (tmp_path / "one" / "ATTRIBUTION.md").exists()
    assert [path.name for path in tmp_path.iterdir()] == ["one"]


# -------------------------------------------------------------------------------------------------------------- drawing


@given(
    kind=st.sampled_from(["dining_table", "sofa", "mug"]),
    scale=st.tuples(*[st.floats(0.85, 1.15) for _ in range(3)]),
)
def test_pieces_fill_the_thing_and_bear_what_lies_on_it(built: making.ConvertedModel, kind: str, scale: Vec3) -> None:
    size = tuple(a * b for a, b in zip(catalog.kind(kind).size, scale, strict=True))
    pieces = built.pack.look(kind, size)
    assert pieces is not None
    vertices = np.concatenate([piece.mesh.vertices for piece in pieces])
    assert vertices.max(0) == pytest.approx(np.array(size) / 2, abs=1e-5)
    assert vertices.min(0) == pytest.approx(-np.array(size) / 2, abs=1e-5)
    for place in fitting.supports(kind, size):
        at = [vertices[piece.mesh.faces] for piece in pieces for vertices in (piece.mesh.vertices,)]
        height = _height_under(np.concatenate(at), place.centre[0], place.centre[1])
        assert height == pytest.approx(place.centre[2], abs=0.002)


def _height_under(triangles: np.ndarray, x: float, y: float) -> float:
    """The topmost surface above a place."""
    best = -np.inf
    for a, b, c in triangles.astype(float):
        area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])
        if abs(area) > 1e-12:
            v = ((x - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (y - a[1])) / area
            w = ((b[0] - a[0]) * (y - a[1]) - (x - a[0]) * (b[1] - a[1])) / area
            if v >= -1e-9 and w >= -1e-9 and v + w <= 1 + 1e-9:
                best = max(best, a[2] + v * (b[2] - a[2]) + w * (c[2] - a[2]))
    return best


def test_the_front_is_where_ours_is(built: making.ConvertedModel) -> None:
    """The settee's back is at the rear, which is -y in our frame and -z in the library's."""
    pieces = built.pack.look("sofa", catalog.kind("sofa").size)
    assert pieces is not None
    top = np.concatenate([piece.mesh.vertices for piece in pieces])
    top = top[top[:, 2] > top[:, 2].max() - 0.01]
    assert top[:, 1].max() < 0.0


def test_pictures_are_small_and_found(built: making.ConvertedModel) -> None:
    pieces = built.pack.look("dining_table", catalog.kind("dining_table").size)
    assert pieces is not None
    image = built.pack.texture(pieces[0].material.texture)
    assert image.dtype == np.uint8
    assert image.shape == (512, 219, 3)
    assert image[0, 0].astype(int) == pytest.approx((200, 120, 10), abs=4)


def test_what_a_pack_has_not_is_left_to_us(built: making.ConvertedModel) -> None:
    assert built.pack.look("fridge", catalog.kind("fridge").size) is None
    assert built.pack.look("dining_table", (6.0, 0.3, 0.1)) is None, "a model is not stretched beyond recognition"


def test_things_that_would_float_are_refused(tmp_path: Path) -> None:
    files = libraries()
    holes = boxes(((0, 65, 0), (20, 70, 80)), ((100, 0, 0), (120, 70, 80)))
    files[CC0] = library(CATALOGUE, {"tiny/table/table.obj": holes.encode(), "tiny/settee/settee.obj": SETTEE.encode()})
    with pytest.raises(PackError, match="too little of its 'top' is level"):
        making.convert_models(files, "t", tmp_path / "t", "t", cc_by=False, picks=PICKS[:1])


# ----------------------------------------------------------------------------------------------------- broken or absent


@pytest.mark.parametrize(
    ("data", "expected"),
    [
        (b"hello", "is not a Debian package"),
        (deb({"a.sh3f": b"x"})[:300], "is a broken Debian package"),
        (deb({"readme.txt": b"x"}), "holds no furniture library"),
    ],
)
def test_broken_packages_are_refused(tmp_path: Path, data: bytes, expected: str) -> None:
    file = tmp_path / "broken.deb"
    file.write_bytes(data)
    with pytest.raises(PackError, match=expected):
        debian.libraries(file)


def test_no_package_and_no_apt(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(debian, "INSTALLED", tmp_path)
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(PackError, match=r"no apt-get to download it with\. Give the package with --deb"):
        debian.libraries(None)
    with pytest.raises(PackError, match="No such file"):
        debian.libraries(tmp_path / "nowhere.deb")


def test_an_installed_library_is_used(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / f"{CC0}.sh3f").write_bytes(b"x")
    monkeypatch.setattr(debian, "INSTALLED", tmp_path)
    assert debian.libraries(None) == ({CC0: b"x"}, "sweethome3d-furniture as installed")


@pytest.mark.parametrize(
    ("files", "expected"),
    [
        ({}, "has no library 'BlendSwap-CC-0'; it has: none"),
        ({CC0: b"no zip"}, "library 'BlendSwap-CC-0' cannot be read"),
        ({CC0: library("name#1=Table\n", {})}, "has no model 'table'"),
        ({CC0: library(CATALOGUE, {})}, "tiny/table/table.obj cannot be read"),
        ({CC0: library(CATALOGUE.replace("width#1=120", "width#1=wide"), {})}, "model number 1 has a bad line"),
        ({CC0: library(CATALOGUE, {"tiny/table/table.obj": b"f 1 2 3"})}, "line 1, 'f 1 2 3'"),
    ],
)
def test_broken_libraries_are_refused(tmp_path: Path, files: dict[str, bytes], expected: str) -> None:
    with pytest.raises(PackError, match=expected):
        making.convert_models(files, "tiny.deb", tmp_path / "p", "p", cc_by=False, picks=PICKS[:1])
    assert list(tmp_path.iterdir()) == []


def test_a_pack_that_was_changed_is_refused(tmp_path: Path) -> None:
    pack = make(tmp_path / "p").pack
    pack.check()
    (tmp_path / "p" / "meshes.npz").write_bytes(b"other")
    with pytest.raises(PackError, match="was changed after it was built"):
        pack.look("sofa", catalog.kind("sofa").size)
    document = json.loads((tmp_path / "p" / "pack.json").read_text())
    (tmp_path / "p" / "pack.json").write_text(json.dumps(document | {"schema": "hthor.pack/0"}))
    with pytest.raises(PackError, match=r"this version reads 'hthor\.pack/1'"):
        packs.load(str(tmp_path / "p"))


def test_the_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert packs.installed() == ()
    make(packs.home() / "tiny")
    assert packs.installed() == ("tiny",)
    assert packs.load("tiny").name == "tiny"
    with pytest.raises(UnknownName, match="Did you mean 'tiny'"):
        packs.load("tinny")
    assert packs.remove("tiny") == tmp_path / "hthor" / "packs" / "tiny"
    assert packs.installed() == ()
    with pytest.raises(UnknownName):
        packs.remove("tiny")


@pytest.mark.parametrize("name", ["", "a/b", "..", "procedural", "-x"])
def test_names_that_cannot_be_folders(name: str) -> None:
    with pytest.raises(PackError, match="cannot be a pack's name"):
        packs.tidy(name)


def test_a_stranger_s_folder_is_not_written_over(tmp_path: Path) -> None:
    packs.overwritable(tmp_path / "new")
    packs.overwritable(tmp_path)
    (tmp_path / "thesis.tex").touch()
    with pytest.raises(PackError, match="is not a furniture pack"):
        packs.overwritable(tmp_path)


def command(*words: str) -> Any:
    return CliRunner().invoke(app, ["assets", *words])


def test_the_commands(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setattr(making, "PICKS", PICKS)
    file = tmp_path / "tiny.deb"
    file.write_bytes(deb({f"{name}.sh3f": data for name, data in libraries().items()}))
    assert json.loads(command("list", "--json").stdout) == []
    done = command("build", "--deb", str(file), "--json")
    assert done.exit_code == 0
    made = json.loads(done.stdout)
    assert (made["name"], made["kinds"], made["licences"]) == ("photoreal", ["dining_table", "sofa"], ["CC0-1.0"])
    assert "left out fridge table: a fridge opens" in done.stderr
    assert json.loads(command("build", "--deb", str(file), "--cc-by", "--json").stdout)["name"] == "photoreal-by"
    assert [row["name"] for row in json.loads(command("list", "--json").stdout)] == ["photoreal", "photoreal-by"]
    folder = command("path", "photoreal").stdout.strip()
    assert command("remove", "photoreal").stdout.strip() == folder
    assert isinstance(command("path", "photoreal").exception, UnknownName)


# -------------------------------------------------------------------------------------------------------------- details


def test_obj_corners_of_all_sorts() -> None:
    text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nf 1 2 3 4\nf -4//1 -3//1 -2//1\nf 1 1 2\n"
    (group,) = obj.read_obj(text, lambda name: "")
    assert len(group.faces) == 3, "a square is two triangles, and one without area is dropped"
    assert group.normals is None, "some corners have none"


def test_materials() -> None:
    paints = obj.read_paints("newmtl a\nKd 1 0 0\nd 0.5\nnewmtl b\nTr 0.25\nKs 0.2 0.4 0.6\nmap_Kd dir\\pic.jpg\n")
    assert paints["a"].rgba == (1.0, 0.0, 0.0, 0.5)
    assert paints["b"].rgba[3] == 0.75
    assert paints["b"].picture == "dir/pic.jpg"
    assert paints["b"].specular == pytest.approx(0.4)


def test_detailed_models_need_the_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "fast_simplification", None)
    rng = np.random.default_rng(0)
    group = obj.Group(obj.Paint(), rng.random((300, 3)), np.zeros((300, 2)), None, np.arange(300).reshape(-1, 3))
    assert thinning.decimate([group], 1000) == [group]
    with pytest.raises(MissingExtra, match=r"hthor\[assets\]"):
        thinning.decimate([group], 70)


def test_a_world_takes_a_pack_before_our_own(built: making.ConvertedModel) -> None:
    from hthor.world import World
    from hthor.world.rendering.scene.asset_registry import AssetSource

    fabric, size = AssetSource(built.pack), catalog.kind("dining_table").size
    texture = fabric.look("dining_table", size, 0)[0].material.texture
    assert texture.startswith("pack:")
    assert np.array_equal(fabric.texture(texture), built.pack.texture(texture.removeprefix("pack:")))
    assert fabric.look("fridge", catalog.kind("fridge").size, 0) == AssetSource().look(
        "fridge", catalog.kind("fridge").size, 0
    )
    with pytest.raises(UnknownName, match="furniture pack"):
        World(tiny.house(), assets="nowhere")
