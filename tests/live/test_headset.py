"""The page with an emulated headset in a real browser: a person walks, uses their hands, answers and rates in VR."""

from __future__ import annotations

from pathlib import Path

import pytest
from live_browser import CHROMIUM
from live_session import LiveSession
from test_page import APPLE, check_played, opened, session

from benchmarks.page_wearer import DEVICE, Wearer
from hthor.live import server
from hthor.types import HUMAN
from hthor.types.events import Paused

pytest.importorskip("starlette", reason="live sessions need an optional dependency: pip install 'hthor[live]'")
pytest.importorskip("playwright", reason="pages are opened with an optional dependency: pip install 'hthor[browser]'")
pytestmark = [
    pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on the PATH"),
    pytest.mark.skipif(not (server.FOLDER / server.PAGE).exists(), reason="the page is not built: make page"),
]
CALLS = 90
"""How many calls may draw what both eyes see."""


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
        check_played(live)
        check_paused(live)


def deliver(person: Wearer) -> None:
    person.press("accept")
    person.until("page.begun && page.panel !== null")
    assert abs(person.page.evaluate("page.headset.rig.head.z") - 1.6) < 0.01
    person.press("accept")
    person.until("page.shownMap !== null")
    check_drawn(person)
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


def check_drawn(person: Wearer) -> None:
    """Both eyes together are drawn in a few calls, as a headset's own processor can."""
    person.page.evaluate(f"{DEVICE}.stereoEnabled = true")
    frame = person.page.evaluate("page.headset.renderer.info.render.frame")
    person.until(f"page.headset.renderer.info.render.frame > {frame} + 2")
    drawn = person.page.evaluate("page.headset.renderer.info.render")
    assert 8 <= drawn["calls"] <= CALLS
    person.page.evaluate(f"{DEVICE}.stereoEnabled = false")


def take_off(person: Wearer) -> None:
    """Take the headset off until time stands still, and put it on again."""
    person.page.evaluate(f"{DEVICE}.updateVisibilityState('hidden')")
    person.until("page.paused === 'the headset of human is off'")
    person.page.evaluate(f"{DEVICE}.updateVisibilityState('visible')")
    person.until("page.paused === ''")


def search(person: Wearer) -> None:
    person.until("page.trial.trial === 1 && page.house !== null")
    person.press("accept")
    person.until("page.begun && page.panel !== null")
    person.press("decline")
    person.until("page.panel === null")
    person.touch(*APPLE, 1.2)
    stick = f"{DEVICE}.controllers.{person.stick}.updateAxes('thumbstick', 0, {{}})"
    person.page.evaluate(stick.format(-1))  # until it is found, which is when they see it from near
    person.until("page.ended !== null && page.ended.rate")
    person.page.evaluate(stick.format(0))
    rate(person, 2)


def rate(person: Wearer, value: int) -> None:
    """Choose a value with the stick, from the middle of the scale."""
    while (gap := value - person.page.evaluate("page.chosen")) != 0:
        for x in (1 if gap > 0 else -1, 0):
            frame = person.page.evaluate("page.headset.renderer.info.render.frame")
            person.page.evaluate(f"{DEVICE}.controllers.{person.hand}.updateAxes('thumbstick', {x}, 0)")
            person.until(f"page.headset.renderer.info.render.frame > {frame} + 1")
    person.press("accept")


def check_paused(live: LiveSession) -> None:
    reasons = [event.reason for event in live.logs[0].events if isinstance(event, Paused)]
    assert reasons == ["the headset of human is off"]
