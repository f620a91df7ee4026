"""The network of SAVN: an actor-critic that adapts its weights within an episode by the gradient of a learned loss.

Self-adaptive visual navigation (Wortsman et al., CVPR 2019): after every few actions the policy takes one step down the
gradient of a loss that is itself learned, computed from nothing but the policy's own hidden states and action
probabilities. Training goes through those steps, so that the weights which an episode starts with, and the loss, make
the adapted policy good. With ``updates=0`` the same network is the ordinary actor-critic of that paper.

A batch of episodes runs in lock-step, each with weights of its own; see `FastWeights`. Needs the extra ``torch``.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, NamedTuple

from msgspec import Struct, structs

from hthor.agents.skills.picture_encoder import PictureEncoder
from hthor.agents.skills.semantic_cells import CELLS
from hthor.errors import MissingExtra

try:
    import torch
    from torch import Tensor, nn
    from torch.nn import functional as F  # noqa: N812
except ModuleNotFoundError as error:
    raise MissingExtra("SAVN", "torch") from error

ACTIONS = ("ahead", "left", "right", "up", "down", "done")
"""The published action set: 0.25 m ahead, 45 degrees to a side, the camera 30 degrees up or down, "here it is"."""


class NetworkConfig(Struct, frozen=True, kw_only=True):
    """The sizes of a network and how it adapts; the defaults are those of the profile "slim".

    Attributes:
        profile: "slim" reads a class and a range per cell, "paper" features of the colour picture per cell.
        words: length of a word vector. classes: of things that a cell can show, the empty cell included.
        embedding: numbers that stand for a cell's class. channels: features of a cell, for "paper".
        image, goal, action: channels of the three inputs after their first layer. fused: channels after the second.
        hidden: size of the recurrent state. dropout: share of fused and image channels dropped in training.
        window: actions between two adaptations. updates: how often an episode adapts at most, 0 for never.
        rate: step size of an adaptation.
    """

    profile: Literal["slim", "paper"] = "slim"
    words: int = 50
    classes: int = 1
    embedding: int = 8
    channels: int = 512
    image: int = 16
    goal: int = 16
    action: int = 10
    fused: int = 8
    hidden: int = 128
    dropout: float = 0.0
    window: int = 6
    updates: int = 4
    rate: float = 0.01


PAPER = NetworkConfig(profile="paper", image=64, goal=64, fused=64, hidden=512, dropout=0.25, rate=1e-4)
"""The published constants (Wortsman et al. 2019 and its released code), but word vectors have length 50, not 300."""


class Memory(NamedTuple):
    """What a network carries from one action to the next: hidden and cell state (B, hidden), and the probabilities of
    the last action (B, 6), zero before the first.
    """

    hidden: Tensor
    cell: Tensor
    action: Tensor


class FastWeights:
    """The weights of each episode of a batch, as what its adaptations added to the weights that all share.

    For an affine layer ``y = W x + b`` the gradient of a loss is the sum over its uses ``j`` of ``d_j x_j^T`` for the
    weights and of ``d_j`` for the bias, where ``d_j`` is the gradient with respect to ``y_j``. So after a step of size
    ``rate`` the layer computes ``W x + b - rate * sum_j d_j (x_j . x + 1)``, without the 1 if it has no bias. Keeping
    the pairs (x_j, d_j) of each episode is exact, can be differentiated again, and needs no copy of the weights per
    episode. A layer that is used at every cell of a picture has many uses in one step, so for it the sum is kept as a
    matrix per episode.

    Args:
        rate: step size.
        again: whether the steps are to be differentiated too, as training does.
    """

    def __init__(self, rate: float, again: bool) -> None:
        self._rate, self._again = rate, again
        self._added: dict[str, tuple[Tensor, Tensor]] = {}
        self._used: list[tuple[str, Tensor, Tensor]] = []
        self.notes_uses = True
        """Whether another adaptation will follow, for which the layers' uses have to be kept."""

    def __call__(self, name: str, layer: nn.Linear, x: Tensor) -> Tensor:
        """What a layer computes in each episode.

        Args:
            x: (B, in), or (B, cells, in) for a layer that is used at every cell.
        """
        y: Tensor = layer(x)
        added = self._added.get(name)
        if added is not None and x.dim() == 3:
            y = y - self._rate * torch.baddbmm(added[1].unsqueeze(1), x, added[0].mT)
        elif added is not None:
            match = torch.bmm(added[0], x.unsqueeze(2))
            y = y - self._rate * torch.bmm(added[1].mT, match if layer.bias is None else match + 1.0).squeeze(2)
        if self.notes_uses:
            self._used.append((name, x, y))
        return y

    def step(self, loss: Tensor) -> None:
        """Adapt every episode to its own loss.

        Args:
            loss: the sum over the episodes. They share nothing but the first weights, so the gradient with respect to
                an episode's outputs is that of its own loss.
        """
        outputs = [y for _, _, y in self._used]
        gradients = torch.autograd.grad(loss, outputs, create_graph=self._again, allow_unused=True)
        fresh: dict[str, list[tuple[Tensor, Tensor]]] = {}
        for (name, x, _), gradient in zip(self._used, gradients, strict=True):
            if gradient is not None:
                fresh.setdefault(name, []).append((x, gradient))
        for name, uses in fresh.items():
            self._add(name, uses)
        self._used = []

    def keep(self, episodes: Tensor) -> None:
        """Go on with some of the episodes only, numbers (K,) of them; not while uses are kept."""
        if self._used:
            raise ValueError("episodes can only be left out between two adaptations")
        self._added = {name: (one[episodes], other[episodes]) for name, (one, other) in self._added.items()}

    def _add(self, name: str, uses: Sequence[tuple[Tensor, Tensor]]) -> None:
        old = self._added.get(name)
        if uses[0][0].dim() == 3:
            x, d = torch.cat([x for x, _ in uses], 1), torch.cat([d for _, d in uses], 1)
            new = (torch.bmm(d.mT, x), d.sum(1))
            if old is not None:
                new = (old[0] + new[0], old[1] + new[1])
        else:
            new = (torch.stack([x for x, _ in uses], 1), torch.stack([d for _, d in uses], 1))
            if old is not None:
                new = (torch.cat((old[0], new[0]), 1), torch.cat((old[1], new[1]), 1))
        self._added[name] = new if self._again else (new[0].detach(), new[1].detach())


class Network(nn.Module):
    """The policy, its critic and its learned loss.

    The policy's layers adapt within an episode; the critic, the learned loss and the table of classes do not.

    Attributes:
        words: (classes, words), a vector of length 1 for each class; goals are named by them too.
        table: for "slim", numbers that stand for each class. encoder: for "paper", makes the features; its weights are
            made before and stay as they are.
    """

    words: Tensor

    def __init__(self, config: NetworkConfig) -> None:
        super().__init__()
        self.config = config
        self.register_buffer("words", torch.zeros(config.classes, config.words))
        channels = config.channels
        if config.profile == "slim":
            self.table = nn.Embedding(config.classes, config.embedding)
            channels = config.embedding + 6  # see `_cells`
        else:
            self.encoder = PictureEncoder(config.classes, channels).requires_grad_(False)
        self.image = nn.Linear(channels, config.image)
        self.goal = nn.Linear(config.words, config.goal)
        self.action = nn.Linear(len(ACTIONS), config.action)
        self.fused = nn.Linear(config.image, config.fused)
        self.aim = nn.Linear(config.goal + config.action, config.fused, bias=False)
        self.gates = nn.Linear(config.fused * CELLS + config.hidden, 4 * config.hidden)
        self.actor = nn.Linear(config.hidden, len(ACTIONS))
        self.critic = nn.Linear(config.hidden, 1)
        self.loss_1 = nn.Conv1d(config.window, 10, 2)
        self.loss_2 = nn.Conv1d(10, 1, 2, dilation=2)

    def begin(self, batch: int) -> Memory:
        """The memory before the first action of ``batch`` episodes."""
        like = self.critic.weight
        return Memory(*(like.new_zeros(batch, n) for n in (self.config.hidden, self.config.hidden, len(ACTIONS))))

    def forward(
        self, features: Sequence[Tensor], goal: Tensor, memory: Memory, fast: FastWeights
    ) -> tuple[Tensor, Tensor, Memory]:
        """Logits of the actions (B, 6), the value (B,) and the new memory.

        Args:
            features: for "slim" the classes (B, cells) and the ranges (B, cells), for "paper" the encoder's codes
                (B, cells, 32). goal: (B,) int64, classes. fast: the episodes' own weights.
        """
        drop = self.config.dropout if self.training else 0.0
        image = F.relu(fast("image", self.image, self._cells(features, goal)))
        image = F.dropout(image, drop) if drop else image
        wanted = F.relu(fast("goal", self.goal, self.words[goal]))
        last = F.relu(fast("action", self.action, memory.action))
        # One layer over an image's cells with goal and action at each of them, which are the same at all.
        aim = fast("aim", self.aim, torch.cat((wanted, last), 1))
        fused = F.relu(fast("fused", self.fused, image) + aim.unsqueeze(1))
        fused = F.dropout(fused, drop) if drop else fused
        gates = fast("gates", self.gates, torch.cat((fused.flatten(1), memory.hidden), 1))
        n = self.config.hidden  # the cell by hand: the library's cannot be differentiated twice
        write, keep, show = torch.sigmoid(gates[:, : 3 * n]).chunk(3, 1)
        cell = keep * memory.cell + write * torch.tanh(gates[:, 3 * n :])
        hidden = show * torch.tanh(cell)
        logits = fast("actor", self.actor, hidden)
        return logits, self.critic(hidden).squeeze(1), Memory(hidden, cell, logits.softmax(1))

    def _cells(self, features: Sequence[Tensor], goal: Tensor) -> Tensor:
        """(B, cells, channels) of what the image layer reads: of a slim cell what it is, how like the goal in meaning,
        whether it is the goal, and how far, near distances also on a finer scale.
        """
        if self.config.profile == "paper":
            return self.encoder.features(features[0])
        classes, ranges = features[0], features[1].to(self.words.dtype)
        likeness = (self.words[goal] @ self.words.T).gather(1, classes)
        near = torch.exp(-6.0 * ranges)
        same = (classes == goal.unsqueeze(1)).to(ranges.dtype)
        return torch.cat(
            (self.table(classes), torch.stack((likeness, ranges, near, same, same * ranges, same * near), 2)), 2
        )

    def likelihood(self, features: Sequence[Tensor], goal: Tensor) -> Tensor:
        """(B, cells) how likely each cell shows the goal: for "slim" 0 or 1, as the detector says, for "paper" from 0
        to 1, as the encoder believes.
        """
        if self.config.profile == "paper":
            logits, _ = self.encoder.read(self.encoder.features(features[0]))
            return logits.softmax(2)[torch.arange(len(goal)), :, goal]
        return (features[0] == goal.unsqueeze(1)).to(self.words.dtype)

    def learned_loss(self, window: Tensor) -> Tensor:
        """(B,) from the hidden states and action probabilities of a window, (B, window, hidden + 6).

        Two convolutions slide over the numbers of a state, with the window's actions as their channels, as in the
        released code; the loss is the length of what comes out.
        """
        x = F.leaky_relu(self.loss_1(F.pad(window, (1, 0))))
        x = F.leaky_relu(self.loss_2(F.pad(x, (2, 0)))).flatten(1)
        return torch.sqrt(x.square().sum(1) + 1e-8)  # the square root of exactly zero has no gradient


def without_adaptation(network: Network) -> Network:
    """The same weights in a network that never adapts."""
    copy = Network(structs.replace(network.config, updates=0))
    copy.to(network.words.dtype).load_state_dict(network.state_dict())
    copy.eval()
    return copy


def draw_actions(logits: Tensor, generator: torch.Generator) -> Tensor:
    """(B,) int64, an action for each row of logits (B, 6), with the probabilities that they stand for."""
    chance = logits.detach().softmax(1)
    return (chance / torch.empty_like(chance).exponential_(generator=generator)).argmax(1)


class AdaptiveRun:
    """Runs a network through a batch of episodes in lock-step and adapts its weights to each of them.

    Attributes:
        memory: what the network carries to the next action. fast: what each episode's adaptations added.
        adaptations: how many there were. goal: as in the arguments.

    Args:
        goal: (B,) int64, the class that each episode looks for.
        learning: whether the run is to be differentiated, adaptations included; if not, nothing is kept that the next
            adaptation does not need.
    """

    def __init__(self, network: Network, goal: Tensor, learning: bool) -> None:
        self.network, self.goal, self._learning = network, goal, learning
        self.memory = network.begin(len(goal))
        self.fast = FastWeights(network.config.rate, learning)
        self.fast.notes_uses = network.config.updates > 0
        self.adaptations = 0
        self._window: list[Tensor] = []

    def step(self, features: Sequence[Tensor], alive: Tensor | None = None) -> tuple[Tensor, Tensor]:
        """Logits (B, 6) and values (B,) for the next action; adapts after the last action of a window.

        Args:
            features: see `Network.forward`. alive: (B,) 1 for episodes that go on, 0 for those that have ended, which
                do not adapt any more; None if all go on.
        """
        with torch.set_grad_enabled(self._learning or self.fast.notes_uses):
            logits, value, self.memory = self.network(features, self.goal, self.memory, self.fast)
            if self.fast.notes_uses:
                self._window.append(torch.cat((self.memory.hidden, self.memory.action), 1))
                if len(self._window) == self.network.config.window:
                    self._adapt(alive)
        return logits, value

    def keep(self, episodes: Tensor) -> None:
        """Go on with some of the episodes only, numbers (K,) of them, when a window has just ended.

        Raises:
            ValueError: within a window, if another adaptation follows.
        """
        self.fast.keep(episodes)
        self.goal = self.goal[episodes]
        self.memory = Memory(*(part[episodes] for part in self.memory))

    def divergence(self, features: Sequence[Tensor]) -> Tensor:
        """(B,) how far adaptation has moved the policy at what is seen now: the divergence (Kullback-Leibler) [nats] of
        the next action's probabilities from those with the weights that the run began with.
        """
        notes, self.fast.notes_uses = self.fast.notes_uses, False  # this look is no part of the episode
        with torch.no_grad():
            fast = (self.fast, FastWeights(0.0, again=False))
            logits = [self.network(features, self.goal, self.memory, one)[0] for one in fast]
        self.fast.notes_uses = notes
        adapted, first = (row.log_softmax(1) for row in logits)
        return (adapted.exp() * (adapted - first)).sum(1).clamp(min=0.0)

    def _adapt(self, alive: Tensor | None) -> None:
        loss = self.network.learned_loss(torch.stack(self._window, 1))
        self.fast.step((loss if alive is None else loss * alive).sum())
        self._window = []
        self.adaptations += 1
        self.fast.notes_uses = self.adaptations < self.network.config.updates
        if not self._learning:
            self.memory = Memory(*(part.detach() for part in self.memory))
