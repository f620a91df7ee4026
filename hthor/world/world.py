"""A simulation to control by hand: set up a house, move bodies, take pictures, pass messages.

from hthor.world import World

world = World("hazel", robots=["tender"])
world.robot.go_to("fridge")
"""

from hthor import houses
from hthor.errors import UnknownName
from hthor.types import HUMAN
from hthor.world.actor import Actor
from hthor.world.interactive_simulation import InteractiveSimulation


class World(InteractiveSimulation):
    """A house with people and robots in it, for notebooks, studies and scripts.

    It has all members of `hthor.world.simulation.Simulation` and `SensingSimulation`. ``human``, ``robot`` and
    ``actor(seat)`` are the bodies; a call on one of them lets time pass until its motion ends.

    Args:
        house: a name of `scenes`, the path of a house file, or a `HouseSpec`.
        robots: the robots' bodies, by name or as `RobotSpec`; their seats are "robot", "robot2", ...
        objects: (id, kind) pairs of spare objects, which `put_object` brings into the house; by default the benchmark's
            six targets, each with its kind's name as id.
        people: how many people there are; their seats are "human", "human2", ...

    Attributes:
        mail: the mailbox that `Actor.send` and `Actor.reply` use.
        events: everything that has happened since the last reset, in order.
    """

    @staticmethod
    def scenes() -> tuple[str, ...]:
        """Names of the houses that come with hthor."""
        return houses.names()

    def actor(self, seat: str) -> Actor:
        """The body in a seat.

        Raises:
            UnknownName: when this world has no such seat.
        """
        if seat not in self.bodies:
            raise UnknownName("seat", seat, self.seats, "Give robots=[...] or people=... when you make the world.")
        return Actor(self, seat)

    @property
    def human(self) -> Actor:
        """The first person."""
        return self.actor(HUMAN)

    @property
    def robot(self) -> Actor:
        """The first robot."""
        return self.actor("robot")
