"""The page with an emulated headset in a real browser: a person walks, uses their hands, answers and rates in VR."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from live_browser import CHROMIUM
from live_session import LiveSession
from test_page import APPLE, opened, session

from benchmarks.page_person import Person
from hthor.live import server
from hthor.types import HUMAN
from hthor.types.events import Accepted, Declined, Displayed, Paused

pytest.importorskip("starlette", reason="live sessions need an optional dependency: pip install 'hthor[live]'")
pytest.importorskip("playwright", reason="pages are opened with an optional dependency: pip install 'hthor[browser]'")
pytestmark = [
    pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on the PATH"),
    pytest.mark.skipif(not (server.FOLDER / server.PAGE).exists(), reason="the page is not built: make page"),
]

_DEVICE = "page.headsetChoice.device"
_BUTTONS = {
    "right": {"accept": ("right", "a-button"), "decline": ("right", "b-button"), "map": ("left", "x-button")},
    "left": {"accept": ("left", "x-button"), "decline": ("left", "y-button"), "map": ("right", "a-button")},
}
_WALK = """([x, y, stick]) => new Promise((done) => {
  const { headset, motion, headsetChoice: { device } } = page;
  const begin = [x - motion.x, y - motion.y];
  const step = () => {
    const left = [x - motion.x, y - motion.y];
    if (Math.hypot(...left) < 0.12 || left[0] * begin[0] + left[1] * begin[1] < 0) {
      device.controllers[stick].updateAxes("thumbstick", 0, 0);
      return done();
    }
    const yaw = Math.atan2(left[1], left[0]) - headset.rig.group.rotation.z - Math.PI / 2;
    device.quaternion.set(0, Math.sin(yaw / 2), 0, Math.cos(yaw / 2));
    device.controllers[stick].updateAxes("thumbstick", 0, -1);
    requestAnimationFrame(step);
  };
  step();
})"""
"""Looks to a place, with the stick held forward, until the person is there or has just passed it."""
_TOUCH = """([hand, x, y, z]) => {
  const { headset: { rig, camera }, motion, headsetChoice: { device } } = page;
  const yaw = Math.atan2(y - motion.y, x - motion.x) - rig.group.rotation.z - Math.PI / 2;
  device.quaternion.set(0, Math.sin(yaw / 2), 0, Math.cos(yaw / 2));
  rig.group.updateMatrixWorld(true);
  const place = rig.room.worldToLocal(camera.position.clone().set(x, y, z));
  device.controllers[hand].position.set(place.x, place.y, place.z);
}"""
"""Looks to a place in the house, and puts a hand there."""


class Wearer(Person):
    """Somebody with a headset."""

    def __init__(self, page: Any, hand: str) -> None:
        super().__init__(page)
        self.hand, self.stick = hand, "left" if hand == "right" else "right"

    def enter(self) -> None:
        self.page.click("#enter-vr")
        self.until("page.headset.standing === true || page.headset.session !== null")

    def press(self, action: str) -> None:
        hand, button = _BUTTONS[self.hand].get(action, (self.hand, action))
        self.hold(hand, button, 1)
        self.page.wait_for_timeout(150)
        self.hold(hand, button, 0)
        self.page.wait_for_timeout(150)

    def hold(self, hand: str, button: str, value: int) -> None:
        frame = self.page.evaluate("page.headset.renderer.info.render.frame")
        self.page.evaluate(f"{_DEVICE}.controllers.{hand}.updateButtonValue('{button}', {value})")
        self.until(f"page.headset.renderer.info.render.frame > {frame} + 1")

    def walk_to(self, x: float, y: float) -> None:
        for _ in range(20):
            self.page.evaluate(_WALK, [x, y, self.stick])
            self.answered()
            if self.page.evaluate(f"Math.hypot(page.head.x - {x}, page.head.y - {y})") < 0.25:
                return
        raise AssertionError(f"the person does not come to {x}, {y}")

    def touch(self, x: float, y: float, z: float) -> None:
        self.page.evaluate(_TOUCH, [self.hand, x, y, z])

    def do(self, button: str, words: str) -> None:
        """Press a button once that is what it does."""
        self.until(f"page.offers.some(([, what]) => what === {words!r})")
        self.press(button)


@pytest.mark.parametrize(("model", "hand"), [("quest2", "right"), ("quest3", "left")])
def test_a_person_plays_a_delivery_and_a_search_with_a_headset(model: str, hand: str, tmp_path: Path) -> None:
    with session(tmp_path) as live:
        url = f"{live.server.address}/?plain&emulated={model}&hand={hand}&seated={'no' if hand == 'right' else ''}"
        with opened(f"{url}#{live.server.tokens[HUMAN]}", live.server.address) as page:
            person = Wearer(page, hand)
            page.wait_for_selector("#go:not(.hidden)")
            person.enter()
            deliver(person)
            search(person)
            person.until("page.ended !== null && page.rated")
        live.thread.join(60.0)
        check(live)


def deliver(person: Wearer) -> None:
    person.press("accept")
    person.until("page.begun && page.panel !== null")
    assert abs(person.page.evaluate("page.headset.rig.head.z") - 1.6) < 0.01
    person.press("accept")
    person.until("page.shownMap !== null")
    take_off(person)
    person.press("map")
    person.until("page.shownMap === null")
    person.press("map")
    person.until("page.shownMap !== null")
    person.walk_to(3.65, 2.15)
    person.touch(*APPLE, 0.8)
    person.do("squeeze", "pick up the apple")
    person.until("page.now.holding === 'apple'")
    person.walk_to(3.5, 1.75)
    person.walk_to(1.3, 1.75)
    person.walk_to(0.75, 2.3)
    person.touch(0.6, 3.3, 1.0)
    while not person.page.evaluate("page.offers.some(([, what]) => what === 'close the fridge')"):
        person.do("trigger", "open the fridge")
        pressed = person.page.evaluate("page.head.tick")
        person.until(f"page.head.tick > {pressed + 15} && !page.now.busy")
    person.do("squeeze", "put the apple in the fridge")
    person.until("page.ended !== null && page.ended.rate")
    rate(person, 6)


def take_off(person: Wearer) -> None:
    """Take the headset off until time stands still, and put it on again."""
    person.page.evaluate(f"{_DEVICE}.updateVisibilityState('hidden')")
    person.until("page.paused === 'the headset of human is off'")
    person.page.evaluate(f"{_DEVICE}.updateVisibilityState('visible')")
    person.until("page.paused === ''")


def search(person: Wearer) -> None:
    person.until("page.trial.trial === 1 && page.house !== null")
    person.press("accept")
    person.until("page.begun && page.panel !== null")
    person.press("decline")
    person.until("page.panel === null")
    person.touch(*APPLE, 1.2)
    stick = f"{_DEVICE}.controllers.{person.stick}.updateAxes('thumbstick', 0, {{}})"
    person.page.evaluate(stick.format(-1))  # until it is found, which is when they see it from near
    person.until("page.ended !== null && page.ended.rate")
    person.page.evaluate(stick.format(0))
    rate(person, 2)


def rate(person: Wearer, value: int) -> None:
    """Choose a value with the stick, from the middle of the scale."""
    while (gap := value - person.page.evaluate("page.chosen")) != 0:
        for x in (1 if gap > 0 else -1, 0):
            frame = person.page.evaluate("page.headset.renderer.info.render.frame")
            person.page.evaluate(f"{_DEVICE}.controllers.{person.hand}.updateAxes('thumbstick', {x}, 0)")
            person.until(f"page.headset.renderer.info.render.frame > {frame} + 1")
    person.press("accept")


def check(live: LiveSession) -> None:
    delivery, found = live.logs
    assert delivery.met
    assert found.met
    assert [log.ratings for log in live.logs] == [{HUMAN: 6}, {HUMAN: 2}]
    assert any(isinstance(event, Accepted) for event in delivery.events)
    assert [event.reason for event in delivery.events if isinstance(event, Paused)] == ["the headset of human is off"]
    assert any(isinstance(event, Declined) for event in found.events)
    assert [event.on for event in delivery.events if isinstance(event, Displayed)][-2:] == [False, True]
