"""A composer environment that does no work while nothing moves; knows nothing of seats, tasks or goals.

Bodies are puppets that meet nothing, so between the rare moments when an object falls or a door swings every tree of
the engine sleeps and a tick costs nothing. Stepping lazily gives bit for bit the states that stepping always gives.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from hthor.world.engine import Environment, mujoco

QPose = tuple[float, float, float, float, float, float, float]
"""Position [m] and unit quaternion (w, x, y, z) of a free object."""


class FastEnv(Environment):
    """The environment of a `HouseTask`.

    It is a composer environment like any other: `reset` and `step` do what they always do. `tick` is the short way
    through one control step that `World` takes.
    """

    def __init__(self, task: Any) -> None:
        super().__init__(task, random_state=0, legacy_step=False, recompile_mjcf_every_episode=False)
        self._mjcf_never_compiled = False  # the constructor has just compiled it; composer would do it again

    def _recompile_physics(self) -> None:
        super()._recompile_physics()
        self.model, self.data = self._physics.model.ptr, self._physics.data.ptr
        self.asleep = self.data.tree_asleep  # per tree, below 0 while awake
        self._carried = np.full(self.model.ntree, -(1 << 30), np.int32)  # 0 while that tree is carried
        self._held: dict[int, tuple[int, int, Callable[[], QPose]]] = {}
        self._still = False

    def reset(self) -> Any:
        """Start an episode: nothing is carried, everything sleeps where the task puts it."""
        self._held.clear()
        self._carried[:] = -(1 << 30)
        self._still = False
        return super().reset()

    @property
    def still(self) -> bool:
        """Whether nothing but carried objects moves."""
        return self._still

    def carry(self, tree: int, qpos: int, dof: int, pose: Callable[[], QPose]) -> None:
        """From now on the free object of ``tree`` follows ``pose()``; ``qpos`` and ``dof`` are its addresses."""
        self._held[tree] = (qpos, dof, pose)
        self._carried[tree] = 0

    def release(self, tree: int, pose: QPose) -> None:
        """Let go of the object at ``pose``; the engine takes it from there."""
        qpos, dof, _ = self._held.pop(tree)
        self._carried[tree] = -(1 << 30)
        self.data.qpos[qpos : qpos + 7] = pose
        self.data.qvel[dof : dof + 6] = 0.0
        self.touch()

    def touch(self) -> None:
        """Say that the state was written to, so that the next tick looks whether anything moves."""
        self._still = False

    def pin(self) -> None:
        """Write the carried objects' poses."""
        for qpos, dof, pose in self._held.values():
            self.data.qpos[qpos : qpos + 7] = pose()
            self.data.qvel[dof : dof + 6] = 0.0

    def tick(self) -> bool:
        """One control step; says whether anything may have moved. What is carried moves only by `pin`."""
        if self._still:
            return False
        self.pin()
        mujoco.mj_kinematics(self.model, self.data)  # wakes the trees whose state was written to
        if not self._quiet():
            mujoco.mj_step(self.model, self.data, self._n_sub_steps)
            self.pin()
            mujoco.mj_kinematics(self.model, self.data)
        self._still = self._quiet()
        return True

    def _quiet(self) -> bool:
        return bool(not len(self.asleep) or np.maximum(self.asleep, self._carried).min() >= 0)

    def warnings(self) -> tuple[str, ...]:
        """What the engine complained about in this episode, such as a bad acceleration."""
        numbers = (warning.number for warning in self.data.warning)
        return tuple(mujoco.mjtWarning(kind).name for kind, count in enumerate(numbers) if count)
