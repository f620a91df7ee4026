"""Somebody with an emulated headset at the page of `hthor live`, who walks, touches and presses buttons by a script."""

from __future__ import annotations

from typing import Any

from benchmarks.page_person import WALK_S, Person

DEVICE = "page.headsetChoice.device"
_BUTTONS = {
    "right": {"accept": ("right", "a-button"), "decline": ("right", "b-button"), "map": ("left", "x-button")},
    "left": {"accept": ("left", "x-button"), "decline": ("left", "y-button"), "map": ("right", "a-button")},
}
_WALK = """([x, y, stick, seconds]) => new Promise((done) => {
  const { headset, motion, headsetChoice: { device } } = page;
  const begin = [x - motion.x, y - motion.y];
  const end = performance.now() + 1000 * seconds;
  const step = () => {
    const left = [x - motion.x, y - motion.y];
    const there = Math.hypot(...left) < 0.12 || left[0] * begin[0] + left[1] * begin[1] < 0;
    if (there || page.ended !== null || performance.now() > end) {
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
  const pitch = Math.atan2(z - rig.head.z, Math.hypot(x - motion.x, y - motion.y));
  const [sy, cy, sp, cp] = [Math.sin(yaw / 2), Math.cos(yaw / 2), Math.sin(pitch / 2), Math.cos(pitch / 2)];
  device.quaternion.set(cy * sp, sy * cp, -sy * sp, cy * cp);
  rig.group.updateMatrixWorld(true);
  const place = rig.room.worldToLocal(camera.position.clone().set(x, y, z));
  device.controllers[hand].position.set(place.x, place.y, place.z);
}"""
"""Looks to a place in the house, and puts a hand there."""


class Wearer(Person):
    """Somebody with a headset; ``hand``, "right" or "left", is the one that answers."""

    def __init__(self, page: Any, hand: str) -> None:
        super().__init__(page)
        self.hand, self.stick = hand, "left" if hand == "right" else "right"

    def enter(self) -> None:
        """Enter VR."""
        self.page.click("#enter-vr")
        self.until("page.headset.standing === true || page.headset.session !== null")

    def press(self, action: str) -> None:
        """Press the button of an action, or one by its name."""
        hand, button = _BUTTONS[self.hand].get(action, (self.hand, action))
        self.hold(hand, button, 1)
        self.page.wait_for_timeout(150)
        self.hold(hand, button, 0)
        self.page.wait_for_timeout(150)

    def hold(self, hand: str, button: str, value: int) -> None:
        """Hold a button down (1) or let go of it (0) until the page has seen it."""
        frame = self.page.evaluate("page.headset.renderer.info.render.frame")
        self.page.evaluate(f"{DEVICE}.controllers.{hand}.updateButtonValue('{button}', {value})")
        self.until(f"page.headset.renderer.info.render.frame > {frame} + 1")

    def go_straight(self, x: float, y: float) -> None:
        """Walk by stick until the page shows that the person is there or has just passed it, or can go no farther."""
        self.page.evaluate(_WALK, [x, y, self.stick, WALK_S])

    def touch(self, x: float, y: float, z: float) -> None:
        """Look to a place [m], and put the hand there."""
        self.page.evaluate(_TOUCH, [self.hand, x, y, z])

    def do(self, button: str, words: str) -> None:
        """Press a button once that is what it does."""
        self.until(f"page.offers.some(([, what]) => what === {words!r})")
        self.press(button)
