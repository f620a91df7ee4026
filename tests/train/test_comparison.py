"""Comparisons of robots on pose grids: walkers, lists of episodes, intervals, and the numbers of what ships."""

from __future__ import annotations

import json
from pathlib import Path

import msgspec
import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="needs torch: pip install 'hthor[torch]'", exc_type=ImportError)

from small_grids import make_grid  # noqa: E402
from typer.testing import CliRunner  # noqa: E402

from hthor import jsonio  # noqa: E402
from hthor.agents.skills import savn_checkpoint  # noqa: E402
from hthor.agents.skills.savn_network import without_adaptation  # noqa: E402
from hthor.cli import app  # noqa: E402
from hthor.errors import HthorError  # noqa: E402
from hthor.train import comparison, evaluation, groups  # noqa: E402
from hthor.train.controls import robots  # noqa: E402
from hthor.train.grid_worlds import BOTH, DONE, GridWorlds  # noqa: E402
from hthor.train.map_walker import MapWalker  # noqa: E402
from hthor.train.resampling import Sums, add_up, difference, rate  # noqa: E402
from hthor.train.training_state import TrainConfig  # noqa: E402
from hthor.train.walkers import Aids, ExpertWalker, NetworkWalker, RandomWalker  # noqa: E402

SHIPPED = [groups.SHIPPED / "savn", groups.SHIPPED / "a2c"]
GRIDS = [make_grid(seed) for seed in range(3)]


@pytest.fixture(scope="module")
def shipped() -> list[groups.Group]:
    return groups.load_groups(SHIPPED)


@pytest.fixture(scope="module")
def arena() -> comparison.Arena:
    return comparison.make_arena(GridWorlds(GRIDS, "houses"), "houses", "test", 8)


def generator() -> torch.Generator:
    return torch.Generator().manual_seed(7)


def actions(walker: object, arena: comparison.Arena, steps: int = 6) -> torch.Tensor:
    """(steps, E) what a walker does when it is led along the same way as any other."""
    pose, alive = arena.episodes.pose, torch.ones(len(arena.house))
    found, chance = [], generator()
    for _ in range(steps):
        found.append(walker.act(pose, alive))  # type: ignore[attr-defined]
        pose = arena.worlds.go(pose, torch.randint(DONE, pose.shape, generator=chance))
    return torch.stack(found)


def test_the_expert_is_as_good_as_can_be_and_ideal_done_is_never_wrong(
    shipped: list[groups.Group], arena: comparison.Arena
) -> None:
    worlds, episodes = arena.worlds, arena.episodes
    best = evaluation.evaluate(ExpertWalker(worlds, episodes.goal), worlds, episodes, 200)
    assert best.found.all()
    assert torch.equal(best.actions, best.least)
    network = shipped[0].networks[0]
    for walker in (
        RandomWalker(worlds, episodes.goal, generator()),
        NetworkWalker(network, worlds, episodes.goal, generator(), Aids(ideal_done=True)),
    ):
        results = evaluation.evaluate(walker, worlds, episodes, 60)
        assert results.found.any()
        assert (results.found | (results.actions == 60)).all()
    assert not evaluation.evaluate(RandomWalker(worlds, None, generator()), worlds, episodes, 60).found.all()


def test_aids_change_what_they_name_and_nothing_else(shipped: list[groups.Group], arena: comparison.Arena) -> None:
    network, worlds, goal = shipped[0].networks[0], arena.worlds, arena.episodes.goal
    blank = [msgspec.structs.replace(grid, shown=np.zeros_like(grid.shown)) for grid in GRIDS]
    other = GridWorlds(blank, "houses")

    def walk(worlds: GridWorlds, **more: object) -> torch.Tensor:
        return actions(NetworkWalker(network, worlds, goal, generator(), **more), arena)  # type: ignore[arg-type]

    plain = walk(worlds, aids=Aids(noise=False))
    assert not torch.equal(plain, walk(other, aids=Aids(noise=False)))
    blind = Aids(sight=False, noise=False)
    assert torch.equal(walk(worlds, aids=blind), walk(other, aids=blind))
    assert not torch.equal(plain, walk(worlds))

    leader = MapWalker(worlds, None, "nearest")
    led = walk(worlds, aids=Aids(noise=False), explorer=leader)
    steps = actions(MapWalker(worlds, None, "nearest"), arena)
    assert not (steps == DONE).any()
    assert ((led == plain) | (led == steps)).all()
    assert torch.equal(led == DONE, plain == DONE)
    assert (led != plain).any()

    frozen = without_adaptation(network)
    assert frozen.config.updates == 0
    before = actions(NetworkWalker(frozen, worlds, goal, generator()), arena)
    assert torch.equal(before[: network.config.window], walk(worlds)[: network.config.window])


def test_an_episode_depends_on_its_house_only() -> None:
    few = comparison.make_arena(GridWorlds(GRIDS[:2], "rooms"), "rooms", "test", 5)
    more = comparison.make_arena(GridWorlds(GRIDS, "rooms"), "rooms", "test", 5)
    for one, other in zip(few.episodes, more.episodes, strict=True):
        assert torch.equal(one, other[:10])
    assert few.house.tolist() == [0] * 5 + [1] * 5
    assert (few.episodes.least >= 2).all()
    known = comparison.make_arena(GridWorlds(GRIDS[:2], "rooms"), "rooms", "train", 5)
    assert not torch.equal(known.episodes.pose, few.episodes.pose)
    assert jsonio.sha256([column.tolist() for column in few.episodes])[:10] == "b45ac5b096"


def test_intervals_are_those_of_houses_and_checkpoints() -> None:
    rng = np.random.default_rng(0)
    house = np.repeat(np.arange(40), 10)
    of_house, every = rng.normal(size=40), np.ones(400, np.bool_)
    values = np.repeat(of_house, 10)[None, :]
    found = rate(add_up(values, every, house), "one")
    assert found.ci95 is not None
    assert found.mean == pytest.approx(of_house.mean(), abs=1e-6)
    half = 1.96 * of_house.std() / np.sqrt(40)  # episodes of a house are all alike here
    assert found.ci95[1] - found.ci95[0] == pytest.approx(2.0 * half, rel=0.05)

    seeds = rng.normal(size=(30, 1)) + np.zeros((30, 400))
    found = rate(add_up(seeds, every, house), "one")
    assert found.ci95 is not None
    assert found.ci95[1] - found.ci95[0] == pytest.approx(2.0 * 1.96 * seeds[:, 0].std() / np.sqrt(30), rel=0.05)

    one = add_up(values, every, house)
    better = Sums(one.total + one.episodes, one.episodes)
    assert difference(better, one, ("one", "other")).ci95 == (1.0, 1.0)  # the same houses were drawn for both
    long = rng.random(400) < 0.3
    assert rate(add_up(values, long, house), "one").mean == pytest.approx(values[0, long].mean(), abs=1e-6)
    nothing = rate(add_up(values, ~every, house), "one")
    assert (nothing.mean, nothing.ci95) == (None, None)


def test_checkpoints_that_differ_in_the_seed_are_one_robot(tmp_path: Path) -> None:
    def copy(name: str, **training: object) -> Path:
        folder = tmp_path / name
        savn_checkpoint.save(folder, savn_checkpoint.load(SHIPPED[1]))
        if training:
            config = TrainConfig(
                algorithm="a2c", houses=1, arrangements=1, zones="both", every=1, begin="", training=training
            )
            (folder / "train_config.json").write_bytes(jsonio.pretty(config))
        return folder

    folders = [copy("s0", seed=0), copy("mine"), copy("s1", seed=1), copy("faster", seed=0, learning_rate=1)]
    found = groups.load_groups(folders)
    assert [(group.name, len(group.networks)) for group in found] == [("a2c", 2), ("mine", 1), ("a2c 2", 1)]
    config = json.loads((folders[1] / "config.json").read_text())
    config["classes"] = config["classes"][::-1]
    (folders[1] / "config.json").write_text(json.dumps(config))
    with pytest.raises(HthorError, match="classes: are not those that this version"):
        groups.load_groups(folders)
    (folders[0] / "train_config.json").write_text("{")
    with pytest.raises(HthorError, match=r"s0/train_config\.json: \$: is not JSON"):
        groups.load_groups(folders[:1])


def test_the_command_shows_and_writes_every_robot(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(comparison, "load_grids", lambda split, *_, **__: GRIDS[1:] if split == "test" else GRIDS[:1])
    monkeypatch.setattr(evaluation, "MOST_ACTIONS", {"rooms": 12, "houses": 12})
    monkeypatch.setenv("COLUMNS", "120")
    out = tmp_path / "eval.json"
    options = ["train", "eval", "--episodes", "3", "--out", str(out)]
    done = CliRunner().invoke(app, [*options, "--zones", "rooms"])
    assert done.exit_code == 0, done.output
    found = json.loads(out.read_bytes())
    names = [row["robot"] for row in found["rows"] if row["split"] == "test"]
    assert len(names) == len(set(names)) == 13
    words = " ".join(done.stdout.split())
    for name in names:
        assert name.removeprefix("savn, ") in words
    assert [row["robot"] for row in found["rows"] if row["split"] == "train"] == ["a2c", "savn, not adapted", "savn"]
    assert {one["other"] for one in found["differences"]} == set(names) - {"savn"}
    assert found["houses"] == {"test": 2, "train": 1}
    assert found["divergence"]["rooms"] > 0.0
    again = CliRunner().invoke(app, [*options, "--json", "--quiet", "--zones", "rooms"])
    assert json.loads(again.stdout) == found


@pytest.mark.slow
def test_what_ships_finds_what_it_found_before(shipped: list[groups.Group]) -> None:
    """100 episodes in a house and its rooms, to the digit: how many were found, and all actions together."""
    grids = comparison.load_grids("test", 1, 1)
    found = {}
    for zones in BOTH:
        arena = comparison.make_arena(GridWorlds(grids, zones), zones, "test", 50)
        for robot in robots(arena.worlds, arena.episodes, shipped, variants=True):
            if robot.name in ("random with ideal Done", "a2c", "savn", "savn, not adapted"):
                results = evaluation.evaluate(
                    robot.walkers[0](), arena.worlds, arena.episodes, evaluation.MOST_ACTIONS[zones]
                )
                found[f"{zones} {robot.name}"] = (int(results.found.sum()), int(results.actions.sum()))
    assert found == {
        "houses a2c": (23, 5952),
        "houses random with ideal Done": (7, 8694),
        "houses savn": (25, 5668),
        "houses savn, not adapted": (26, 5469),
        "rooms a2c": (36, 2193),
        "rooms random with ideal Done": (13, 4086),
        "rooms savn": (34, 2172),
        "rooms savn, not adapted": (31, 2317),
    }
