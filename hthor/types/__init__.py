"""The records that the packages of hthor exchange; begin with `events` (`Mind`) and `observations`.

Frames and units, everywhere in hthor: metres, radians, seconds; the *house frame* is MuJoCo's world frame (x right,
y forward, z up). A body's ``yaw`` is its heading, counter-clockwise from +x. A thing's ``yaw`` turns its *local
frame* (origin at the centre of its bounding box, front towards +y) counter-clockwise about z.
"""

from hthor.types.actions import Action, Close, Drop, Motion, Move, Open, Pick, Place, Reply, Rotate, Send, Wait
from hthor.types.events import Event, Mind, Snapshot
from hthor.types.house import HUMAN, HouseSpec, Joint, Opening, Part, Pose, Rgba, Room, Surface, Thing, Vec2, Vec3, Wall
from hthor.types.observations import Briefing, Message, Observation, Outcome, Receipt, Status, ThingState
from hthor.types.sensors import Camera, CameraSpec, Detection, DetectorSpec, Scan, Senses, Sighting, View
from hthor.types.specs import AgentRef, BodySpec, Goal, Job, Placement, RobotSeat, RobotSpec, TaskSpec, TrialSpec

__all__ = [
    "HUMAN",
    "Action",
    "AgentRef",
    "BodySpec",
    "Briefing",
    "Camera",
    "CameraSpec",
    "Close",
    "Detection",
    "DetectorSpec",
    "Drop",
    "Event",
    "Goal",
    "HouseSpec",
    "Job",
    "Joint",
    "Message",
    "Mind",
    "Motion",
    "Move",
    "Observation",
    "Open",
    "Opening",
    "Outcome",
    "Part",
    "Pick",
    "Place",
    "Placement",
    "Pose",
    "Receipt",
    "Reply",
    "Rgba",
    "RobotSeat",
    "RobotSpec",
    "Room",
    "Rotate",
    "Scan",
    "Send",
    "Senses",
    "Sighting",
    "Snapshot",
    "Status",
    "Surface",
    "TaskSpec",
    "Thing",
    "ThingState",
    "TrialSpec",
    "Vec2",
    "Vec3",
    "View",
    "Wait",
    "Wall",
]
