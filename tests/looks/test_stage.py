"""The stage of the profile nice: its building, its lamps, its puppets; and what is drawn there, where OpenGL works."""

from __future__ import annotations

import itertools
import math
from typing import Any

import msgspec
import numpy as np
import pytest
import world_house as tiny
from hypothesis import given
from hypothesis import strategies as st
from skimage.color import rgb2gray
from skimage.filters import gaussian
from skimage.metrics import structural_similarity
from world_house import COFFEE, FRIDGE, TABLE, do, on, task

from hthor import houses, looks
from hthor.errors import RenderingUnavailable
from hthor.geometry import plane
from hthor.types import HUMAN, Close, Open, Pick, Pose
from hthor.world import World
from hthor.world.model import inventory
from hthor.world.model.walls import WallSlab
from hthor.world.rendering import contact_sheet
from hthor.world.rendering.scene import lights, shell
from hthor.world.rendering.scene.asset_registry import AssetSource
from hthor.world.rendering.scene.compile_scene import compile_scene
from hthor.world.rendering.scene.pose_sync import PoseSync
from hthor.world.rendering.scene.scene_mesh import facet, slab

AT_THE_FRIDGE = Pose(x=0.75, y=2.5, yaw=math.pi / 2)


class Pack:
    """A pack that has red cubes for apples and nothing else."""

    name, sha256 = "cubes", "0" * 64

    def look(self, kind: str, size: Any, variant: int) -> tuple[looks.Piece, ...] | None:
        if kind != "apple":
            return None
        return (looks.Piece(slab((0.0, 0.0, 0.0), (0.04, 0.04, 0.04)), looks.Material(texture="red")),)

    def texture(self, name: str) -> Any:
        assert name == "red"
        return np.full((4, 4, 3), (255, 0, 0), np.uint8)


@pytest.fixture(scope="module")
def world() -> World:
    return World(tiny.house(), robots=("scout",), profile="nice")


@pytest.fixture(autouse=True)
def _again(world: World) -> None:
    human = Pose(x=4.0, y=2.0, yaw=math.atan2(0.6, -1.5), pitch=-0.3)
    start = task(on(TABLE, "apple"), on(COFFEE, "lettuce"), human=human, robots=(Pose(x=6.2, y=2.0, yaw=math.pi),))
    world.reset(start)


@pytest.fixture(scope="module")
def drawn(world: World) -> World:
    try:
        world.picture(HUMAN)
    except RenderingUnavailable as error:
        pytest.skip(str(error))
    return world


def undressed(world: World, pack: Any = None) -> Any:
    """The visual model of a world, without any OpenGL."""
    split = inventory.split_things(world.house, inventory.DEFAULT_OBJECTS)
    puppets, lamps = PoseSync(world.model, world.parts.geoms), lights.RoomLights(world.house)
    return compile_scene(world.house, split, puppets, AssetSource(pack), world.bodies, lamps)


# ------------------------------------------------------------------------------------------------- without any OpenGL


@given(st.floats(0.1, 9.0), st.floats(0.1, 9.0), st.floats(-3.0, 3.0))
def test_a_facet_has_its_area_and_faces_one_way(width: float, height: float, yaw: float) -> None:
    along = (width * math.cos(yaw), width * math.sin(yaw), 0.0)
    mesh = facet((1.0, 2.0, 0.5), along, (0.0, 0.0, height))
    a, b, c = (mesh.vertices[mesh.faces[:, k]].astype(float) for k in range(3))
    crosses = np.cross(b - a, c - a)
    assert np.linalg.norm(crosses, axis=1).sum() / 2 == pytest.approx(width * height, rel=1e-3)
    facing = np.array((math.sin(yaw), -math.cos(yaw), 0.0))
    assert (crosses @ facing > 0.0).all()
    assert mesh.normals @ facing == pytest.approx(1.0, abs=1e-5)
    assert np.ptp(mesh.uv, axis=0) == pytest.approx((width, height), rel=1e-4)


@pytest.mark.parametrize("name", houses.names()[:4])
def test_walls_meet_without_two_in_one_place(name: str) -> None:
    pieces = list(shell.wall_slabs(houses.load(name)))
    assert len(pieces) > 20
    for a, b in itertools.combinations(pieces, 2):
        if a.face.id != b.face.id:
            shared = [min(a.centre[k] + p, b.centre[k] + q) - max(a.centre[k] - p, b.centre[k] - q)
                      for k, (p, q) in enumerate(zip(_extent(a), _extent(b), strict=True))]  # fmt: skip
            assert min(shared) < 1e-4 or max(shared[:2]) < 0.051, (a.face.id, b.face.id)  # only corners are shared


@pytest.mark.parametrize("name", houses.names()[:4])
def test_walls_close_every_corner_and_leave_every_opening(name: str) -> None:
    house = houses.load(name)
    pieces = list(shell.wall_slabs(house))

    def solid(x: float, y: float, z: float) -> bool:
        return any(
            abs(x - piece.centre[0]) <= _extent(piece)[0] + 1e-6
            and abs(y - piece.centre[1]) <= _extent(piece)[1] + 1e-6
            and abs(z - piece.centre[2]) <= piece.half[2] + 1e-6
            for piece in pieces
        )

    for face in house.walls:
        for x, y in (face.a, face.b):
            if any(face.id != other.id and (x, y) in (other.a, other.b) for other in house.walls):
                assert solid(x + 0.02, y + 0.02, 2.4) or solid(x - 0.02, y - 0.02, 2.4)
    for opening in house.openings:
        x, y = (opening.a[0] + opening.b[0]) / 2, (opening.a[1] + opening.b[1]) / 2
        assert not solid(x, y, (opening.low + opening.high) / 2)
        assert solid(x, y, opening.high + 0.1)


def _extent(piece: WallSlab) -> tuple[float, float, float]:
    cos, sin = abs(math.cos(piece.yaw)), abs(math.sin(piece.yaw))
    return (cos * piece.half[0] + sin * piece.half[1], sin * piece.half[0] + cos * piece.half[1], piece.half[2])


@pytest.mark.parametrize("name", houses.names()[:4])
def test_every_room_has_lamps_of_its_own(name: str) -> None:
    house = houses.load(name)
    places = lights.RoomLights(house).places
    for room in house.rooms:
        assert 1 <= len(places[room.id]) <= 3
        assert all(plane.inside(place, room.polygon) for place in places[room.id])
        assert len(set(places[room.id])) == len(places[room.id])


def test_the_sky_is_bright_blue_above_and_the_same_every_time() -> None:
    sky = lights.sky()
    assert np.array_equal(sky, lights.sky())
    right, _, up, *_ = np.split(sky, 6)
    assert sky.min() > 40
    red, _, blue = up[100:156, 100:156].reshape(-1, 3).mean(axis=0)
    assert blue > red + 20
    assert right[200, 128, 1] > right[200, 128, 2]  # grass below the horizon


def test_the_stage_touches_no_physics_and_everything_has_its_owner(world: World) -> None:
    dressed = undressed(world)
    assert not dressed.model.geom_contype.any()
    assert not dressed.model.geom_conaffinity.any()
    assert set(dressed.owner) <= set(world.names)
    things = {thing.id for thing in world.house.things}
    assert things | {"apple", "mug", HUMAN, "robot", "window|1", "outdoors"} <= set(dressed.owner)


def test_a_pack_comes_first_and_brings_its_own_textures(world: World) -> None:
    plain, packed = undressed(world).model, undressed(world, Pack()).model
    red = [bool((packed.tex_data[at : at + 3] == (255, 0, 0)).all()) for at in packed.tex_adr]
    assert sum(red) == 1
    assert packed.nmeshface < plain.nmeshface


def test_puppets_follow_doors(world: World) -> None:
    puppets = PoseSync(world.model, world.parts.geoms)
    body = puppets.hung[FRIDGE, world.parts.doors.get(FRIDGE).joints[0].name]
    closed = puppets.at(world.env.data.qpos)[1][body].copy()
    _, (w, *_rest) = puppets.relative(body, ((0.0, 0.0, 0.0), tuple(closed)))
    assert abs(w) == pytest.approx(1.0, abs=1e-9)  # at rest it is what it is closed
    world.teleport(HUMAN, AT_THE_FRIDGE)
    do(world, HUMAN, Open(thing=FRIDGE))
    opened = puppets.at(world.env.data.qpos)[1][body]
    assert 2.0 * math.acos(min(1.0, abs(float(opened @ closed)))) > 1.0


# ------------------------------------------------------------------------------------------------------- with OpenGL


def test_both_profiles_show_the_same_world(drawn: World) -> None:
    fast, nice = (drawn.picture(HUMAN, "segmentation", profile=profile) for profile in ("fast", "nice"))
    assert (fast == nice).mean() > 0.85
    apple = drawn.names.index("apple")
    assert (nice == apple).sum() >= 4
    centres = [np.argwhere(picture == apple).mean(axis=0) for picture in (fast, nice)]
    assert np.abs(centres[0] - centres[1]).max() < 1.5
    depths = [drawn.picture(HUMAN, "depth", profile=profile) for profile in ("fast", "nice")]
    assert np.median(np.abs(depths[0] - depths[1])) < 0.03


@pytest.mark.parametrize("size", [(320, 240), (120, 200)])
def test_both_profiles_have_square_pixels_at_every_shape(drawn: World, size: tuple[int, int]) -> None:
    """The law of square pixels is that of the camera's record; what is drawn has to keep it."""
    apple, camera = drawn.names.index("apple"), drawn.camera(HUMAN, size)
    assert camera.matrix[0, 0] == pytest.approx(camera.matrix[1, 1])
    column, row, depth = (camera.matrix @ (np.linalg.inv(camera.pose) @ (*drawn.position("apple"), 1.0))[:3]).tolist()
    for profile in ("fast", "nice"):
        seen = np.argwhere(drawn.picture(HUMAN, "segmentation", size, profile) == apple)
        assert seen.mean(axis=0) == pytest.approx((row / depth, column / depth), abs=1.5)


def test_both_profiles_look_alike(drawn: World) -> None:
    """By structure, a picture is like the other profile's of the same place, and unlike that of another place."""
    fast, nice = (_grey(drawn.picture(HUMAN, size=(192, 192), profile=profile)) for profile in ("fast", "nice"))
    pose = drawn.pose(HUMAN)
    drawn.teleport(HUMAN, msgspec.structs.replace(pose, yaw=pose.yaw + 1.5))
    aside = _grey(drawn.picture(HUMAN, size=(192, 192), profile="nice"))
    drawn.teleport(HUMAN, pose)
    same, other = (structural_similarity(fast, one, data_range=255) for one in (nice, aside))
    assert same > 0.5
    assert same > other + 0.1


def _grey(picture: np.ndarray) -> np.ndarray:
    """Brightness, smoothed: textures and shadows differ by design, edges and surfaces must not."""
    return gaussian(rgb2gray(picture) * 255.0, sigma=2.0)


def test_no_picture_is_dark_or_has_a_hole(drawn: World) -> None:
    for x, y in ((1.0, 1.0), (4.2, 3.3), (6.0, 3.0)):
        for turn in range(0, 4, 2) if x < 5.0 else range(1, 4, 2):
            drawn.teleport(HUMAN, Pose(x=x, y=y, yaw=turn * math.pi / 2))
            picture = drawn.picture(HUMAN, size=(64, 64)).astype(int)
            assert (picture.max(axis=2) < 12).mean() < 0.02
            seen = drawn.picture(HUMAN, "segmentation", size=(64, 64))
            assert (seen < 0).mean() < 0.05  # the sky through the window
            ahead = drawn.picture(HUMAN, "depth", size=(64, 64))
            assert (ahead > 12.0).mean() < 0.25  # only through the window can one look far


def test_drawing_leaves_the_world_alone_and_is_repeatable(drawn: World) -> None:
    before, qpos = drawn.snapshot(), drawn.env.data.qpos.copy()
    first = drawn.picture("robot", size=(96, 64)), drawn.top_view(20.0)
    again = drawn.picture("robot", size=(96, 64)), drawn.top_view(20.0)
    assert all(np.array_equal(one, other) for one, other in zip(first, again, strict=True))
    assert drawn.snapshot() == before
    assert np.array_equal(drawn.env.data.qpos, qpos)


def test_bodies_are_seen_by_others_only(drawn: World) -> None:
    human = drawn.names.index(HUMAN)
    assert human not in drawn.picture(HUMAN, "segmentation")
    assert human in drawn.picture("robot", "segmentation")


def test_what_opens_and_what_is_carried_is_drawn_so(drawn: World) -> None:
    drawn.teleport(HUMAN, AT_THE_FRIDGE)
    closed = drawn.picture(HUMAN, "depth")
    do(drawn, HUMAN, Open(thing=FRIDGE))
    assert np.abs(drawn.picture(HUMAN, "depth") - closed).max() > 0.3
    do(drawn, HUMAN, Close(thing=FRIDGE))
    assert np.abs(drawn.picture(HUMAN, "depth") - closed).max() < 0.01
    drawn.teleport(HUMAN, Pose(x=2.5, y=3.4, yaw=-math.pi / 2))
    do(drawn, HUMAN, Pick(object="apple"))
    assert drawn.holding(HUMAN) == "apple"
    drawn.teleport(HUMAN, Pose(x=4.3, y=3.4, yaw=-math.pi / 2, pitch=-0.9))
    assert (drawn.picture(HUMAN, "segmentation") == drawn.names.index("apple")).sum() > 20


def test_the_plan_is_to_scale(drawn: World) -> None:
    x0, y0, x1, y1 = drawn.top_view_bounds
    image = drawn.top_view(pixels_per_metre=40.0)
    assert image.shape == (round((y1 - y0) * 40), round((x1 - x0) * 40), 3)
    lettuce = image[int((y1 - 1.9) * 40), int((7.5 - x0) * 40)].astype(int)
    assert lettuce[1] > max(lettuce[0], lettuce[2])


def test_a_sheet_has_four_views_and_a_plan(drawn: World, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(contact_sheet, "_PLACES", 8)
    monkeypatch.setattr(contact_sheet, "_TURNS", 4)
    photographer = contact_sheet.Photographer(drawn.house)
    shots = contact_sheet.choose(photographer)
    assert [shot.room.kind for shot in shots] == ["kitchen", "living_room", "kitchen", "living_room"]
    assert shots == contact_sheet.choose(photographer)
    whole = contact_sheet.sheet(drawn.house)
    assert whole.shape[0] > 2 * contact_sheet.VIEW[1]
    assert whole.shape[1] > 2 * contact_sheet.VIEW[0] + 320


def test_a_house_that_cannot_be_read_is_an_error(tmp_path: Any, capsys: pytest.CaptureFixture[str]) -> None:
    assert contact_sheet.main([str(tmp_path / "none.json"), "--out", str(tmp_path)]) == 2
    assert "none.json" in capsys.readouterr().err


def test_an_observation_is_of_one_profile(drawn: World) -> None:
    drawn.teleport(HUMAN, AT_THE_FRIDGE)
    senses, view = drawn.senses(HUMAN), drawn.look(HUMAN)
    assert drawn.profile == "nice"
    for mode in ("rgb", "depth", "segmentation"):
        picture, other = drawn.picture(HUMAN, mode), drawn.picture(HUMAN, mode, profile="fast")
        assert (getattr(senses, mode)() == picture).all()
        assert (getattr(view, mode) == picture).all()
        assert (picture != other).any()


def test_labels_and_depth_end_where_colors_do(drawn: World) -> None:
    drawn.teleport(HUMAN, Pose(x=4.3, y=3.4, yaw=-math.pi / 2, pitch=-0.9))
    view = drawn.look(HUMAN, (192, 192), "nice")
    grey, owner = view.rgb.astype(float).mean(axis=2), view.segmentation
    across = owner[:, 1:] != owner[:, :-1]
    steps = np.abs(np.diff(grey, axis=1))
    assert steps[across].mean() > 3.0 * steps[~across].mean()
    shifted = np.roll(across, 4, axis=1)
    assert steps[across].mean() > 2.0 * steps[shifted & ~across].mean()
    assert view.depth.max() <= 80.0
