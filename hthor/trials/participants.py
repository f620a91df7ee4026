"""The people and the agents of a session."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from hthor.types import Action, Briefing, Mind, Observation, RobotSeat

if TYPE_CHECKING:
    from hthor.humans.model import HumanModel

LAST_STEPS = 20
"""How many of an agent's last steps are kept. Our choice."""


class RecordedAgent:
    """An agent that is recorded while it acts; its behaviour stays the same.

    Args:
        mind: the agent.
        last: how many steps to keep; None for all of the trial.

    Attributes:
        looks: the last observations with the actions that followed; the last action is None when the agent failed.
    """

    def __init__(self, mind: Mind, last: int | None = LAST_STEPS) -> None:
        self.mind: Any = mind
        self.looks: deque[tuple[Observation, Action | None]] = deque(maxlen=last)

    def begin(self, briefing: Briefing) -> None:
        self.looks.clear()
        self.mind.begin(briefing)

    def act(self, observation: Observation) -> Action:
        self.looks.append((observation, None))
        action: Action = self.mind.act(observation)
        self.looks[-1] = (observation, action)
        return action

    def finish(self) -> None:
        """Tell the agent that its trial is over."""
        if (finish := getattr(self.mind, "finish", None)) is not None:
            finish()

    def close(self) -> None:
        """End the agent's process."""
        self.mind.close()

    @property
    def output(self) -> str:
        """The end of the agent's output."""
        return str(getattr(self.mind, "log", ""))


class Participants:
    """The people and the agents of one session. A context manager: submitted agents are processes, which it ends.

    Args:
        humans: the human models by seat; they remember earlier trials of the session.
        seats: the robots.
        make_agent: makes the agent of a seat.
    """

    def __init__(
        self,
        humans: Mapping[str, HumanModel],
        seats: Sequence[RobotSeat],
        make_agent: Callable[[RobotSeat], Mind],
    ) -> None:
        self.humans = dict(humans)
        self._seats = tuple(seats)
        self._make_agent = make_agent
        self.agents: dict[str, Mind] = {}  # of the last trial, by seat

    def __enter__(self) -> Participants:
        return self

    def __exit__(self, *_: object) -> None:
        for seat in tuple(self.agents):
            self.dismiss(seat)

    def ready_agents(self) -> Mapping[str, Mind]:
        """An agent for each robot, by seat: the agent of the trial before, or a new agent if that one was dismissed."""
        for robot in self._seats:
            if robot.seat not in self.agents:
                self.agents[robot.seat] = self._make_agent(robot)
        return dict(self.agents)

    def finish_trial(self) -> None:
        """The trial is over: agents that clean up for the next trial may do so now."""
        for agent in self.agents.values():
            if (finish := getattr(agent, "finish", None)) is not None:
                finish()

    def dismiss(self, seat: str) -> None:
        """End an agent; the next trial gets a new one."""
        agent: Any = self.agents.pop(seat)
        if hasattr(agent, "close"):
            agent.close()
