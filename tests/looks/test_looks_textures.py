from __future__ import annotations

import zlib

import numpy as np
import pytest

from hthor.catalog import colors
from hthor.errors import UnknownName
from hthor.looks import materials, textures
from hthor.looks.meshes import solids

# ---------------------------------------------------------------------------------------------------------- textures


@pytest.mark.parametrize("name", textures.names())
def test_textures_are_small_pictures_that_are_made_anew_the_same(name: str) -> None:
    picture = textures.image(name)
    assert picture.dtype == np.uint8
    assert picture.ndim == 3
    assert picture.shape[2] == 3
    assert max(picture.shape) <= 512
    assert not picture.flags.writeable
    assert textures.scale(name) >= 0.0
    textures.image.cache_clear()
    assert zlib.crc32(textures.image(name).tobytes()) == zlib.crc32(picture.tobytes())


@pytest.mark.parametrize("name", [name for name in textures.names() if textures.scale(name) > 0.0])
def test_textures_repeat_without_a_seam(name: str) -> None:
    picture = textures.image(name).astype(float)
    for axis in (0, 1):
        steps = np.abs(np.diff(picture, axis=axis, append=np.take(picture, [0], axis=axis))).mean(axis=(1 - axis, 2))
        assert steps[-1] <= 1.5 * max(steps[:-1].max(), 2.0)


def test_an_unknown_texture_is_refused() -> None:
    with pytest.raises(UnknownName):
        textures.image("plasma")


# --------------------------------------------------------------------------------------------------------- materials


@pytest.mark.parametrize(
    ("name", "texture"),
    [("WoodOak", "planks"), ("TileWhite", "tile"), ("CarpetGrey", "carpet"), ("DarkWoodPlanks", "planks"),
     ("KitchenTilesCheckerboard", "checker"), ("LightWoodCounters4", "planks_wide"),
     ("", "planks"), ("Herringbone", "herringbone")],
)  # fmt: skip
def test_floors_by_name(name: str, texture: str) -> None:
    assert materials.floor(name).texture == texture


@pytest.mark.parametrize(
    ("name", "texture"),
    [("PlasterWarm", "plaster"), ("RedBrick", "brick"), ("SubwayTilesAO", "subway"), ("PureWhite", "plaster"),
     ("ConcreteFloor", "concrete"), ("BrownMarbleFake 1", "marble"), ("LivingRoomFireplacebrickTexWHITE", "brick")],
)  # fmt: skip
def test_walls_by_name(name: str, texture: str) -> None:
    assert materials.wall(name).texture == texture


def test_a_wall_takes_the_color_that_its_house_gives() -> None:
    green = materials.wall("PureWhite", (0.2, 0.6, 0.3))
    shown = np.array(green.rgba[:3]) * textures.mean(green.texture)
    assert shown == pytest.approx((0.2, 0.6, 0.3), abs=0.01)


def test_colors_of_the_catalog_speak_of_materials() -> None:
    assert materials.guess(colors.OAK).texture == "wood"
    assert materials.guess(colors.STEEL).texture == "brushed"
    assert materials.guess(colors.STONE).texture == "granite"
    assert materials.guess(colors.GLASS).rgba[3] < 0.5
    assert materials.guess(colors.RED).texture == ""


def test_texture_coordinates_count_repeats() -> None:
    board = solids.box((0.0, 0.0, 0.0), (1.8, 0.2, 0.02), 0.0)
    uv = materials.piece(board, materials.wood((0.7, 0.5, 0.3, 1.0))).mesh.uv
    assert np.ptp(uv[:4, 0]) == pytest.approx(1.8 / textures.scale("wood"), rel=0.2) or np.ptp(uv[:, 0]) >= 1.9
