"""A composer environment that does no work while nothing moves.

Bodies are puppets that meet nothing, so between the rare moments when an object falls or a door swings every tree of
the engine sleeps and a tick costs nothing. Stepping lazily gives bit for bit the states that stepping always gives.

The long step at which resting things fall asleep is far too long for falling ones, which would be through a board
between one step and the next. So a step in which anything moves farther than `STEP_TRAVEL_MAX_M` or turns farther than
`STEP_TURN_MAX_RAD` is split.
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from hthor.world.model.engine import Environment, mujoco

QPose = tuple[float, float, float, float, float, float, float]
"""Position [m] and unit quaternion (w, x, y, z) of a free object."""
STEP_TRAVEL_MAX_M = 0.003
"""[m] The longest travel in one step of the engine: a fifth of the thinnest board."""
STEP_TURN_MAX_RAD = 0.2
"""[rad] The largest turn in one step: beyond it thin things would spin up without end."""
RESTLESS_TICKS, _RESTLESS_PARTS = 20, 4
"""After this many ticks without rest every step is split into this many parts: some long things tremble otherwise."""
DAMP_TICKS, DAMP_TOLERANCE = 50, 0.5
"""After this many ticks without rest the engine's sleep tolerance is raised to this value, so that trembling ends."""
_PARTS_MAX = 64
"""The most parts that a step is split into."""
SPEED_MAX_M_S, SPIN_MAX_RAD_S = 20.0, 300.0
"""[m/s, rad/s] Limits on speed along and spin about any axis: beyond them things would pass through boards, or spin up
without end.
"""


class LazyComposerEnv(Environment):
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
        self._still, self._restless = False, 0
        self._step_s = float(self.model.opt.timestep)
        free = self.model.jnt_dofadr[self.model.jnt_type == int(mujoco.mjtJoint.mjJNT_FREE)]
        self._free = (free[:, None] + np.arange(6)).ravel()
        self._limits = np.tile((STEP_TRAVEL_MAX_M,) * 3 + (STEP_TURN_MAX_RAD,) * 3, len(free)) / self._step_s
        self._sound = self.data.qpos.copy()
        self._most = np.tile((SPEED_MAX_M_S,) * 3 + (SPIN_MAX_RAD_S,) * 3, len(free))

    def reset(self) -> Any:
        """Start an episode: nothing is carried, everything sleeps where the task puts it."""
        self._held.clear()
        self._carried[:] = -(1 << 30)
        self._still, self._restless = False, 0
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
        """Say that the state was written to: shapes are there at once, and the next tick looks whether anything moves.

        Without the first, two things put in one place in one tick would not know of each other.
        """
        self._still, self._restless = False, 0
        mujoco.mj_kinematics(self.model, self.data)

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
            self._sound[:] = self.data.qpos
            for _ in range(self._n_sub_steps):
                self._advance()
            self.pin()
            mujoco.mj_kinematics(self.model, self.data)
        self._still = self._quiet()
        self._restless = 0 if self._still else self._restless + 1
        return True

    def _advance(self) -> None:
        """One step of the engine, in as many parts as the fastest object asks for."""
        haste = float((np.abs(self.data.qvel[self._free]) / self._limits).max(initial=0.0))
        parts = math.ceil(haste) if haste < _PARTS_MAX else _PARTS_MAX  # what is no number too: the engine will say so
        if parts <= 1 and self._restless < RESTLESS_TICKS:
            mujoco.mj_step(self.model, self.data)
            return
        if parts <= _RESTLESS_PARTS:
            self._steps(
                _RESTLESS_PARTS, DAMP_TOLERANCE if self._restless >= DAMP_TICKS else self.model.opt.sleep_tolerance
            )
        else:
            self._steps(parts, 0.0)  # still for a millisecond is not at rest

    def _steps(self, parts: int, drowsy: float) -> None:
        """One step of the engine in parts, what is slower than ``drowsy`` falling asleep."""
        option, tolerance = self.model.opt, self.model.opt.sleep_tolerance
        option.timestep, option.sleep_tolerance = self._step_s / parts, drowsy
        for done in range(0, parts, _RESTLESS_PARTS):
            mujoco.mj_step(self.model, self.data, min(_RESTLESS_PARTS, parts - done))
            self._brake()
        option.timestep, option.sleep_tolerance = self._step_s, tolerance

    def _brake(self) -> None:
        """Let nothing go or spin faster than can be stepped through: a thin thing that hits an edge would."""
        speeds = self.data.qvel[self._free]
        if (np.abs(speeds) > self._most).any():
            self.data.qvel[self._free] = np.clip(speeds, -self._most, self._most)

    def _quiet(self) -> bool:
        return bool(not len(self.asleep) or np.maximum(self.asleep, self._carried).min() >= 0)

    def warnings(self) -> dict[str, int]:
        """What the engine complained about since the last reset or `recover`, such as a bad acceleration, and where:
        for a bad state the number of a degree of freedom.
        """
        found = enumerate(self.data.warning)
        return {mujoco.mjtWarning(kind).name: int(one.lastinfo) for kind, one in found if one.number}

    def recover(self) -> None:
        """Put everything back where it was before the last tick, at rest; the engine has lost what came of it."""
        mujoco.mj_resetData(self.model, self.data)
        self.data.qpos[:] = self._sound
        self.touch()
