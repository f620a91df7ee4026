"""The contract of a human model, simulated or live.

A human model is a file that defines ``class Model``, in ``hthor/humans/models`` or anywhere else; `hthor eval --humans`
takes its name or path. ``Model(participant)`` is made once per session and goes through the session's trials in order:
``begin``, then ``act`` until the trial ends, then ``rate``. ``Model(participant, state)`` continues a session in a new
process.

Optional parts of the file and the class:

- ``ingredients(source: str) -> dict``, a function in the file: plain JSON values of everything else that decides how
  the model behaves, such as the hash of its weights. They become part of the run's identity.
- ``Model(participant, source="/path")``: a model named with a source (``replay:runs/demo``) is made with that path.
- ``alike = True`` in the class: participants do not differ; all get the population's mean traits.
- ``frame(controls)``, a method: called in every step of a tick, 60 times a second, with the `hthor.types.Controls` of
  the seat. `act` is then never called: what the person sees and does goes through these controls.
- ``record_belief(tick, object)``, a method: records in the journal, as `Believed`, where the person now expects an
  object (empty for none) and what they are doing, for robots that predict it; it must change nothing else.
- ``journal``, a property of the class: the trial's entries for a recorder (`hthor.types.events.JournalEntry`).
"""

from collections.abc import Mapping
from typing import Protocol

from hthor.types import Action, Briefing, Observation

State = Mapping[str, bool | int | float | str | None]
"""Plain JSON values that carry over between trials."""


class HumanModel(Protocol):
    """One participant during one session.

    The same participant must give the same actions on the same observations: draw random numbers by name
    (`hthor.seeds`) from ``participant.trial_root(index)``, never from a global generator or the clock.
    """

    def begin(self, briefing: Briefing) -> None:
        """Start a trial: forget the house of the last one.

        Args:
            briefing: the instruction, the body, the time limit [s] and the length of a tick [s].
        """

    def act(self, observation: Observation) -> Action:
        """Decide what to do and say now; called when the body is free and whenever a message comes.

        Args:
            observation: the perceptions of a person in a headset: the pose in the house frame (x, y [m], yaw and pitch
                [rad], yaw counter-clockwise, pitch up), detections in view, the room, the object in hand, how the last
                motion ended, and the messages shown. It never has the true state of the world.

        Returns:
            A motion, which is carried out only when ``observation.idle``, and at most one utterance: a `Reply` to a
            message or question on the panel, or a `Send` to others, which may be a question or the answer to one.

        Raises:
            HthorError: if the model cannot go on, for example a replay of another task. The run then stops.
        """
        ...

    def rate(self, met: bool, tick: int) -> int | None:
        """End a trial and rate the robots.

        Args:
            met: whether the task was done in time.
            tick: when the trial ended.

        Returns:
            Trust in the robots from 1 to 7 (`hthor.rules.TRUST_MIN`, `TRUST_MAX`); None without a robot.
        """
        ...

    def state(self) -> State:
        """Values that carry over to the next trial, such as trust and practice; never knowledge of a house."""
        ...
