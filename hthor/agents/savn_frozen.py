"""SAVN with the weights that it starts with: the control for what adapting during the trial does."""

from hthor.agents import savn


class Agent(savn.Agent):
    """Does what `hthor.agents.savn` does, and never adapts."""

    adapts = False
