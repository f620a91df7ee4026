"""What a person is offered where they stand and look."""

import math
from typing import Any

import msgspec
import pytest

from hthor.live.choices import find_choices
from hthor.live.wire import Choice, Choices, Hand
from hthor.types import Close, Detection, Drop, Observation, Open, Pick, Place, Pose

APPLE = Detection(
    id="apple", kind="apple", family="object", position=(0.7, 0.0, 0.9), size=(0.08, 0.08, 0.08), yaw=0.0, distance=1.0
)
MUG = msgspec.structs.replace(APPLE, id="mug", kind="coffee_mug", position=(0.7, 0.25, 0.9))
TABLE = Detection(
    id="table",
    kind="dining_table",
    family="furniture",
    position=(1.0, 0.0, 0.4),
    size=(1.0, 2.0, 0.8),
    yaw=0.0,
    distance=1.5,
)
FRIDGE = msgspec.structs.replace(TABLE, id="fridge", kind="fridge", size=(0.7, 0.7, 1.8), position=(1.0, 0.0, 0.9))


def seen(*detections: Detection, yaw: float = 0.0, pitch: float = 0.0, **more: Any) -> Observation:
    class Senses:
        pass

    senses = Senses()
    senses.detections = lambda: detections  # type: ignore[attr-defined]
    return Observation(tick=0, pose=Pose(x=0.0, y=0.0, yaw=yaw, pitch=pitch), idle=True, senses=senses, **more)  # type: ignore[arg-type]


def offered(*detections: Detection, **more: Any) -> Choices:
    return find_choices(seen(*detections, **more), 1.6, 0.8)


DOWN = -math.atan2(0.7, 0.7)


def test_the_thing_that_is_looked_at_is_offered() -> None:
    assert offered(APPLE, MUG, pitch=DOWN).hand == Choice(words="pick up the apple", motion=Pick(object="apple"))
    aside = math.atan2(0.25, 0.7)
    assert offered(APPLE, MUG, pitch=DOWN, yaw=aside).hand == Choice(
        words="pick up the coffee mug", motion=Pick(object="mug")
    )


@pytest.mark.parametrize("more", [{"yaw": 1.2}, {"pitch": 0.6}])
def test_nothing_is_offered_to_who_looks_elsewhere(more: dict[str, float]) -> None:
    assert offered(APPLE, **more) == Choices()


def test_nothing_is_offered_out_of_reach_or_to_busy_hands_or_in_another_hand() -> None:
    far = msgspec.structs.replace(APPLE, position=(2.0, 0.0, 1.6))
    assert offered(far) == Choices()
    near = msgspec.structs.replace(APPLE, position=(0.7, 0.0, 1.6))
    assert offered(near).hand is not None
    assert offered(msgspec.structs.replace(near, held_by="robot")) == Choices()
    assert find_choices(msgspec.structs.replace(seen(near), idle=False), 1.6, 0.8) == Choices()


def test_what_is_in_hand_is_put_where_the_person_looks() -> None:
    choice = offered(TABLE, APPLE, pitch=-math.atan2(0.8, 0.7), holding="apple").hand
    assert choice is not None
    assert choice.words == "put the apple on the dining table"
    assert isinstance(choice.motion, Place)
    assert choice.motion.position == pytest.approx((0.7, 0.0, 0.8))
    assert offered(TABLE, APPLE, yaw=3.0, holding="apple").hand == Choice(words="let go of the apple", motion=Drop())


@pytest.mark.parametrize(("state", "motion", "verb"), [("closed", Open, "open"), ("open", Close, "close")])
def test_doors_are_opened_and_closed_with_full_hands_too(state: str, motion: Any, verb: str) -> None:
    fridge = msgspec.structs.replace(FRIDGE, state=state)
    for holding in ("", "apple"):
        door = offered(fridge, holding=holding).door
        assert door == Choice(words=f"{verb} the fridge", motion=motion(thing="fridge"))
    placed = offered(fridge, holding="apple").hand
    assert placed is not None
    assert placed.words == "put the apple in the fridge"


@pytest.mark.parametrize(("gap", "words"), [(0.6, "put the apple in the fridge"), (0.7, "")])
def test_nothing_is_put_where_the_surface_is_out_of_reach_behind_the_front(gap: float, words: str) -> None:
    """The world measures to the surface, which begins 0.17 m behind the front."""
    fridge = msgspec.structs.replace(FRIDGE, state="open", position=(gap + 0.35, 0.0, 0.9), yaw=math.pi / 2)
    placed = offered(fridge, holding="apple").hand
    assert (placed.words if placed is not None else "") == words
    assert offered(fridge, holding="apple").door is not None


def by_hand(*detections: Detection, place: tuple[float, float, float], **more: Any) -> Choices:
    """What is offered to a hand that points ahead, of a person who looks up at nothing."""
    return find_choices(seen(*detections, pitch=1.2, **more), 1.6, 0.8, Hand(place, (1.0, 0.0, 0.0)))


def test_a_hand_picks_what_it_touches_and_else_what_it_points_at() -> None:
    assert by_hand(APPLE, MUG, place=(0.7, 0.2, 0.95)).hand == Choice(
        words="pick up the coffee mug", motion=Pick(object="mug")
    )
    assert by_hand(APPLE, MUG, place=(0.2, 0.0, 0.9)).hand == Choice(
        words="pick up the apple", motion=Pick(object="apple")
    )
    assert by_hand(APPLE, MUG, place=(0.2, 0.0, 2.0)) == Choices()


@pytest.mark.parametrize(
    ("place", "point"),
    [((0.7, 0.3, 1.1), (0.7, 0.3, 0.8)), ((0.2, 0.0, 0.6), (0.5, 0.0, 0.6)), ((0.7, 0.3, 1.6), None)],
)
def test_a_hand_puts_things_down_below_it_or_where_it_points(
    place: tuple[float, float, float], point: tuple[float, float, float] | None
) -> None:
    choice = by_hand(TABLE, APPLE, place=place, holding="apple").hand
    assert choice is not None
    if point is None:
        assert choice.motion == Drop()
    else:
        assert isinstance(choice.motion, Place)
        assert choice.motion.position == pytest.approx(point)


def test_a_hand_opens_what_it_touches_and_puts_things_inside() -> None:
    fridge = msgspec.structs.replace(FRIDGE, state="closed")
    assert by_hand(fridge, place=(0.6, 0.0, 1.0)).door == Choice(words="open the fridge", motion=Open(thing="fridge"))
    inside = by_hand(msgspec.structs.replace(fridge, state="open"), place=(0.8, 0.0, 1.0), holding="apple").hand
    assert inside is not None
    assert inside.words == "put the apple in the fridge"
    assert isinstance(inside.motion, Place)
    assert inside.motion.position == pytest.approx((0.8, 0.0, 1.0))
