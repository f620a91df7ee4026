"""The encoder of pictures: what it learns, what it is read from, and networks that see with it."""

from __future__ import annotations

import json
import signal
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

torch = pytest.importorskip("torch", reason="needs torch: pip install 'hthor[torch]'", exc_type=ImportError)

from small_grids import make_grid  # noqa: E402
from typer.testing import CliRunner  # noqa: E402

from hthor import catalog, houses, tasks  # noqa: E402
from hthor.agents import savn as savn_agent  # noqa: E402
from hthor.agents.skills import picture_encoder, savn_checkpoint  # noqa: E402
from hthor.agents.skills.picture_encoder import CODE, PictureEncoder  # noqa: E402
from hthor.agents.skills.savn_network import PAPER  # noqa: E402
from hthor.agents.skills.semantic_cells import CELLS, CLASSES, GOALS, GRID, mean_depths  # noqa: E402
from hthor.cli import app  # noqa: E402
from hthor.errors import HthorError  # noqa: E402
from hthor.train import algorithms, comparison, encoder, evaluation, grid_data, grid_pictures, groups, session  # noqa: E402
from hthor.train.grid_pictures import Pictures  # noqa: E402
from hthor.train.grid_worlds import GridWorlds  # noqa: E402
from hthor.train.watcher import Watcher  # noqa: E402

SMALL = CLASSES.index(catalog.TARGETS[0])
KINDS = (SMALL, CLASSES.index("floor"), CLASSES.index("wall"))
COLOURS = np.array([(230, 30, 30), (40, 200, 40), (40, 40, 220)], np.uint8)


def made_up(count: int, seed: int) -> Pictures:
    """Pictures of which each cell has the colour of its class; it is as far off as its class is high."""
    rng = np.random.default_rng(seed)
    kind = np.kron(rng.integers(0, len(KINDS), (count, 1, 2)), np.ones((1, GRID, 4), int))[:, :, :GRID]
    rgb = np.kron(COLOURS[kind], np.ones((1, 8, 8, 1), np.uint8))
    shown = np.array(KINDS, np.uint8)[kind].reshape(count, CELLS)
    return Pictures(rgb, shown, (kind * 100).astype(np.uint8).reshape(count, CELLS))


@pytest.fixture
def pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    held = {"train": made_up(60, 0), "validation": made_up(20, 1)}
    monkeypatch.setattr(encoder, "load_pictures", lambda split, *_, **__: held[split])


class StopsAfter(Watcher):
    """Sends a signal to this process after so many batches."""

    def __init__(self, batches: int) -> None:
        self.left = batches

    def seeing(self, pictures: int, total: int) -> None:
        self.left -= 1
        if self.left == 0:
            signal.raise_signal(signal.SIGTERM)


def files(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir()) if path.is_file()}


@pytest.mark.slow
@pytest.mark.usefixtures("pictures")
def test_an_encoder_learns_to_name_what_it_sees_and_goes_on_where_it_was(tmp_path: Path) -> None:
    config = encoder.Config(pictures=1_600, batch=8, every=800, learning_rate=3e-3)
    row = encoder.train(config, tmp_path / "whole", "cpu", None, Watcher())
    assert row is not None
    first = json.loads((tmp_path / "whole" / "metrics.jsonl").read_text().splitlines()[0])
    assert row["train"]["loss"] < 0.5 * first["train"]["loss"]
    found = row["validation"]
    assert found["right"] > 0.8
    assert found["small_found"] > 0.8
    assert found["small_right"] > 0.8
    assert found["range_error_m"] < 1.0
    assert encoder.train(config, tmp_path / "parts", "cpu", None, StopsAfter(30)) is None
    assert encoder.train(config, tmp_path / "parts", "cpu", None, Watcher()) == row
    assert files(tmp_path / "parts") == files(tmp_path / "whole")
    with pytest.raises(HthorError, match=r"other settings \(batch\)"):
        encoder.train(msgspec.structs.replace(config, batch=4), tmp_path / "whole", "cpu", None, Watcher())


@pytest.mark.usefixtures("pictures")
def test_the_command_shows_how_well_it_reads_new_houses(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("COLUMNS", "120")
    options = ["train", "encoder", "--pictures", "64", "--out", str(tmp_path / "one"), "--quiet"]
    done = CliRunner().invoke(app, options)
    assert done.exit_code == 0, done.output
    assert "cells named rightly" in done.stdout
    assert f"--profile paper --encoder {tmp_path / 'one'}" in " ".join(done.stderr.split())
    again = CliRunner().invoke(app, [*options, "--json"])
    assert set(json.loads(again.stdout)) == {"folder", "frames", "train", "validation"}


def test_weights_are_read_as_they_were_written_and_others_are_refused(tmp_path: Path) -> None:
    network = PictureEncoder(len(CLASSES), 6)
    data = picture_encoder.dump(network)
    assert picture_encoder.dump(picture_encoder.load(data)) == data
    assert picture_encoder.dump(network.double()) == data
    with pytest.raises(HthorError, match=r"encoder\.safetensors cannot be read: .*'hthor train encoder --out"):
        picture_encoder.read_file(tmp_path)
    for damaged in (data[:100], savn_checkpoint.tensors.save({"classes.bias": torch.zeros(3)})):
        (tmp_path / "encoder.safetensors").write_bytes(damaged)
        with pytest.raises(HthorError, match="does not hold the weights of an encoder of pictures"):
            picture_encoder.read_file(tmp_path)


def test_a_code_is_the_same_alone_and_among_others_in_any_size() -> None:
    torch.manual_seed(0)
    network = PictureEncoder(len(CLASSES), 6).double()
    for height, width in ((104, 160), (56, 56), (64, 90)):
        some = torch.randint(0, 256, (3, height, width, 3), dtype=torch.uint8)
        codes = network.encode(some)
        assert codes.shape == (3, CELLS, CODE)
        assert torch.equal(network.encode(some[1:2])[0], codes[1])
    assert network.features(codes).shape == (3, CELLS, 6)


@given(st.integers(7, 30), st.integers(7, 30), st.integers(0, 2**32 - 1))
def test_the_mean_depth_of_a_cell_is_that_of_its_pixels(height: int, width: int, seed: int) -> None:
    depth = np.random.default_rng(seed).random((height, width)).astype(np.float32)
    row, column = np.arange(height) * GRID // height, np.arange(width) * GRID // width
    expected = [depth[np.ix_(row == i, column == j)].mean(dtype=float) for i in range(GRID) for j in range(GRID)]
    np.testing.assert_allclose(mean_depths(depth), expected, rtol=1e-6)


def test_codes_of_a_grid_are_those_of_its_pictures_and_are_kept(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    house = houses.load("hazel")
    objects = next(task for task in tasks.load_suite("smoke").tasks if task.house == "hazel").objects
    monkeypatch.setattr(grid_pictures.houses, "make_house", lambda *_: house)
    monkeypatch.setattr(grid_pictures.houses, "make_arrangement", lambda *_: objects)
    key: grid_data.Key = ("test", 0, 0)
    whole = make_grid(0)
    start = np.array([(house.start.x, house.start.y)])
    grid = msgspec.structs.replace(
        whole, places=start, rooms=whole.rooms[:1], shown=whole.shown[:16], visible=whole.visible[:16]
    )
    monkeypatch.setattr(grid_pictures, "load_grid", lambda _: grid)
    monkeypatch.setattr(grid_pictures, "build_grids", lambda *_, **__: {key: grid})
    torch.manual_seed(0)
    networks = [PictureEncoder(len(CLASSES), 6) for _ in range(2)]
    told: list[tuple[int, int]] = []

    def fill(entries: Any, jobs: Any, progress: Any) -> None:  # in this process
        for one in entries:
            if not one.path.is_file():
                grid_pictures.array_cache.write(one)
                told.append((1, 1))

    monkeypatch.setattr(grid_pictures.array_cache, "fill", fill)
    taken = grid_pictures.load_pictures("test", 1, 10)
    assert taken.rgb.shape == (10, 104, 160, 3)
    poses = [int(np.flatnonzero((grid.shown == row).all(1))[0]) for row in taken.shown]
    assert poses == sorted(set(poses))
    for network in networks:
        (found,) = grid_pictures.load_grids("test", 1, 1, encoder=picture_encoder.dump(network))
        assert found.codes is not None
        assert np.array_equal(found.codes[poses], network.encode(torch.from_numpy(taken.rgb)).numpy())
    assert len(told) == 3
    grid_pictures.load_grids("test", 1, 1, encoder=picture_encoder.dump(networks[0]))
    assert len(told) == 3, "codes that are there are not made again"
    assert grid_pictures.load_grids("test", 1, 1)[0].codes is None


def coded(seed: int) -> Any:
    grid = make_grid(seed)
    rng = np.random.default_rng(seed)
    return msgspec.structs.replace(grid, codes=rng.integers(0, 256, (len(grid.visible), CELLS, CODE)).astype(np.uint8))


@pytest.fixture
def eyes(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """A folder with an encoder; grids have codes instead of being drawn."""
    grids = {"train": [coded(0)], "validation": [coded(1)], "test": [coded(2)]}

    def load(split: str, *_: Any, encoder: bytes | None, **__: Any) -> list[Any]:
        return grids[split] if encoder is not None else [make_grid(3)]

    monkeypatch.setattr(session, "load_grids", load)
    monkeypatch.setattr(comparison, "load_grids", load)
    monkeypatch.setattr(session, "VALIDATION_EPISODES", 10)
    monkeypatch.setattr(evaluation, "MOST_ACTIONS", {"rooms": 8, "houses": 8})
    torch.manual_seed(0)
    folder = tmp_path / "eyes"
    folder.mkdir()
    (folder / "encoder.safetensors").write_bytes(picture_encoder.dump(PictureEncoder(len(CLASSES), 8)))
    return folder


TINY = ["channels=8", "image=4", "goal=4", "action=3", "fused=2", "hidden=8", "window=3", "updates=2"]


def train(out: Path, *settings: str, **more: Any) -> Any:
    wanted = [*(f"network.{one}" for one in TINY), "frames=300", "batch=8", "horizon=9", *settings]
    learner, config = algorithms.make("savn", wanted, "paper")
    setup = session.Setup(algorithm="savn", out=out, every=300, device="cpu", **more)
    return session.run(learner, config, setup, Watcher())


def test_the_profile_of_the_paper_trains_on_codes_and_keeps_its_encoder(eyes: Path, tmp_path: Path) -> None:
    row = train(tmp_path / "one", encoder=eyes)
    assert row["frames"] >= 300
    before = (eyes / "encoder.safetensors").read_bytes()
    network = savn_checkpoint.load(tmp_path / "one").network
    assert picture_encoder.dump(network.encoder) == before
    train(tmp_path / "next", begin=tmp_path / "one")
    assert picture_encoder.dump(savn_checkpoint.load(tmp_path / "next").network.encoder) == before
    found = groups.load_groups([tmp_path / "one", tmp_path / "next"])
    assert groups.find_encoder(found) == before
    arena = comparison.make_arena(GridWorlds([coded(2)], "houses"), "houses", "test", 4)
    names = [one.name for one in comparison.robots(arena.worlds, arena.episodes, found, variants=True)]
    assert "savn, with a map" in names
    assert "savn, ideal detector" not in names
    compared = comparison.compare(found, comparison.Setup(houses=1, episodes=3, zones=("houses",)), Watcher())
    assert {row.robot for row in compared.rows if row.split == "test"} == set(names)


def test_what_does_not_fit_together_is_refused(eyes: Path, tmp_path: Path) -> None:
    train(tmp_path / "one", encoder=eyes)
    with pytest.raises(HthorError, match="give either --begin or --encoder"):
        train(tmp_path / "next", encoder=eyes, begin=tmp_path / "one")
    with pytest.raises(HthorError, match="the encoder of pictures has other sizes than this network"):
        train(tmp_path / "next", "network.channels=9", encoder=eyes)
    with pytest.raises(HthorError, match="the checkpoint to begin with has other sizes than this network"):
        train(tmp_path / "next", begin=savn_agent.CHECKPOINTS / "savn")
    learner, config = algorithms.make("a2c")
    setup = session.Setup(algorithm="a2c", out=tmp_path / "slim", encoder=eyes, device="cpu")
    with pytest.raises(HthorError, match="add --profile paper"):
        session.run(learner, config, setup, Watcher())
    both = groups.load_groups([savn_agent.CHECKPOINTS / "savn", tmp_path / "one"])
    with pytest.raises(HthorError, match="be compared in one call"):
        groups.find_encoder(both)


def test_the_encoder_that_ships_fits_the_published_network() -> None:
    shipped = picture_encoder.read_file(groups.SHIPPED / "encoder")
    _, config = algorithms.make("savn", (), "paper")
    assert config.network == PAPER
    network = session.loop.make_network(config, None, picture_encoder.dump(shipped))
    assert network.encoder.classes.out_features == len(CLASSES)
    picture = torch.zeros((1, 104, 160, 3), dtype=torch.uint8)
    likely = network.likelihood((network.encoder.encode(picture),), torch.tensor([CLASSES.index(GOALS[0])]))
    assert likely.shape == (1, CELLS)
