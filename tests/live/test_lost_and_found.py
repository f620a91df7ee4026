"""Headsets that are left and entered, and connections that are lost, again and again: nothing is lost with them."""

from __future__ import annotations

from pathlib import Path
from urllib.parse import urlsplit

import msgspec
import pytest
from live_browser import CHROMIUM
from relay import Relay
from test_page import opened, session, tasks

from benchmarks.page_wearer import Wearer
from hthor.live import server
from hthor.live.desk_wire import AskForHeadset
from hthor.types import HUMAN

pytest.importorskip("starlette", reason="live sessions need an optional dependency: pip install 'hthor[live]'")
pytest.importorskip("playwright", reason="pages are opened with an optional dependency: pip install 'hthor[browser]'")
pytestmark = [
    pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on the PATH"),
    pytest.mark.skipif(not (server.FOLDER / server.PAGE).exists(), reason="the page is not built: make page"),
]
_MESSAGE = "page.headset.screens.sheets.message.mesh.visible"


@pytest.mark.parametrize(
    "times", [pytest.param(3, id="thrice"), pytest.param(20, id="often", marks=pytest.mark.nightly)]
)
def test_vr_is_left_and_entered_and_the_connection_is_lost(times: int, tmp_path: Path) -> None:
    delivery = msgspec.structs.replace(tasks()[0], time_limit=600.0)
    with (
        session(tmp_path, (delivery,)) as live,
        Relay(urlsplit(live.server.address).port, 0.02) as network,  # type: ignore[arg-type]
        opened(
            f"{network.address}/?plain&emulated=quest3&seated=no#{live.server.tokens[HUMAN]}", network.address
        ) as page,
    ):
        live.desk.do(None, AskForHeadset(on=True))  # type: ignore[arg-type]
        page.wait_for_selector("#text:text('The experimenter asks you to enter VR. You have')")
        person = Wearer(page, "right")
        person.enter()
        person.press("accept")
        person.until(f"page.begun && page.panel !== null && {_MESSAGE}")
        for _ in range(times):
            page.evaluate("page.headset.leave()")
            page.wait_for_selector("#title:text('You have left VR')")
            page.wait_for_selector("#panel #words:text('It is over there.')", state="attached")
            person.enter()
            person.until(f"page.headset.standing && {_MESSAGE}")
            assert abs(page.evaluate("page.headset.rig.head.z") - 1.6) < 0.01
            joined = page.evaluate("(window.house = page.house, page.joined)")
            network.cut()
            person.until(f"page.joined > {joined}")
            shown = page.evaluate("page.head?.tick ?? -1")  # of the last connection, or the first of this one
            person.until(f"page.plays && page.head?.tick > {shown} && {_MESSAGE}")
            assert page.evaluate("page.house === window.house"), "the house stays"
        person.press("accept")
        person.until("page.shownMap !== null")
        answers = [line for line in live.desk.events if line.kind == "accepted"]
        assert len(answers) == 1
        page.evaluate("page.headset.leave()")
        page.click("#go:text('Go on at the desk')")
        page.wait_for_selector("#title:text('Please put on the headset')", state="hidden")
        person.until("page.plays")
