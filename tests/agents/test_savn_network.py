"""The network of SAVN: low-rank fast weights against explicit ones, and what an adaptation changes."""

from __future__ import annotations

from typing import Any

import msgspec
import pytest

torch = pytest.importorskip("torch", reason="needs torch: pip install 'hthor[torch]'", exc_type=ImportError)

from hthor.agents.skills import savn_network as savn  # noqa: E402
from hthor.agents.skills.picture_encoder import CODE  # noqa: E402
from hthor.agents.skills.semantic_cells import CELLS  # noqa: E402

torch.set_num_threads(1)  # two threads wait for each other longer than they compute
STEPS, BATCH = 30, 3
SLIM = savn.NetworkConfig(words=5, classes=9, embedding=3, image=4, goal=4, action=5, fused=3, hidden=6, rate=0.5)
PAPER = savn.NetworkConfig(
    profile="paper", words=5, classes=9, channels=5, image=4, goal=4, action=5, fused=3, hidden=6, rate=0.5
)
BOTH = pytest.mark.parametrize("config", [SLIM, PAPER], ids=["slim", "paper"])


def _network(config: Any, seed: int = 2) -> Any:
    torch.manual_seed(seed)
    network = savn.Network(config).double()
    with torch.no_grad():
        network.words.copy_(torch.nn.functional.normalize(torch.randn(config.classes, config.words)))
    return network


def _episodes(config: Any, seed: int = 1) -> tuple[list[tuple[Any, ...]], Any, list[Any]]:
    """Features of every step, the goals, and which episodes go on: the second ends in the middle of a window."""
    g = torch.Generator().manual_seed(seed)
    features: list[tuple[Any, ...]] = []
    for _ in range(STEPS):
        if config.profile == "slim":
            classes = torch.randint(0, config.classes, (BATCH, CELLS), generator=g)
            features.append((classes, torch.rand(BATCH, CELLS, generator=g, dtype=torch.float64)))
        else:
            features.append((torch.randint(0, 256, (BATCH, CELLS, CODE), generator=g).to(torch.uint8),))
    goal = torch.randint(0, config.classes, (BATCH,), generator=g)
    alive = [torch.tensor([1.0, float(step < 15), 1.0], dtype=torch.float64) for step in range(STEPS)]
    return features, goal, alive


def _objective(logits: list[Any], values: list[Any], alive: list[Any]) -> Any:
    """Something that depends on every output, as a loss of reinforcement learning does."""
    terms = [
        (row.log_softmax(1)[:, step % 6] * on + 0.3 * (value - 0.1 * step).square() * on).sum()
        for step, (row, value, on) in enumerate(zip(logits, values, alive, strict=True))
    ]
    return torch.stack(terms).sum()


def _low_rank(network: Any) -> tuple[Any, Any]:
    features, goal, alive = _episodes(network.config)
    run = savn.AdaptiveRun(network, goal, learning=True)
    outputs = [run.step(one, on) for one, on in zip(features, alive, strict=True)]
    assert run.adaptations == network.config.updates
    logits, values = [row for row, _ in outputs], [value for _, value in outputs]
    return torch.stack(logits, 1), _objective(logits, values, alive)


class _Plain(savn.FastWeights):
    """Adds nothing and keeps nothing: the weights that it is called with are the episode's own."""

    def __init__(self) -> None:
        super().__init__(0.0, again=True)
        self.notes_uses = False


def _explicit(network: Any) -> tuple[Any, Any]:
    """The same with a set of weights for each episode, adapted by gradient steps on the weights themselves."""
    config = network.config
    features, goal, alive = _episodes(config)
    fixed = ("loss_", "critic", "table", "encoder")
    adapted = [name for name, _ in network.named_parameters() if not name.startswith(fixed)]
    all_logits, terms = [], []
    for b in range(BATCH):
        weights = dict(network.named_parameters())
        memory, window, updates = network.begin(1), [], 0
        logits, values = [], []
        for step in range(STEPS):
            one = tuple(part[b : b + 1] for part in features[step])
            row, value, memory = torch.func.functional_call(
                network, weights, (one, goal[b : b + 1], memory, _Plain()), strict=False
            )
            logits.append(row)
            values.append(value)
            window.append(torch.cat((memory.hidden, memory.action), 1))
            if len(window) == config.window:
                if updates < config.updates:
                    loss = network.learned_loss(torch.stack(window, 1)).sum() * alive[step][b]
                    gradients = torch.autograd.grad(loss, [weights[name] for name in adapted], create_graph=True)
                    weights = weights | {
                        name: weights[name] - config.rate * gradient
                        for name, gradient in zip(adapted, gradients, strict=True)
                    }
                    updates += 1
                window = []
        all_logits.append(torch.cat(logits))
        terms.append(_objective(logits, values, [on[b : b + 1] for on in alive]))
    return torch.stack(all_logits), torch.stack(terms).sum()


@BOTH
def test_low_rank_fast_weights_equal_explicit_ones_in_value_and_in_every_meta_gradient(config: Any) -> None:
    network = _network(config)
    parameters = {name: weight for name, weight in network.named_parameters() if weight.requires_grad}
    found, objective = _low_rank(network)
    expected, same = _explicit(network)
    torch.testing.assert_close(found, expected, rtol=0.0, atol=1e-10)
    torch.testing.assert_close(objective, same, rtol=1e-10, atol=0.0)
    one = torch.autograd.grad(objective, list(parameters.values()))
    other = torch.autograd.grad(same, list(parameters.values()))
    for name, a, b in zip(parameters, one, other, strict=True):
        scale = float(b.abs().max())
        assert scale > 0.0, f"{name} has no gradient"
        torch.testing.assert_close(a, b, rtol=0.0, atol=1e-10 * max(1.0, scale), msg=lambda m, n=name: f"{n}: {m}")


@BOTH
def test_the_gradient_of_the_learned_loss_is_that_of_a_finite_difference(config: Any) -> None:
    network = _network(config)
    weight = network.loss_1.weight
    (gradient,) = torch.autograd.grad(_low_rank(network)[1], [weight])
    where = divmod(int(gradient.abs().flatten().argmax()), weight[0].numel())
    index = (where[0], *divmod(where[1], weight.shape[2]))
    values, step = [], 1e-5
    for sign in (1.0, -1.0):
        with torch.no_grad():
            weight[index] += sign * step
        values.append(float(_low_rank(network)[1].detach()))
        with torch.no_grad():
            weight[index] -= sign * step
    assert (values[0] - values[1]) / (2.0 * step) == pytest.approx(float(gradient[index]), rel=1e-5)


@BOTH
def test_an_adaptation_moves_the_policy_and_leaves_the_checkpoint_as_it_is(config: Any) -> None:
    network = _network(msgspec.structs.replace(config, rate=5.0))
    with torch.no_grad():
        for weight in network.parameters():
            weight *= 4.0  # as nothing has been learned yet, what it sees hardly moves it
    before = {name: value.clone() for name, value in network.state_dict().items()}
    features, goal, _ = _episodes(config)
    run, same = (savn.AdaptiveRun(network, goal, learning=False) for _ in range(2))
    for one in features[: config.window * config.updates]:
        run.step(one)
        run.divergence(one)  # changes nothing
        same.step(one)
    memory = run.memory
    assert torch.equal(memory.hidden, same.memory.hidden)
    with torch.no_grad():
        adapted, _, _ = network(features[-1], goal, memory, run.fast)
        frozen, _, _ = network(features[-1], goal, memory, _Plain())
    divergence = (adapted.softmax(1) * (adapted.log_softmax(1) - frozen.log_softmax(1))).sum(1)
    assert float(divergence.min()) > 1e-4
    torch.testing.assert_close(run.divergence(features[-1]), divergence)
    assert all(torch.equal(before[name], value) for name, value in network.state_dict().items())


@BOTH
def test_a_run_that_is_not_differentiated_gives_the_same_outputs_and_keeps_no_graph(config: Any) -> None:
    network = _network(config)
    features, goal, alive = _episodes(config)
    learning, acting = (savn.AdaptiveRun(network, goal, learning=learning) for learning in (True, False))
    for one, on in zip(features, alive, strict=True):
        torch.testing.assert_close(acting.step(one, on), learning.step(one, on), rtol=1e-12, atol=1e-12)
    assert not any(part.requires_grad for part in acting.memory)


def test_an_ended_episode_does_not_adapt() -> None:
    network, (features, goal, _) = _network(SLIM), _episodes(SLIM)
    run, plain = (savn.AdaptiveRun(one, goal, learning=False) for one in (network, _frozen(network)))
    over = torch.tensor([1.0, 0.0, 1.0], dtype=torch.float64)
    for one in features[:20]:
        logits, _ = run.step(one, over)
        unchanged, _ = plain.step(one)
    assert torch.equal(logits[1], unchanged[1])
    assert not torch.allclose(logits[0], unchanged[0])


@BOTH
def test_episodes_that_are_left_out_between_windows_change_nothing_for_the_others(config: Any) -> None:
    """Neither what the others do nor any gradient, as an ended episode adds nothing to either."""
    network = _network(config)
    features, goal, alive = _episodes(config)
    run = savn.AdaptiveRun(network, goal, learning=True)
    logits, values = [], []
    for step, (one, on) in enumerate(zip(features, alive, strict=True)):
        rest = torch.tensor([0, 1, 2] if step < 18 else [0, 2])  # the second has ended after 15
        if step == 18:
            run.keep(rest)
        row, value = run.step([part[rest] for part in one], on[rest])
        whole = row.new_zeros(BATCH, row.shape[1]).index_copy(0, rest, row)
        logits.append(whole)
        values.append(value.new_zeros(BATCH).index_copy(0, rest, value))
    shorter = _gradients(network, _objective(logits, values, alive))
    expected, objective = _low_rank(network)
    torch.testing.assert_close(torch.stack(logits, 1)[[0, 2]], expected[[0, 2]], rtol=1e-12, atol=1e-12)
    for one, other in zip(shorter, _gradients(network, objective), strict=True):
        assert (one - other).abs().max() < 1e-12
    run = savn.AdaptiveRun(network, goal, learning=True)
    run.step(features[0])
    with pytest.raises(ValueError, match="between two adaptations"):
        run.keep(rest)


def _gradients(network: Any, objective: Any) -> list[Any]:
    parameters = [weight for weight in network.parameters() if weight.requires_grad]
    found = torch.autograd.grad(objective, parameters, allow_unused=True)
    return [torch.zeros_like(p) if g is None else g for p, g in zip(parameters, found, strict=True)]


def _frozen(network: Any) -> Any:
    """The same weights in a network that never adapts."""
    copy = savn.Network(msgspec.structs.replace(network.config, updates=0)).double()
    copy.load_state_dict(network.state_dict())
    return copy
