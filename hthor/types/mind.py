"""The contract of agents and human models: the program that controls the body in a seat."""

from typing import Protocol

from hthor.types.actions import Action, Drive
from hthor.types.observations import Briefing, Observation


class Mind(Protocol):
    """The program that controls the body in a seat: an agent for a robot, a human model for the person.

    A robot's agent is created for every trial; one human model plays all trials of a session.
    """

    def begin(self, briefing: Briefing) -> None:
        """Called once before a trial, before time starts to count.

        Raises:
            Exception: any exception of a robot's agent is logged as a fault; the trial goes on, and the robot's body
                stands still throughout it. An exception of a human model ends the run.
        """
        ...

    def act(self, observation: Observation) -> Action:
        """Called whenever the body is free for a new motion, and whenever the seat's inbox or receipt has changed.

        A tick lasts `rules.TICK_S` [s]. All seats that are called in a tick observe the same moment; only then do their
        actions take effect. In lock-step the world waits for the answer. With another clock (``TrialSpec.clock``) the
        action takes effect after as many ticks as the answer took, and until then the seat is not called again.

        Args:
            observation: valid only during this call; reading its sensors later raises `StaleObservation`.

        Returns:
            one motion and at most one utterance. While ``observation.idle`` is false the motion is ignored. A motion
            that a rule forbids is refused and costs one tick; the ``outcome`` of the next observation says why.

        Raises:
            Exception: any exception of a robot's agent, or a result that is not an `Action`, is logged as a fault: the
                body stays where it is for the rest of the trial. An exception of a human model ends the run.
        """
        ...


class Controls(Protocol):
    """The hold on its body of somebody who acts 60 times a second, as a person in a headset does.

    It is given to ``frame``, which human models may have instead of being asked: see `hthor.humans.model`.
    """

    @property
    def tick(self) -> int:
        """Ticks of `rules.TICK_S` since the trial began."""

    @property
    def step(self) -> int:
        """The step of the tick that comes next, from 0 to `hthor.types.SUBTICKS` - 1."""

    def observe(self) -> Observation:
        """What the seat observes as this tick begins; a message in it counts as shown. Only at step 0.

        Raises:
            HthorError: at a later step, when the tick was not observed at step 0.
        """

    def submit(self, action: Action, seen: Observation | None = None) -> None:
        """Act as the next tick begins: this one at step 0, else the one after it. The motion counts if the body is
        free; a `Drive` counts at any time. ``seen`` is the observation on which the seat decided, if that is known.
        """

    def steer(self, drive: Drive) -> None:
        """Drive like this from the next step on."""
