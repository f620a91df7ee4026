"""Pictures of a trial at the page of `hthor live`: ``python -m benchmarks.page_trial [--out FOLDER]``.

A script plays a delivery in Chromium, in real time: the states of the person's page as tiles of one sheet, and the
experimenter's page in the middle of the trial.
"""

from __future__ import annotations

import argparse
import functools
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import cv2
import msgspec
import numpy as np

from benchmarks import page_browser
from benchmarks.page_person import Person
from hthor import houses
from hthor.guest import GuestPool
from hthor.live.control import SessionControl, SessionStopped
from hthor.live.desk import Desk
from hthor.live.loop import RealTimeLoop
from hthor.live.run_book import RunBook
from hthor.live.seat import LiveSeat
from hthor.live.server import LiveServer
from hthor.live.sessions import welcome
from hthor.tasks.arrangement.placement import place_on, supports_of
from hthor.trials import TrialRunner, form_team, make_sessions, make_sources
from hthor.types import HUMAN, Goal, Placement, Pose, TaskSpec

TRIAL, EXPERIMENTER = "live_trial.jpg", "live_experimenter.jpg"
_HOME, _COUNTER = "juniper", "counter_top"
_START, _ROBOT = Pose(x=2.3, y=8.9, yaw=-0.65), Pose(x=3.7, y=6.3, yaw=0.35, pitch=-0.1)
BY_COUNTER, BY_FRIDGE, FRIDGE = (4.5, 6.9), (4.25, 9.0), (5.43, 9.2, 1.0)
_AGENT = """
from hthor.types import Action, Send, Wait


class Agent:
    def begin(self, briefing):
        self.said = False

    def act(self, observation):
        if self.said or observation.tick < 40:
            return Action(motion=Wait(seconds=0.2))
        self.said = True
        return Action(say=Send(text="I found the apple here.", object="apple", position={place}))
"""
"""A robot that stands before the apple, and says so after four seconds."""
PAGE, _TILE, _DESK = (1200, 750), (600, 375), (1200, 740)
_COLUMNS, _GAP, _BAR, _PAPER, _INK = 2, 8, 26, 250, (60, 55, 50)
_REST_MS, _TRIES, _PATIENCE_MS = 700, 20, 120_000
_QUALITY, _DESK_QUALITY = 82, 86


def task() -> TaskSpec:
    """A delivery in one kitchen, with time for a browser that draws on the processor."""
    sample = make_sessions("smoke", agent=form_team(["scout"], ["none"]), humans="live", clock="concurrent")
    plan = houses.load(_HOME)
    first = next(trial.task for one in sample for trial in one.trials if trial.task.house == _HOME)
    return msgspec.structs.replace(
        first,
        kind="mobile_manipulation",
        human_start=_START,
        robot_starts=(_ROBOT,),
        objects=(apple(),),
        goal=Goal(target="apple", relation="in", destination="fridge"),
        instruction="Pick an apple and place it in a fridge.",
        house_sha256=plan.sha256,
        time_limit=300.0,
    )


@functools.cache
def apple() -> Placement:
    """The apple, on a counter top."""
    thing = next(one for one in houses.load(_HOME).things if one.id == _COUNTER)
    top = next(rest for rest in supports_of(thing) if not rest.surface.inside)
    return place_on("apple", top, 0.45, 0.25, 0.0)


@contextmanager
def session() -> Iterator[LiveServer]:
    """The server of a session with one trial, which is played in a thread."""
    with tempfile.TemporaryDirectory() as folder:
        agent = Path(folder) / "finder.py"
        agent.write_text(_AGENT.replace("{place}", repr(apple().position)), encoding="utf-8")
        team = form_team(["scout"], [str(agent)])
        first = make_sessions("smoke", agent=team, humans="live", clock="concurrent")[0]
        trial = msgspec.structs.replace(first.trials[0], task=task(), index=0)
        played = msgspec.structs.replace(first, trials=(trial,))
        seats, control = {HUMAN: LiveSeat(HUMAN)}, SessionControl()
        desk = Desk(control, seats, RunBook())
        server = LiveServer(seats, desk)
        server.start(page=True)
        loop = RealTimeLoop(seats, control, desk, trials=1, publish=server.publish)
        runner = TrialRunner(make_sources(team), GuestPool(), loop=loop)

        def play() -> None:
            with suppress(SessionStopped), runner.enter(played) as participants:
                welcome(participants, seats)
                runner.run(participants, trial)

        thread = threading.Thread(target=play)
        thread.start()
        try:
            yield server
        finally:
            control.stop()
            thread.join()
            server.close()


class Sheet:
    """Pictures of a page's states, with a line of words above each."""

    def __init__(self, page: Any) -> None:
        self._page, self._tiles = page, list[Any]()

    def take(self, words: str) -> None:
        """Add what the page shows now."""
        bar = np.full((_BAR, _TILE[0], 3), _PAPER, np.uint8)
        cv2.putText(bar, words, (2, _BAR - 8), cv2.FONT_HERSHEY_SIMPLEX, 0.5, _INK, 1, cv2.LINE_AA)
        shot = cv2.resize(_screenshot(self._page), _TILE, interpolation=cv2.INTER_AREA)
        self._tiles.append(np.concatenate([bar, shot]))

    def picture(self) -> Any:
        """All tiles, (H, W, 3) uint8 in the order of colours of OpenCV."""
        blank = np.full_like(self._tiles[0], _PAPER)
        tiles = self._tiles + [blank] * (-len(self._tiles) % _COLUMNS)
        edged = [np.pad(one, ((0, _GAP), (0, _GAP), (0, 0)), constant_values=_PAPER) for one in tiles]
        rows = [np.concatenate(edged[k : k + _COLUMNS], axis=1) for k in range(0, len(edged), _COLUMNS)]
        return np.concatenate(rows)[:-_GAP, :-_GAP]


def play() -> tuple[Any, Any]:
    """Play the trial; the sheet of the person's page, and the experimenter's page in the middle of it."""
    with page_browser.browser() as browser, session() as server:
        page = browser.new_page(viewport=dict(zip(("width", "height"), PAGE, strict=True)))
        page.set_default_timeout(_PATIENCE_MS)
        page.goto(server.url(HUMAN))
        sheet, person = Sheet(page), Person(page)
        page.wait_for_selector("#go:not(.hidden)")
        sheet.take("before the trial: the task, and the keys")
        page.click("#go")
        person.until("page.head !== null && page.plays")
        person.look_at(*apple().position[:2], 1.3)
        page.keyboard.down("w")
        page.wait_for_timeout(700)
        sheet.take("walking")
        page.keyboard.up("w")
        page.wait_for_selector("#picture:not(.hidden)")
        page.wait_for_timeout(500)
        sheet.take("a robot's message, with its picture")
        page.keyboard.press("y")
        page.wait_for_selector("#map:not(.hidden)")
        page.wait_for_timeout(500)
        sheet.take("the map, once the message is confirmed")
        person.walk_to(*BY_COUNTER)
        _face(person, apple().position, "pick up the apple")
        sheet.take("the apple is in reach, and is offered")
        page.evaluate("page.renderer.setPixelRatio(0.2)")  # leaves the processor to the other page
        desk = _experimenter(browser, server)
        page.evaluate("page.renderer.setPixelRatio(1)")
        page.keyboard.press("e")
        person.until("page.now.holding === 'apple' && !page.now.busy")
        page.evaluate("page.keys.pitch = -0.8")
        page.wait_for_timeout(500)
        sheet.take("in hand")
        person.walk_to(*BY_FRIDGE)
        _face(person, FRIDGE, "open the fridge")
        person.open_fridge()
        person.go_on_until_offered("put the apple in the fridge")
        page.wait_for_timeout(1000)
        sheet.take("at the fridge, which is open")
        page.keyboard.press("e")
        page.wait_for_selector("#scale [data-value='6']")
        page.wait_for_timeout(300)
        sheet.take("after the trial: trust in the robot")
        page.click("#scale [data-value='6']")
    return sheet.picture(), desk


def _face(person: Person, place: tuple[float, float, float], words: str) -> None:
    """Look at a place [m] until these words are offered, again and again, as the last step may not be over."""
    for _ in range(_TRIES):
        person.page.wait_for_timeout(_REST_MS)
        person.look_at(*place)
        person.page.wait_for_timeout(_REST_MS)
        if person.page.query_selector(f"#offers :text('{words}')"):
            return
    raise SystemExit(f"the page does not offer to {words}")


def _experimenter(browser: Any, server: LiveServer) -> Any:
    page = browser.new_page(viewport=dict(zip(("width", "height"), _DESK, strict=True)))
    page.goto(server.desk_url)
    page.click("#look:not(.hidden)")
    end = time.monotonic() + 60.0
    while page.evaluate("document.querySelectorAll('#views canvas').length") < 2:
        assert time.monotonic() < end, "the experimenter's page shows no seats"
        page.wait_for_timeout(50)
    page.wait_for_timeout(6000)
    shot = _screenshot(page)
    page.close()
    return shot


def _screenshot(page: Any) -> Any:
    return cv2.imdecode(np.frombuffer(page.screenshot(timeout=_PATIENCE_MS), np.uint8), cv2.IMREAD_COLOR)


@functools.cache
def pictures() -> dict[str, Any]:
    """Both pictures by the names of their files; the trial is played once."""
    return dict(zip((TRIAL, EXPERIMENTER), play(), strict=True))


def write(path: Path) -> None:
    """Write the picture with this name."""
    quality = _QUALITY if path.name == TRIAL else _DESK_QUALITY
    cv2.imwrite(str(path), pictures()[path.name], [cv2.IMWRITE_JPEG_QUALITY, quality])


def main() -> None:
    """Make both pictures."""
    options = argparse.ArgumentParser(prog="python -m benchmarks.page_trial", description=__doc__.splitlines()[0])
    options.add_argument("--out", type=Path, default=Path("docs/images"), help="folder")
    folder = options.parse_args().out
    for name in (TRIAL, EXPERIMENTER):
        write(folder / name)


if __name__ == "__main__":
    main()
