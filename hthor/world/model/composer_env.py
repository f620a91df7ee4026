"""A composer environment that does no work while nothing moves, and in which a step can be a tick of a trial.

Bodies are puppets without contacts in the engine. So every tree of the engine sleeps, and a tick costs nothing, except
while an object falls or a door swings. The states are bitwise those of an environment that makes every step.

The long step at which resting things fall asleep is far too long for falling things, which would pass through a board
between two steps. So a step in which anything moves farther than `STEP_TRAVEL_MAX_M` or turns farther than
`STEP_TURN_MAX_RAD` is split.
"""

import math
from collections.abc import Callable, Iterable
from typing import Any

import dm_env
import numpy as np

from hthor.errors import HthorError, UnknownName, WorldClosed
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
_HOOKS = ("initialize_episode", "before_step", "before_substep", "after_substep", "after_step")
_NUDGE_M_S = -1e-9
"""[m/s] Enough speed to wake a sleeping object, and too little to move it."""


class LazyComposerEnv(Environment):
    """The environment of a `HouseTask`.

    With a `TrialControl`, `reset` begins a trial and `step` is one tick of it; without one, bodies stand still, and
    objects fall. `Simulation` needs neither: it calls `begin` and `tick`, which reset the engine and make one control
    step; a control does so too, through its simulation.
    """

    def __init__(self, task: Any) -> None:
        self._closed_house = ""
        super().__init__(
            task,
            random_state=0,
            legacy_step=False,
            recompile_mjcf_every_episode=False,
            strip_singleton_obs_buffer_dim=True,
        )
        self.model, self.data = self.physics.model.ptr, self.physics.data.ptr
        self.asleep = self.data.tree_asleep  # per tree, below 0 while awake
        self._carried = np.full(self.model.ntree, -(1 << 30), np.int32)  # 0 while that tree is carried
        self._held: dict[int, tuple[int, int, Callable[[], QPose]]] = {}
        self._still, self._restless = False, 0
        self._puppets = np.flatnonzero(self.model.body_mocapid >= 0).tolist()
        self._step_s = float(self.model.opt.timestep)
        self._steps_per_tick = task.physics_steps_per_control_step
        free = self.model.jnt_dofadr[self.model.jnt_type == int(mujoco.mjtJoint.mjJNT_FREE)]
        self._free = (free[:, None] + np.arange(6)).ravel()
        self._limits = np.tile((STEP_TRAVEL_MAX_M,) * 3 + (STEP_TURN_MAX_RAD,) * 3, len(free)) / self._step_s
        self._sound = self.data.qpos.copy()
        self._most = np.tile((SPEED_MAX_M_S,) * 3 + (SPIN_MAX_RAD_S,) * 3, len(free))
        self._over = True
        self._extra_hooks: dict[str, list[Callable[..., Any]]] = {name: [] for name in _HOOKS}
        self.hand_over(None)

    def hand_over(self, control: TrialControl | None) -> None:
        """From now on a step is a tick of ``control``'s trial, which begins at the next reset; None: only objects move.

        Observables are updated once in a step.
        """
        self.task.take(control)
        self._observed = composer.observation.Updater(self.task.observables, 1, True)
        self._observed.reset(self.physics, self.random_state)
        self._over = True

    def close(self) -> None:
        """Let go of the control. The engine is the world's, and freed with it: `hthor.world.World.close`."""
        if self.task.control is not None:
            self.hand_over(None)

    def shut(self, house: str) -> None:
        """Free the engine, with a control or without one; from then on whatever needs it raises WorldClosed."""
        self.task.take(None)
        super().close()
        self._closed_house, self._over = house, True

    @property
    def physics(self) -> Any:
        """The engine, as composer gives it."""
        if self._closed_house:
            raise WorldClosed.of(self._closed_house)
        return super().physics

    def action_spec(self) -> Any:
        """The control's specification of actions."""
        return self.task.action_spec(self.physics)

    def reset(self) -> Any:
        """Begin an episode: the control's trial, or one of the engine alone."""
        if self.task.control is None:
            self.begin()
        else:
            self.task.control.reset()
            self._show_puppets()
        self._call("initialize_episode")
        self._observed.reset(self.physics, self.random_state)
        self._over = False
        return dm_env.restart(self._observed.get_observation())

    def step(self, action: Any) -> Any:
        """Let a tick pass: of the control's trial, in which the bodies act as ``action`` says, or of the engine alone.

        After the last step of an episode, or after somebody else has reset the world, it begins the next episode.

        Raises:
            HthorError: when there is no control, and so nothing that acts, but an action.
        """
        physics, task, control = self.physics, self.task, self.task.control
        if control is None:
            action = _no_action(action)
        if self._over:
            return self.reset()
        task.before_step(physics, action, self.random_state)
        self._call("before_step", action)
        self._observed.prepare_for_next_control_step()
        self._call("before_substep", action)
        if control is None:
            self.tick()
        else:
            control.advance()
            self._show_puppets()
        self._call("after_substep")
        self._call("after_step")
        self._over = bool(task.should_terminate_episode(physics))  # also where a tour of this trial began again
        self._observed.update()
        return dm_env.TimeStep(
            step_type=dm_env.StepType.LAST if self._over else dm_env.StepType.MID,
            reward=task.get_reward(physics),
            discount=task.get_discount(physics),
            observation=self._observed.get_observation(),
        )

    def observation_spec(self) -> Any:
        """What `step` returns, by name: the control's observables."""
        return self._observed.observation_spec()

    def add_extra_hook(self, hook_name: str, hook_callable: Callable[..., Any]) -> None:
        """Have a function called at every reset or step, as composer does; a step is one substep.

        Raises:
            UnknownName: for any other hook: the model is compiled only once.
        """
        if hook_name not in self._extra_hooks:
            raise UnknownName("hook", hook_name, self._extra_hooks)
        self._extra_hooks[hook_name].append(hook_callable)

    def _call(self, hook_name: str, *given: Any) -> None:
        for hook in self._extra_hooks[hook_name]:
            hook(self.physics, *given, self.random_state)

    def begin(self) -> None:
        """Start an episode of the engine: nothing is carried, and all sleeps at the place that the task gives it."""
        self._held.clear()
        self._carried[:] = -(1 << 30)
        self._still, self._restless = False, 0
        self._over = self.task.control is not None  # an episode that the control did not begin is not its
        with self.physics.reset_context():
            self.task.initialize_episode(self.physics, self.random_state)

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

    def wake(self, dofs: Iterable[int]) -> None:
        """Wake the free objects with these addresses, because what bore them may be gone; nothing else changes."""
        for dof in dofs:
            self.data.qvel[dof + 2] = _NUDGE_M_S
        self.touch()

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


def _no_action(action: Any) -> Any:
    """The action of an environment without a control: an array of nothing, also for None."""
    nothing = np.zeros(0) if action is None else action
    if not isinstance(nothing, np.ndarray) or nothing.size:
        raise HthorError(
            "this environment has no trial, so that nothing in it acts: it was closed, or never had one. Give it one "
            "with hthor.envs.trial_environment, or give no action (None) to let a tick pass"
        )
    return nothing


def _write(array: Any, raw: bytes) -> None:
    """Fill an array of the engine with bytes."""
    array[:] = np.frombuffer(raw, array.dtype).reshape(array.shape)
