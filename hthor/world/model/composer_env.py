"""A composer environment that does no work while nothing moves, and in which a step can be a tick of a trial.

Bodies are puppets without contacts in the engine. So every tree of the engine sleeps, and a tick costs nothing, except
while an object falls or a door swings. The states are bitwise those of an environment that makes every step.

The long step at which resting things fall asleep is far too long for falling things, which would pass through a board
between two steps. So a step in which anything moves farther than `STEP_TRAVEL_MAX_M` or turns farther than
`STEP_TURN_MAX_RAD` is split.
"""

import math
from collections.abc import Callable
from typing import Any

import dm_env
import numpy as np

from hthor.errors import WorldClosed
from hthor.world.model.engine import Environment, composer, mujoco
from hthor.world.model.trial_control import TrialControl
from hthor.world.records import EngineRecord

QPose = tuple[float, float, float, float, float, float, float]
"""Position [m] and unit quaternion (w, x, y, z) of a free object."""
STEP_TRAVEL_MAX_M = 0.003
"""[m] The longest travel in one step of the engine: a fifth of the thinnest board."""
STEP_TURN_MAX_RAD = 0.2
"""[rad] The largest turn in one step: with larger turns, thin things would spin ever faster."""
RESTLESS_TICKS, _RESTLESS_PARTS = 20, 4
"""After so many ticks without rest, steps are split into so many parts, because some long things would tremble."""
DAMP_TICKS, DAMP_TOLERANCE = 50, 0.5
"""After so many ticks without rest, the engine's sleep tolerance is raised to the second number to end trembling."""
_PARTS_MAX = 64
"""The most parts that a step is split into."""
# fmt: off
_ARRAYS = (
    "qpos", "qvel", "qacc", "qacc_smooth", "qacc_warmstart", "xfrc_applied", "energy", "tree_asleep", "tree_awake",
    "body_awake", "body_awake_ind", "parent_awake_ind", "dof_awake_ind", "bvh_active", "xpos", "xquat", "xmat",
    "xipos", "ximat", "xanchor", "xaxis", "geom_xpos", "geom_xmat", "subtree_com", "cinert", "cdof", "crb", "M",
    "qLD", "qLDiagInv", "cvel", "cdof_dot", "subtree_linvel", "subtree_angmom", "cacc", "cfrc_ext", "cfrc_int",
    "qDeriv", "qH", "qHDiagInv", "qLU", "qfrc_applied", "qfrc_bias", "qfrc_passive", "qfrc_constraint",
    "qfrc_damper", "qfrc_gravcomp", "qfrc_smooth", "qfrc_spring", "qfrc_fluid",
)
# fmt: on
"""What the engine keeps from step to step: its state, and what it does not compute again of things that sleep."""
_COUNTS = ("time", "nbody_awake", "nparent_awake", "ntree_awake", "nv_awake")
SPEED_MAX_M_S, SPIN_MAX_RAD_S = 20.0, 300.0
"""[m/s, rad/s] Limits on speed along and spin about any axis: above them things would pass through boards or spin ever
faster.
"""


class LazyComposerEnv(Environment):
    """The environment of a `HouseTask`.

    By itself it is an ordinary composer environment with the usual `reset` and `step`, in which bodies stand still.
    With a `TrialControl`, `reset` begins a trial and `step` is one tick of it. `Simulation` needs neither: it calls
    `begin` and `tick`, which reset the engine and make one control step; a control does so too, through its simulation.
    """

    def __init__(self, task: Any) -> None:
        super().__init__(
            task,
            random_state=0,
            legacy_step=False,
            recompile_mjcf_every_episode=False,
            strip_singleton_obs_buffer_dim=True,
        )
        self._shut = False
        self._mjcf_never_compiled = False  # the constructor has just compiled it; composer would compile it again

    def hand_over(self, control: TrialControl | None) -> None:
        """From now on a step is a tick of ``control``'s trial, which begins at the next reset; None: an engine's step.

        A control step then has a single substep, the tick, so that observables are updated once in it.
        """
        self._task.take(control)
        self._n_sub_steps = self._steps_per_tick if control is None else 1
        self._observation_updater = self._make_observation_updater()
        self._observation_updater.reset(self._physics_proxy, self._random_state)
        self._reset_next_step = True

    def close(self) -> None:
        """Let go of the control; an environment without one frees the engine, and its world with it."""
        if self._task.control is not None:
            self.hand_over(None)
        elif not self._shut:
            super().close()

    def shut(self, house: str) -> None:
        """Free the engine, with a control or without one; from then on whatever needs it raises WorldClosed."""
        self._task.take(None)
        super().close()
        self._physics = self._physics_proxy = _ClosedEngine(house)
        self._shut = True

    def _recompile_physics(self) -> None:
        super()._recompile_physics()
        self.model, self.data = self._physics.model.ptr, self._physics.data.ptr
        self.asleep = self.data.tree_asleep  # per tree, below 0 while awake
        self._carried = np.full(self.model.ntree, -(1 << 30), np.int32)  # 0 while that tree is carried
        self._held: dict[int, tuple[int, int, Callable[[], QPose]]] = {}
        self._still, self._restless = False, 0
        self._puppets = np.flatnonzero(self.model.body_mocapid >= 0).tolist()
        self._step_s = float(self.model.opt.timestep)
        self._steps_per_tick = self._task.physics_steps_per_control_step
        free = self.model.jnt_dofadr[self.model.jnt_type == int(mujoco.mjtJoint.mjJNT_FREE)]
        self._free = (free[:, None] + np.arange(6)).ravel()
        self._limits = np.tile((STEP_TRAVEL_MAX_M,) * 3 + (STEP_TURN_MAX_RAD,) * 3, len(free)) / self._step_s
        self._sound = self.data.qpos.copy()
        self._most = np.tile((SPEED_MAX_M_S,) * 3 + (SPIN_MAX_RAD_S,) * 3, len(free))

    def begin(self) -> None:
        """Start an episode of the engine: nothing is carried, and all sleeps at the place that the task gives it."""
        self._held.clear()
        self._carried[:] = -(1 << 30)
        self._still, self._restless = False, 0
        self._reset_next_step = self._task.control is not None  # an episode that the control did not begin is not its
        with self._physics.reset_context():
            self._hooks.initialize_episode(self._physics_proxy, self._random_state)

    def _reset_attempt(self) -> Any:
        """What composer does, but a control begins the episode of the engine itself."""
        if self._task.control is None:
            self.begin()
        else:
            self._task.control.reset()
            self._show_puppets()
        self._observation_updater.reset(self._physics_proxy, self._random_state)
        self._reset_next_step = False
        return dm_env.restart(self._observation_updater.get_observation())

    def _substep(self, action: Any) -> None:
        """One of the engine's steps; with a control, a tick."""
        if self._task.control is None:
            super()._substep(action)
            return
        self._hooks.before_substep(self._physics_proxy, action, self._random_state)
        self._task.control.advance()
        self._reset_next_step = False  # a trial whose task begins after a tour goes on, though the engine began again
        self._show_puppets()
        self._hooks.after_substep(self._physics_proxy, self._random_state)

    def _make_observation_updater(self) -> Any:
        steps = self._steps_per_tick if self._task.control is None else 1
        return composer.observation.Updater(self._task.observables, steps, self._strip_singleton_obs_buffer_dim)

    def _show_puppets(self) -> None:
        """Move the mocap bodies' shapes to their poses, which the engine does only when something else moves.

        It does this as `mj_kinematics` does, which must not be called here: it would wake what is carried.
        """
        model, data = self.model, self.data
        for body in self._puppets:
            place, turn = data.mocap_pos[model.body_mocapid[body]], data.mocap_quat[model.body_mocapid[body]]
            if (data.xpos[body] == place).all() and (data.xquat[body] == turn).all():
                continue
            data.xpos[body], data.xquat[body] = place, turn
            mujoco.mju_quat2Mat(data.xmat[body], turn)
            pos, quat, frame = model.body_ipos[body], model.body_iquat[body], model.body_sameframe[body]
            mujoco.mj_local2Global(data, data.xipos[body], data.ximat[body], pos, quat, body, frame)
            first = int(model.body_geomadr[body])
            for geom in range(first, first + int(model.body_geomnum[body])):
                pos, quat, frame = model.geom_pos[geom], model.geom_quat[geom], model.geom_sameframe[geom]
                mujoco.mj_local2Global(data, data.geom_xpos[geom], data.geom_xmat[geom], pos, quat, body, frame)

    @property
    def still(self) -> bool:
        """Whether nothing but carried objects moves."""
        return self._still

    def carry(self, tree: int, qpos: int, dof: int, pose: Callable[[], QPose]) -> None:
        """From now on the free object of ``tree`` follows ``pose()``; ``qpos`` and ``dof`` are its addresses."""
        self._held[tree] = (qpos, dof, pose)
        self._carried[tree] = 0

    def release(self, tree: int, pose: QPose) -> None:
        """Let go of the object at ``pose``; from then on the engine moves it."""
        qpos, dof, _ = self._held.pop(tree)
        self._carried[tree] = -(1 << 30)
        self.data.qpos[qpos : qpos + 7] = pose
        self.data.qvel[dof : dof + 6] = 0.0
        self.touch()

    def touch(self) -> None:
        """Note that the state was changed: shapes are moved at once, and the next tick checks whether anything moves.

        If shapes were moved later, two things could be put in one place in one tick.
        """
        self._still, self._restless = False, 0
        mujoco.mj_kinematics(self.model, self.data)

    def pin(self) -> None:
        """Write the carried objects' poses."""
        for qpos, dof, pose in self._held.values():
            self.data.qpos[qpos : qpos + 7] = pose()
            self.data.qvel[dof : dof + 6] = 0.0

    def before(self, qpos: int) -> QPose:
        """The pose, before the last tick that moved anything, of the free object with this address."""
        x, y, z, *turn = self._sound[qpos : qpos + 7].tolist()
        return (x, y, z, *turn)

    def tick(self) -> bool:
        """Make one control step; returns whether anything may have moved. Carried objects are moved only by `pin`."""
        if self._still:
            return False
        self.pin()
        mujoco.mj_kinematics(self.model, self.data)  # wakes the trees whose state was changed
        if not self._quiet():
            self._sound[:] = self.data.qpos
            for _ in range(self._steps_per_tick):
                self._advance()
            self.pin()
            mujoco.mj_kinematics(self.model, self.data)
        self._still = self._quiet()
        self._restless = 0 if self._still else self._restless + 1
        return True

    def record(self) -> EngineRecord:
        """The state of the engine, from which it goes on bitwise the same; what is carried is not in it."""
        data = self.data
        arrays = {name: getattr(data, name).tobytes() for name in _ARRAYS}
        arrays["qpos0"] = self.model.qpos0.tobytes()
        counts = {name: float(getattr(data, name)) for name in _COUNTS}
        return EngineRecord(arrays, counts, self._still, self._restless)

    def restore(self, record: EngineRecord) -> None:
        """Go back to a state of this model; nothing is carried until `carry` is called."""
        self._held.clear()
        self._carried[:] = -(1 << 30)
        self._still, self._restless = record.still, record.restless
        _write(self.model.qpos0, record.arrays["qpos0"])
        mujoco.mj_resetData(self.model, self.data)
        for name in _ARRAYS:
            _write(getattr(self.data, name), record.arrays[name])
        for name in _COUNTS:
            setattr(self.data, name, type(getattr(self.data, name))(record.counts[name]))

    def fits(self, record: EngineRecord) -> bool:
        """Whether a record has all that this model's state consists of."""
        sizes = {name: getattr(self.data, name).nbytes for name in _ARRAYS} | {"qpos0": self.model.qpos0.nbytes}
        return {name: len(raw) for name, raw in record.arrays.items()} == sizes and set(record.counts) == set(_COUNTS)

    def _advance(self) -> None:
        """Make one step of the engine, in as many parts as the fastest object needs."""
        haste = float((np.abs(self.data.qvel[self._free]) / self._limits).max(initial=0.0))
        parts = math.ceil(haste) if haste < _PARTS_MAX else _PARTS_MAX  # also for NaN, which the engine then reports
        if parts <= 1 and self._restless < RESTLESS_TICKS:
            mujoco.mj_step(self.model, self.data)
            return
        if parts <= _RESTLESS_PARTS:
            self._steps(
                _RESTLESS_PARTS, DAMP_TOLERANCE if self._restless >= DAMP_TICKS else self.model.opt.sleep_tolerance
            )
        else:
            self._steps(parts, 0.0)  # a thing that stands still for a millisecond is not at rest

    def _steps(self, parts: int, drowsy: float) -> None:
        """Make one step of the engine in parts; things slower than ``drowsy`` fall asleep."""
        option, tolerance = self.model.opt, self.model.opt.sleep_tolerance
        option.timestep, option.sleep_tolerance = self._step_s / parts, drowsy
        for done in range(0, parts, _RESTLESS_PARTS):
            mujoco.mj_step(self.model, self.data, min(_RESTLESS_PARTS, parts - done))
            self._brake()
        option.timestep, option.sleep_tolerance = self._step_s, tolerance

    def _brake(self) -> None:
        """Limit speeds and spins to values that can be simulated: a thin thing that hits an edge would exceed them."""
        speeds = self.data.qvel[self._free]
        if (np.abs(speeds) > self._most).any():
            self.data.qvel[self._free] = np.clip(speeds, -self._most, self._most)

    def _quiet(self) -> bool:
        return bool(not len(self.asleep) or np.maximum(self.asleep, self._carried).min() >= 0)

    def warnings(self) -> dict[str, int]:
        """The engine's warnings since the last reset or `recover`, such as a bad acceleration, and their places: for a
        bad state, the number of a degree of freedom.
        """
        if not self.data.warning.number.any():
            return {}
        found = enumerate(self.data.warning)
        return {mujoco.mjtWarning(kind).name: int(one.lastinfo) for kind, one in found if one.number}

    def recover(self) -> None:
        """Put everything back, at rest, to where it was before the last tick, whose result the engine has lost."""
        mujoco.mj_resetData(self.model, self.data)
        self.data.qpos[:] = self._sound
        self.touch()


class _ClosedEngine:
    """Stands for the engine of a world that was closed."""

    def __init__(self, house: str) -> None:
        self._house = house

    def __getattr__(self, name: str) -> Any:
        raise WorldClosed.of(self._house)


def _write(array: Any, raw: bytes) -> None:
    """Fill an array of the engine with bytes."""
    array[:] = np.frombuffer(raw, array.dtype).reshape(array.shape)
