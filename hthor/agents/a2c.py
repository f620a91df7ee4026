"""The actor-critic that was trained like SAVN, and never adapts: the control for what learning to adapt does."""

from hthor.agents import savn


class Agent(savn.Agent):
    """Does what `hthor.agents.savn` does, with a network that was trained without adaptation."""

    shipped = "a2c"
    ingredients = ("checkpoints/a2c/config.json", "checkpoints/a2c/model.safetensors")
    adapts = False
