"""The records that rooms hand to one another; knows nothing of engines, scoring or files.

Frames and units, everywhere in hthor: metres, radians, seconds; the *house frame* is MuJoCo's world frame (x right,
y forward, z up). A body's ``yaw`` is its heading, counter-clockwise from +x. A thing's ``yaw`` turns its *local
frame* (origin at the centre of its bounding box, front towards +y) counter-clockwise about z.
"""

from __future__ import annotations

from hthor.types.acting import Action, Close, Drop, Motion, Move, Open, Pick, Place, Reply, Rotate, Send, Wait
from hthor.types.bodies import AgentRef, BodySpec, Goal, Placement, RobotSeat, RobotSpec, TaskSpec, TrialSpec
from hthor.types.happening import Event, Mind, Snapshot
from hthor.types.places import (
    HUMAN,
    HouseSpec,
    Joint,
    Opening,
    Part,
    Pose,
    Rgba,
    Room,
    Surface,
    Thing,
    Vec2,
    Vec3,
    Wall,
)
from hthor.types.sensing import (
    Briefing,
    Camera,
    Detection,
    DetectorSpec,
    Message,
    Observation,
    Outcome,
    Receipt,
    Scan,
    Senses,
    Status,
    ThingState,
    View,
)

__all__ = [
    "HUMAN",
    "Action",
    "AgentRef",
    "BodySpec",
    "Briefing",
    "Camera",
    "Close",
    "Detection",
    "DetectorSpec",
    "Drop",
    "Event",
    "Goal",
    "HouseSpec",
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
