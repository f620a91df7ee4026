"""The page in a real browser: a person walks, confirms and declines messages, delivers and searches."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import msgspec
import pytest
from live_browser import CHROMIUM, launch
from live_session import LiveSession
from practice_trials import play_in_practice_room
from relay import Relay
from world_house import COUNTER, TABLE, house, on, task

from benchmarks.page_person import Person
from hthor.errors import HthorError
from hthor.eval.config.options import EvalOptions
from hthor.eval.runner.progress import Silent
from hthor.live import server
from hthor.live.run import LiveRun
from hthor.types import HUMAN, Goal, Pose, TaskSpec
from hthor.types.events import Accepted, Declined, Displayed
from hthor.world import World

pytest.importorskip("starlette", reason="live sessions need an optional dependency: pip install 'hthor[live]'")
browsers = pytest.importorskip(
    "playwright.sync_api", reason="pages are opened with an optional dependency: pip install 'hthor[browser]'"
)

_PATIENCE_MS = 60_000
APPLE = (2.95, 2.8)

_COLOURS = """(seat) => {
  const canvas = document.querySelector(`#views canvas[data-seat=${seat}]`);
  if (!canvas) return 0;
  const pen = new OffscreenCanvas(canvas.width, canvas.height).getContext("2d", { willReadFrequently: true });
  pen.drawImage(canvas, 0, 0);
  const { data } = pen.getImageData(0, 0, canvas.width, canvas.height);
  return new Set(new Uint32Array(data.buffer)).size;
}"""
"""How many colours the picture of what a seat sees has, on the experimenter's page."""

pytestmark = [
    pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on the PATH"),
    pytest.mark.skipif(not (server.FOLDER / server.PAGE).exists(), reason="the page is not built: make page"),
]


def tasks() -> tuple[TaskSpec, ...]:
    """A delivery and a search in one room."""
    objects = (on(TABLE, "apple", u=0.45, v=0.2), on(COUNTER, "mug", u=-0.4))
    first = task(*objects, robots=(Pose(x=4.3, y=3.4, yaw=3.0),))
    delivery = msgspec.structs.replace(
        first,
        goal=Goal(target="apple", relation="in", destination="fridge"),
        kind="mobile_manipulation",
        instruction="Pick the apple and place it in the fridge.",
    )
    search = msgspec.structs.replace(
        first, kind="object_goal_navigation", instruction="Find an apple.", human_start=Pose(x=4.0, y=2.0, yaw=-1.0)
    )
    return delivery, search


@pytest.fixture
def live(tmp_path: Path) -> Iterator[LiveSession]:
    with session(tmp_path) as made:
        yield made


@contextmanager
def session(folder: Path, played: Sequence[TaskSpec] = (), **options: Any) -> Iterator[LiveSession]:
    """These tasks, or both, in one room, in real time."""
    plan = house()
    rooms = msgspec.structs.replace(plan, things=tuple(one for one in plan.things if one.id != "chair|1"))
    world = World(rooms, robots=["scout"], objects=(("apple", "apple"), ("mug", "mug")))
    made = LiveSession(folder, played or tasks(), world, faster=1.0, **options)
    try:
        yield made
    finally:
        made.close()


def test_a_person_plays_a_delivery_and_a_search_in_the_browser(live: LiveSession) -> None:
    play(live, live.server.address)


def test_a_house_that_cannot_be_loaded_is_loaded_again(live: LiveSession) -> None:
    failed: list[str] = []

    def fail_once(route: Any) -> None:
        if failed:
            route.continue_()
        else:
            failed.append(route.request.url)
            route.fulfill(status=200, body="")

    address = live.server.address
    with opened(plain(live.server.url(HUMAN)), address, lambda page: page.route("**/house/*", fail_once)) as page:
        page.wait_for_selector("#text:text('The house cannot be loaded. The page tries again')")
        page.click("#go:text('Begin')")
        Person(page).until("page.plays")


@pytest.fixture
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    """Trials in the room of the practice, which is drawn in no time."""
    play_in_practice_room(monkeypatch, 90.0)


def test_a_practice_ticks_off_what_was_tried_and_is_skipped(tmp_path: Path, small: None) -> None:
    options = EvalOptions(agent=("none",), humans=("live",), limit=1, suite="smoke", out=tmp_path / "run")
    with LiveRun(options, practice=True) as run:
        playing = threading.Thread(target=lambda: play_until_stopped(run))
        playing.start()
        with opened(plain(run.server.url(HUMAN)), run.server.address) as page:
            page.wait_for_selector("#title:text('Practice')")
            page.click("#go:not(.hidden)")
            page.wait_for_selector("#steps-left:text('Still to try: 11')")
            assert page.is_hidden("#time")
            page.wait_for_selector("#words:text('confirm this message')")
            page.keyboard.press("y")
            page.wait_for_selector("#steps-list .done :text('confirm a message')")
            page.evaluate("page.keys.yaw = 0.1")
            page.keyboard.down("w")
            page.wait_for_selector("#steps-list .done :text('walk about')")
            page.keyboard.up("w")
            page.click("#skip")
            page.wait_for_selector("#text:text('You have 90 seconds.')")
            assert page.text_content("#trial") == "1 of 1"
            assert page.is_hidden("#steps")
        run.control.stop()
        playing.join()


def play_until_stopped(run: LiveRun) -> None:
    with suppress(HthorError):  # it is ended before its end
        run.play(lambda _: Silent())


@pytest.mark.nightly
@pytest.mark.parametrize("round_trip_ms", [100, 200, 300, 500])
def test_delays_and_jitter_spoil_neither(round_trip_ms: int, live: LiveSession) -> None:
    with Relay(urlsplit(live.server.address).port, round_trip_ms / 1000) as slow:  # type: ignore[arg-type]
        largest = play(live, slow.address)
    assert round_trip_ms > 200 or largest < 0.5


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("gap_s", "every_s"), [pytest.param(0.25, 2.0, id="stalls"), *((gap, 10.0) for gap in (1.0, 2.0, 5.0))]
)
def test_gaps_of_the_network_spoil_neither(gap_s: float, every_s: float, live: LiveSession) -> None:
    over = threading.Event()
    with Relay(urlsplit(live.server.address).port, 0.02) as network:  # type: ignore[arg-type]

        def disturb() -> None:
            while not over.wait(every_s):
                network.hold(gap_s)

        disturber = threading.Thread(target=disturb)
        disturber.start()
        try:
            play(live, network.address)
        finally:
            over.set()
            disturber.join()


def play(live: LiveSession, address: str) -> float:
    """Play a session at this address, and check what became of it; the largest correction [m] of the own motion."""
    with opened(f"{address}/?plain#{live.server.tokens[HUMAN]}", address) as page:
        person = Person(page)
        deliver(person)
        search(person)
        page.wait_for_selector("#title:text('Thank you')")
        live.thread.join(60.0)
        largest: float = page.evaluate("page.motion.largest")
    check_played(live)
    return largest


def check_played(live: LiveSession) -> None:
    """Both trials were played to the end as the script wanted them."""
    delivery, found = live.logs
    assert delivery.met
    assert found.met
    assert [log.ratings for log in live.logs] == [{HUMAN: 6}, {HUMAN: 2}]
    assert any(isinstance(event, Accepted) for event in delivery.events)
    assert any(isinstance(event, Declined) for event in found.events)
    shown = [(event.what, event.on) for event in delivery.events if isinstance(event, Displayed)]
    assert shown[-2:] == [("map", False), ("map", True)]
    for log in live.logs:
        answers = [event.message for event in log.events if isinstance(event, Accepted | Declined)]
        assert len(answers) == len(set(answers)), "each answer counts once"


def test_the_experimenter_starts_a_trial_and_sees_what_everybody_sees(tmp_path: Path) -> None:
    with (
        session(tmp_path, experimenter_starts=True) as live,
        opened(plain(live.server.desk_url), live.server.address) as page,
    ):
        page.wait_for_selector("#state:text('waiting for human')")
        assert page.is_disabled("#start")
        with live.person() as person:
            person.wait_for("trial")
            person.send({"type": "begin", "trial": 0})
            page.click("#start:not([disabled])")
            person.wait_for("began")
            page.click("#look")
            for seat in (HUMAN, "robot"):
                Person(page).until(f"({_COLOURS})('{seat}') > 100")
            page.wait_for_selector("#events :text('robot said')")
            page.wait_for_selector("#people :text('pictures/s')")
            assert page.is_hidden("#start")
            page.click("#look")
            assert page.query_selector("#views canvas") is None


def plain(url: str) -> str:
    """The address of a page that spares machines without graphics."""
    return url.replace("#", "?plain#")


@contextmanager
def opened(url: str, address: str, prepare: Callable[[Any], None] = lambda _: None) -> Iterator[Any]:
    """A page in a browser, which must not complain, nor ask any other site for anything."""
    complaints: list[str] = []
    with browsers.sync_playwright() as playwright:
        browser = launch(playwright)
        page = browser.new_page(viewport={"width": 480, "height": 300})
        page.on("console", lambda message: complaints.append(message.text))
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.on("request", lambda request: note_foreign(request.url, address, complaints))
        prepare(page)
        page.goto(url)
        page.set_default_timeout(_PATIENCE_MS)
        yield page
        browser.close()
    assert complaints == []


def note_foreign(url: str, address: str, complaints: list[str]) -> None:
    if not url.startswith((address, "blob:" + address, address.replace("http", "ws"))):
        complaints.append(url)


def deliver(person: Person) -> None:
    page = person.page
    page.click("#go")
    page.wait_for_selector("#words:text('It is over there.')")
    page.wait_for_selector("#picture:not(.hidden)")
    page.keyboard.press("y")
    page.wait_for_selector("#map:not(.hidden)")
    page.keyboard.press("m")
    page.wait_for_selector("#map", state="hidden")
    page.keyboard.press("m")
    page.wait_for_selector("#map:not(.hidden)")
    person.walk_to(3.65, 2.15)
    person.look_at(*APPLE, 0.78)
    person.press_when_offered("e", "pick up the apple")
    person.until("page.now.holding === 'apple'")
    person.walk_to(3.5, 1.75)
    person.walk_to(1.3, 1.75)
    person.walk_to(0.75, 2.3)
    person.look_at(0.6, 3.2, 1.0)
    person.open_fridge()
    person.go_on_until_offered("put the apple in the fridge")
    person.press_when_offered("e", "put the apple in the fridge")
    page.wait_for_selector("#scale [data-value='6']")
    page.reload()  # the question is still there
    page.click("#scale [data-value='6']")


def search(person: Person) -> None:
    page = person.page
    page.click("#go")
    page.wait_for_selector("#words:text('It is over there.')")
    page.keyboard.press("n")
    page.wait_for_selector("#panel", state="hidden")
    person.look_at(*APPLE, 1.6)
    page.keyboard.down("w")  # until it is found, which is when they see it from near
    page.wait_for_selector("#scale [data-value='2']")
    page.keyboard.up("w")
    page.click("#scale [data-value='2']")
