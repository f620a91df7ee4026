"""Somebody at the page of a live session, who walks, looks and presses keys in a browser by a script."""

from __future__ import annotations

import math
import time
from typing import Any

_PATIENCE_S = 60.0
_NEAR_M = 0.25

WALK_S = 20.0
"""[s] How long somebody walks to one place at most."""
_WALK = """([x, y, seconds]) => new Promise((done) => {
  const begin = [x - page.motion.x, y - page.motion.y];
  const end = performance.now() + 1000 * seconds;
  const step = () => {
    const left = [x - page.motion.x, y - page.motion.y];
    const there = Math.hypot(...left) < 0.12 || left[0] * begin[0] + left[1] * begin[1] < 0;
    if (there || page.ended !== null || performance.now() > end) {
      page.keys.held.clear();
      return done();
    }
    page.keys.yaw = Math.atan2(left[1], left[0]);
    requestAnimationFrame(step);
  };
  step();
})"""
"""Looks to a place, with the key to walk held down, until the person is there or has just passed it.

It ends with the trial too, and after some time, as when somebody stands in the way: nothing else ends what a page does.
"""


class Person:
    """Somebody at the browser; ``page`` is that of Playwright."""

    def __init__(self, page: Any) -> None:
        self.page = page

    def until(self, condition: str) -> None:
        """Wait until something is so on the page."""
        end = time.monotonic() + _PATIENCE_S
        while not self.page.evaluate(condition):
            assert time.monotonic() < end, condition
            self.page.wait_for_timeout(20)

    def look_at(self, x: float, y: float, z: float) -> None:
        """Turn the eyes to a place [m]."""
        here = self.page.evaluate("[page.motion.x, page.motion.y, page.self.eye]")
        dx, dy, dz = x - here[0], y - here[1], z - here[2]
        pitch = math.atan2(dz, math.hypot(dx, dy))
        self.page.evaluate(f"page.keys.yaw = {math.atan2(dy, dx)}; page.keys.pitch = {pitch}")

    def walk_to(self, x: float, y: float) -> None:
        """Walk there, and see whether that is where they are, once the server has answered; else walk again."""
        end = time.monotonic() + _PATIENCE_S
        while time.monotonic() < end:
            self.go_straight(x, y)
            self.answered()
            if self.page.evaluate(f"Math.hypot(page.head.x - {x}, page.head.y - {y})") < _NEAR_M:
                return
        raise AssertionError(f"the person does not come to {x}, {y}")

    def go_straight(self, x: float, y: float) -> None:
        """Walk until the page shows that the person is there or has just passed it, or they can go no farther."""
        self.page.evaluate(f"page.keys.yaw = Math.atan2({y} - page.motion.y, {x} - page.motion.x)")
        self.page.keyboard.down("w")
        self.page.evaluate(_WALK, [x, y, WALK_S])
        self.page.keyboard.up("w")

    def answered(self) -> None:
        """Wait until the server has answered all that was steered so far."""
        last = self.page.evaluate("page.motion.number")
        self.until(f"page.head.steering > {last}")

    def open_fridge(self) -> None:
        """Open it, with a step back each time that the door meets the person."""
        while not self.page.query_selector("#offers :text('close the fridge')"):
            self.press_when_offered("f", "open the fridge")
            pressed = self.page.evaluate("page.head.tick")
            self.until(f"page.head.tick > {pressed + 15} && !page.now.busy")
            if self.page.evaluate("!page.now.outcome.ok"):
                self.page.keyboard.press("s", delay=300)
            self.page.wait_for_timeout(300)

    def go_on_until_offered(self, words: str) -> None:
        """Go ahead, step by step, until the page offers to do something."""
        end = time.monotonic() + _PATIENCE_S
        while not self.page.query_selector(f"#offers :text('{words}')"):
            assert time.monotonic() < end, words
            self.page.keyboard.press("w", delay=150)
            self.answered()
            self.page.wait_for_timeout(300)

    def press_when_offered(self, key: str, words: str) -> None:
        """Press a key as soon as the page offers what it does."""
        self.page.wait_for_selector(f"#offers :text('{words}')")
        self.page.keyboard.press(key)
