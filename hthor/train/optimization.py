"""The steps of every training: batches, the optimizer, its learning rate, and a state to go on from."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import torch
from msgspec import Struct
from torch import Tensor

from hthor.train.training_state import TrainingState, load_state, save_state

Batch = Callable[[int], tuple[Tensor, int, dict[str, float]]]
"""Makes batch number so: the loss, how many frames it has, and what was measured."""
Report = Callable[[int, dict[str, float] | None], None]
"""Is called after each batch with the number of frames so far, and every so often with means of what was measured."""


class Schedule(Struct, frozen=True, kw_only=True):
    """How long a training is.

    Attributes:
        frames: actions or pictures to train on. every: of them between two reports of means.
        learning_rate: falls evenly to a tenth. clip: largest norm of a gradient.
    """

    frames: int
    every: int
    learning_rate: float
    clip: float = math.inf


def optimize(
    state: TrainingState,
    batch: Batch,
    schedule: Schedule,
    folder: Path,
    *,
    report: Report,
    save: Callable[[], None],
    stops: Callable[[], bool],
) -> bool:
    """Train ``state.network``, going on from where a training in the same folder stopped.

    Args:
        folder: of the training's state. save: writes the network, after each report of means.
        stops: whether to stop after this batch, as after a signal.

    Returns:
        Whether it has come to its end; the state is kept either way.

    Raises:
        HthorError: when the state in the folder is damaged, or of another network. FloatingPointError: when the loss is
            not finite.
    """
    load_state(folder, state)
    frames, every = schedule.frames, schedule.every
    while state.frames < frames:
        if stops():
            save_state(folder, state)
            return False
        for group in state.optimizer.param_groups:
            group["lr"] = schedule.learning_rate * (1.0 - 0.9 * state.frames / frames)
        loss, played, measured = batch(state.batches)
        state.optimizer.zero_grad()
        loss.backward()
        measured["gradient"] = float(torch.nn.utils.clip_grad_norm_(state.network.parameters(), schedule.clip))
        state.optimizer.step()
        measured["loss"] = float(loss.detach())
        if not math.isfinite(measured["loss"]):
            raise FloatingPointError(f"the loss is {measured['loss']} after {state.batches} batches")
        before, state.frames, state.batches = state.frames, state.frames + played, state.batches + 1
        state.add(measured)
        if state.frames // every > before // every or state.frames >= frames:
            report(state.frames, state.take_means())
            save_state(folder, state)
            save()
        else:
            report(state.frames, None)
    return True
