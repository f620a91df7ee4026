"""Trainings from beginning to end on small grids, their resuming, and what stops them."""

from __future__ import annotations

import json
import signal
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest

torch = pytest.importorskip("torch", reason="needs torch: pip install 'hthor[torch]'", exc_type=ImportError)

from small_grids import make_grid  # noqa: E402
from typer.testing import CliRunner  # noqa: E402

from hthor.agents.skills import savn_checkpoint  # noqa: E402
from hthor.agents.skills.savn_network import NetworkConfig  # noqa: E402
from hthor.agents.skills.semantic_cells import CELLS, CLASSES, GOALS  # noqa: E402
from hthor.cli import app  # noqa: E402
from hthor.errors import HthorError, UnknownName  # noqa: E402
from hthor.train import algorithms, bc, evaluation, loop, savn, session  # noqa: E402
from hthor.train.grid_worlds import DONE, GridWorlds  # noqa: E402
from hthor.train.watcher import Watcher  # noqa: E402

TINY = NetworkConfig(embedding=3, image=4, goal=4, action=3, fused=2, hidden=8, window=3, updates=2)
ALGORITHMS = ("savn", "a2c", "bc")
SETTINGS = ["frames=1200", "batch=16", "horizon=8"]


@pytest.fixture(autouse=True)
def small_grids(monkeypatch: pytest.MonkeyPatch) -> None:
    grids = {"train": [make_grid(0), make_grid(1)], "validation": [make_grid(2)]}
    monkeypatch.setattr(session, "load_grids", lambda split, *_, **__: grids[split])
    monkeypatch.setattr(session, "VALIDATION_EPISODES", 10)
    monkeypatch.setattr(evaluation, "MOST_ACTIONS", {"rooms": 8, "houses": 8})


class StopsAfter(Watcher):
    """Sends a signal to this process after so many batches."""

    def __init__(self, batches: int) -> None:
        self.left = batches

    def training(self, frames: int, total: int) -> None:
        del frames, total
        self.left -= 1
        if self.left == 0:
            signal.raise_signal(signal.SIGTERM)


def make(name: str, *settings: str) -> tuple[Any, Any]:
    learner, config = algorithms.make(name, [*SETTINGS, *settings])
    updates = config.network.updates and TINY.updates
    return learner, msgspec.structs.replace(config, network=msgspec.structs.replace(TINY, updates=updates))


def train(name: str, out: Path, watcher: Any = None, **more: Any) -> dict[str, Any] | None:
    setup = session.Setup(algorithm=name, out=out, every=400, device="cpu", **more)
    return session.run(*make(name), setup, watcher or Watcher())


def files(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir()) if path.is_file()}


@pytest.mark.parametrize("name", ALGORITHMS)
def test_a_training_that_was_stopped_ends_like_one_that_was_not(name: str, tmp_path: Path) -> None:
    handlers = [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)]
    row = train(name, tmp_path / "whole")
    assert row is not None
    assert row["frames"] >= 1200
    assert train(name, tmp_path / "parts", StopsAfter(2)) is None
    assert not (tmp_path / "parts" / "model.safetensors").exists()
    assert train(name, tmp_path / "parts", StopsAfter(7)) is None
    assert train(name, tmp_path / "parts") == row
    assert files(tmp_path / "parts") == files(tmp_path / "whole")
    assert train(name, tmp_path / "parts") == row  # nothing is left to do
    assert handlers == [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)]
    rows = [json.loads(line) for line in (tmp_path / "whole" / "metrics.jsonl").read_text().splitlines()]
    assert [one["frames"] // 400 for one in rows] == [1, 2, 3]
    assert all(set(one) == {"frames", "train", "rooms", "houses"} for one in rows)


def test_a_checkpoint_is_read_as_it_was_written_and_another_training_starts_from_it(tmp_path: Path) -> None:
    train("bc", tmp_path / "bc")
    begin = savn_checkpoint.load(tmp_path / "bc")
    setup = session.Setup(algorithm="a2c", out=tmp_path / "next", begin=tmp_path / "bc", device="cpu", zones="rooms")
    learner, config = make("a2c", "learning_rate=0")
    config = msgspec.structs.replace(config, learning_rate=0.0, network=begin.network.config)
    row = session.run(learner, config, setup, Watcher())
    assert row is not None
    assert set(row) == {"frames", "train", "rooms"}
    after = savn_checkpoint.load(tmp_path / "next")
    assert after.classes == begin.classes
    for name, value in begin.network.state_dict().items():
        assert torch.equal(value, after.network.state_dict()[name]), name


def test_a_folder_with_another_training_or_a_damaged_one_is_refused(tmp_path: Path) -> None:
    out = tmp_path / "one"
    train("a2c", out, StopsAfter(2))
    with pytest.raises(HthorError, match=r"other settings \(algorithm, training\)"):
        train("bc", out)
    with pytest.raises(HthorError, match=r"other settings \(zones\)"):
        train("a2c", out, zones="rooms")
    state = out / "state.safetensors"
    state.write_bytes(state.read_bytes()[:1000])
    with pytest.raises(HthorError, match=r"state\.safetensors is not the state of this training"):
        train("a2c", out)


def test_a_damaged_checkpoint_is_named(tmp_path: Path) -> None:
    train("a2c", tmp_path)
    whole = files(tmp_path)
    with pytest.raises(HthorError, match="cannot be read: No such file"):
        savn_checkpoint.load(tmp_path / "nowhere")
    config = json.loads(whole["config.json"])
    for document, words in (
        ("{", "is not JSON"),
        (json.dumps({**config, "classes": config["classes"][1:]}), "names 109 classes, but its network is for 110"),
        (json.dumps({**config, "network": {**config["network"], "hidden": 9}}), "does not hold the weights"),
    ):
        (tmp_path / "config.json").write_text(document)
        with pytest.raises(HthorError, match=words):
            savn_checkpoint.load(tmp_path)
    (tmp_path / "config.json").write_bytes(whole["config.json"])
    (tmp_path / "model.safetensors").write_bytes(whole["model.safetensors"][:500])
    with pytest.raises(HthorError, match=r"model\.safetensors does not hold the weights"):
        savn_checkpoint.load(tmp_path)


def test_settings_are_checked() -> None:
    _, config = algorithms.make("savn", ["network.rate=.5", "entropy=0.02", "wrong_ends=true"], seed=3)
    assert (config.network.rate, config.entropy, config.wrong_ends, config.seed) == (0.5, 0.02, True, 3)  # type: ignore[attr-defined]
    assert algorithms.make("a2c")[1].network.updates == 0
    with pytest.raises(UnknownName, match="Did you mean 'entropy'"):
        algorithms.make("savn", ["entropi=1"])
    with pytest.raises(UnknownName, match="unknown setting 'network'"):
        algorithms.make("savn", ["network=1"])
    with pytest.raises(HthorError, match=r"batch=many: Expected `int`"):
        algorithms.make("savn", ["batch=many"])
    with pytest.raises(HthorError, match="written KEY=VALUE"):
        algorithms.make("savn", ["batch"])
    with pytest.raises(UnknownName, match="Did you mean 'savn'"):
        algorithms.make("savm")
    with pytest.raises(HthorError, match="the device 'abacus' cannot be used here"):
        session.choose_device("abacus")


def test_advantages_are_those_of_the_definition() -> None:
    config = savn.Config(batch=2)
    g = torch.Generator().manual_seed(0)
    steps, gamma, trace = 5, config.gamma, config.trace
    value, reward = (torch.randn(steps, 2, generator=g, dtype=torch.float64) for _ in range(2))
    alive = torch.ones(steps, 2, dtype=torch.float64)
    alive[3:, 1] = 0.0
    chosen = torch.randn(steps, 2, generator=g, dtype=torch.float64, requires_grad=True)
    after = torch.tensor([0.7, 0.0], dtype=torch.float64)
    rollout = savn.Rollout(chosen, torch.zeros_like(value), value, reward * alive, alive, after, alive[0] > 0)
    savn.loss_of(rollout, config).backward()
    for episode, length in ((0, 5), (1, 3)):
        values = [*value[:length, episode].tolist(), float(after[episode]) if length == steps else 0.0]
        for t in range(length):
            surprises = [reward[k, episode] + gamma * values[k + 1] - values[k] for k in range(t, length)]
            advantage = sum((gamma * trace) ** k * one for k, one in enumerate(surprises))
            assert float(chosen.grad[t, episode]) == pytest.approx(-float(advantage) / 2)
    assert not chosen.grad[3:, 1].any()


def test_the_expert_s_way_is_a_shortest_one() -> None:
    worlds = GridWorlds([make_grid(0)], "houses")
    pose, goal, least = worlds.draw(64, torch.Generator().manual_seed(4))
    for step in range(1, int(least.max()) + 1):
        action = bc.expert_action(worlds, pose, goal)
        assert torch.equal(action == DONE, least <= step)
        pose = worlds.go(pose, action)


def test_learning_finds_what_is_to_be_found(tmp_path: Path) -> None:
    """On one small house with two kinds of things, after two thousandths of a real training, far better than before."""
    grid = make_grid(0)
    seen, goal = grid.visible > 0, np.random.default_rng(0).integers(0, 2, len(grid.visible))
    shown = np.zeros_like(grid.shown)
    shown[:, CELLS // 2] = np.where(seen, np.array([CLASSES.index(name) for name in GOALS[:2]])[goal], 0)
    grid = msgspec.structs.replace(grid, shown=shown, visible=np.where(seen, 1 << goal, 0).astype(np.uint16))
    found: list[float] = []
    network = msgspec.structs.replace(TINY, hidden=32, fused=8, updates=0)
    config = savn.Config(network=network, frames=40_000, batch=32, horizon=20, learning_rate=1e-2)

    def report(frames: int, means: dict[str, float] | None) -> None:
        del frames
        if means is not None:
            found.append(means["success"])

    loop.train(
        savn.learn, config, loop.make_network(config), [GridWorlds([grid], "houses")], tmp_path, report, every=10_000
    )
    assert found[-1] > 0.2 > 2.0 * found[0]


def test_the_command_says_how_it_went_and_what_comes_next(tmp_path: Path) -> None:
    out = tmp_path / "mine"
    options = ["--out", str(out), "--frames", "0.3k", "--every", "200", "--batch", "16", "--device", "cpu"]
    sizes = [f"network.{name}={getattr(TINY, name)}" for name in ("image", "goal", "fused", "hidden", "window")]
    options += [word for size in (*sizes, "horizon=8") for word in ("--set", size)]
    done = CliRunner().invoke(app, ["train", "savn", *options])
    assert done.exit_code == 0, done.output
    assert "success" in done.stdout
    assert f"hthor eval --agent none --agent savn:{out} --humans proxy" in done.stderr.replace("\n", " ")
    again = CliRunner().invoke(app, ["train", "savn", *options, "--json"])
    row = json.loads(again.stdout)
    assert row["folder"] == str(out)
    assert row["frames"] >= 300
    wrong = CliRunner().invoke(app, ["train", "savn", "--frames", "lots"])
    assert wrong.exit_code == 2
    assert "is not a number such as 250000" in " ".join(wrong.output.split())
