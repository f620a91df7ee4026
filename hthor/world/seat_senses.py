"""The sensors of a seat as agents and human models read them: at one tick only, or frozen at one moment.

They have a method for each sensor that `hthor.types.sensors.READINGS` lists, so a new one needs no change here.
"""

from collections.abc import Callable, Mapping
from typing import Any, Protocol

from numpy.typing import NDArray

from hthor.errors import StaleObservation
from hthor.types import Sighting, View
from hthor.types.sensors import READINGS
from hthor.world.rendering.lazy_images import MODES

MEASURED = tuple(name for name in READINGS if name not in MODES)
"""The sensors other than pictures: a method of `hthor.world.sensors.Sensors` with the sensor's
name measures each of them for a seat.
"""
_NOT_SEEN = Sighting()


class SensedWorld(Protocol):
    """The members of a `hthor.world.sensors.Sensors` that senses use, besides `MEASURED`."""

    @property
    def moment(self) -> tuple[int, int, int]: ...
    @property
    def profile(self) -> str: ...
    def sighting(self, seat: str, id: str) -> Sighting: ...
    def look(self, seat: str) -> View: ...
    def picture(self, seat: str, mode: str) -> NDArray[Any]: ...


class _EverySensor:
    """Has a method for each sensor, as `hthor.types.Senses` describes them; it returns what ``_read`` returns."""

    __slots__ = ()

    def _read(self, name: str) -> Any:
        raise NotImplementedError


def _reader(name: str) -> Callable[[_EverySensor], Any]:
    return lambda senses: senses._read(name)


for _name in READINGS:  # __getattr__ would take longer than reading again what is known
    setattr(_EverySensor, _name, _reader(_name))


class SeatSenses(_EverySensor):
    """A seat's sensors at the tick at which this object was made.

    Nothing is computed before it is read, and nothing twice.
    """

    __slots__ = ("_known", "_moment", "_seat", "_world")

    def __init__(self, world: SensedWorld, seat: str) -> None:
        self._world, self._seat, self._moment = world, seat, world.moment
        self._known: dict[str, Any] = {}

    def sighting(self, id: str) -> Sighting:
        """How visible an object is; a share of 0 if it is not in view."""
        self._check()
        return self._world.sighting(self._seat, id)

    def _read(self, name: str) -> Any:
        self._check()
        if name not in self._known:
            self._known.update(self._measured(name))
        return self._known[name]

    def _measured(self, name: str) -> Mapping[str, Any]:
        """The reading; in the profile "fast" all three pictures, as drawing them at once costs little more than one."""
        if name in MEASURED:
            return {name: getattr(self._world, name)(self._seat)}
        if self._world.profile == "fast":
            view = self._world.look(self._seat)
            return {mode: getattr(view, mode) for mode in MODES}
        return {name: self._world.picture(self._seat, name)}

    def _check(self) -> None:
        if self._world.moment != self._moment:
            tick = self._moment[1]
            raise StaleObservation(
                f"this observation of seat '{self._seat}' was made at tick {tick} and the world has moved on; "
                "read pictures, scans and detections inside act, and keep what you need of them"
            )


class FrozenSenses(_EverySensor):
    """A seat's sensors at one moment, which may be read at any time and in any thread.

    Args:
        readings: of the moment, by the names of the sensors in `MEASURED`. sightings: of the objects in view, by id.
        draw: draws a picture of the moment: "rgb", "depth" or "segmentation".
    """

    __slots__ = ("_draw", "_readings", "_sightings")

    def __init__(
        self, readings: Mapping[str, Any], sightings: Mapping[str, Sighting], draw: Callable[[str], NDArray[Any]]
    ) -> None:
        self._readings, self._sightings, self._draw = readings, sightings, draw

    def sighting(self, id: str) -> Sighting:
        """How visible an object is; a share of 0 if it was not in view."""
        return self._sightings.get(id, _NOT_SEEN)

    def _read(self, name: str) -> Any:
        return self._readings[name] if name in self._readings else self._draw(name)
