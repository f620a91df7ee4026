"""A search for one kind of thing that a network leads, one action after another. Needs the extra ``torch``."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hthor.agents.skills.detector_noise import DetectorNoise
from hthor.agents.skills.savn_checkpoint import Checkpoint
from hthor.agents.skills.savn_network import ACTIONS, AdaptiveRun, draw_actions, without_adaptation
from hthor.agents.skills.semantic_cells import FAR_M, GRID, LEVELS, CellReader, mean_depths
from hthor.errors import MissingExtra
from hthor.geometry.plane import wrap
from hthor.types import Briefing, Camera, Motion, Move, Observation, Pose, Rotate, Vec3, Wait

try:
    import torch
    from torch import Tensor
except ModuleNotFoundError as error:
    raise MissingExtra("SAVN", "torch") from error

STEP_M, TURN_RAD, TILT_RAD = 0.25, math.radians(45.0), math.radians(30.0)
"""The published action set; a step along a diagonal is longer by the square root of 2, as on the training's lattice."""
MOST_ACTIONS = 200
"""After so many actions, the longest episode of an evaluation, a search begins again from where the robot stands."""


class Decision(NamedTuple):
    """What a network decided.

    Attributes:
        motion: the motion; None for "here it is". position: [m], house frame, where it believes the thing to be.
        divergence: [nats] how far adaptation had moved the policy when it had just adapted; None if it had not.
    """

    motion: Motion | None
    position: Vec3
    divergence: float | None


class NetworkSearch:
    """Runs a checkpoint's network through a trial.

    Args:
        adapts: whether the network adapts, if it was made to. noisy: whether its detector errs. seed: of all draws.
    """

    def __init__(self, checkpoint: Checkpoint, briefing: Briefing, *, adapts: bool, noisy: bool, seed: int) -> None:
        torch.set_num_threads(1)  # more threads wait for each other longer than they compute
        network = checkpoint.network.double()  # so that processors, which round differently, decide alike
        self._network = network if adapts else without_adaptation(network)
        self._classes, self._labels = checkpoint.classes, briefing.labels
        self._noise = DetectorNoise(checkpoint.classes, torch.device("cpu")) if noisy else None
        self._generator = torch.Generator().manual_seed(seed)
        self._reader: CellReader | None = None

    def begin(self, kind: str) -> bool:
        """Begin to search for a kind of thing; False if the network knows no such kind."""
        if kind not in self._classes:
            return False
        self._goal = torch.tensor([self._classes.index(kind)])
        self._run = AdaptiveRun(self._network, self._goal, learning=False)
        self._actions, self._told = 0, 0
        return True

    def decide(self, observation: Observation) -> Decision:
        """The next action."""
        if self._actions == MOST_ACTIONS:
            self.begin(self._classes[int(self._goal)])
        self._actions += 1
        features, metres = self._look(observation)
        divergence = None
        if self._run.adaptations > self._told:
            self._told = self._run.adaptations
            divergence = float(self._run.divergence(features))
        logits, _ = self._run.step(features)
        action = ACTIONS[int(draw_actions(logits, self._generator))]
        likely = self._network.likelihood(features, self._goal)[0].numpy() > 0.5
        position = _believed(observation.camera, observation.pose, likely, metres)
        return Decision(make_motion(action, observation.pose), position, divergence)

    def _look(self, observation: Observation) -> tuple[Sequence[Tensor], NDArray[np.float64]]:
        """What the network reads of what the robot sees, and how far off each cell is, (cells,) [m]."""
        if self._network.config.profile == "paper":
            picture = torch.from_numpy(np.array(observation.rgb)).unsqueeze(0)
            return (self._network.encoder.encode(picture),), mean_depths(observation.depth)
        segmentation = observation.segmentation
        if self._reader is None:
            height, width = segmentation.shape
            self._reader = CellReader(self._labels, (width, height), self._classes)
        cells = self._reader.read(segmentation, observation.depth)
        shown, behind = (torch.from_numpy(one.astype(np.int64)).unsqueeze(0) for one in (cells.shown, cells.behind))
        ranges = torch.from_numpy(cells.depth.astype(np.float32) / LEVELS).unsqueeze(0)
        if self._noise is not None:
            shown = self._noise(shown, behind, ranges, self._generator)
        return (shown, ranges), ranges[0].numpy().astype(np.float64) * FAR_M


def _believed(camera: Camera, pose: Pose, likely: NDArray[np.bool_], metres: NDArray[np.float64]) -> Vec3:
    """The middle of the nearest cell that is likely to show the thing; a step ahead of the robot if none is.

    Args:
        likely, metres: (cells,), and how far off each cell is [m].
    """
    cells = np.flatnonzero(likely)
    if not len(cells):
        return (pose.x + math.cos(pose.yaw), pose.y + math.sin(pose.yaw), float(camera.pose[2, 3]))
    cell = int(cells[metres[cells].argmin()])
    width, height = camera.size
    pixel = np.array([(cell % GRID + 0.5) * width / GRID, (cell // GRID + 0.5) * height / GRID, 1.0])
    ray = np.linalg.inv(camera.matrix) @ pixel * float(metres[cell])
    x, y, z = (camera.pose @ np.append(ray, 1.0))[:3].tolist()
    return (x, y, z)


def align(pose: Pose) -> Rotate | None:
    """The turn to the nearest heading and tilt of the training's lattice; None if the robot has one of them."""
    yaw = wrap(round(pose.yaw / TURN_RAD) * TURN_RAD - pose.yaw)
    pitch = (-TILT_RAD if pose.pitch < -0.5 * TILT_RAD else 0.0) - pose.pitch
    return None if abs(yaw) < 1e-6 and abs(pitch) < 1e-6 else Rotate(yaw=yaw, pitch=pitch)


def make_motion(action: str, pose: Pose) -> Motion | None:
    """The motion that an action stands for at a pose; None for "done"."""
    heading = round(pose.yaw / TURN_RAD)
    match action:
        case "done":
            return None
        case "ahead":
            return Move(forward=STEP_M * (math.sqrt(2.0) if heading % 2 else 1.0))
        case "left" | "right":
            turn = 1 if action == "left" else -1
            return Rotate(yaw=wrap((heading + turn) * TURN_RAD - pose.yaw))
        case _:
            pitch = (0.0 if action == "up" else -TILT_RAD) - pose.pitch
            return Rotate(pitch=pitch) if abs(pitch) > 1e-6 else Wait()
