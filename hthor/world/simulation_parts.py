"""The parts of a simulation, made in the order of their dependencies; each action goes to the part that handles it."""

from collections.abc import Mapping, Sequence

from hthor.houses.space.free_space import FreeSpace
from hthor.types import (
    BodySpec,
    Close,
    DetectorSpec,
    Drive,
    Drop,
    HouseSpec,
    Motion,
    Move,
    Open,
    Pick,
    Place,
    Rotate,
    Vec2,
    Wait,
)
from hthor.world.carrying.joint_carrying import CarryMotion, CarryRotation, JointCarrying
from hthor.world.ground_truth import GroundTruth
from hthor.world.interaction.manipulation import HandMotion, Manipulation
from hthor.world.interaction.opening import DoorHandling
from hthor.world.interaction.scene_editing import SceneEditor
from hthor.world.interaction.usability import Usability
from hthor.world.model.composer_env import LazyComposerEnv
from hthor.world.model.composer_task import HouseTask
from hthor.world.model.geom_index import GeomIndex
from hthor.world.model.inventory import Contents
from hthor.world.motion import locomotion
from hthor.world.motion.driving import DrivenBodies
from hthor.world.motion.locomotion import (
    MoveMotion,
    ObstacleFootprints,
    RotateMotion,
    WaitMotion,
    duration_ticks,
    length_and_direction,
)
from hthor.world.motion.loose_things import LooseThings
from hthor.world.motion.push_plan import Floor
from hthor.world.perception.detector_noise import NoisyDetector
from hthor.world.perception.range_scanner import RangeScanner
from hthor.world.perception.visibility import Visibility
from hthor.world.records import ActivityState, Handling, Rotating, Turning, Waiting
from hthor.world.state.body_state import Activity, BodyState, BodyStates, RoomTracker
from hthor.world.state.doors import Doors, Doorways
from hthor.world.state.mocap_poses import MocapPoses
from hthor.world.state.objects import Objects
from hthor.world.state.overlap_test import OverlapTest
from hthor.world.state.support_surfaces import SupportSurfaces


class ActionDispatch:
    """Checks the motions of one world's bodies and starts them; ``manipulation`` has the rules of the hands."""

    def __init__(
        self,
        house: HouseSpec,
        manipulation: Manipulation,
        doors: Doors,
        seats: Sequence[BodyState],
        loose_things: LooseThings,
    ) -> None:
        self._loose_things = loose_things
        self.manipulation, self._doors, self._obstacles = manipulation, doors, ObstacleFootprints(house)
        self._joint_carrying = manipulation.joint_carrying
        self._others = {seat.name: tuple(other for other in seats if other is not seat) for seat in seats}

    def refusal(self, seat: BodyState, action: object) -> str:
        """Why the motion cannot be started, empty when it can."""
        if isinstance(action, (Move, Rotate, Wait)):
            reason = locomotion.refusal(seat, action)
            return reason or (self._joint_carrying.stuck(seat) if seat.holding and isinstance(action, Move) else "")
        if isinstance(action, (Pick, Place, Drop, Open, Close)):
            return self.manipulation.refusal(seat, action)
        names = "Move, Rotate, Drive, Pick, Place, Drop, Open, Close, Wait"
        return f"{type(action).__name__} is not a motion; valid: {names}"

    def activity(self, seat: BodyState, action: Motion) -> Activity:
        """A motion that has begun, to be carried on tick by tick."""
        load = self._joint_carrying.of(seat) if seat.holding else None
        if isinstance(action, Move):
            left, along = length_and_direction(seat, action)
            if load is not None:
                return CarryMotion(seat, load, self.culprit, left, along)
            return MoveMotion(seat, self._others[seat.name], self.culprit, left, along)
        if isinstance(action, Rotate):
            if load is not None:
                return CarryRotation(seat, action.yaw, action.pitch)
            return RotateMotion(seat, action, seat.pose)
        if isinstance(action, Wait):
            return WaitMotion(duration_ticks(action.seconds))
        assert not isinstance(action, Drive), "see DrivenBodies"
        return HandMotion(seat, action, self.manipulation)

    def resume(self, seat: BodyState, state: ActivityState) -> Activity:
        """A motion that goes on from a state."""
        if isinstance(state, Waiting):
            return WaitMotion(state.left)
        if isinstance(state, Rotating):
            return RotateMotion(seat, state.motion, state.begun, state.done)
        if isinstance(state, Turning):
            return CarryRotation(seat, state.yaw, state.pitch)
        if isinstance(state, Handling):
            return HandMotion(seat, state.motion, self.manipulation, state.done)
        if state.load:
            return CarryMotion(seat, self._joint_carrying.load(state.load), self.culprit, state.left, state.along)
        others = self._others[seat.name]
        return MoveMotion(seat, others, self.culprit, state.left, state.along, state.hindered)

    def culprit(self, seat: BodyState, step: Vec2) -> str:
        """The obstacle that the body would have hit: a loose thing's id, the nearest thing's id, or "wall"."""
        place = (seat.pose.x + step[0], seat.pose.y + step[1])
        if seat.space.segment_free((seat.pose.x, seat.pose.y), place):
            loose = self._loose_things.stops(seat, step)
            if loose:
                return loose
        return self._obstacles.nearest(place, seat.spec.height, self._doors.shut().values())


class SimulationParts:
    """Everything that shares one compiled model of a house.

    Args:
        house: the floor plan. contents: its things, split into moving and static ones.
        bodies: the body in each seat, the people's first. space: each seat's free-space grid; the dict is updated when
            doorways are shut or opened.
        detectors: each robot's detector.
    """

    def __init__(
        self,
        house: HouseSpec,
        contents: Contents,
        bodies: Mapping[str, BodySpec],
        space: dict[str, FreeSpace],
        detectors: Mapping[str, DetectorSpec],
    ) -> None:
        self.task = HouseTask(house, contents, bodies)
        self.env = LazyComposerEnv(self.task)
        self.geoms = GeomIndex(self.env, self.task)
        surfaces = SupportSurfaces(contents.statics)
        overlap = OverlapTest(env=self.env, geoms=self.geoms)
        self.objects = Objects(contents.movables, env=self.env, geoms=self.geoms, surfaces=surfaces, overlap=overlap)
        self.doors = Doors(self.task.doors, env=self.env, surfaces=surfaces)
        self.seats = BodyStates((name, BodyState(name, spec, space[name])) for name, spec in bodies.items())
        seats = tuple(self.seats.values())
        self.mocap = MocapPoses(self.env, seats)
        self.rooms = RoomTracker(house, tuple(self.seats))
        self.doorways = Doorways(seats, space)
        geoms, objects, doors = self.geoms, self.objects, self.doors
        self.door_handling = DoorHandling(geoms, objects, doors, surfaces, doorways=self.doorways, seats=seats)
        self.joint_carrying = JointCarrying(house, objects, doors, overlap, seats)
        self.manipulation = Manipulation(
            house, geoms, objects, doors, surfaces, overlap, self.door_handling, self.joint_carrying
        )
        self.usability = Usability(geoms, objects, doors, surfaces, self.manipulation, self.door_handling)
        self.loose_things = LooseThings(Floor(house, self.env, geoms, objects, overlap, seats))
        for seat in seats:
            seat.loose = self.loose_things
        self.dispatch = ActionDispatch(house, self.manipulation, doors, seats, self.loose_things)
        self.driven = DrivenBodies(seats, self.joint_carrying, self.dispatch.culprit, objects.follow)
        self.editor = SceneEditor(house, self.task, self.env, geoms, objects, surfaces, overlap)
        self.scanners = {seat.name: RangeScanner(seat.spec, seat.space, house) for seat in seats}
        self.visibility = Visibility(geoms, objects, doors, contents.statics, house.openings, seats)
        self.truth = GroundTruth(objects, doors, self.visibility, seats)
        self.detectors = {
            name: NoisyDetector(spec, self.seats[name], self.geoms, surfaces)
            for name, spec in detectors.items()
            if spec.miss or spec.false_alarm or spec.position_sigma
        }
