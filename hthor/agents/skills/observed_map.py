"""What a robot has seen of a house: objects and furniture, and routes on its own map."""

from __future__ import annotations

from collections.abc import Sequence

from hthor.agents.skills.explorer import Explorer
from hthor.agents.skills.subgoals import Knowledge, has_door
from hthor.navigation.waiting_spots import retreat
from hthor.types import Observation, Place, Thing, ThingState, Vec2, Vec3

_WALL_M = 0.12


class ObservedKnowledge(Knowledge):
    """Knowledge from detections alone: things where they were seen last."""

    def __init__(self) -> None:
        super().__init__()
        self._known: dict[str, ThingState] = {}
        self.states = self._known

    def note(self, observation: Observation) -> None:
        """Update from what is in view."""
        for seen in observation.detections:
            if seen.family == "object":
                self._known[seen.id] = ThingState(
                    id=seen.id, kind=seen.kind, position=seen.position, support=seen.support, held_by=seen.held_by
                )
            elif seen.family == "furniture":
                if seen.id not in self.things:
                    self.things[seen.id] = Thing(
                        id=seen.id, kind=seen.kind, asset="", centre=seen.position, size=seen.size, yaw=seen.yaw
                    )
                if seen.state:
                    self._known[seen.id] = ThingState(
                        id=seen.id, kind=seen.kind, position=seen.position, open=seen.state == "open"
                    )

    def put(self, object: str, place: Place) -> None:
        """Note that the robot itself has put an object down there, in view or not."""
        state = self._known.get(object)
        if state is not None:
            position = place.position or state.position
            self._known[object] = ThingState(id=object, kind=state.kind, position=position, support=place.on)

    def forget(self, object: str) -> None:
        """Forget an object that is not where it was."""
        self._known.pop(object, None)

    def shut(self) -> list[Thing]:
        """Furniture whose inside is hidden by a closed door."""
        return [thing for thing in self.things.values() if has_door(thing) and self.is_shut(thing.id)]


class ObservedRoutes:
    """Routes of a robot through the part of a house that it has seen."""

    def __init__(self, explorer: Explorer) -> None:
        self.explorer = explorer

    def stands(self, spot: Vec2) -> bool:
        """Whether the body may stand here, according to the map."""
        return self.explorer.planner.fits(*spot)

    def standing(self, spots: Sequence[Vec2]) -> list[Vec2]:
        """Those of the spots where the body may stand, according to the map."""
        return [spot for spot in spots if self.explorer.planner.fits(*spot)]

    def fits(self, a: Vec2, b: Vec2) -> bool:
        """Whether the body can go straight from ``a`` to ``b``."""
        return self.explorer.fits(a, b)

    def lengths(self, here: Vec2, spots: Sequence[Vec2]) -> Sequence[float]:
        """Walking distances [m]; inf where no path is known."""
        return self.explorer.planner.distances(here, spots)

    def way(self, here: Vec2, spot: Vec2) -> tuple[Vec2, ...]:
        """The shortest known path, () for none."""
        return self.explorer.planner.path(here, spot) or ()

    def broad(self, here: Vec2, spot: Vec2) -> tuple[Vec2, ...]:
        """The shortest known path: a robot's own map is too coarse to prefer broad ones."""
        return self.way(here, spot)

    def retreat(self, here: Vec2, point: Vec2, apart_m: float) -> tuple[Vec2, ...]:
        """The path to a spot where the body blocks nobody, ``apart_m`` metres from ``point``; () to stay."""
        explorer = self.explorer
        return () if explorer.grid is None else retreat(explorer.grid, explorer.planner, here, point, apart_m) or ()

    def loose(self, here: Vec2) -> Vec2:
        """Where to go first when the body is stopped here: paths on a map begin with that anyway."""
        return here

    def sees(self, spot: Vec2, point: Vec3) -> bool:  # noqa: ARG002
        """Always True: without a model of the house it has to try."""
        return True

    def open_to(self, spot: Vec2, edge: Vec2) -> bool:
        """Whether nothing on the map is between a spot and the edge of a thing."""
        grid = self.explorer.grid
        return grid is not None and not grid.meets(spot, edge, _WALL_M)
