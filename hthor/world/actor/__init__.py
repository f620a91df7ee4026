"""Control of one body by hand: motions, perception, messages and a person's display."""

from hthor.world.actor.actor import Actor

__all__ = ["Actor"]
