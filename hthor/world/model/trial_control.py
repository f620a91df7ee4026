"""How a trial runs inside composer's environment: a `TrialControl` answers the hooks of composer's task."""

from collections import OrderedDict
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple, Protocol

from hthor.world.model.engine import composer


class Reading(NamedTuple):
    """One observable: ``spec``, a `dm_env.specs.Array`, and ``read``, which returns an array of that specification.

    ``enabled`` says whether it is observed unless somebody changes that; composer reads no others.
    """

    spec: Any
    read: Callable[[], Any]
    enabled: bool = True


class TrialControl(Protocol):
    """A trial, as composer's environment drives it. One of its ticks is one control step.

    Attributes:
        reward: of the last tick. discount: 0.0 if the episode ended in a terminal state, else 1.0.
        done: whether the last tick was the trial's last.
    """

    @property
    def reward(self) -> float: ...
    @property
    def discount(self) -> float: ...
    @property
    def done(self) -> bool: ...

    def reset(self) -> None:
        """Begin the trial; this begins an episode of the world, and so calls `LazyComposerEnv.begin`."""

    def submit(self, action: Any) -> None:
        """Take the action of the next tick; raises, and changes nothing, if it does not fit `action_spec`."""

    def advance(self) -> None:
        """Let one tick pass; this lets the world pass a tick, and so calls `LazyComposerEnv.tick`."""

    def action_spec(self) -> Any:
        """A nested dict of `dm_env.specs.Array`."""

    def readings(self) -> Mapping[str, Reading]:
        """The observables by name; before the first `reset` they may be read too, and give any valid value."""


class ControlledTask(composer.Task):
    """A task whose actions, observations, reward and end are those of ``control``; without one, composer's defaults."""

    def __init__(self) -> None:
        self.control: TrialControl | None = None
        self._observed: OrderedDict[str, Any] = OrderedDict()

    def take(self, control: TrialControl | None) -> None:
        """Set or remove the control."""
        readings = {} if control is None else control.readings()
        self._observed = OrderedDict((name, _ReadingObservable(reading)) for name, reading in readings.items())
        self.control = control

    @property
    def task_observables(self) -> OrderedDict[str, Any]:
        """The control's observables, by name."""
        return self._observed

    def action_spec(self, physics: Any) -> Any:
        """The control's specification of actions."""
        return super().action_spec(physics) if self.control is None else self.control.action_spec()

    def before_step(self, physics: Any, action: Any, random_state: Any) -> None:
        """Hand the action to the control."""
        if self.control is None:
            super().before_step(physics, action, random_state)
        else:
            self.control.submit(action)

    def get_reward(self, physics: Any) -> float:  # noqa: ARG002 - composer's signature
        """The control's reward; without a control 0, as a task is judged by its goal."""
        return 0.0 if self.control is None else self.control.reward

    def get_discount(self, physics: Any) -> float:
        """The control's discount."""
        return float(super().get_discount(physics)) if self.control is None else self.control.discount

    def should_terminate_episode(self, physics: Any) -> bool:
        """Whether the control's trial is over."""
        return bool(super().should_terminate_episode(physics)) if self.control is None else self.control.done


class _ReadingObservable(composer.observation.observable.Generic):
    """A reading as an observable of composer, which checks nothing and copies each value once."""

    def __init__(self, reading: Reading) -> None:
        super().__init__(lambda _physics: reading.read())
        self._spec, self.enabled = reading.spec, reading.enabled

    @property
    def array_spec(self) -> Any:
        """The specification of its values."""
        return self._spec
