"""Pictures of a trial with a headset: ``python -m benchmarks.page_headset [--out FOLDER]``.

A script plays the delivery of `benchmarks.page_trial` with an emulated Quest 3; a tile shows what both eyes see.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import cv2

from benchmarks import page_browser
from benchmarks.page_trial import BY_COUNTER, BY_FRIDGE, FRIDGE, PAGE, Sheet, apple, session
from benchmarks.page_wearer import DEVICE, Wearer
from hthor.types import HUMAN

HEADSET = "live_headset.jpg"
_QUALITY = 82
_REST_MS, _PATIENCE_MS = 1500, 120_000


@contextmanager
def deliver(options: str, hand: str) -> Iterator[tuple[Wearer, Iterator[str]]]:
    """The trial, by somebody who is in VR already.

    Args:
        options: of the page's address. hand: the one that answers.

    Returns:
        the person; and the moments of the trial in words, each of which comes when the person is there.
    """
    with page_browser.browser() as browser, session() as server:
        page = browser.new_page(viewport=dict(zip(("width", "height"), PAGE, strict=True)))
        page.set_default_timeout(_PATIENCE_MS)
        page.goto(server.url(HUMAN).replace("#", f"?{options}#"))
        person = Wearer(page, hand)
        page.wait_for_selector("#go:not(.hidden)")
        person.enter()
        yield person, _moments(person)


def _moments(person: Wearer) -> Iterator[str]:
    page = person.page
    person.press("accept")
    person.until("page.begun && page.panel !== null && page.headset.screens.picture !== null")
    person.touch(*apple().position[:2], 1.4)
    yield "a message, with its picture"
    person.press("accept")
    person.until("page.shownMap !== null")
    yield "the map, once it is confirmed"
    person.walk_to(*BY_COUNTER)
    person.touch(*apple().position)
    person.until("page.offers.some(([, what]) => what === 'pick up the apple')")
    yield "the hand at the apple"
    person.press("squeeze")
    person.until("page.now.holding === 'apple' && !page.now.busy")
    person.walk_to(*BY_FRIDGE)
    person.touch(*FRIDGE)
    while not page.evaluate("page.offers.some(([, what]) => what === 'close the fridge')"):
        person.do("trigger", "open the fridge")
        pressed = page.evaluate("page.head.tick")
        person.until(f"page.head.tick > {pressed + 15} && !page.now.busy")
    yield "the apple in hand, the fridge open"
    person.do("squeeze", "put the apple in the fridge")
    person.until("page.ended !== null && page.ended.rate")
    yield "after the trial: trust in the robot"
    person.press("accept")


def play() -> Any:
    """Play the trial; the sheet of what the person sees with both eyes."""
    with deliver("emulated=quest3", "right") as (person, moments):
        person.page.evaluate(f"{DEVICE}.stereoEnabled = true")
        sheet = Sheet(person.page)
        for words in moments:
            person.page.wait_for_timeout(_REST_MS)
            sheet.take(words)
    return sheet.picture()


def write(path: Path) -> None:
    """Write the picture."""
    cv2.imwrite(str(path), play(), [cv2.IMWRITE_JPEG_QUALITY, _QUALITY])


def main() -> None:
    """Make the picture."""
    options = argparse.ArgumentParser(prog="python -m benchmarks.page_headset", description=__doc__.splitlines()[0])
    options.add_argument("--out", type=Path, default=Path("docs/images"), help="folder")
    write(options.parse_args().out / HEADSET)


if __name__ == "__main__":
    main()
