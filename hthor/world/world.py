"""A simulation to control by hand: set up a house, move bodies, take pictures, pass messages.

from hthor.world import World

with World("hazel", robots=["tender"]) as world:
    world.robot.go_to("fridge")
"""

from typing import TYPE_CHECKING, Any, Self

from hthor import gc_freeze, houses
from hthor.errors import UnknownName, WorldClosed
from hthor.types import HUMAN
from hthor.world.actor import Actor
from hthor.world.interactive_simulation import InteractiveSimulation

_KEPT_WHEN_CLOSED = ("house", "seats", "robots", "bodies", "detectors", "cameras", "tick", "events", "mail")


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

    def close(self) -> None:
        """Give back the memory of the renderers, and, when a fifth of the open worlds were closed, of their engines.

        Pictures, observations and records that were read before stay valid. ``house``, ``seats``, ``robots``,
        ``bodies``, ``detectors``, ``cameras``, ``tick``, ``events`` and ``messages`` can still be read; everything else
        raises `hthor.errors.WorldClosed`, also a picture of before that is drawn only now. Closing twice is fine.
        """
        if "_env" not in vars(self):
            return
        self._pictures.close()
        self._env.shut(self.house.id)
        kept = {name: vars(self)[name] for name in _KEPT_WHEN_CLOSED}
        vars(self).clear()
        vars(self).update(kept)
        gc_freeze.collect_closed(self)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    if not TYPE_CHECKING:  # else a wrong name would pass as an attribute

        def __getattr__(self, name: str) -> Any:
            house = vars(self).get("house")
            if house is not None and "_env" not in vars(self) and "mail" in vars(self):
                raise WorldClosed.of(house.id)
            raise AttributeError(f"'{type(self).__name__}' object has no attribute '{name}'")

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
